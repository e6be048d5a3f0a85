"""What a call loads: imports are most of the time that a short log takes."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from dogbot_logtool.extras import install_command
from tests.oracles.small_logs import first_seconds
from tests.paths import ROOT, TROT, WALK
from tests.shell import Shell

HEAVY = {"numpy", "rosbags", "rich", "mcap", "google.protobuf", "lz4", "zstandard"}
SLOW = {"numpy.ma", "multiprocessing", "concurrent.futures", "asyncio", "jinja2"}
WRITER = {"mcap", "dogbot_logtool.writer.template"}
DISTRIBUTIONS = {f"rosbags.typesys.stores.{each}" for each in ("ros1_noetic", "ros2_humble")}


@pytest.mark.parametrize(
    ("words", "unneeded"),
    [
        (["--help"], HEAVY | SLOW),
        (["convert"], HEAVY | SLOW),
        (
            ["stats", "SHORT", "--json", "--jobs", "1"],
            SLOW | WRITER | DISTRIBUTIONS | {"rich", "tempfile"},
        ),
        (
            ["convert", "SHORT", "-o", "out.mcap", "-q", "--jobs", "1"],
            SLOW | DISTRIBUTIONS | {"rich"},
        ),
    ],
)
def test_a_call_loads_only_what_it_needs(
    tmp_path: Path, words: list[str], unneeded: set[str]
) -> None:
    call = [str(first_seconds(TROT)) if word == "SHORT" else word for word in words]
    done = subprocess.run(  # noqa: S603 - this program
        [sys.executable, "-X", "importtime", "-m", "dogbot_logtool", *call],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    loaded = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert done.returncode == (2 if words == ["convert"] else 0)
    assert unneeded & loaded == set()
    assert "dogbot_logtool.options" in loaded


def test_without_matplotlib_it_is_said_how_to_install_it(tmp_path: Path) -> None:
    (tmp_path / "matplotlib.py").write_text("raise ImportError")
    refused = subprocess.run(  # noqa: S603 - this program
        [sys.executable, "-m", "dogbot_logtool", "stats", str(WALK), "--figure", "walk.pdf"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])},
        capture_output=True,
        text=True,
        check=False,
    )
    assert refused.returncode == 1
    assert install_command("plot") in refused.stderr


@pytest.mark.parametrize(
    ("words", "package"),
    [
        (("info", "s3://lab/walk.bag"), "upath"),
        (("stats", TROT, "--scheduler", "tcp://x:1"), "distributed"),
        (("export", TROT, "--dataset", "walks"), "pyarrow"),
    ],
)
def test_what_an_extra_brings_is_asked_for(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, words: Sequence[object], package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    for module in ("run.cluster", "report.dataset"):
        monkeypatch.delitem(sys.modules, f"dogbot_logtool.{module}", raising=False)
    done = shell(*words)
    assert (done.code, done.out, shell.files()) == (1, "", [])
    assert done.err.endswith(f"not installed: {install_command('fleet')}\n")
