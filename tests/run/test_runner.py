"""Runners: order, errors as outcomes, processes that die; signals that end the program."""

import os
import signal
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.run.executor import ProcessRunner
from dogbot_logtool.run.runner import Failure, Runner, runner_for
from tests.paths import ROOT
from tests.processes import survivors_of
from tests.run.work import Progress, work
from tests.shell import Outcome, python


def outcomes(runner: Runner[Any], folder: Path, *items: str) -> tuple[list[Any], Progress]:
    progress = Progress()
    with closing(runner):
        return list(runner.run(work, [(item, folder) for item in items], progress)), progress


def test_in_this_process_an_error_is_an_outcome(tmp_path: Path) -> None:
    items = ("a", "wrong", "fault", "b", "greedy")
    found, progress = outcomes(runner_for("info", 5, 1, None), tmp_path, *items)
    assert found[:2] == ["A", Failure("no such file", 2)]
    assert found[2].sentence.startswith("failed by a fault of dogbot-logtool")
    assert found[3:] == ["B", Failure("there was not enough memory for it", 1)]
    assert progress.done == [0, 1, 2, 3, 4]


def test_a_process_that_dies_costs_its_own_item_only(tmp_path: Path) -> None:
    items = ("slow", "a", "wrong", "fault", "deadly", "b", "deadly once", "c")
    found, progress = outcomes(runner_for("info", len(items), 2, None), tmp_path, *items)
    assert found[:3] == ["SLOW", "A", Failure("no such file", 2)]
    assert found[3].sentence.startswith("failed by a fault of dogbot-logtool")
    assert found[4] == Failure(
        "the process that worked on it died twice, perhaps because memory ran out", 1
    )
    assert found[5:] == ["B", "DEADLY ONCE", "C"]
    assert sorted(progress.done) == list(range(len(items)))
    assert {4, 6} <= set(progress.lost_items)


def test_a_result_that_cannot_be_sent_costs_its_own_item_only(tmp_path: Path) -> None:
    found, _ = outcomes(ProcessRunner(2), tmp_path, "a", "unsendable", "b")
    assert (found[0], found[2]) == ("A", "B")
    assert found[1].sentence.startswith("its result cannot be sent: ZeroDivisionError")


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGHUP], ids=lambda n: n.name)
def test_no_worker_outlives_the_first_process(tmp_path: Path, number: signal.Signals) -> None:
    """Nor does one hold its pipes, or leave what it has begun."""
    script = f"""
import signal
from pathlib import Path
from dogbot_logtool.run.executor import ProcessRunner
from tests.run.work import Progress, work

if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    list(ProcessRunner(2).run(work, [("endless", Path({str(tmp_path)!r}))] * 4, Progress()))
"""
    file = tmp_path.parent / "script.py"
    file.write_text(script)
    process = subprocess.Popen(  # noqa: S603
        [sys.executable, file],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        start_new_session=True,
    )
    end = time.monotonic() + 60.0
    while len(list(tmp_path.iterdir())) < 2:
        assert time.monotonic() < end
        time.sleep(0.01)
    process.send_signal(number)
    process.communicate(timeout=60.0)
    assert [*survivors_of(process.pid), *tmp_path.iterdir()] == []


@pytest.mark.skipif(sys.platform != "linux", reason="limits files")
@pytest.mark.parametrize("files", [15, 24])
def test_processes_that_cannot_be_started_are_told(files: int) -> None:
    script = f"""
import dogbot_logtool.run.executor, dogbot_logtool.report.text.console
from contextlib import closing
from resource import RLIMIT_NOFILE, setrlimit
from dogbot_logtool.errors import LogtoolError
from tests.run.work import Progress

if __name__ == "__main__":
    setrlimit(RLIMIT_NOFILE, ({files}, {files}))
    try:
        with closing(dogbot_logtool.run.executor.ProcessRunner(9)) as runner:
            list(runner.run(str, range(9), Progress()))
    except LogtoolError as error:
        print(error)
"""
    what = "9 processes cannot be started: Too many open files; try fewer --jobs\n"
    done = python("-c", script)
    assert (done.code, done.out) == (0, what)


# --- Signals --------------------------------------------------------------------------------------


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="has no timer that sends a signal")
@pytest.mark.parametrize(
    ("number", "where"),
    [
        (signal.SIGINT, "weakref.finalize(thing, fall)"),
        (signal.SIGTERM, "weakref.ref(thing, fall)"),
    ],
)
def test_a_signal_in_a_finalizer_is_not_lost(number: signal.Signals, where: str) -> None:
    script = f"""
import os, signal, time, weakref
from dogbot_logtool.signals import raise_on_signals

# In the background of a shell it may be ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)

class Thing:
    pass

def fall(*_):
    os.kill(os.getpid(), {int(number)})
    list(range(100))

raise_on_signals()
thing = Thing()
kept = {where}
del thing
time.sleep(30.0)
print("lost")
"""
    assert python("-c", script) == Outcome(128 + number, "", "")


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="cannot hold signals back")
def test_a_worker_ends_by_what_was_held_back_while_it_was_started() -> None:
    script = """
import os, signal
from dogbot_logtool.signals import held_back, leave_to_parent

with held_back():
    os.kill(os.getpid(), signal.SIGTERM)
    leave_to_parent()
    print("lives on", flush=True)
"""
    assert python("-c", script) == Outcome(-signal.SIGTERM, "", "")


@pytest.mark.skipif(sys.platform != "linux", reason="limits memory")
def test_too_little_memory_is_told() -> None:
    script = """
import sys
import numpy
from resource import RLIMIT_AS, setrlimit
from dogbot_logtool.cli import convert, main

with open("/proc/self/statm") as file:
    used = int(file.read().split()[0]) * 4096
setrlimit(RLIMIT_AS, (used + (24 << 20), used + (24 << 20)))
sys.argv = ["dogbot-logtool", "stats", "sample_logs/dogbot_trot.bag", "--jobs", "1"]
main()
"""
    what = "error: there is not enough memory; with --jobs 1 the least is needed\n"
    assert python("-c", script) == Outcome(1, "", what)
