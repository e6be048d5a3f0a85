"""Many items over an executor of `concurrent.futures`: order, bounds, and workers that die."""

from abc import abstractmethod
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from queue import Empty, SimpleQueue
from typing import Any, Final, Generic

from dogbot_logtool.run.runner import Failure, Progress, Result, Runner, Work

AHEAD: Final = 2000
"""Items that are begun beyond the first one whose outcome is waited for: they bound the memory."""
LOOK_EVERY_S: Final = 0.25


class RunLost(Exception):  # noqa: N818 - the outcome of all items that are left
    """No worker is left; the message is the outcome of every item that was not done."""


@dataclass(slots=True)
class _Items(Generic[Result]):
    """The state of the items of a run."""

    begun: int = 0
    wanted: int = 0
    """The first item whose outcome was not yielded."""
    under_way: dict[Future[Any], int] = field(default_factory=dict)
    done: "SimpleQueue[Future[Any]]" = field(default_factory=SimpleQueue)
    lost: deque[int] = field(default_factory=deque)
    """Items whose worker was lost, and that are to be tried once more."""
    retried: set[int] = field(default_factory=set)
    finished: dict[int, Result | Failure] = field(default_factory=dict)


class ExecutorRunner(Runner[Result]):
    """Hands items to an executor and takes outcomes as they come.

    An item whose worker was lost is tried once more, alone: the items beside it are not to blame,
    and with nothing else under way it has all memory.
    """

    capacity: int
    """How many items may be under way at once."""

    @abstractmethod
    def submit(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """Hand out an item.

        Raises:
            RunLost: nothing more will be done.
        """

    @abstractmethod
    def look(self) -> None:
        """Look after the workers; called every `LOOK_EVERY_S` in which no item is done.

        Raises:
            RunLost: nothing more will be done.
        """

    @abstractmethod
    def explain(self, error: Exception, *, again: bool) -> str | None:
        """Return the outcome, in words, of an item whose worker was lost; None: try once more.

        Args:
            error: of the executor.
            again: whether that was the second try.
        """

    def run(
        self, work: Work[Result], items: Sequence[Any], progress: Progress
    ) -> Iterator[Result | Failure]:
        """See `Runner.run`."""
        state: _Items[Result] = _Items()
        while state.wanted < len(items):
            try:
                for number in self._next(state, len(items), progress):
                    future = self.submit(work, items[number])
                    state.under_way[future] = number
                    future.add_done_callback(state.done.put)
                self._collect(state, progress)
            except RunLost as error:
                for number in set(range(state.wanted, len(items))) - state.finished.keys():
                    state.finished[number] = Failure(str(error), 1)
                    progress.finished(number)
            while state.wanted in state.finished:
                state.wanted += 1
                yield state.finished.pop(state.wanted - 1)

    def _next(self, state: _Items[Result], count: int, progress: Progress) -> Sequence[int]:
        """Return the items to begin now: several, or one that is tried alone."""
        if state.lost or state.retried.intersection(state.under_way.values()):
            if state.under_way:
                return ()
            number = state.lost.popleft()
            state.retried.add(number)
            progress.lost(number)
            return (number,)
        first = state.begun
        room = first + self.capacity - len(state.under_way)
        state.begun = max(first, min(count, state.wanted + AHEAD, room))
        return range(first, state.begun)

    def _collect(self, state: _Items[Result], progress: Progress) -> None:
        """Take the outcome of an item that is done, after waiting a while for one."""
        try:
            future = state.done.get(timeout=LOOK_EVERY_S)
        except Empty:
            self.look()
            return
        number = state.under_way.pop(future)
        try:
            outcome = future.result()
        except Exception as error:  # noqa: BLE001 - errors of the work itself are outcomes
            why = self.explain(error, again=number in state.retried)
            if why is None:
                state.lost.append(number)
                return
            outcome = Failure(why, 1)
        state.finished[number] = outcome
        progress.finished(number)
