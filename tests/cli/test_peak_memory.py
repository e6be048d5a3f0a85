"""Memory does not grow with the log."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.paths import ROOT

LIMIT_MIB = 150
SLACK_MIB = 25
"""What two runs of the same command may differ by: the shorter log ends before all workers are at
their peak. Half a minute of messages takes more than that."""


def run(*words: str | Path) -> str:
    command = [sys.executable, *words]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout  # noqa: S603


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="nothing tells the memory of all processes")
@pytest.mark.parametrize(("suffix", "kind"), [("bag", "lz4"), ("mcap", "ros1")])
def test_four_times_the_log_takes_no_more_memory(tmp_path: Path, suffix: str, kind: str) -> None:
    peaks: list[float] = []
    for seconds in (12, 48):
        log = tmp_path / f"{seconds}.{suffix}"
        run("benchmarks/make_log.py", log, str(seconds), kind)
        words = ("convert", log, "-o", tmp_path / f"{seconds}.out.mcap", "-q", "--jobs", "2")
        tool = (sys.executable, "-m", "dogbot_logtool")
        peaks.append(float(run("benchmarks/memory.py", *tool, *words)))

    assert max(peaks) < LIMIT_MIB
    assert peaks[1] < peaks[0] + SLACK_MIB
