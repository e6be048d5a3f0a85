"""Work on many items, by whoever can: this process, others on this machine, or a cluster.

An engine is given a function that can be pickled and hands back what it returned, in the order of
the items. An error of one item is its outcome and stops no other.
"""

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final, Generic, Protocol, Self, TypeVar

from dogbot_logtool.errors import LogtoolError, StoreError

Item = TypeVar("Item")
Result = TypeVar("Result")
Tell = Callable[[int, int], None]
"""Is told bytes done and bytes in all."""
Work = Callable[[Any, Tell | None], Result]

AHEAD: Final = 2000
"""Items that are handed out beyond the first one whose outcome is waited for."""
_TELL_EVERY_S: Final = 0.5


@dataclass(frozen=True, slots=True)
class Failure:
    """What became of an item that could not be done."""

    sentence: str
    exit_code: int


class Watch(Protocol):
    """Whoever follows a run."""

    def told(self, number: int, done: int, total: int) -> None:
        """Hear how far an item has come, in bytes."""

    def finished(self, number: int) -> None:
        """Hear that an item is done, well or badly."""

    def say(self, sentence: str) -> None:
        """Hear what a user should know."""


class Engine(ABC, Generic[Result]):
    """Works on items, several at once."""

    jobs: int
    """How many batches of an item may be worked on at once."""
    may_repeat: bool = True
    """Whether an item may be begun again after whoever worked on it was lost."""

    @abstractmethod
    def run(
        self, work: Work[Result], items: Sequence[Item], watch: Watch, ahead: int = AHEAD
    ) -> Iterator[Result | Failure]:
        """Yield what became of each item, in order.

        Args:
            work: a function, or an object with a `__call__`, that can be pickled.
            items: can be pickled, too.
            watch: is told how it goes.
            ahead: bounds how many outcomes wait for an earlier one.
        """

    def close(self) -> None:
        """Let everybody go; what is under way is given up, and leaves nothing behind."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()


class Crew(Engine[Result]):
    """Hands out items one by one, and takes outcomes as they come."""

    def run(
        self, work: Work[Result], items: Sequence[Item], watch: Watch, ahead: int = AHEAD
    ) -> Iterator[Result | Failure]:
        """See `Engine.run`."""
        self._give_up()
        finished: dict[int, Result | Failure] = {}
        begun = wanted = 0
        while wanted < len(items):
            while begun < min(len(items), wanted + ahead):
                self._begin(begun, work, items[begun], watch)
                begun += 1
            for number, outcome in self._wait(watch):
                finished[number] = outcome
                watch.finished(number)
            while wanted in finished:
                yield finished.pop(wanted)
                wanted += 1

    @abstractmethod
    def _begin(self, number: int, work: Work[Result], item: object, watch: Watch) -> None:
        """Hand out an item."""

    @abstractmethod
    def _wait(self, watch: Watch) -> list[tuple[int, Result | Failure]]:
        """Return items that are done, with what became of them, after waiting for some."""

    def _give_up(self) -> None:
        """Forget what an earlier run handed out and nobody waits for any more."""


class Here(Crew[Result]):
    """One item after the other, each on all cores that may be used."""

    may_repeat = False

    def __init__(self, jobs: int) -> None:
        self.jobs = jobs
        self._alone = True
        self._next: list[tuple[int, Result | Failure]] = []

    def run(
        self, work: Work[Result], items: Sequence[Item], watch: Watch, ahead: int = 1
    ) -> Iterator[Result | Failure]:
        """See `Engine.run`."""
        self._alone = len(items) == 1
        return super().run(work, items, watch, min(ahead, 1))

    def _begin(self, number: int, work: Work[Result], item: object, watch: Watch) -> None:
        def tell(done: int, total: int) -> None:
            watch.told(number, done, total)

        outcome: Result | Failure
        try:
            # A fault of ours with a single log had better be seen whole.
            outcome = work(item, tell) if self._alone else attempt(work, item, tell)
        except LogtoolError as error:
            outcome = Failure(str(error), error.exit_code)
        self._next.append((number, outcome))

    def _wait(self, watch: Watch) -> list[tuple[int, Result | Failure]]:
        del watch
        outcomes, self._next = self._next, []
        return outcomes


def attempt(work: Work[Result], item: object, tell: Tell) -> Result | Failure:
    """Work on an item far from the user: whatever happens becomes an outcome.

    Where a store has failed in spite of all patience, the item is begun anew once.
    """
    for last in (False, True):
        try:
            return work(item, _now_and_then(tell))
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


def _now_and_then(tell: Tell) -> Tell:
    """Pass on only so much as a person can read."""
    last = 0.0

    def seldom(done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last > _TELL_EVERY_S:
            last = now
            tell(done, total)

    return seldom
