"""Work on several items at once, with results in the order of the items."""

import mmap
import os
import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable
from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeVar

import numpy as np

if TYPE_CHECKING:
    from concurrent.futures import Future

Item = TypeVar("Item")
Result = TypeVar("Result")
State = TypeVar("State")
OnProgress = Callable[[int, int], None]
"""Called with bytes done and bytes in all while work goes on."""
_LARGEST_THRESHOLD: Final = 32 << 20
"""Bytes up to which glibc raises its thresholds by itself."""


class StateExchange(Protocol[State]):
    """The state that the work on one item sends to the work on the next, on another worker."""

    def receive(self) -> State:
        """Wait for the state after the item before this one, and return it."""

    def send(self, state: State) -> None:
        """Send the state after this item: the sooner, the less the next one waits."""


StatefulWork = Callable[[Item, StateExchange[State]], Result]
"""Works on an item; receives the state and sends it on once each."""


def in_order(
    work: Callable[[Item], Result], items: Iterable[Item], jobs: int, *, forks: bool
) -> Generator[Result, None, None]:
    """Yield `work(item)` for every item, in order; see `in_order_with_state`."""

    def alone(item: Item, _exchange: StateExchange[None]) -> Result:
        return work(item)

    return in_order_with_state(alone, items, jobs, None, forks=forks)


def in_order_with_state(
    work: StatefulWork[Item, State, Result],
    items: Iterable[Item],
    jobs: int,
    first: State,
    *,
    forks: bool,
) -> Generator[Result, None, None]:
    """Yield `work(item, exchange)` for every item, in order.

    At most a few results a worker are kept until they are read, so memory does not grow.

    Args:
        work: called in `jobs` processes where that can be, else in as many threads. Columns are
            made by many short calls of numpy, each of which releases Python's lock and takes it
            again: on two cores, threads took as long as one.
        items: one for each call.
        jobs: how many work at once; 1: this thread alone.
        first: the state before the first item.
        forks: whether forked copies of this process may use what the work refers to. Results and
            states must be picklable then.

    Raises:
        LogtoolError: a process died.
    """
    _keep_freed_memory()
    if jobs > 1 and forks:
        items = several = list(items)
        jobs = min(jobs, len(several))
        if jobs > 1 and can_fork():
            from dogbot_logtool.run.forked import forked  # noqa: PLC0415 - takes time

            return forked(work, several, jobs, first)
    if jobs <= 1:
        return one_by_one(work, items, first)
    return _threaded(work, items, jobs, first)


class _LocalExchange(Generic[State]):
    """An exchange within one thread."""

    def __init__(self, state: State) -> None:
        self._state = state

    def receive(self) -> State:
        """See `StateExchange.receive`."""
        return self._state

    def send(self, state: State) -> None:
        """See `StateExchange.send`."""
        self._state = state


def one_by_one(
    work: StatefulWork[Item, State, Result], items: Iterable[Item], first: State
) -> Generator[Result, None, None]:
    """Yield `work(item, exchange)` for every item, worked on in this thread."""
    exchange = _LocalExchange(first)
    for item in items:
        yield work(item, exchange)


class _ThreadExchange(Generic[State]):
    """An exchange between threads."""

    def __init__(self, before: "Future[State]", after: "Future[State]") -> None:
        self._before = before
        self._after = after

    def receive(self) -> State:
        """See `StateExchange.receive`."""
        return self._before.result()

    def send(self, state: State) -> None:
        """See `StateExchange.send`."""
        self._after.set_result(state)


def _threaded(
    work: StatefulWork[Item, State, Result], items: Iterable[Item], jobs: int, first: State
) -> Generator[Result, None, None]:
    from concurrent.futures import Future, ThreadPoolExecutor  # noqa: PLC0415 - takes long

    def attempt(item: Item, before: Future[State], after: Future[State]) -> Result:
        try:
            return work(item, _ThreadExchange(before, after))
        finally:
            # The next item must not wait for ever; does nothing if the state was sent.
            after.cancel()

    before: Future[State] = Future()
    before.set_result(first)
    with ThreadPoolExecutor(jobs, thread_name_prefix="batch") as pool:
        waiting: deque[tuple[Future[Result], Future[State]]] = deque()
        try:
            for item in items:
                after: Future[State] = Future()
                waiting.append((pool.submit(attempt, item, before, after), after))
                before = after
                if len(waiting) > jobs:
                    yield waiting.popleft()[0].result()
            while waiting:
                yield waiting.popleft()[0].result()
        finally:
            for future, after in waiting:
                # The next item may have begun, and waits for the state of one that never does.
                if future.cancel():
                    after.cancel()


def can_fork() -> bool:
    """Tell whether this process may fork.

    Apple's libraries do not survive a fork, and daemonic processes may have no children.
    """
    import multiprocessing  # noqa: PLC0415 - takes long, and a log of one batch needs none of it

    can = sys.platform == "linux" and hasattr(os, "fork")
    return can and not multiprocessing.current_process().daemon


def _keep_freed_memory() -> None:
    """Let the allocator keep memory that one batch frees for the next one.

    glibc returns freed memory to the system, above a threshold that follows the largest block
    freed so far. If it stays small, every batch has its pages mapped anew: up to a sixth of the
    time. So a block of nearly the largest size that counts is freed once; its pages are never
    touched. Other allocators are not affected.
    """
    # The block's own head counts, too, and all is rounded up to pages.
    np.empty(_LARGEST_THRESHOLD - 2 * mmap.PAGESIZE, np.uint8)
