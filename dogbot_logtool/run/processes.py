"""Many logs on this machine: a pool of the standard library.

Workers are forked where that can be, from a process that has loaded the command and runs no other
thread: locks that threads hold do not survive a fork. So workers that take the place of dead ones
are spawned. Each ends with this process, however that ends, and first removes what it has begun to
write.
"""

import gc
import importlib
import multiprocessing
import os
import signal
import sys
import threading
import time
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from typing import Final

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.workers import kill_if_one_died, kill_processes, processes_of
from dogbot_logtool.run.executor import ExecutorRunner
from dogbot_logtool.run.runner import Failure, Result, Work, attempt
from dogbot_logtool.signals import (
    Stopped,
    end_with_parent,
    held_back,
    leave_to_parent,
    raise_again_if_lost,
    raise_stopped,
)

_CLEAN_UP_S: Final = 5.0
"""Time for a worker to remove what it has begun to write."""
_END_S: Final = 8.0
"""Time for workers to end: one that was stopped, or that got no memory for it, never does."""


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
            kill_processes(self._pool)
            self._pool.shutdown()
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
        with held_back():
            processes = processes_of(self._pool)
            for process in processes:
                process.terminate()
            end = time.monotonic() + _END_S
            for process in processes:
                process.join(max(end - time.monotonic(), 0.0))
            kill_processes(self._pool)
            self._pool.shutdown(cancel_futures=True)


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
