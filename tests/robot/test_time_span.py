"""Spans of a log that hold nothing: refused, with what the log has."""

import pytest

from tests.oracles.small_logs import first_seconds, odometry_log
from tests.paths import TROT, TROUBLED
from tests.shell import Shell

SHORT = first_seconds(TROUBLED)
LENGTH = "it lasts from 0 to 2.000 s"


@pytest.mark.parametrize("words", ["convert", "stats", "stats --json", "report"])
@pytest.mark.parametrize(
    "span",
    [
        "--start 4 --end 2",
        "--start 2 --end 2",
        "--start 100",
        "--start -1",
        "--start -2 --end -1",
        "--end -1",
        "--end 0",
        # 1 ns after a message: nothing was recorded in the next one.
        "--start 1.000000001 --end 1.000000002",
    ],
)
def test_an_empty_span_is_refused(shell: Shell, words: str, span: str) -> None:
    first, *rest = words.split()
    done = shell(first, SHORT, *rest, *span.split())
    assert (done.code, done.out if "--json" not in words else "", shell.files()) == (2, "", [])
    assert f"{SHORT}: {span}: the log has no messages there; {LENGTH}" in done.err


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
