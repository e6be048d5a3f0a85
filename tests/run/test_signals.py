"""Signals that ask the program to end."""

import signal
import subprocess
import sys

import pytest

NEEDED = "there is not enough memory; with --jobs 1 the least is needed"


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
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=60.0
    )
    assert (done.returncode, done.stdout, done.stderr) == (128 + number, "", "")


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
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=60.0
    )
    assert (done.returncode, done.stdout) == (-signal.SIGTERM, "")


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
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", script], capture_output=True, text=True, check=False, timeout=60.0
    )
    assert (done.returncode, done.stderr) == (1, f"error: {NEEDED}\n")
