"""Spans of a log that hold nothing: refused, with what the log has."""

import pytest

from tests.oracles.small_logs import first_seconds, odometry_log
from tests.paths import TROT, TROUBLED
from tests.shell import Shell

SHORT = first_seconds(TROUBLED)
LENGTH = "it lasts from 0 to 2.000 s"


@pytest.mark.parametrize("words", ["convert", "stats", "stats --json", "report"])
@pytest.mark.parametrize(
    ("span", "fault"),
    [
        (["--start", "4", "--end", "2"], "--end 2 is not after --start 4"),
        (["--start", "2", "--end", "2"], "--end 2 is not after --start 2"),
        (["--start", "100"], "--start 100 is not before the log's end"),
        (["--start", "-1"], "--start -1 lies before the log"),
        (["--start", "-2", "--end", "-1"], "--start -2 lies before the log"),
        (["--end", "-1"], "--end -1 is not after the log's start"),
        (["--end", "0"], "--end 0 is not after the log's start"),
        # 1 ns after a message: nothing was recorded in the next one.
        (["--start", "1.000000001", "--end", "1.000000002"], "no message was recorded from 1.0"),
    ],
)
def test_an_empty_span_is_refused(shell: Shell, words: str, span: list[str], fault: str) -> None:
    first, *rest = words.split()
    done = shell(first, SHORT, *rest, *span)
    assert (done.code, done.out if "--json" not in words else "", shell.files()) == (2, "", [])
    assert fault in done.err
    assert f"{SHORT}: " in done.err
    assert LENGTH in done.err


@pytest.mark.parametrize("span", [["--start", "0"], ["--end", "1e9"], ["--start", "0.5"]])
def test_a_span_that_reaches_beyond_the_log_is_fine(shell: Shell, span: list[str]) -> None:
    log = odometry_log(shell.folder / "log.mcap", "/odom")
    assert shell("convert", log, *span).code == 0


@pytest.mark.parametrize("command", ["convert", "stats", "report"])
def test_each_log_has_its_own_span(shell: Shell, command: str) -> None:
    done = shell(command, TROT, SHORT, "--start", "5.5", "--end", "6.5")
    assert done.code == 2
    assert "1 of 2 logs could not be done" in done.err
    assert LENGTH in " ".join(done.err.split())
    assert len(shell.files()) == {"convert": 1, "stats": 0, "report": 3}[command]
