"""Work on several items at once, with results in the order of the items."""

import mmap
import multiprocessing
import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, Generic, Protocol, TypeVar

import numpy as np

Item = TypeVar("Item")
Result = TypeVar("Result")
State = TypeVar("State")
Progress = Callable[[int, int], None]
"""Is told bytes done and bytes in all, while work goes on."""
_LARGEST_THRESHOLD: Final = 32 << 20
"""Bytes up to which glibc raises its thresholds by itself."""


class Baton(Protocol[State]):
    """What the work on one item hands on to the work on the next, which is done elsewhere."""

    def take(self) -> State:
        """Return what the items before this one hand on; waits for it."""

    def pass_on(self, state: State) -> None:
        """Hand on what the items after this one must know: the sooner, the less they wait."""


RelayWork = Callable[[Item, Baton[State]], Result]
"""Works on an item; takes the baton and passes it on once each."""


def in_order(
    work: Callable[[Item], Result], items: Iterable[Item], jobs: int, *, forks: bool
) -> Generator[Result, None, None]:
    """Yield `work(item)` for every item, in order; see `relayed`."""

    def alone(item: Item, _baton: Baton[None]) -> Result:
        return work(item)

    return relayed(alone, items, jobs, None, forks=forks)


def relayed(
    work: RelayWork[Item, State, Result],
    items: Iterable[Item],
    jobs: int,
    first: State,
    *,
    forks: bool,
) -> Generator[Result, None, None]:
    """Yield `work(item, baton)` for every item, in order.

    No more than a few results a worker wait to be taken, so memory does not grow.

    Args:
        work: called in `jobs` processes where that can be, else in as many threads. Columns are
            made by many short calls of numpy, each of which gives Python's lock away and wants
            it back: on two cores, threads took as long as one.
        items: one for each call.
        jobs: how many work at once; 1: this thread alone.
        first: the baton of the first item.
        forks: what the work refers to may be used by copies of this process. Results and batons
            must be such as can be pickled, then.

    Raises:
        LogtoolError: a process died.
    """
    _keep_freed_memory()
    if jobs > 1 and forks and _can_fork():
        from dogbot_logtool.run.forked import forked  # noqa: PLC0415 - takes time, and may not be

        items = list(items)
        jobs = min(jobs, len(items))
        if jobs > 1:
            return forked(work, items, jobs, first)
    if jobs <= 1:
        return one_by_one(work, items, first)
    return _threaded(work, items, jobs, first)


class _Held(Generic[State]):
    """A baton that stays in one thread."""

    def __init__(self, state: State) -> None:
        self._state = state

    def take(self) -> State:
        """See `Baton.take`."""
        return self._state

    def pass_on(self, state: State) -> None:
        """See `Baton.pass_on`."""
        self._state = state


def one_by_one(
    work: RelayWork[Item, State, Result], items: Iterable[Item], first: State
) -> Generator[Result, None, None]:
    """Yield `work(item, baton)` for every item, worked on in this thread."""
    baton = _Held(first)
    for item in items:
        yield work(item, baton)


class _Promised(Generic[State]):
    """A baton between threads."""

    def __init__(self, before: Future[State], after: Future[State]) -> None:
        self._before = before
        self._after = after

    def take(self) -> State:
        """See `Baton.take`."""
        return self._before.result()

    def pass_on(self, state: State) -> None:
        """See `Baton.pass_on`."""
        self._after.set_result(state)


def _threaded(
    work: RelayWork[Item, State, Result], items: Iterable[Item], jobs: int, first: State
) -> Generator[Result, None, None]:
    def attempt(item: Item, before: Future[State], after: Future[State]) -> Result:
        try:
            return work(item, _Promised(before, after))
        finally:
            # Whoever waits must not wait for ever; does nothing where it was passed on.
            after.cancel()

    before: Future[State] = Future()
    before.set_result(first)
    with ThreadPoolExecutor(jobs, thread_name_prefix="batch") as pool:
        waiting: deque[Future[Result]] = deque()
        try:
            for item in items:
                after: Future[State] = Future()
                waiting.append(pool.submit(attempt, item, before, after))
                before = after
                if len(waiting) > jobs:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()


def _can_fork() -> bool:
    """Tell whether this process may make copies of itself.

    Apple's libraries do not survive it, and a process that must not outlive another may have none.
    """
    return sys.platform == "linux" and not multiprocessing.current_process().daemon


def _keep_freed_memory() -> None:
    """Let the allocator keep what one batch frees for the next one.

    glibc hands memory that is freed back to the system, above a threshold that follows the largest
    block freed so far. Where that stays small, every batch pays for all its pages anew: up to a
    sixth of the time. So a block of nearly the largest size that counts is freed once; its pages
    are never touched. Other allocators do not care.
    """
    # The block's own head counts, too, and all is rounded up to pages.
    np.empty(_LARGEST_THRESHOLD - 2 * mmap.PAGESIZE, np.uint8)
