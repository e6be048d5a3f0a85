"""The command on a terminal."""

import subprocess
from pathlib import Path

import pyte
import pytest

from tests import forked_cli
from tests.oracles.small_logs import first_seconds
from tests.paths import TROT, TROUBLED


@pytest.mark.parametrize("logs", [[TROT], [TROT, TROUBLED]], ids=["one", "several"])
@pytest.mark.parametrize("command", ["convert", "stats"])
def test_a_terminal_shows_in_the_end_what_a_pipe_gets(
    tmp_path: Path, command: str, logs: list[Path]
) -> None:
    output = {"convert": ["-o", "./", "--overwrite"]}.get(command, [])
    # What several processes do is shown by any command alike.
    jobs = ["--jobs", "1"] if len(logs) > 1 and command != "stats" else []
    words = [command, *map(str, map(first_seconds, logs)), *output, *jobs]
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
