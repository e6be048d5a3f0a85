"""Results in order, errors from where they arise, no more work in flight than is wanted."""

import gc
import mmap
import multiprocessing
import os
import platform
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.errors import LogError, LogtoolError
from dogbot_logtool.run.in_order import StateExchange, in_order, in_order_with_state, one_by_one
from tests.run.work import wait_for_the_end_of

FORKS = [False, *([True] if sys.platform == "linux" else [])]
FROZEN = gc.get_freeze_count()
"""Objects that Python has frozen itself: 3.12 does."""
every_way = pytest.mark.parametrize("forks", FORKS)
"""On threads, and on copies of this process where there can be such."""


@every_way
@settings(max_examples=15)
@given(items=st.lists(st.integers()), jobs=st.integers(1, 5))
def test_results_come_in_the_order_of_the_items(
    *, forks: bool, items: list[int], jobs: int
) -> None:
    assert list(in_order(lambda item: (item, str(item)), items, jobs, forks=forks)) == [
        (item, str(item)) for item in items
    ]


def running_sum(item: int, exchange: StateExchange[int]) -> tuple[int, int]:
    """Send on the sum of all items so far."""
    before = exchange.receive()
    exchange.send(before + item)
    return item, before


@every_way
@settings(max_examples=15)
@given(items=st.lists(st.integers()), jobs=st.integers(1, 5), first=st.integers())
def test_states_pass_from_each_item_to_the_next(
    *, forks: bool, items: list[int], jobs: int, first: int
) -> None:
    got = list(in_order_with_state(running_sum, items, jobs, first, forks=forks))
    assert got == [(item, first + sum(items[:row])) for row, item in enumerate(items)]
    assert got == list(one_by_one(running_sum, items, first))


@every_way
@pytest.mark.parametrize("jobs", [2, 3])
@pytest.mark.parametrize("items", [1, 2, 3, 8])
def test_large_states_and_results_get_through(*, forks: bool, items: int, jobs: int) -> None:
    def work(item: int, exchange: StateExchange[np.ndarray]) -> np.ndarray:
        state = exchange.receive()
        exchange.send(state + 1)
        return state + item

    first = np.zeros(1 << 20)
    for number, result in enumerate(
        in_order_with_state(work, range(items), jobs, first, forks=forks)
    ):
        assert (result == 2 * number).all()


@pytest.mark.parametrize("jobs", [2, 3, 4])
def test_an_early_item_that_takes_long_still_comes_first(jobs: int) -> None:
    second_is_done = threading.Event()

    def work(item: int) -> int:
        if item == 0:
            assert second_is_done.wait(30)
        if item == 1:
            second_is_done.set()
        return item

    assert list(in_order(work, range(20), jobs, forks=False)) == list(range(20))


@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_items_are_taken_only_as_threads_become_free(jobs: int) -> None:
    taken = 0

    def items() -> Iterator[int]:
        nonlocal taken
        for number in range(100):
            taken += 1
            yield number

    results = in_order(lambda item: item, items(), jobs, forks=False)
    for got, result in enumerate(results, start=1):
        assert result == got - 1
        assert taken <= got + jobs
    assert taken == 100


@every_way
@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_an_error_comes_at_its_place(*, forks: bool, jobs: int) -> None:
    def work(item: int) -> int:
        if item == 5:
            raise LogError("x.bag: five is broken")
        return item

    results = in_order(work, range(100), jobs, forks=forks)
    assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    with pytest.raises(LogError, match=r"x\.bag: five is broken"):
        next(results)
    assert_no_worker_is_left()


@every_way
@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_no_worker_waits_for_a_state_that_will_not_come(*, forks: bool, jobs: int) -> None:
    def work(item: int, exchange: StateExchange[int]) -> int:
        if item == 5:
            raise ValueError("five")
        exchange.send(exchange.receive() + 1)
        return item

    results = in_order_with_state(work, range(100), jobs, 0, forks=forks)
    assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    with pytest.raises(ValueError, match="five"):
        next(results)
    assert_no_worker_is_left()


@every_way
@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_an_error_of_the_items_is_raised(*, forks: bool, jobs: int) -> None:
    def items() -> Iterator[int]:
        yield 1
        raise OSError("no more")

    with pytest.raises(OSError, match="no more"):
        list(in_order(lambda item: item, items(), jobs, forks=forks))


@every_way
@pytest.mark.parametrize("jobs", [2, 4])
def test_work_stops_when_no_one_takes_results(tmp_path: Path, *, forks: bool, jobs: int) -> None:
    def work(item: int) -> bytes:
        # No lock counts them: who is killed may hold it.
        (tmp_path / str(item)).touch()
        return bytes([item]) * (1 << 20)

    results = in_order(work, range(200), jobs, forks=forks)
    assert next(results)[:1] == b"\0"
    results.close()
    # Each worker may have a result that is taken, one that waits, and one under way.
    assert len(list(tmp_path.iterdir())) <= 3 * jobs
    assert_no_worker_is_left()


def assert_no_worker_is_left() -> None:
    assert not multiprocessing.active_children()
    assert not [t for t in threading.enumerate() if t.name.startswith("batch")]
    assert gc.get_freeze_count() == FROZEN


