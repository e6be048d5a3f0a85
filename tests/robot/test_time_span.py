"""Spans of a log that reach beyond it."""

import pytest

from tests.oracles.small_logs import first_seconds, odometry_log
from tests.paths import TROT, TROUBLED
from tests.shell import Shell

SHORT = first_seconds(TROUBLED)


@pytest.mark.parametrize("span", [["--start", "0"], ["--end", "1e9"], ["--start", "0.5"]])
def test_a_span_that_reaches_beyond_the_log_is_fine(shell: Shell, span: list[str]) -> None:
    log = odometry_log(shell.folder / "log.mcap", "/odom")
    assert shell("convert", log, *span).code == 0


@pytest.mark.parametrize("command", ["convert", "stats", "report"])
def test_each_log_has_its_own_span(shell: Shell, command: str) -> None:
    done = shell(command, TROT, SHORT, "--start", "5.5", "--end", "6.5")
    assert done.code == 2
    assert "1 of 2 logs could not be done" in done.err
    assert "it lasts from 0 to 2.000 s" in " ".join(done.err.split())
    assert len(shell.files()) == {"convert": 1, "stats": 0, "report": 3}[command]
