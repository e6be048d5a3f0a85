"""What a call loads, and the memory that it takes: imports are most of the time of a short log."""

import shlex
import subprocess
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from dogbot_logtool import extras
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


@pytest.mark.parametrize(
    ("words", "package", "extra"),
    [
        (("info", "s3://lab/walk.bag"), "upath", "fleet"),
        (("stats", TROT, "--scheduler", "tcp://x:1"), "distributed", "fleet"),
        (("export", TROT, "--dataset", "walks"), "pyarrow", "fleet"),
        (("stats", WALK, "--figure", "walk.pdf"), "matplotlib", "plot"),
        (("report", TROT), "jinja2", "report"),
    ],
)
def test_what_an_extra_brings_is_asked_for(
    shell: Shell,
    monkeypatch: pytest.MonkeyPatch,
    words: Sequence[object],
    package: str,
    extra: str,
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    for module in ("run.cluster", "report.dataset", "report.gait_figure", "report.page.render"):
        monkeypatch.delitem(sys.modules, f"dogbot_logtool.{module}", raising=False)
    done = shell(*words)
    assert (done.code, done.out, shell.files()) == (1, "", [])
    assert done.err.endswith(f"not installed: {install_command(extra)}\n")


# --- What an extra brings -------------------------------------------------------------------------


@pytest.mark.parametrize("installer", ["-m pip install", "uv pip install"])
def test_libraries_are_named(monkeypatch: pytest.MonkeyPatch, installer: str) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda _: installer.startswith("-m") or None)
    command = extras.install_command("fleet")
    assert installer in command
    words = shlex.split(command)
    assert sys.executable in words
    assert words[-4:] == ["distributed", "fsspec", "pyarrow", "universal-pathlib"]


def test_a_clone_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(extras, "requires", missing)
    command = extras.install_command("plot")
    assert command.endswith(f" -e {shlex.quote(f'{ROOT.resolve()}[plot]')}")


# --- Memory ---------------------------------------------------------------------------------------


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
