"""Work on many items, with results in the order of the items.

A runner is given a function that can be pickled. An error of one item is its outcome and stops no
other.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, Protocol, Self, TypeVar

from dogbot_logtool.errors import LogtoolError, StoreError
from dogbot_logtool.run.relay import Progress

Item = TypeVar("Item")
Result = TypeVar("Result")
Work = Callable[[Any, Progress | None], Result]

_PROGRESS_EVERY_S: Final = 0.2


@dataclass(frozen=True, slots=True)
class Failure:
    """The outcome of an item that could not be done."""

    sentence: str
    exit_code: int


class Watcher(Protocol):
    """Follows a run."""

    def told(self, number: int, done: int, total: int) -> None:
        """Take how far an item has come, in bytes."""

    def finished(self, number: int) -> None:
        """Take that an item is done, well or badly."""

    def lost(self, number: int) -> None:
        """Take that the worker of an item was lost, and that the item will be tried once more."""

    def say(self, sentence: str) -> None:
        """Take a sentence that the user should read."""


class Runner(ABC, Generic[Result]):
    """Works on items."""

    jobs: int
    """How many batches of an item may be worked on at once."""
    may_repeat: bool
    """Whether an item may be begun again after the process that worked on it was lost."""

    @abstractmethod
    def run(
        self, work: Work[Result], items: Sequence[Any], watcher: Watcher
    ) -> Iterator[Result | Failure]:
        """Yield the outcome of each item, in order.

        Args:
            work: a function, or an object with a `__call__`, that can be pickled.
            items: can be pickled, too.
            watcher: follows the run.

        Raises:
            LogtoolError: nothing can be begun.
        """

    def close(self) -> None:
        """End all workers; what is under way is given up."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()


class Here(Runner[Result]):
    """One item after the other in this process, each on all cores that may be used."""

    may_repeat = False

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs

    def run(
        self, work: Work[Result], items: Sequence[Any], watcher: Watcher
    ) -> Iterator[Result | Failure]:
        """See `Runner.run`."""
        for number, item in enumerate(items):
            progress = _numbered(watcher, number)
            outcome: Result | Failure
            try:
                # A bug met with a single log is better seen with its traceback.
                alone = len(items) == 1
                outcome = work(item, progress) if alone else attempt(work, item, progress)
            except LogtoolError as error:
                outcome = Failure(str(error), error.exit_code)
            watcher.finished(number)
            yield outcome


def _numbered(watcher: Watcher, number: int) -> Progress:
    return seldom(lambda done, total: watcher.told(number, done, total))


def attempt(work: Work[Result], item: object, progress: Progress) -> Result | Failure:
    """Work on an item; every error becomes an outcome.

    Where a store still fails after several requests, the item is begun anew once.
    """
    for last in (False, True):
        try:
            return work(item, progress)
        except StoreError as error:
            if last:
                return Failure(str(error), error.exit_code)
        except LogtoolError as error:
            return Failure(str(error), error.exit_code)
        except MemoryError:
            return Failure("there was not enough memory for it", 1)
        except Exception as error:  # noqa: BLE001 - one bad log never stops the rest
            what = f"{type(error).__name__}: {error}"
            return Failure(f"failed by a fault of dogbot-logtool, please report it ({what})", 1)
    raise AssertionError


def seldom(progress: Progress) -> Progress:
    """Return a callback that passes on no more than a person can read."""
    last = 0.0

    def passed_on(done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last > _PROGRESS_EVERY_S:
            last = now
            progress(done, total)

    return passed_on
