"""Many logs on this machine: pools of the standard library.

Each worker is a pool of one process: where that dies it is known what it worked on, and the others
go on. They are forked where that can be, from a process that has loaded the command and runs no
other thread: locks that threads hold do not survive a fork. So a process that takes the place of a
dead one is spawned. The progress that they share has no lock, which one of them could take with it
when it dies.

Workers end when the lifeline does, a pipe that nothing is written to: its other end is closed when
this runner is closed, or by the system when this process ends, however that happens.
"""

import gc
import importlib
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from typing import Any, Final

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.workers import kill_processes
from dogbot_logtool.run.executor import ExecutorRunner
from dogbot_logtool.run.runner import Failure, Progress, Result, Work, attempt
from dogbot_logtool.signals import (
    Stopped,
    held_back,
    leave_to_parent,
    raise_again_if_lost,
    raise_stopped,
)

_SPAWN: Final = multiprocessing.get_context("spawn")
_CLEAN_UP_S: Final = 5.0
"""Time for a worker to remove what it has begun to write."""
_END_S: Final = 8.0
"""Time for a worker to end: one that was stopped, or that got no memory for it, never does."""


class _Worker:
    """One process, and another one where it has died."""

    def __init__(self, lifeline: Connection, held: Connection, *, forks: bool) -> None:
        """Set up.

        Args:
            lifeline: ends with this process.
            held: its other end, which a forked process must not hold open.
            forks: whether to begin with a copy of this process.
        """
        self._lifeline = lifeline
        self._progress: Any = _SPAWN.RawArray("q", 2)
        """Bytes done and in all; no lock, since a process may die with it."""
        if forks:
            self._pool = self._opened(multiprocessing.get_context("fork"), held)
            self._pool.submit(_nothing)  # A pool starts its process with its first item.
        else:
            self._pool = self._opened(_SPAWN)

    def _opened(self, context: BaseContext, *held: Connection) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(
            1, context, initializer=_begin, initargs=(self._lifeline, self._progress, *held)
        )

    def submit(self, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """Hand the process an item."""
        self._progress[:] = 0, 0
        try:
            return self._pool.submit(_attempt, work, item)
        except BrokenExecutor:
            self._pool.shutdown()
            self._pool = self._opened(_SPAWN)
            return self._pool.submit(_attempt, work, item)

    def progress(self) -> tuple[int, int]:
        """Return bytes done and in all of its item; 0 of 0 if nothing was reported."""
        done, total = self._progress
        return done, total

    def close(self) -> None:
        """Wait for the end of the process."""
        # A pool whose thread could not be started has none to wait for.
        with suppress(RuntimeError):
            self._pool.shutdown(cancel_futures=True)

    def kill(self) -> None:
        """End the process at once, if it has not ended yet."""
        kill_processes(self._pool)


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
        # A signal that reaches all processes must not end what is started here.
        with held_back(), _started(workers):
            ends, self._lifeline = _SPAWN.Pipe(duplex=False)
            forks = _can_fork() and threading.active_count() == 1
            if forks and load is not None:
                importlib.import_module(load)
            self._workers = [_Worker(ends, self._lifeline, forks=forks) for _ in range(workers)]
        self._idle = list(self._workers)
        self._busy: dict[int, _Worker] = {}

    def submit(self, number: int, work: Work[Result], item: object) -> "Future[Result | Failure]":
        """See `ExecutorRunner.submit`."""
        worker = self._idle.pop()
        with held_back(), _started(self.capacity):
            future = worker.submit(work, item)
        self._busy[number] = worker
        future.add_done_callback(partial(self._freed, number))
        return future

    def _freed(self, number: int, _future: "Future[Result | Failure]") -> None:
        self._idle.append(self._busy.pop(number))

    def look(self, progress: Progress) -> None:
        """See `ExecutorRunner.look`."""
        for number, worker in list(self._busy.items()):
            done, total = worker.progress()
            if total:
                progress.update(number, done, total)

    def explain(self, error: Exception) -> str:
        """See `ExecutorRunner.explain`."""
        if isinstance(error, BrokenExecutor):
            return "the process that worked on it died twice, perhaps because memory ran out"
        return f"its result cannot be sent: {type(error).__name__}: {error}"

    def close(self) -> None:
        """End the processes, which first remove what they have begun to write."""
        # A signal that breaks into the wait for a pool's thread could leave it waiting for ever.
        with held_back():
            self._lifeline.close()
            last_resort = threading.Timer(_END_S, self._kill)
            with suppress(RuntimeError):
                last_resort.start()
            for worker in self._workers:
                worker.close()
            last_resort.cancel()

    def _kill(self) -> None:
        for worker in self._workers:
            worker.kill()


def _can_fork() -> bool:
    """Tell whether this process may fork: Apple's libraries do not survive it."""
    forks = sys.platform == "linux" and hasattr(os, "fork")
    return forks and not multiprocessing.current_process().daemon


@contextmanager
def _started(workers: int) -> Iterator[None]:
    """Explain why the processes that a block starts cannot be started.

    Raises:
        LogtoolError: there are not as many processes, threads or files to be had, or no memory.
    """
    try:
        yield
    except (OSError, RuntimeError, MemoryError) as error:
        why = getattr(error, "strerror", None) or str(error) or "not enough memory"
        raise LogtoolError(
            f"{workers} processes cannot be started: {why}; try fewer --jobs"
        ) from error


_progress: Any = None
"""The progress of this process if it is a worker: bytes done and in all."""


def _nothing() -> None:
    """Do nothing."""


def _begin(lifeline: Connection, progress: Any, *held: Connection) -> None:  # noqa: ANN401 - ctypes has no public name for it
    """Begin a worker."""
    global _progress  # noqa: PLW0603 - there is no other way to reach a function of a pool
    _progress = progress
    leave_to_parent()
    for end in held:
        end.close()
    gc.freeze()
    raise_again_if_lost()
    threading.Thread(target=_end_with, args=(lifeline,), daemon=True).start()


def _end_with(lifeline: Connection) -> None:
    with suppress(EOFError, OSError):
        lifeline.recv_bytes()
    if hasattr(signal, "pthread_kill"):
        # Unlike other ways, this wakes it where it waits for a disk or a store.
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGTERM)
    else:
        signal.raise_signal(signal.SIGTERM)
    time.sleep(_CLEAN_UP_S)
    os._exit(1)


def _attempt(work: Work[Result], item: object) -> Result | Failure:
    """Work on an item; runs in a worker."""
    # Only here SIGTERM becomes an exception, so that files that were begun are removed; the pool
    # would print it, or take it for a result.
    try:
        signal.signal(signal.SIGTERM, raise_stopped)
        outcome = attempt(work, item, _report_progress)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    except Stopped as stopped:
        os._exit(stopped.exit_code)
    return outcome


def _report_progress(done: int, total: int) -> None:
    _progress[:] = done, total
