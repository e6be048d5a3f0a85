"""Memory does not grow with the log."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LIMIT_MIB = 150
SLACK_MIB = 15
"""What two runs of the same command may differ by."""


# A child starts with its parent's peak, and this process may be large: a small one stands between.
_LAUNCHER = """
import os, subprocess, sys
process = subprocess.Popen([sys.executable, *sys.argv[1:]])
_, status, usage = os.wait4(process.pid, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


def peak_mib(*command: str | Path) -> float:
    words = [sys.executable, "-c", _LAUNCHER, *command]
    done = subprocess.run(words, cwd=ROOT, check=True, capture_output=True, text=True)  # noqa: S603
    return int(done.stdout.split()[-1]) / (1 << 20 if sys.platform == "darwin" else 1 << 10)


@pytest.mark.skipif(not hasattr(os, "wait4"), reason="nothing tells a process's peak memory")
@pytest.mark.parametrize(("suffix", "kind"), [("bag", "lz4"), ("mcap", "ros1")])
def test_three_times_the_log_takes_no_more_memory(tmp_path: Path, suffix: str, kind: str) -> None:
    peaks: list[float] = []
    for seconds in (15, 45):
        log = tmp_path / f"{seconds}.{suffix}"
        peak_mib("benchmarks/make_log.py", log, str(seconds), kind)
        words = ("convert", log, "-o", tmp_path / f"{seconds}.out.mcap", "-q", "--jobs", "2")
        peaks.append(peak_mib("-m", "dogbot_logtool", *words))

    assert max(peaks) < LIMIT_MIB
    assert peaks[1] < peaks[0] + SLACK_MIB
