"""Work on several copies of this process, with results in the order of the work.

A fork takes a few milliseconds and inherits whatever the work refers to: an opened log, a plan,
the columns of its index. The copies take the items in turn, pass batons round in a ring, and send
results here. They read the log, compute and answer: of the threads that were copied as they
stood, none is needed.
"""

import gc
import multiprocessing
import os
import signal
import traceback
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import chain
from multiprocessing.context import ForkProcess
from typing import Any, BinaryIO, Final, Generic

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.parallel.relay import Item, RelayWork, Result, State
from dogbot_logtool.parallel.transport import NeighbourDied, Tray, receive, send

_FORK: Final = multiprocessing.get_context("fork")


def forked(
    work: RelayWork[Item, State, Result],
    items: Sequence[Item],
    jobs: int,
    first: State,
    *,
    lent: bool,
) -> Generator[Result, None, None]:
    """Yield `work(item, baton)` for every item, in order; see `relay.relayed`.

    Args:
        work: what is done to an item.
        items: at least as many as `jobs`.
        jobs: at least two, since a process cannot hand on a large baton to itself.
        first: the baton of the first item.
        lent: arrays of a result need not outlast the next one.

    Raises:
        LogtoolError: a process died.
    """
    with _crew(work, items, jobs, first) as desks:
        for number in range(len(items)):
            desk = desks[number % jobs]
            yield _received(desk, lent=lent)
            desk.clear()


def _received(desk: "_Desk", *, lent: bool) -> Any:  # noqa: ANN401 - it was pickled
    try:
        outcome = receive(desk.results, desk.tray, lent=lent)
    except NeighbourDied as error:
        raise LogtoolError(
            "a process that worked on it died: perhaps for want of memory; try --jobs 1"
        ) from error
    if isinstance(outcome, _Raised):
        raise outcome.error
    return outcome


@dataclass(frozen=True, slots=True)
class _Raised:
    """What came of work instead of a result."""

    error: Exception


@dataclass(frozen=True, slots=True)
class _Desk:
    """Where the results of a worker arrive."""

    results: BinaryIO
    taken: BinaryIO
    """Leads to the worker."""
    tray: Tray

    def clear(self) -> None:
        """Let the worker use its tray for another result."""
        # Behind its last item it is gone.
        with suppress(BrokenPipeError):
            os.write(self.taken.fileno(), b".")

    def __iter__(self) -> Iterator[BinaryIO]:
        return iter((self.results, self.taken))


@dataclass(frozen=True, slots=True)
class _Ends:
    """A worker's ends of its pipes, and its tray."""

    batons_in: BinaryIO
    batons_out: BinaryIO
    results: BinaryIO
    taken: BinaryIO
    """Tells that the tray is free."""
    tray: Tray

    def __iter__(self) -> Iterator[BinaryIO]:
        return iter((self.batons_in, self.batons_out, self.results, self.taken))


class _Piped(Generic[State]):
    """A baton between processes."""

    def __init__(self, ends: _Ends, given: list[State]) -> None:
        self._ends = ends
        self._given = given

    def take(self) -> State:
        """See `Baton.take`."""
        if self._given:
            return self._given.pop()
        state: State = receive(self._ends.batons_in)
        return state

    def pass_on(self, state: State) -> None:
        """See `Baton.pass_on`."""
        # Behind the last item nobody waits.
        with suppress(BrokenPipeError):
            send(self._ends.batons_out, state)


@contextmanager
def _crew(
    work: RelayWork[Item, State, Result], items: Sequence[Item], jobs: int, first: State
) -> Iterator[list[_Desk]]:
    """Start the workers; yield where their results arrive."""
    pipes = _Pipes()
    crew: list[ForkProcess] = []
    # A garbage collection writes to all that it looks at: each process would get its own pages of
    # what was there before, an index of an hour for one.
    gc.freeze()
    try:
        try:
            desks, ends_of = pipes.ring(jobs)
            for number, ends in enumerate(ends_of):
                given = [] if number else [first]
                crew.append(_started(work, items[number::jobs], ends, given, pipes))
        except OSError as error:
            raise LogtoolError(
                f"{jobs} processes cannot be started: {error.strerror}; try fewer --jobs"
            ) from error
        pipes.close_all_but(chain(*desks))
        yield desks
    finally:
        for process in crew:
            process.kill()
        for process in crew:
            process.join()
        pipes.close_all_but([])
        gc.unfreeze()


class _Pipes:
    """All ends of all pipes between workers, and between them and here."""

    def __init__(self) -> None:
        self._ends: list[BinaryIO] = []

    def ring(self, jobs: int) -> tuple[list[_Desk], list[_Ends]]:
        """Connect workers: each takes batons from the one before it.

        Returns:
            this process's ends, and the workers'.
        """
        batons = [self._pipe() for _ in range(jobs)]
        desks: list[_Desk] = []
        workers: list[_Ends] = []
        for number in range(jobs):
            results, taken, tray = self._pipe(), self._pipe(), Tray()
            desks.append(_Desk(results[0], taken[1], tray))
            batons_in, batons_out = batons[number][0], batons[(number + 1) % jobs][1]
            workers.append(_Ends(batons_in, batons_out, results[1], taken[0], tray))
        return desks, workers

    def _pipe(self) -> tuple[BinaryIO, BinaryIO]:
        arrive, leave = os.pipe()
        pipe = open(arrive, "rb"), open(leave, "wb")  # noqa: SIM115, PTH123 - closed below
        self._ends.extend(pipe)
        return pipe

    def close_all_but(self, kept: Iterable[BinaryIO]) -> None:
        """Close ends: a pipe is over only when nobody holds its other end."""
        kept = set(kept)
        for end in self._ends:
            if end not in kept:
                end.close()


def _started(
    work: RelayWork[Item, State, Result],
    items: Sequence[Item],
    ends: _Ends,
    given: list[State],
    pipes: _Pipes,
) -> ForkProcess:
    """Start a worker."""
    signals = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))

    def serve() -> None:
        # Ctrl-C reaches all processes; only the first one decides, and ends the others.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.pthread_sigmask(signal.SIG_SETMASK, signals)
        pipes.close_all_but(ends)
        _serve(work, items, ends, given)

    try:
        process = _FORK.Process(target=serve, daemon=True)
        process.start()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, signals)
    return process


def _serve(
    work: RelayWork[Item, State, Result], items: Sequence[Item], ends: _Ends, given: list[State]
) -> None:
    """Work on some items; runs in a copy of the process."""
    baton = _Piped(ends, given)
    for number, item in enumerate(items):
        try:
            outcome: Result | _Raised = work(item, baton)
        except NeighbourDied:
            return
        except Exception as error:  # noqa: BLE001 - it is raised where the result is wanted
            error.add_note(traceback.format_exc())
            outcome = _Raised(error)
        # On the tray still lies its last result, until that is taken or nobody is left to take it.
        if number and not ends.taken.read(1):
            return
        try:
            send(ends.results, outcome, ends.tray)
        except BrokenPipeError:
            return
        if isinstance(outcome, _Raised):
            return
