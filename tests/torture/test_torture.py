"""Commands on damaged logs, and interrupted ones: a few, and by the hundred in `make torture`."""

import itertools
import os
import shutil
import signal
import sys
import time
from pathlib import Path
from typing import Final

import pytest
from rosbags.rosbag2.enums import StoragePlugin

from tests.oracles.recorded import unpacked
from tests.oracles.small_logs import odometry_log
from tests.oracles.walks import write_rosbag2
from tests.paths import TROT, TROUBLED, WALK
from tests.torture import commands, signals
from tests.torture.signals import HUP, INT, KILL, TERM

TRIES, SEED = (int(os.environ.get(name, "1")) for name in ("TRIES", "SEED"))
LINUX: Final = pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc")
FIRST: Final = {each.split()[0]: each for each in reversed(commands.COMMANDS)}.values()
"""One call of every command."""
PATIENCE_S: Final = 10.0
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


@pytest.mark.slow
def test_every_command_ends_well_on_damaged_logs(tmp_path: Path) -> None:
    real = commands.real_logs() if TRIES > 1 else []
    damaged = commands.damaged_logs(tmp_path, 2 * TRIES, SEED)
    codes = set()
    for log in itertools.chain(commands.SAMPLES[:1], real, damaged):
        for command in commands.COMMANDS:
            code, faults = commands.attempt(command, log)
            assert faults == [], command.format(log=log)
            codes.add(code)
    assert codes >= {0, 3}


@pytest.fixture(scope="module", params=[1, 6], ids=["one log", "six logs"])
def calls(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> list[signals.Call]:
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
        found.append(signals.undisturbed(words))
    return found


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("kind", signals.KINDS[:: 1 if TRIES > 1 else 3], ids=str)
def test_nothing_is_left_after_signals(
    calls: list[signals.Call], kind: tuple[signal.Signals, ...]
) -> None:
    tried = (signals.attempt(calls[number % len(calls)], kind) for number in range(TRIES))
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
    with signals.started(words, folder) as process:
        signals.wait_until_written(process, 20_000_000)
        signals.interrupt(process, [each], everyone=False)
        says = "" if each is KILL else "interrupted: nothing was left behind\n"
        call = signals.Call(words, 0.0, {})
        assert list(signals.faults_of(process, call, [each], folder, PATIENCE_S, says)) == []
    assert process.returncode == (-KILL if each is KILL else 128 + each)


@LINUX
def test_signals_end_every_command_on_a_long_bag_at_once(bag: Path, folder: Path) -> None:
    for number, (command, each) in enumerate(zip(FIRST, itertools.cycle((INT, TERM)))):
        words = tuple(command.format(log=bag).split())
        with signals.started(words, folder) as process:
            signals.wait_until_ready(process)
            time.sleep(0.08 * (number % 4 + 1))
            signals.interrupt(process, [each], everyone=True)
            call = signals.Call(words, 0.0, {})
            faults = list(signals.faults_of(process, call, [each], folder, PATIENCE_S))
        assert faults == [], command
        assert list(bag.parent.iterdir()) == [bag]