def test_one_job_works_in_this_thread() -> None:
    here = os.getpid(), threading.get_ident()
    whereabouts = in_order(lambda _: (os.getpid(), threading.get_ident()), range(5), 1, forks=True)
    assert set(whereabouts) == {here}


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
def test_items_are_shared_out_among_copies_of_this_process() -> None:
    workers = list(in_order(lambda _: os.getpid(), range(6), 3, forks=True))
    assert len(set(workers)) == 3
    assert os.getpid() not in workers
    assert workers[:3] == workers[3:]


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
def test_copies_collect_no_garbage_of_this_process() -> None:
    counts = in_order(lambda _: gc.get_freeze_count(), range(4), 2, forks=True)
    assert all(count > FROZEN for count in counts)
    assert_no_worker_is_left()


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
@pytest.mark.parametrize("jobs", [2, 3])
def test_a_process_that_dies_is_an_error(jobs: int) -> None:
    def work(item: int, exchange: StateExchange[int]) -> int:
        if item == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        exchange.send(exchange.receive() + 1)
        return item

    results = in_order_with_state(work, range(20), jobs, 0, forks=True)
    with pytest.raises(LogtoolError, match=r"a process that worked on it died, .*--jobs 1"):
        list(results)
    assert_no_worker_is_left()


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
@pytest.mark.parametrize("kind", [np.zeros, bytes], ids=["array", "pickled"])
def test_a_process_that_dies_while_it_sends_is_told(kind: Callable[[int], object]) -> None:
    second = multiprocessing.get_context("fork").Value("i", 0, lock=False)

    def work(item: int) -> object:
        if item == 1:
            second.value = os.getpid()
        return kind(item * (8 << 20))

    with closing(in_order(work, range(4), 2, forks=True)) as results:
        next(results)
        while not second.value:
            time.sleep(0.01)
        # It soon waits for somebody to take what a pipe cannot hold.
        time.sleep(0.3)
        os.kill(second.value, signal.SIGKILL)
        with pytest.raises(LogtoolError, match=r"a process that worked on it died"):
            next(results)
    assert_no_worker_is_left()


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
def test_an_interruption_ends_all_processes() -> None:
    def work(item: int) -> int:
        time.sleep(60.0 * item)
        return item

    with closing(in_order(work, range(10), 3, forks=True)) as results:
        next(results)
        for process in multiprocessing.active_children():
            # As a terminal sends it to all; only this process decides.
            os.kill(process.pid or 0, signal.SIGINT)
        assert len(multiprocessing.active_children()) >= 2
    assert_no_worker_is_left()


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
def test_no_process_outlives_the_first_one() -> None:
    script = """
import os, time
from dogbot_logtool.run import forked
from dogbot_logtool.run.in_order import in_order_with_state

forked._LOOK_EVERY_S = 0.05

def work(item, exchange):
    state = exchange.receive()
    exchange.send(state)
    time.sleep(0.01)
    return bytes(1 << 20), os.getpid()

for _, worker in in_order_with_state(work, range(10_000), 3, 0, forks=True):
    print(worker, flush=True)
"""
    with subprocess.Popen(  # noqa: S603
        [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        workers = {int(next(process.stdout)) for _ in range(6)}
        process.kill()
    assert len(workers) == 3
    wait_for_the_end_of(*workers)


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGHUP], ids=lambda n: n.name)
def test_a_process_amid_long_work_ends_with_the_first_one(number: signal.Signals) -> None:
    script = """
import os, signal, time
from dogbot_logtool.run import forked
from dogbot_logtool.run.in_order import in_order

forked._LOOK_EVERY_S = 0.05

def work(item):
    if item == 0:
        return os.getppid()
    print(os.getpid(), flush=True)
    time.sleep(600.0)

signal.signal(signal.SIGHUP, signal.SIG_DFL)
list(in_order(work, range(4), 3, forks=True))
"""
    with subprocess.Popen(  # noqa: S603
        [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        workers = {int(next(process.stdout)) for _ in range(3)}
        process.send_signal(number)
        process.communicate(timeout=30.0)
    wait_for_the_end_of(*workers)


@pytest.mark.skipif(True not in FORKS, reason="processes are not forked here")
def test_processes_that_cannot_be_started_are_told() -> None:
    script = """
import resource
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.run.in_order import in_order

resource.setrlimit(resource.RLIMIT_NOFILE, (20, 20))
try:
    list(in_order(str, range(100), 50, forks=True))
except LogtoolError as error:
    print(error)
"""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == (
        "50 processes cannot be started: Too many open files; try fewer --jobs\n"
    )


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other allocators differ")
def test_memory_that_is_freed_is_used_again() -> None:
    script = """
import resource
from dogbot_logtool.run.in_order import in_order

def two_blocks(_):
    first, second = bytes(790_000), bytes(790_000)

list(in_order(two_blocks, range(200), 1, forks=False))
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt)
"""
    faults = [
        int(subprocess.check_output([sys.executable, "-c", text]))  # noqa: S603
        for text in (script, script.replace("range(200)", "range(0)"))
    ]
    pages = 2 * 790_000 // mmap.PAGESIZE
    # If each round were given pages of its own, it would be two hundred times as many.
    assert faults[0] - faults[1] < 5 * pages


@every_way
def test_nothing_to_do(*, forks: bool) -> None:
    assert list(in_order(str, [], 1, forks=forks)) == []
    assert list(in_order(str, [], 3, forks=forks)) == []
