"""An engine of processes on this machine, one item each."""

import multiprocessing
import signal
import threading
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.queues import SimpleQueue
from types import FrameType
from typing import Any, Final, NoReturn

from dogbot_logtool.fleet.engine import Crew, Failure, Result, Watch, Work, attempt

_News = tuple[int, int, int] | None
"""An item's number, bytes done and in all; None: there will be no more."""
_BEGUN: Final = -1
_SPAWN: Final = multiprocessing.get_context("spawn")
"""Threads, which libraries start as they like, do not survive a fork."""


class Processes(Crew[Result]):
    """A pool of processes. One that dies, for want of memory perhaps, costs its own item only."""

    def __init__(self, workers: int, jobs: int = 1) -> None:
        self.jobs = jobs
        self._workers = workers
        self._open()

    def _open(self) -> None:
        self._news: SimpleQueue[_News] = _SPAWN.SimpleQueue()
        self._pool = ProcessPoolExecutor(
            self._workers, mp_context=_SPAWN, initializer=_begin_worker, initargs=(self._news,)
        )
        self._futures: dict[Future[Any], int] = {}
        self._handed_out: dict[int, tuple[Work[Any], object]] = {}
        self._begun: set[int] = set()
        self._listener: threading.Thread | None = None

    def _begin(self, number: int, work: Work[Result], item: object, watch: Watch) -> None:
        if self._listener is None:
            self._listener = threading.Thread(target=self._listen, args=(watch,), daemon=True)
            self._listener.start()
        self._handed_out[number] = work, item
        try:
            self._futures[self._pool.submit(_attempt, number, work, item)] = number
        except BrokenProcessPool:
            broken: Future[Any] = Future()
            broken.set_exception(BrokenProcessPool())
            self._futures[broken] = number

    def _wait(self, watch: Watch) -> list[tuple[int, Result | Failure]]:
        done, _ = wait(self._futures, return_when=FIRST_COMPLETED)
        outcomes: list[tuple[int, Result | Failure]] = []
        for future in done:
            if isinstance(future.exception(), BrokenProcessPool):
                return [*outcomes, *self._mend(watch)]
            number = self._futures.pop(future)
            del self._handed_out[number]
            outcomes.append((number, future.result()))
        return outcomes

    def _mend(self, watch: Watch) -> list[tuple[int, Result | Failure]]:
        """After a process died: try what was under way alone, and go on with the rest."""
        finished = {n: f for f, n in self._futures.items() if f.done() and not f.exception()}
        outcomes = [(number, future.result()) for number, future in finished.items()]
        left = {n: what for n, what in self._handed_out.items() if n not in finished}
        suspects = sorted(self._begun & left.keys())
        watch.say(f"a process died; {len(suspects)} logs that were under way are tried once more")
        self.close()
        outcomes += [(number, _alone(number, *left.pop(number))) for number in suspects]
        self._open()
        for number, (work, item) in left.items():
            self._begin(number, work, item, watch)
        return outcomes or self._wait(watch)

    def _listen(self, watch: Watch) -> None:
        while (news := self._news.get()) is not None:
            number, done, total = news
            if total == _BEGUN:
                self._begun.add(number)
            else:
                watch.told(number, done, total)

    def close(self) -> None:
        """End all processes; those at work clean up first."""
        if any(not future.done() for future in self._futures):
            for process in multiprocessing.active_children():
                process.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)
        if self._listener is not None:
            self._news.put(None)
            self._listener.join()


def _alone(number: int, work: Work[Result], item: object) -> Result | Failure:
    news: SimpleQueue[_News] = _SPAWN.SimpleQueue()
    with ProcessPoolExecutor(
        1, mp_context=_SPAWN, initializer=_begin_worker, initargs=(news,)
    ) as pool:
        try:
            outcome: Result | Failure = pool.submit(_attempt, number, work, item).result()
        except BrokenProcessPool:
            what = "the process that worked on it died twice: perhaps for want of memory"
            return Failure(what, 1)
        return outcome


_news: "SimpleQueue[_News] | None" = None


def _begin_worker(news: "SimpleQueue[_News]") -> None:
    global _news  # noqa: PLW0603 - there is no other way to reach a function of a pool
    _news = news
    # Ctrl-C reaches all processes; only the first one decides, and ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _stop)


def _stop(number: int, _frame: FrameType | None) -> NoReturn:
    # Unlike an interruption, this ends a process without a word if it waits for work.
    raise SystemExit(128 + number)


def _attempt(number: int, work: Work[Result], item: object) -> Result | Failure:
    assert _news is not None  # noqa: S101 - set when the process began
    news = _news
    news.put((number, 0, _BEGUN))
    return attempt(work, item, lambda done, total: news.put((number, done, total)))
