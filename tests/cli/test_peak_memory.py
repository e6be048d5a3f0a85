"""The memory of all processes: columns of the log, and what workers have in hand."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.paths import ROOT

LIMIT_MIB = 200
"""Of which the columns of a minute take 25."""


def run(*words: str | Path) -> str:
    command = [sys.executable, *words]
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout  # noqa: S603


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="nothing tells the memory of all processes")
@pytest.mark.parametrize(("suffix", "kind"), [("bag", "lz4"), ("mcap", "ros1")])
def test_a_minute_takes_little_memory(tmp_path: Path, suffix: str, kind: str) -> None:
    log = tmp_path / f"walk.{suffix}"
    run("benchmarks/make_log.py", log, "60", kind)
    words = ("convert", log, "-o", tmp_path / "out.mcap", "-q", "--jobs", "2")
    tool = (sys.executable, "-m", "dogbot_logtool")
    assert float(run("benchmarks/memory.py", *tool, *words)) < LIMIT_MIB
