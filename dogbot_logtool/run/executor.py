"""Many items over an executor of `concurrent.futures`: order, bounds, and workers that die."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any, ClassVar, Final, Generic

from dogbot_logtool.run.runner import Failure, Progress, Result, Runner, Work

AHEAD: Final = 2000
"""Items that are begun beyond the first one whose outcome is waited for: they bound the memory."""
_LOOK_EVERY_S: Final = 0.25


class RunLost(Exception):  # noqa: N818 - the outcome of all items that are left
    """No worker is left; the message is the outcome of every item that was not done."""


@dataclass(slots=True)
class _Items(Generic[Result]):
    """The state of the items of a run."""

    count: int
    begun: int = 0
    wanted: int = 0
    """The first item whose outcome was not yielded."""
    under_way: dict[Future[Any], int] = field(default_factory=dict)
    done: "SimpleQueue[Future[Any]]" = field(default_factory=SimpleQueue)
    suspects: dict[int, Exception] = field(default_factory=dict)
    """Items whose worker was lost, and that are to be tried once more."""
    several_lost: bool = False
    """Several of them were lost together."""
    tried_alone: set[int] = field(default_factory=set)
    finished: dict[int, Result | Failure] = field(default_factory=dict)

    def ready(self) -> Iterator[Result | Failure]:
        """Yield outcomes that are next in order."""
        while self.wanted in self.finished:
            outcome = self.finished.pop(self.wanted)
            self.wanted += 1
            yield outcome


class ExecutorRunner(Runner[Result]):
    """Hands items to an executor and takes outcomes as they come.

    An item whose worker was lost is tried once more, alone: with nothing else under way it has all
    the memory, and where several items were lost together it becomes clear which one kills.
    """

    capacity: int
    """How many items may be under way at once."""
    conclusive: ClassVar[tuple[type[Exception], ...]] = ()
    """Errors that need no second try unless several items were lost together."""

    @abstractmethod
    def submit(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """Hand out an item.

        Raises:
            RunLost: nothing more will be done.
        """

    @abstractmethod
    def look(self, progress: Progress) -> None:
        """Look after the workers; called several times a second.

        Raises:
            RunLost: nothing more will be done.
        """

    @abstractmethod
    def explain(self, error: Exception) -> str:
        """Return the outcome, in words, of an item whose worker was lost for good."""

    def run(
        self, work: Work[Result], items: Sequence[Any], progress: Progress, ahead: int = AHEAD
    ) -> Iterator[Result | Failure]:
        """See `Runner.run`.

        Args:
            work: see there.
            items: see there.
            progress: see there.
            ahead: bounds how many outcomes wait for an earlier one.
        """
        state: _Items[Result] = _Items(len(items))
        while state.wanted < state.count:
            try:
                for number in self._next(state, ahead, progress):
                    future = self.submit(work, items[number])
                    state.under_way[future] = number
                    future.add_done_callback(state.done.put)
                self._collect(state, progress)
                self.look(progress)
            except RunLost as error:
                for number in set(range(state.wanted, state.count)) - state.finished.keys():
                    state.finished[number] = Failure(str(error), 1)
                    progress.finished(number)
            yield from state.ready()

    def _next(self, state: _Items[Result], ahead: int, progress: Progress) -> list[int]:
        """Return the items to begin now: several, or one that is tried alone."""
        if state.tried_alone.intersection(islice(state.under_way.values(), 1)):
            return []
        if not state.suspects:
            state.several_lost = False
            first = state.begun
            room = first + self.capacity - len(state.under_way)
            state.begun = max(first, min(state.count, state.wanted + ahead, room))
            return list(range(first, state.begun))
        if state.under_way:
            return []
        state.several_lost |= len(state.suspects) > 1
        number, error = next(iter(state.suspects.items()))
        del state.suspects[number]
        if isinstance(error, self.conclusive) and not state.several_lost:
            state.finished[number] = Failure(self.explain(error), 1)
            progress.finished(number)
            return []
        state.tried_alone.add(number)
        progress.lost(number)
        return [number]

    def _collect(self, state: _Items[Result], progress: Progress) -> None:
        """Take the outcomes of items that are done, after waiting a while for one."""
        try:
            future = state.done.get(timeout=_LOOK_EVERY_S)
        except Empty:
            return
        number = state.under_way.pop(future)
        try:
            outcome = future.result()
        except Exception as error:  # noqa: BLE001 - errors of the work itself are outcomes
            if number not in state.tried_alone:
                state.suspects[number] = error
                return
            outcome = Failure(self.explain(error), 1)
        state.finished[number] = outcome
        progress.finished(number)
