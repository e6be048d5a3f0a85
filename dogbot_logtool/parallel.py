"""Work on several threads, with results in the order of the work."""

import mmap
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, TypeVar

import numpy as np

Item = TypeVar("Item")
Result = TypeVar("Result")
Progress = Callable[[int, int], None]
"""Is told bytes done and bytes in all, while work goes on."""
_LARGEST_THRESHOLD: Final = 32 << 20
"""Bytes up to which glibc raises its thresholds by itself."""


def in_order(work: Callable[[Item], Result], items: Iterable[Item], jobs: int) -> Iterator[Result]:
    """Yield `work(item)` for every item, in order.

    The codecs and numpy let other threads run, so threads are as good as processes here. No more
    than one result a thread waits to be taken, so memory does not grow.

    Args:
        work: called from `jobs` threads, or from this one when `jobs` is 1.
        items: taken one by one as threads become free.
        jobs: how many threads.
    """
    _keep_freed_memory()
    if jobs == 1:
        yield from map(work, items)
        return
    with ThreadPoolExecutor(jobs, thread_name_prefix="batch") as pool:
        waiting: deque[Future[Result]] = deque()
        try:
            for item in items:
                waiting.append(pool.submit(work, item))
                if len(waiting) > jobs:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()


def _keep_freed_memory() -> None:
    """Let the allocator keep what one batch frees for the next one.

    glibc hands memory that is freed back to the system, above a threshold that follows the largest
    block freed so far. Where that stays small, every batch pays for all its pages anew: up to a
    sixth of the time. So a block of the largest size that counts is freed once; its pages are never
    touched. Other allocators do not care.
    """
    np.empty(_LARGEST_THRESHOLD - mmap.PAGESIZE, np.uint8)
