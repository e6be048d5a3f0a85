"""What a command on a short log must not load, since it takes long and is not needed."""

import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest

BAG: Final = Path(__file__).parents[2] / "sample_logs" / "dogbot_trot.bag"
SLOW: Final = {"numpy.ma", "multiprocessing", "concurrent.futures", "asyncio", "jinja2"}


@pytest.mark.parametrize(
    ("words", "slow"),
    [
        (["stats", str(BAG), "--json", "--jobs", "1"], {"rich", "google.protobuf"}),
        (["convert", str(BAG), "-o", "out.mcap", "-q", "--jobs", "1"], {"rich"}),
    ],
)
def test_slow_libraries_are_not_loaded(words: list[str], slow: set[str], tmp_path: Path) -> None:
    done = subprocess.run(  # noqa: S603 - this program
        [sys.executable, "-X", "importtime", "-m", "dogbot_logtool", *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "numpy" in loaded
    assert (SLOW | slow) & loaded == set()
