"""Work on many items, with results in the order of the items.

A runner is given a function that can be pickled. An error of one item is its outcome and stops no
other.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, Generic, Literal, NamedTuple, Protocol, TypeVar

from dogbot_logtool.errors import LogtoolError

Result = TypeVar("Result")
OnProgress = Callable[[int, int], None]
"""Called with bytes done and bytes in all while work goes on."""
Work = Callable[..., Result]
"""Called as ``work(item, progress=on_progress)``."""
Command = Literal["convert", "info", "stats"]
"""A module of `dogbot_logtool.commands`."""


class Failure(NamedTuple):
    """The outcome of an item that could not be done."""

    sentence: str
    exit_code: int


class Progress(Protocol):
    """Is called while a run goes on."""

    def update(self, number: int, done: int, total: int) -> None:
        """Show how far an item has come, in bytes."""

    def finished(self, number: int) -> None:
        """Show that an item is done, well or badly."""

    def lost(self, number: int) -> None:
        """Show that the worker of an item was lost, and that the item will be tried once more."""


class Runner(ABC, Generic[Result]):
    """Works on items."""

    jobs: int
    """How many batches of an item may be worked on at once."""

    @abstractmethod
    def run(
        self, work: Work[Result], items: Sequence[Any], progress: Progress
    ) -> Iterator[Result | Failure]:
        """Yield the outcome of each item, in order.

        Args:
            work: a function, or an object with a `__call__`, that can be pickled.
            items: can be pickled, too.
            progress: called while the run goes on.

        Raises:
            LogtoolError: nothing can be begun.
        """

    def close(self) -> None:
        """End all workers; what is under way is given up."""


class SerialRunner(Runner[Result]):
    """One item after the other in this process, each on all cores that may be used."""

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs

    def run(
        self, work: Work[Result], items: Sequence[Any], progress: Progress
    ) -> Iterator[Result | Failure]:
        """See `Runner.run`."""
        for number, item in enumerate(items):
            on_progress = partial(progress.update, number)
            # A bug met with a single log is better seen with its traceback.
            outcome = attempt(work, item, on_progress, raises=len(items) == 1)
            progress.finished(number)
            yield outcome


def attempt(
    work: Work[Result], item: object, on_progress: OnProgress | None, *, raises: bool = False
) -> Result | Failure:
    """Work on an item; every error becomes an outcome, or but those that users know is raised."""
    try:
        return work(item, progress=on_progress)
    except LogtoolError as error:
        return Failure(str(error), error.exit_code)
    except Exception as error:
        if raises:
            raise
        if isinstance(error, MemoryError):
            return Failure("there was not enough memory for it", 1)
        what = f"{type(error).__name__}: {error}"
        return Failure(f"failed by a fault of dogbot-logtool, please report it ({what})", 1)


def runner_for(command: Command, logs: int, jobs: int, scheduler: str | None = None) -> Runner[Any]:
    """Choose what works on the logs of a call.

    One log is done in this process, several batches at once; several logs by as many processes; and
    all of them by a cluster if there is a scheduler.

    Args:
        command: what is done to each.
        logs: how many.
        jobs: how much is done at once on this machine.
        scheduler: address of one of dask.distributed.

    Raises:
        CallError: that is no address.
        LogtoolError: no scheduler answers, or the extra `fleet` is not installed.
    """
    if scheduler is not None:
        from dogbot_logtool.run.cluster import ClusterRunner  # noqa: PLC0415 - needs the extra

        return ClusterRunner(scheduler)
    if min(logs, jobs) <= 1:
        return SerialRunner(jobs)
    from dogbot_logtool.run.executor import ProcessRunner  # noqa: PLC0415 - slow to import

    load = f"dogbot_logtool.commands.{command}"
    return ProcessRunner(min(logs, jobs), max(jobs // logs, 1), load=load)
