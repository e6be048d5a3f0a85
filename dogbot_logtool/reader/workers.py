"""Work on the parts of a log in several processes: a pool of the standard library."""

import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from itertools import islice
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.signals import end_with_parent, held_back, leave_to_parent

# Pools take as long to load as a short log to read, and such a log needs none.
if TYPE_CHECKING:
    from concurrent.futures import Executor, Future
    from multiprocessing.process import BaseProcess

Item = TypeVar("Item")
Result = TypeVar("Result")
Work = Callable[[Log, Item], Result]
_AHEAD: Final = 2
"""Items that are worked on, or done, beside one for each worker."""
_FEWEST_ITEMS: Final = 2
"""Items for each worker: to start one takes as long as to read one or two parts."""
_LOOK_EVERY_S: Final = 1.0
"""Between two looks at whether all workers are alive."""
Start = Literal["fork", "spawn", "threads"]
"""How workers start: as copies of this process, as new processes, or as its threads."""


def start_method(log: Log) -> Start:
    """Return how workers that read a log can start.

    Apple's libraries do not survive a fork, and daemonic processes may have no children. A log
    that only this process can read is read by its threads.
    """
    import multiprocessing  # noqa: PLC0415 - see above

    if multiprocessing.current_process().daemon or not log.source.can_fork:
        return "threads"
    if sys.platform == "linux":
        return "fork"
    return "threads" if log.reopen is None else "spawn"


def in_order(
    work: Work[Item, Result], log: Log, items: Sequence[Item], jobs: int
) -> Generator[Result, None, None]:
    """Yield `work(log, item)` for every item, in order.

    Args:
        work: what is done to an item; new processes receive it pickled.
        log: forked workers and threads read it as it is, new processes open it again.
        items: one for each call.
        jobs: how many work at once; 1: this thread alone.

    Raises:
        LogtoolError: a process died.
    """
    jobs = min(jobs, len(items) // _FEWEST_ITEMS)
    if jobs <= 1:
        yield from (work(log, item) for item in items)
        return
    from concurrent.futures import BrokenExecutor  # noqa: PLC0415 - see above

    with held_back():
        pool = _pool(work, log, jobs)
        # Few results wait for the one that is next: each may be as large as its item.
        coming = iter(items)
        waiting: deque[Future[Result]] = deque()
        waiting.extend(pool.submit(_work, item) for item in islice(coming, jobs + _AHEAD))
    try:
        while waiting:
            result = _result(pool, waiting.popleft())
            waiting.extend(pool.submit(_work, item) for item in islice(coming, 1))
            yield result
    except BrokenExecutor as error:
        raise LogtoolError(
            "a process that worked on it died, perhaps because memory ran out; try --jobs 1"
        ) from error
    finally:
        end_pool(pool)


def _result(pool: "Executor", future: "Future[Result]") -> Result:
    """Wait for a result; where a process has died meanwhile, end the others."""
    from concurrent.futures import wait  # noqa: PLC0415 - see above

    while not wait([future], _LOOK_EVERY_S).done:
        kill_if_one_died(pool)
    return future.result()


def kill_if_one_died(pool: "Executor") -> None:
    """End the processes of a pool one of which has died.

    One that dies while it sends leaves a part of a result, for whose rest the pool waits for ever.
    """
    if not all(process.is_alive() for process in _processes(pool)):
        _kill(pool)


def end_pool(pool: "Executor", clean_up_s: float = 0.0) -> None:
    """End a pool, whose `shutdown` alone waits until its processes have done what they have begun.

    Args:
        pool: the pool.
        clean_up_s: how long they may remove what they have begun to write.
    """
    with held_back():
        end = time.monotonic() + clean_up_s
        processes = _processes(pool)
        for process in processes:
            process.terminate()
        for process in processes:
            process.join(max(end - time.monotonic(), 0.0))
        _kill(pool)
        pool.shutdown(cancel_futures=True)


def _kill(pool: "Executor") -> None:
    # Python 3.14 has a method for this.
    for process in _processes(pool):
        process.kill()
    # One that ended while it sent a result leaves a part of it: with our own end of the pipe
    # closed, the pool's thread does not wait for the rest.
    with suppress(AttributeError, OSError):
        pool._result_queue._writer.close()  # type: ignore[attr-defined]  # noqa: SLF001


def _processes(pool: "Executor") -> "list[BaseProcess]":
    """Return the processes of a pool; of threads, or one that has ended, there are none."""
    return list((getattr(pool, "_processes", None) or {}).values())


def _pool(work: Work[Any, Any], log: Log, jobs: int) -> "Executor":
    import multiprocessing  # noqa: PLC0415 - see above
    from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor  # noqa: PLC0415

    start = start_method(log)
    if start == "threads":
        return ThreadPoolExecutor(jobs, "part", _begin_thread, (work, log))
    context = multiprocessing.get_context(start)
    opened = log if start == "fork" or log.reopen is None else log.reopen
    return ProcessPoolExecutor(jobs, context, _begin_process, (work, opened))


_own = threading.local()
"""The work and the log of each worker."""


def _begin_thread(work: Work[Any, Any], log: Log) -> None:
    _own.work, _own.log = work, log


def _begin_process(work: Work[Any, Any], log: Log | Callable[[], Log]) -> None:
    """Begin a worker, which ends with its parent, however that ends."""
    leave_to_parent()
    end_with_parent()
    _begin_thread(work, log if isinstance(log, Log) else log())


def _work(item: object) -> Any:  # noqa: ANN401 - what the work returns
    return _own.work(_own.log, item)
