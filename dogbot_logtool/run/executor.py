"""Many items over an executor of `concurrent.futures`: order, bounds, and workers that die."""

from abc import abstractmethod
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Any, Final

from dogbot_logtool.run.runner import Failure, Progress, Result, Runner, Work

LOOK_EVERY_S: Final = 0.25


class RunLost(Exception):  # noqa: N818 - the outcome of all items that are left
    """No worker is left; the message is the outcome of every item that was not done."""


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

        Raises:
            RunLost: nothing more will be done.
        """

    def run(
        self, work: Work[Result], items: Sequence[Any], progress: Progress
    ) -> Iterator[Result | Failure]:
        """See `Runner.run`."""
        wanted = 0
        finished: dict[int, Result | Failure] = {}
        for number, outcome in self._outcomes(work, items, progress):
            finished[number] = outcome
            progress.finished(number)
            while wanted in finished:
                yield finished.pop(wanted)
                wanted += 1

    def _outcomes(
        self, work: Work[Result], items: Sequence[Any], progress: Progress
    ) -> Iterator[tuple[int, Result | Failure]]:
        """Yield the number and the outcome of each item, in any order."""
        waiting = deque(range(len(items)))
        while waiting:
            lost: deque[int] = deque()
            yield from self._round(work, items, waiting, self.capacity, lost)
            for number in lost:
                progress.lost(number)
            yield from self._round(work, items, lost, 1, None)

    def _round(
        self,
        work: Work[Result],
        items: Sequence[Any],
        waiting: deque[int],
        capacity: int,
        lost: deque[int] | None,
    ) -> Iterator[tuple[int, Result | Failure]]:
        """Work on items that wait until one of them is lost.

        Args:
            work: what is done to each.
            items: all.
            waiting: which; those that are begun are taken away.
            capacity: how many may be under way at once.
            lost: receives those whose worker was lost; None: they are not tried again.
        """
        under_way: dict[Future[Any], int] = {}
        done: SimpleQueue[Future[Any]] = SimpleQueue()
        try:
            while under_way or (waiting and not lost):
                while waiting and not lost and len(under_way) < capacity:
                    future = self.submit(work, items[waiting[0]])
                    under_way[future] = waiting.popleft()
                    future.add_done_callback(done.put)
                try:
                    future = done.get(timeout=LOOK_EVERY_S)
                except Empty:
                    self.look()
                    continue
                try:
                    outcome: Result | Failure | None = future.result()
                except Exception as error:  # noqa: BLE001 - errors of the work itself are outcomes
                    why = self.explain(error, again=lost is None)
                    outcome = None if why is None else Failure(why, 1)
                number = under_way.pop(future)
                if outcome is not None:
                    yield number, outcome
                elif lost is not None:
                    lost.append(number)
        except RunLost as error:
            for number in (*under_way.values(), *waiting):
                yield number, Failure(str(error), 1)
            waiting.clear()
