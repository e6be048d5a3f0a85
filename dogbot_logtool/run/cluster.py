"""Many logs on a cluster: the executor of dask.distributed."""

import asyncio
import logging
import pickle
import pkgutil
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final

from dogbot_logtool import __version__
from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.run.executor import AHEAD, LOOK_EVERY_S, ExecutorRunner, RunLost
from dogbot_logtool.run.runner import Failure, Progress, Result, Work, attempt

try:
    import distributed
except ImportError as error:
    raise ExtraMissingError("--scheduler", "fleet") from error

_DASK_VERSION: Final[str] = distributed.__version__  # type: ignore[attr-defined]
_PACKAGE: Final = "dogbot_logtool"
_ADDRESS: Final = re.compile(r"(tcp|tls|ws|wss|ucx)://\S+")
_CONNECT_S: Final = 10
_FIRST_WORKER_S: Final = 10
"""How long a scheduler may be without workers when a run begins."""
_NEXT_WORKER_S: Final = 60
"""How long it may be without workers while a run goes on: lost ones may be started anew."""
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

    def run(
        self, work: Work[Result], items: Sequence[Any], progress: Progress
    ) -> Iterator[Result | Failure]:
        """See `ExecutorRunner.run`.

        Raises:
            LogtoolError: there are no workers, or some of them cannot do it.
        """
        try:
            self._await_workers(progress)
            self._check_workers()
        except OSError as error:
            raise LogtoolError(f"--scheduler {self._name}: it was lost; start it again") from error
        yield from super().run(work, items, progress)

    def _await_workers(self, progress: Progress) -> None:
        if not self._has_workers():
            progress.say(f"{self._name} has no workers; waiting {_FIRST_WORKER_S} s for one")
        try:
            self._client.wait_for_workers(1, _FIRST_WORKER_S)
        except TimeoutError as error:
            raise LogtoolError(
                f"--scheduler {self._name}: has no workers; start some where dogbot-logtool is "
                f"installed, with: dask worker {self._name}"
            ) from error

    def _has_workers(self) -> bool:
        return bool(self._client.scheduler_info(n_workers=1)["workers"])

    def _check_workers(self) -> None:
        """Refuse workers that cannot do the work.

        Raises:
            LogtoolError: some have no dogbot-logtool, or another version.
        """
        for package, here in (("distributed", _DASK_VERSION), (_PACKAGE, __version__)):
            name = f"{package}:__version__"
            found = self._client.run(pkgutil.resolve_name, name, on_error="return")
            wrong = {worker: there for worker, there in found.items() if there != here}
            if wrong:
                worker, there = min(wrong.items())
                what = f"has {there}" if isinstance(there, str) else f"has none ({there})"
                raise LogtoolError(
                    f"--scheduler {self._name}: {len(wrong)} of {len(found)} workers cannot do it: "
                    f"here is {package} {here}, and {worker} {what}; install the same there"
                )

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
            found = self._has_workers()
        except OSError as error:
            raise self._run_lost() from error
        self._looks_without_workers = 0 if found else self._looks_without_workers + 1
        if self._looks_without_workers * LOOK_EVERY_S > _NEXT_WORKER_S:
            raise RunLost(f"was not done: {self._name} has no workers any more")

    def _run_lost(self) -> RunLost:
        return RunLost(f"was not done: the scheduler {self._name} was lost")

    def may_help(self, error: Exception) -> bool:
        """See `ExecutorRunner.may_help`.

        Dask tries again itself. But it raises a TypeError where the worker dies whose result it has
        just fetched; errors of the work itself are outcomes, and none of these.
        """
        return isinstance(error, TypeError)

    def explain(self, error: Exception) -> str:
        """See `ExecutorRunner.explain`."""
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
