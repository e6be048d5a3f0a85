"""Work in several copies of this process, with results in the order of the items.

A fork takes a few milliseconds and inherits whatever the work refers to: an opened log, a plan, the
columns of its index. The workers take the items in turn. Each sends its results to this process,
and the state after an item to the next worker, in a ring. Each pipe has one process at each end, so
nothing waits for a process that has ended. A worker ends at once when this process ends, however
that happens.
"""

import gc
import multiprocessing
import os
import threading
import traceback
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing.connection import wait
from multiprocessing.context import ForkProcess
from typing import Any, BinaryIO, Final, Generic

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.run.channels import PeerEndedError, Pipe, ResultChannel, receive, send
from dogbot_logtool.run.in_order import Item, Result, State, StatefulWork
from dogbot_logtool.signals import held_back, leave_to_parent

_FORK: Final = multiprocessing.get_context("fork")
_STARTING: Final = threading.Lock()
"""Held while workers start: another thread's would inherit both ends of their pipes."""
_LOOK_EVERY_S: Final = 1.0


@dataclass(frozen=True, slots=True)
class _Raised:
    """An error of the work, sent instead of a result."""

    error: Exception


def forked(
    work: StatefulWork[Item, State, Result], items: Sequence[Item], jobs: int, first: State
) -> Generator[Result, None, None]:
    """Yield `work(item, exchange)` for every item, in order; see `in_order.in_order_with_state`.

    Args:
        work: what is done to an item.
        items: at least as many as `jobs`.
        jobs: at least two, since a process cannot send a large state to itself.
        first: the state before the first item.

    Raises:
        LogtoolError: a process died.
    """
    with _workers(work, items, jobs, first) as results:
        for number in range(len(items)):
            yield _result(results[number % jobs])


def _result(arriving: ResultChannel) -> Any:  # noqa: ANN401 - it was pickled
    try:
        outcome = arriving.receive()
    except PeerEndedError as error:
        raise LogtoolError(
            "a process that worked on it died, perhaps because memory ran out; try --jobs 1"
        ) from error
    if isinstance(outcome, _Raised):
        raise outcome.error
    return outcome


@dataclass(frozen=True, slots=True)
class _Ends:
    """The ends of pipes that a worker uses."""

    parent: BinaryIO
    """Nothing is sent: it is at its end when the first process is."""
    states_in: BinaryIO
    states_out: BinaryIO
    results: ResultChannel

    def all(self) -> list[BinaryIO]:
        """Return all of them."""
        return [self.parent, self.states_in, self.states_out, *self.results.worker_ends]


class _PipeExchange(Generic[State]):
    """An exchange between processes."""

    def __init__(self, ends: _Ends, first: list[State]) -> None:
        self._ends = ends
        self._first = first

    def receive(self) -> State:
        """See `StateExchange.receive`."""
        if self._first:
            return self._first.pop()
        state: State = receive(self._ends.states_in)
        return state

    def send(self, state: State) -> None:
        """See `StateExchange.send`."""
        # Behind the last item no worker is left to receive it.
        with suppress(BrokenPipeError):
            send(self._ends.states_out, state)


class _Pipes:
    """All pipes between workers, and between them and this process."""

    def __init__(self) -> None:
        self._ends: list[BinaryIO] = []

    def open(self) -> Pipe:
        """Return the ends of a new pipe: to read from, and to write to."""
        reader, writer = os.pipe()
        ends = open(reader, "rb"), open(writer, "wb")  # noqa: SIM115, PTH123 - see close_all_but
        self._ends.extend(ends)
        return ends

    def close_all_but(self, *kept: BinaryIO) -> None:
        """Close ends: a pipe is over only when no process holds its other end."""
        for end in self._ends:
            if end not in kept:
                end.close()


@contextmanager
def _workers(
    work: StatefulWork[Item, State, Result], items: Sequence[Item], jobs: int, first: State
) -> Iterator[list[ResultChannel]]:
    """Start workers, yield the channels through which results arrive, and end the workers."""
    pipes = _Pipes()
    workers: list[ForkProcess] = []
    try:
        # A signal's exception amid a start would leave a process that is never ended.
        with _STARTING, held_back():
            arriving = _start(work, items, jobs, first, pipes, workers)
        yield arriving
    finally:
        for process in workers:
            process.kill()
        for process in workers:
            process.join()
        pipes.close_all_but()


def _start(
    work: StatefulWork[Item, State, Result],
    items: Sequence[Item],
    jobs: int,
    first: State,
    pipes: _Pipes,
    workers: list[ForkProcess],
) -> list[ResultChannel]:
    """Start workers, added to a list as they come; return the channels of their results.

    Raises:
        LogtoolError: there are not as many processes or files to be had.
    """
    try:
        alive, parent = pipes.open()
        states = [pipes.open() for _ in range(jobs)]
        results = [ResultChannel(pipes.open(), pipes.open()) for _ in range(jobs)]
        for number in range(jobs):
            states_out = states[(number + 1) % jobs][1]
            ends = _Ends(alive, states[number][0], states_out, results[number])
            given = [] if number else [first]
            serve = partial(_serve, work, items[number::jobs], ends, given, pipes, os.getpid())
            process = _FORK.Process(target=serve, daemon=True)
            process.start()
            workers.append(process)
    except OSError as error:
        raise LogtoolError(
            f"{jobs} processes cannot be started: {error.strerror}; try fewer --jobs"
        ) from error
    pipes.close_all_but(parent, *(end for each in results for end in each.first_ends))
    return results


def _serve(
    work: StatefulWork[Item, State, Result],
    items: Sequence[Item],
    ends: _Ends,
    first: list[State],
    pipes: _Pipes,
    parent: int,
) -> None:
    """Work on some items; runs in a copy of the process."""
    leave_to_parent()
    # A garbage collection writes to all that it looks at: each process would get its own pages of
    # what was there before, an index of an hour for one.
    gc.freeze()
    pipes.close_all_but(*ends.all())
    threading.Thread(target=_end_with, args=(ends.parent, parent), daemon=True).start()
    exchange = _PipeExchange(ends, first)
    # If sending takes too much memory, the first process finds that this one ended.
    with suppress(PeerEndedError, BrokenPipeError, MemoryError), ThreadPoolExecutor(1) as sender:
        sent: Future[None] = sender.submit(lambda: None)
        for item in items:
            try:
                outcome: Result | _Raised = work(item, exchange)
            except PeerEndedError:
                raise
            except Exception as error:  # noqa: BLE001 - it is raised where the result is wanted
                error.add_note(traceback.format_exc())
                outcome = _Raised(error)
            # The next item is begun while this result waits to be received.
            sent.result()
            sent = sender.submit(ends.results.send, outcome)
            if isinstance(outcome, _Raised):
                break
        sent.result()


def _end_with(parent: BinaryIO, process: int) -> None:
    # Other forks of the first process keep the pipe open, so its end alone is not enough.
    while not wait([parent.fileno()], _LOOK_EVERY_S) and os.getppid() == process:
        pass
    os._exit(1)
