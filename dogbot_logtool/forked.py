"""Work on several copies of this process, with results in the order of the work.

A fork takes a few milliseconds and inherits whatever the work refers to: an opened log, a plan,
the columns of its index. The copies take the items in turn, pass batons round in a ring, and send
results here. They read the log, compute and answer: of the threads that were copied as they
stood, none is needed.
"""

import fcntl
import multiprocessing
import os
import pickle
import signal
import traceback
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.context import ForkProcess
from typing import Any, BinaryIO, Final, Generic

import numpy as np

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.parallel import Item, RelayWork, Result, State

_FORK: Final = multiprocessing.get_context("fork")
_RESULT_SIZE: Final = 1 << 20
"""Bytes that a worker can send before anybody takes them: about what comes of a batch."""


def forked(
    work: RelayWork[Item, State, Result], items: Sequence[Item], jobs: int, first: State
) -> Generator[Result, None, None]:
    """Yield `work(item, baton)` for every item, in order; see `dogbot_logtool.parallel.relayed`.

    Args:
        work: what is done to an item.
        items: at least as many as `jobs`.
        jobs: at least two, since a process cannot hand on a large baton to itself.
        first: the baton of the first item.

    Raises:
        LogtoolError: a process died.
    """
    with _crew(work, items, jobs, first) as results:
        for number in range(len(items)):
            yield _received(results[number % jobs])


def _received(results: BinaryIO) -> Any:  # noqa: ANN401 - it was pickled
    try:
        outcome = _receive(results)
    except _NeighbourDied as error:
        raise LogtoolError(
            "a process that worked on it died: perhaps for want of memory; try --jobs 1"
        ) from error
    if isinstance(outcome, _Raised):
        raise outcome.error
    return outcome


class _NeighbourDied(Exception):  # noqa: N818 - it never leaves this module
    """Who was to send something is no more."""


def _send(end: BinaryIO, thing: object) -> None:
    """Send an object: its arrays as they lie, the rest pickled."""
    arrays: list[pickle.PickleBuffer] = []
    rest = pickle.dumps(thing, protocol=5, buffer_callback=arrays.append)
    pieces = [array.raw() for array in arrays]
    pickle.dump((rest, [len(piece) for piece in pieces]), end)
    end.writelines(pieces)
    end.flush()


def _receive(end: BinaryIO) -> Any:  # noqa: ANN401 - it was pickled
    """Receive what `_send` sent, each array straight into its place.

    Raises:
        _NeighbourDied: it was not sent, or not to its end.
    """
    try:
        rest, sizes = pickle.load(end)  # noqa: S301 - a copy of this process made it
    except (EOFError, pickle.UnpicklingError) as error:
        raise _NeighbourDied from error
    arrays = [np.empty(size, np.uint8) for size in sizes]
    for array in arrays:
        if end.readinto(array.data) < len(array):  # type: ignore[attr-defined]
            raise _NeighbourDied
    return pickle.loads(rest, buffers=arrays)  # noqa: S301 - as above


@dataclass(frozen=True, slots=True)
class _Raised:
    """What came of work instead of a result."""

    error: Exception


@dataclass(frozen=True, slots=True)
class _Ends:
    """A worker's ends of its pipes."""

    batons_in: BinaryIO
    batons_out: BinaryIO
    results: BinaryIO

    def __iter__(self) -> Iterator[BinaryIO]:
        return iter((self.batons_in, self.batons_out, self.results))


class _Piped(Generic[State]):
    """A baton between processes."""

    def __init__(self, ends: _Ends, given: list[State]) -> None:
        self._ends = ends
        self._given = given

    def take(self) -> State:
        """See `Baton.take`."""
        if self._given:
            return self._given.pop()
        state: State = _receive(self._ends.batons_in)
        return state

    def pass_on(self, state: State) -> None:
        """See `Baton.pass_on`."""
        # Behind the last item nobody waits.
        with suppress(BrokenPipeError):
            _send(self._ends.batons_out, state)


@contextmanager
def _crew(
    work: RelayWork[Item, State, Result], items: Sequence[Item], jobs: int, first: State
) -> Iterator[list[BinaryIO]]:
    """Start the workers; yield the ends from which their results come."""
    pipes = _Pipes()
    crew: list[ForkProcess] = []
    try:
        try:
            for number, ends in enumerate(pipes.ring(jobs)):
                given = [] if number else [first]
                crew.append(_started(work, items[number::jobs], ends, given, pipes))
        except OSError as error:
            raise LogtoolError(
                f"{jobs} processes cannot be started: {error.strerror}; try fewer --jobs"
            ) from error
        pipes.close_all_but(pipes.results)
        yield pipes.results
    finally:
        for process in crew:
            process.kill()
        for process in crew:
            process.join()
        pipes.close_all_but([])


class _Pipes:
    """All ends of all pipes between workers, and from them to here."""

    def __init__(self) -> None:
        self.results: list[BinaryIO] = []
        """Where results arrive, by worker."""
        self._ends: list[BinaryIO] = []

    def ring(self, jobs: int) -> list[_Ends]:
        """Return the ends of each worker: it takes batons from the one before it."""
        batons = [self._pipe() for _ in range(jobs)]
        results = [self._pipe() for _ in range(jobs)]
        for arrive, leave in results:
            self.results.append(arrive)
            # The system may allow less; then more switches from process to process are paid.
            with suppress(OSError):
                fcntl.fcntl(leave.fileno(), fcntl.F_SETPIPE_SZ, _RESULT_SIZE)
        return [
            _Ends(batons[number][0], batons[(number + 1) % jobs][1], results[number][1])
            for number in range(jobs)
        ]

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
    for item in items:
        try:
            outcome: Result | _Raised = work(item, baton)
        except _NeighbourDied:
            return
        except Exception as error:  # noqa: BLE001 - it is raised where the result is wanted
            error.add_note(traceback.format_exc())
            outcome = _Raised(error)
        try:
            _send(ends.results, outcome)
        except BrokenPipeError:
            return
        if isinstance(outcome, _Raised):
            return
