"""The command as a process: signals amid writing, and terminals."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pyte
import pytest

from tests import forked_cli
from tests.oracles.small_logs import first_seconds, odometry_log
from tests.paths import TROT, TROUBLED
from tests.unfinished import unfinished

SHORT = first_seconds(TROT)


@pytest.fixture(scope="module")
def long_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a log that takes a while: 120 MB of noise."""
    return odometry_log(tmp_path_factory.mktemp("long") / "long.mcap", "/odom", filler=12)


# A shell that runs the tests in the background has them, and their children, ignore Ctrl-C; nohup
# has them ignore that the terminal hangs up.
INTERRUPTIBLE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
from dogbot_logtool.cli import cli, main
main()
"""


@pytest.mark.parametrize(
    ("number", "jobs", "twins"),
    [
        (signal.SIGINT, 2, 0),
        (signal.SIGTERM, 1, 0),
        (signal.SIGHUP, 2, 1),
        pytest.param(
            signal.SIGKILL,
            2,
            0,
            marks=pytest.mark.skipif(
                not hasattr(os, "O_TMPFILE"), reason="there are no files without names"
            ),
        ),
    ],
)
def test_a_signal_amid_writing_leaves_nothing(
    tmp_path: Path, long_log: Path, number: signal.Signals, jobs: int, twins: int
) -> None:
    words = ["convert", str(long_log), "-o", "x.mcap", "--compression", "lz4", "--jobs", str(jobs)]
    if twins:
        twin = long_log.with_name("twin.mcap")
        twin.unlink(missing_ok=True)
        os.link(long_log, twin)
        words[2:4] = [str(twin), "-o", "."]
    process = subprocess.Popen(  # noqa: S603
        [sys.executable, "-c", INTERRUPTIBLE, *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        for found in _until_written(tmp_path, process):
            assert found.stat().st_size < long_log.stat().st_size
        process.send_signal(number)
        out, err = process.communicate()
    killed = number is signal.SIGKILL
    assert process.returncode == (-number if killed else 128 + number)
    assert (out, err) == ("", "" if killed else "interrupted: nothing was left behind\n")
    assert list(tmp_path.iterdir()) == []


def _until_written(folder: Path, process: "subprocess.Popen[str]") -> Iterator[Path]:
    """Wait until part of the output is there; then yield it."""
    while process.poll() is None:
        for part in unfinished(folder, process.pid):
            with contextlib.suppress(FileNotFoundError):
                if part.stat().st_size:
                    yield part
                    return
        time.sleep(0.001)
    raise AssertionError(process.communicate()[1])


@pytest.mark.parametrize(
    "logs", [[SHORT], [SHORT, first_seconds(TROUBLED)]], ids=["one", "several"]
)
@pytest.mark.parametrize("command", ["convert", "stats", "info"])
def test_a_terminal_shows_in_the_end_what_a_pipe_gets(
    tmp_path: Path, command: str, logs: list[Path]
) -> None:
    output = {"convert": ["-o", "./", "--overwrite"], "info": ["--frames"]}.get(command, [])
    # What several processes do is shown by any command alike.
    jobs = ["--jobs", "1"] if len(logs) > 1 and command != "stats" else []
    words = [command, *map(str, logs), *output, *jobs]
    size = {"COLUMNS": "160", "LINES": "200", "TERM": "xterm"}
    done = forked_cli.run(*words, folder=tmp_path, environment=size, stderr=subprocess.STDOUT)
    code, shown = forked_cli.run_on_terminal(*words, folder=tmp_path, environment=size)
    assert (done.returncode, code) == (0, 0)

    screen = pyte.Screen(160, 200)
    pyte.Stream(screen).feed(shown.decode())
    assert b"\x1b[2K" in shown, "no progress was shown"
    assert [line.rstrip() for line in screen.display if line.strip()] == [
        line.rstrip() for line in done.stdout.splitlines() if line.strip()
    ]
