"""Many items over an executor of `concurrent.futures`: order, bounds, and workers that die.

Workers on this machine are forked where that can be, from a process that has loaded the command and
runs no other thread: locks that threads hold do not survive a fork. So workers that take the place
of dead ones are spawned. Each ends with this process, however that ends, and first removes what it
has begun to write.
"""

import gc
import importlib
import multiprocessing
import os
import signal
import sys
import threading
from abc import abstractmethod
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any, Final

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.workers import end_pool, kill_if_one_died
from dogbot_logtool.run.runner import Failure, Progress, Result, Runner, Work, attempt
from dogbot_logtool.signals import (
    Stopped,
    end_with_parent,
    held_back,
    leave_to_parent,
    raise_again_if_lost,
    raise_stopped,
)

LOOK_EVERY_S: Final = 0.25
_CLEAN_UP_S: Final = 5.0
"""Time for a worker to remove what it has begun to write."""
_END_S: Final = 8.0
"""Time for workers to end: one that was stopped, or that got no memory for it, never does."""


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
        waiting, lost = deque(range(len(items))), set[int]()
        under_way: dict[Future[Any], int] = {}
        done: SimpleQueue[Future[Any]] = SimpleQueue()
        try:
            while waiting or under_way:
                is_alone = not lost.isdisjoint([*under_way.values(), *islice(waiting, 1)])
                while waiting and len(under_way) < (1 if is_alone else self.capacity):
                    future = self.submit(work, items[waiting[0]])
                    under_way[future] = waiting.popleft()
                    future.add_done_callback(done.put)
                try:
                    future = done.get(timeout=LOOK_EVERY_S)
                except Empty:
                    self.look()
                    continue
                outcome = self._outcome(future, again=under_way[future] in lost)
                number = under_way.pop(future)
                if outcome is not None:
                    yield number, outcome
                    continue
                progress.lost(number)
                lost.add(number)
                waiting.appendleft(number)
        except RunLost as error:
            for number in (*under_way.values(), *waiting):
                yield number, Failure(str(error), 1)

    def _outcome(
        self, future: "Future[Result | Failure]", *, again: bool
    ) -> Result | Failure | None:
        """Return the outcome of an item that is done; None: it is to be tried once more."""
        try:
            outcome: Result | Failure = future.result()
        except Exception as error:  # noqa: BLE001 - errors of the work itself are outcomes
            why = self.explain(error, again=again)
            return None if why is None else Failure(why, 1)
        return outcome


class ProcessRunner(ExecutorRunner[Result]):
    """Processes of this machine, one item each."""

    def __init__(self, workers: int, jobs: int = 1, load: str | None = None) -> None:
        """Set up.

        Args:
            workers: how many processes.
            jobs: how many batches each may work on at once.
            load: a module that all need.
        """
        self.jobs = jobs
        self.capacity = workers
        # Apple's libraries do not survive a fork.
        is_alone = threading.active_count() == 1
        forks = sys.platform == "linux" and hasattr(os, "fork") and is_alone
        if forks and load is not None:
            importlib.import_module(load)
        self._pool = self._opened("fork" if forks else "spawn")

    def _opened(self, start: str) -> ProcessPoolExecutor:
        context = multiprocessing.get_context(start)
        return ProcessPoolExecutor(self.capacity, context, initializer=_begin)

    def submit(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """See `ExecutorRunner.submit`."""
        try:
            # A signal that reaches all processes must not end what is started here.
            with held_back():
                return self._submitted(work, item)
        except (MemoryError, OSError, RuntimeError) as error:
            why = getattr(error, "strerror", None) or str(error) or "not enough memory"
            what = f"{self.capacity} processes cannot be started: {why}; try fewer --jobs"
            raise LogtoolError(what) from error

    def _submitted(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        try:
            return self._pool.submit(_attempt, work, item)
        except (BrokenExecutor, ValueError):
            # A pool that breaks just now closes the pipes of the process that it starts, or
            # waits for it without having ended it.
            end_pool(self._pool)
            self._pool = self._opened("spawn")
            return self._pool.submit(_attempt, work, item)

    def look(self) -> None:
        """See `ExecutorRunner.look`."""
        kill_if_one_died(self._pool)

    def explain(self, error: Exception, *, again: bool) -> str | None:
        """See `ExecutorRunner.explain`."""
        if not again:
            return None
        if isinstance(error, BrokenExecutor):
            return "the process that worked on it died twice, perhaps because memory ran out"
        return f"its result cannot be sent: {type(error).__name__}: {error}"

    def close(self) -> None:
        """End the processes, which first remove what they have begun to write."""
        end_pool(self._pool, _END_S)


def _begin() -> None:
    """Begin a worker."""
    leave_to_parent()
    gc.freeze()
    raise_again_if_lost()
    end_with_parent(_CLEAN_UP_S)


def _attempt(work: Work[Result], item: object) -> Result | Failure:
    """Work on an item; runs in a worker."""
    # Only here SIGTERM becomes an exception, so that files that were begun are removed; the pool
    # would print it, or take it for a result.
    try:
        signal.signal(signal.SIGTERM, raise_stopped)
        outcome = attempt(work, item, None)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    except Stopped as stopped:
        os._exit(stopped.exit_code)
    return outcome
