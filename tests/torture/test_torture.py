"""A few of the interruptions and damaged logs that `make torture` tries by the hundred."""

import itertools
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
from tests.paths import TROT
from tests.torture import commands, signals
from tests.torture.signals import HUP, INT, KILL, TERM

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
    logs = itertools.chain(commands.SAMPLES[:1], commands.damaged_logs(tmp_path, 2, seed=16))
    ended = list(commands.torture(logs))
    assert [(command, log, one.faults) for command, log, one in ended if one.faults] == []
    assert len(ended) == 3 * len(commands.COMMANDS)
    assert {one.exit_code for _, _, one in ended} >= {0, 3}


@LINUX
@pytest.mark.slow
def test_nothing_is_left_after_signals() -> None:
    rows = list(signals.torture(1, [(INT,), (TERM, TERM), (KILL,)], ["convert"]))
    assert [(name, faults) for name, _, faults in rows if faults] == []
    assert len(rows) == 6


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
