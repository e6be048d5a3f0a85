"""Signals that interrupt the program: a few, and by the hundred in `make torture`.

What is looked at is the exit code, no traceback, no process that goes on, no wait without end,
nothing left behind, and outputs that are whole.
"""

import contextlib
import itertools
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import psutil
import pytest
from rosbags.rosbag2.enums import StoragePlugin

from tests.oracles.recorded import unpacked
from tests.oracles.small_logs import odometry_log
from tests.oracles.walks import write_rosbag2
from tests.paths import ROOT, TROT, TROUBLED, WALK
from tests.processes import PATIENCE_S, members, survivors_of
from tests.torture.test_commands import COMMANDS, TRIES

INT, TERM, HUP, KILL = signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL
KINDS: Final = (
    (INT,),
    (TERM,),
    (HUP,),
    (KILL,),
    (INT, INT),
    (TERM, TERM),
    (HUP, HUP),
    (INT, TERM),
    (TERM, KILL),
)
"""Signals that are sent one soon after the other."""
START: Final = """
import os, signal, sys

# In the background of a shell they may be ignored.
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, signal.SIG_DFL)
os.execv(sys.executable, [sys.executable, "-m", "dogbot_logtool", *sys.argv[1:]])
"""
APART_S: Final = 0.05
"""Between two signals, at most."""


@dataclass(frozen=True, slots=True)
class Call:
    """A command on some logs, and what comes of it when nothing interrupts it."""

    words: tuple[str, ...]
    takes_s: float
    outputs: dict[str, bytes]


def started(words: Sequence[str], folder: Path) -> "subprocess.Popen[str]":
    """Start the program in a session of its own, as a terminal would."""
    return subprocess.Popen(  # noqa: S603
        [sys.executable, "-c", START, *words],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), **os.environ},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def undisturbed(words: tuple[str, ...]) -> Call:
    """Run a command as it is, and remember what it makes."""
    with tempfile.TemporaryDirectory() as name:
        start = time.monotonic()
        process = started(words, Path(name))
        _, err = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, err
        return Call(words, time.monotonic() - start, contents(Path(name)))


def contents(folder: Path) -> dict[str, bytes]:
    """Return all files below a folder, hidden ones too."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def wait_until_ready(process: "subprocess.Popen[str]") -> None:
    """Wait until the program handles signals: before that they end the interpreter itself."""
    caught = 0
    while not caught >> (TERM - 1) & 1 and process.poll() is None:
        status = Path(f"/proc/{process.pid}/status").read_text()
        caught = int(status.partition("SigCgt:")[2].split()[0], 16)
        time.sleep(0.001)


def wait_until_written(process: "subprocess.Popen[str]", size: int) -> None:
    """Wait until the program and its workers have written so many bytes."""
    parent, written = psutil.Process(process.pid), 0
    while written < size and process.poll() is None:
        with contextlib.suppress(psutil.Error):
            everyone = parent, *parent.children(recursive=True)
            written = sum(each.io_counters().write_chars for each in everyone)


def interrupt(
    process: "subprocess.Popen[str]", signals: Sequence[signal.Signals], *, everyone: bool
) -> None:
    """Send signals, to all processes as a terminal does, or to the first one."""
    for number, each in enumerate(signals):
        if number:
            time.sleep(random.uniform(0.0, APART_S))  # noqa: S311 - no secret
        with contextlib.suppress(ProcessLookupError):
            if everyone and each is not KILL:
                os.killpg(process.pid, each)
            else:
                process.send_signal(each)


def attempt(call: Call, signals: Sequence[signal.Signals]) -> list[str]:
    """Interrupt a call at a random moment; return what is wrong with how it ended."""
    with tempfile.TemporaryDirectory() as name:
        process = started(call.words, Path(name))
        wait_until_ready(process)
        moment = random.uniform(0.0, 1.1 * call.takes_s)  # noqa: S311 - no secret
        everyone = random.random() < 0.5  # noqa: S311 - no secret
        time.sleep(moment)
        interrupt(process, signals, everyone=everyone)
        faults = list(faults_of(process, call, signals, Path(name)))
    sent = "+".join(each.name for each in signals) + (" to all" if everyone else "")
    return [f"{call.words[0]}, {sent} after {moment:.3f} s: {fault}" for fault in faults]


def faults_of(
    process: "subprocess.Popen[str]",
    call: Call,
    signals: Sequence[signal.Signals],
    folder: Path,
    patience_s: float = PATIENCE_S,
    says: str = "",
) -> Iterator[str]:
    """Wait for the end of a call that was interrupted; yield what is wrong."""
    try:
        out, err = process.communicate(timeout=patience_s)
    except subprocess.TimeoutExpired:
        yield f"goes on, or its pipes are held: {members(process.pid)}"
        for survivor in members(process.pid):
            os.kill(survivor, KILL)
        out, err = process.communicate()
    else:
        yield from survivors_of(process.pid)
    yield from unwanted(out + err, signals)
    if says not in err:
        yield f"does not say: {says}: {err}"
    good = {0} | {-KILL if each is KILL else 128 + each for each in signals}
    if process.returncode not in good:
        yield f"exit code {process.returncode}: {err}"
    for name, data in contents(folder).items():
        if name not in call.outputs:
            yield f"left behind: {name}"
        elif data != call.outputs[name]:
            yield f"not whole: {name}"
    if process.returncode == 0 and contents(folder).keys() != call.outputs.keys():
        yield "says that it is done, and is not"


def unwanted(text: str, signals: Sequence[signal.Signals]) -> Iterator[str]:
    # Killed between the start of a worker and the word of what to do, the first process leaves it
    # to the standard library, which prints that nothing came.
    if KILL in signals and "in spawn_main" in text:
        return
    for each in ("Traceback", "Exception ignored", "damage:"):
        if each in text:
            yield f"{each}: {text}"


# --- Tests ----------------------------------------------------------------------------------------


LINUX: Final = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
FIRST: Final = {each.split()[0]: each for each in reversed(COMMANDS)}.values()
"""One call of every command."""
SOON_S: Final = 10.0
"""An end takes a tenth of a second; one that takes longer than this never comes."""


@pytest.fixture(scope="session")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A ROS 2 bag on which every command is busy for half a second."""
    folder = tmp_path_factory.mktemp("long") / "log"
    return write_rosbag2(folder, *unpacked(TROT, 2), StoragePlugin.SQLITE3)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder that a command works in; temporary files would lie in it, too."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return tmp_path


