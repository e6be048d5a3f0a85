"""Many logs on a cluster: the executor of dask.distributed."""

import asyncio
import logging
import pickle
import re
import warnings
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final

from dogbot_logtool import __version__
from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.run.executor import AHEAD, LOOK_EVERY_S, ExecutorRunner, RunLost
from dogbot_logtool.run.runner import Failure, Result, Work, attempt

try:
    import distributed
except ImportError as error:
    raise ExtraMissingError("--scheduler", "fleet") from error

_DASK_VERSION: Final[str] = distributed.__version__  # type: ignore[attr-defined]
_ADDRESS: Final = re.compile(r"(tcp|tls|ws|wss|ucx)://\S+")
_CONNECT_S: Final = 10
_WORKER_S: Final = 30
"""How long a scheduler may be without workers: lost ones may be started anew."""
_CLOSE_S: Final = 5


class ClusterRunner(ExecutorRunner[Result]):
    """The workers of a scheduler, which gives what a lost worker had in hand to others."""

    jobs = 1
    capacity = AHEAD

    def __init__(self, scheduler: str) -> None:
        """Connect.

        Args:
            scheduler: ``tcp://host:port`` or the like.

        Raises:
            CallError: it is no address.
            LogtoolError: no scheduler answers, or one of another version.
        """
        if not _ADDRESS.fullmatch(scheduler):
            hint = "; --jobs N uses N processes of this machine" if "local" in scheduler else ""
            raise CallError(
                f"--scheduler {scheduler}: must be an address such as tcp://host:8786{hint}"
            )
        self._name = scheduler
        self._client = _connected(scheduler)
        self._executor = self._client.get_executor(pure=False)
        self._looks_without_workers = 0

    def submit(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """See `ExecutorRunner.submit`."""
        call = pickle.dumps(_Call((__version__, work, item)))
        try:
            future: Future[Result | Failure] = self._executor.submit(pickle.loads, call)
        except (OSError, RuntimeError) as error:
            raise self._run_lost() from error
        return future

    def look(self) -> None:
        """See `ExecutorRunner.look`."""
        if self._client.status != "running":
            raise self._run_lost()
        try:
            found = self._client.scheduler_info(n_workers=1)["workers"]
        except OSError as error:
            raise self._run_lost() from error
        self._looks_without_workers = 0 if found else self._looks_without_workers + 1
        if self._looks_without_workers * LOOK_EVERY_S > _WORKER_S:
            raise RunLost(
                f"was not done: {self._name} has no workers; start some where dogbot-logtool is "
                f"installed, with: dask worker {self._name}"
            )

    def _run_lost(self) -> RunLost:
        return RunLost(f"was not done: the scheduler {self._name} was lost")

    def explain(self, error: Exception, *, again: bool) -> str | None:
        """See `ExecutorRunner.explain`.

        Dask tries again itself. But it raises a TypeError where the worker dies whose result it has
        just fetched; errors of the work itself are outcomes, and none of these.
        """
        if isinstance(error, TypeError) and not again:
            return None
        if isinstance(error, CancelledError):
            # The client cancels everything when it loses the scheduler.
            return str(self._run_lost())
        if isinstance(error, distributed.KilledWorker):
            return "every worker that worked on it died, perhaps because memory ran out"
        if isinstance(error, ModuleNotFoundError):
            return f"a worker cannot do it: {error}; install dogbot-logtool there"
        return f"the cluster failed: {type(error).__name__}: {error}"

    def close(self) -> None:
        """Give up what is under way, and leave the scheduler."""
        with suppress(OSError, RuntimeError):
            self._executor.shutdown(wait=False)
        with suppress(OSError, RuntimeError):
            self._client.close(_CLOSE_S)


def _connected(scheduler: str) -> "distributed.Client":
    """Return a client of a scheduler.

    Raises:
        LogtoolError: no scheduler answers, or one of another version.
    """
    # Errors are reported in a sentence.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    warnings.simplefilter("ignore", distributed.versions.VersionMismatchWarning)
    try:
        version = asyncio.run(asyncio.wait_for(_version_of(scheduler), _CONNECT_S))
        if version == _DASK_VERSION:
            return distributed.Client(scheduler, timeout=_CONNECT_S, set_as_default=False)
    except Exception as error:  # a server of another kind may answer anything
        # dask names the address without what makes it one, and so with its password.
        why = str(error).replace(scheduler.partition("://")[2], name_of(scheduler))
        raise LogtoolError(
            f"--scheduler {scheduler}: no scheduler answers there ({why or 'timed out'}); "
            "check the address, and that `dask scheduler` runs there"
        ) from error
    raise LogtoolError(
        f"--scheduler {scheduler}: it has dask.distributed {version}, and here is "
        f"{_DASK_VERSION}; install the same version on both"
    )


async def _version_of(scheduler: str) -> str:
    """Ask a scheduler for its version: a client of another one may wait for ever."""
    arguments = distributed.Security().get_connection_args("client")
    async with distributed.rpc(scheduler, connection_args=arguments) as remote:
        packages = (await remote.versions())["packages"]
    return str(dict(packages)["distributed"])


@dataclass(frozen=True, slots=True)
class _Call:
    """A call that is made where this is unpickled, which gives its result.

    Sent as bytes it is read by the worker alone: the scheduler needs no dogbot-logtool, and a
    worker without it raises an error, while dask waits for ever for what it cannot unpickle itself.
    """

    arguments: tuple[Any, ...]

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return _attempt, self.arguments


def _attempt(version: str, work: Work[Result], item: object) -> Result | Failure:
    """Work on an item; runs on a worker."""
    if version != __version__:
        return Failure(f"the worker has dogbot-logtool {__version__}, not {version}", 1)
    return attempt(work, item, None)
