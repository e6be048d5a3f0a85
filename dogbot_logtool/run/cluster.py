"""Many logs on a cluster: the executor of dask.distributed."""

import logging
import pickle
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from typing import Any, Final, NamedTuple

from dogbot_logtool import __version__
from dogbot_logtool.errors import CallError, ExtraMissingError, LogtoolError
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.run.executor import LOOK_EVERY_S, ExecutorRunner, RunLost
from dogbot_logtool.run.runner import Failure, Result, Work, attempt

try:
    import distributed
except ImportError as error:
    raise ExtraMissingError("--scheduler", "fleet") from error

_AT_ONCE: Final = 2000
"""Items that the scheduler has at once: they bound its memory."""
_CONNECT_S: Final = 10
_WORKER_S: Final = 30
"""How long a scheduler may be without workers: lost ones may be started anew."""
_CLOSE_S: Final = 5


class ClusterRunner(ExecutorRunner[Result]):
    """The workers of a scheduler, which gives what a lost worker had in hand to others."""

    jobs = 1
    capacity = _AT_ONCE

    def __init__(self, scheduler: str) -> None:
        """Connect.

        Args:
            scheduler: ``tcp://host:port`` or the like.

        Raises:
            CallError: it is no address.
            LogtoolError: no scheduler answers.
        """
        if "://" not in scheduler:
            what = "must be an address such as tcp://host:8786"
            raise CallError(f"--scheduler {scheduler}: {what}")
        self._name = scheduler
        self._lost = f"was not done: the scheduler {scheduler} was lost"
        self._client = _connected(scheduler)
        self._executor = self._client.get_executor(pure=False)
        self._looks_without_workers = 0

    def submit(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """See `ExecutorRunner.submit`."""
        call = pickle.dumps(_Call((__version__, work, item)))
        future: Future[Result | Failure] = self._executor.submit(pickle.loads, call)
        return future

    def look(self) -> None:
        """See `ExecutorRunner.look`."""
        if self._client.status != "running":
            raise RunLost(self._lost)
        found = self._client.scheduler_info(n_workers=1)["workers"]
        self._looks_without_workers = 0 if found else self._looks_without_workers + 1
        if self._looks_without_workers * LOOK_EVERY_S > _WORKER_S:
            raise RunLost(
                f"was not done: {self._name} has no workers; start some where dogbot-logtool is "
                f"installed, with: dask worker {self._name}"
            )

    def explain(self, error: Exception, *, again: bool) -> str | None:
        """See `ExecutorRunner.explain`.

        Dask tries again itself. But it raises a TypeError where the worker dies whose result it has
        just fetched; errors of the work itself are outcomes, and none of these.
        """
        if isinstance(error, TypeError) and not again:
            return None
        if isinstance(error, CancelledError):
            # The client cancels everything when it loses the scheduler.
            raise RunLost(self._lost)
        if isinstance(error, distributed.KilledWorker):
            return "every worker that worked on it died, perhaps because memory ran out"
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
        LogtoolError: no scheduler answers.
    """
    # Errors are reported in a sentence.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        return distributed.Client(scheduler, timeout=_CONNECT_S, set_as_default=False)
    except Exception as error:  # a server of another kind may answer anything
        # dask names the address without what makes it one, and so with its password.
        why = str(error).replace(scheduler.partition("://")[2] or scheduler, name_of(scheduler))
        raise LogtoolError(
            f"--scheduler {scheduler}: no scheduler answers there ({why or 'timed out'}); "
            "check the address, and that `dask scheduler` runs there"
        ) from error


class _Call(NamedTuple):
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