@pytest.fixture(scope="module", params=[1, 6], ids=["one log", "six logs"])
def calls(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[Call]:
    """Calls on one log or several, as they end when nothing interrupts them."""
    folder = tmp_path_factory.mktemp("logs")
    logs = [
        shutil.copy(log, folder / f"{number}_{log.name}")
        for number in (1, 2)
        for log in (TROT, WALK, TROUBLED)
    ]
    found = []
    for command in ("convert", "stats", "report")[: 3 if TRIES > 1 else 1]:
        output = () if command == "stats" else ("-o", "out/")
        words = (command, *map(str, logs[: request.param]), *output, "--jobs", "2")
        found.append(undisturbed(words))
    return found


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS[:: 1 if TRIES > 1 else 3], ids=str)
def test_nothing_is_left_after_signals(calls: list[Call], kind: tuple[signal.Signals, ...]) -> None:
    tried = (attempt(calls[number % len(calls)], kind) for number in range(TRIES))
    assert [fault for faults in tried for fault in faults] == []


@pytest.fixture(scope="module")
def long_logs(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Two logs that take a while to write: 120 MB of noise each."""
    log = odometry_log(tmp_path_factory.mktemp("long") / "long.mcap", "/odom", filler=12)
    twin = log.with_name("twin.mcap")
    twin.hardlink_to(log)
    return [str(log), str(twin)]


@LINUX
@pytest.mark.parametrize(
    ("each", "logs", "jobs"), [(INT, 1, "2"), (TERM, 1, "1"), (HUP, 2, "2"), (KILL, 1, "2")]
)
def test_signals_amid_writing_leave_nothing(
    folder: Path, long_logs: list[str], each: signal.Signals, logs: int, jobs: str
) -> None:
    words = ("convert", *long_logs[:logs], "-o", "./", "--compression", "lz4", "--jobs", jobs)
    with started(words, folder) as process:
        wait_until_written(process, 20_000_000)
        interrupt(process, [each], everyone=False)
        says = "" if each is KILL else "interrupted: nothing was left behind\n"
        call = Call(words, 0.0, {})
        assert list(faults_of(process, call, [each], folder, SOON_S, says)) == []
    assert process.returncode == (-KILL if each is KILL else 128 + each)


@LINUX
def test_signals_end_every_command_on_a_long_bag_at_once(bag: Path, folder: Path) -> None:
    for number, (command, each) in enumerate(zip(FIRST, itertools.cycle((INT, TERM)))):
        words = tuple(command.format(log=bag).split())
        with started(words, folder) as process:
            wait_until_ready(process)
            time.sleep(0.08 * (number % 4 + 1))
            interrupt(process, [each], everyone=True)
            call = Call(words, 0.0, {})
            faults = list(faults_of(process, call, [each], folder, SOON_S))
        assert faults == [], command
        assert list(bag.parent.iterdir()) == [bag]
