"""What a call loads, the memory that it takes, and what an installation or a system may lack."""

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from dogbot_logtool import extras
from dogbot_logtool.extras import install_command
from dogbot_logtool.io import storage
from tests import forked_cli
from tests.oracles.small_logs import first_seconds
from tests.paths import ROOT, TROT, TROUBLED, WALK
from tests.shell import Shell, python

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
    done = python("-X", "importtime", "-m", "dogbot_logtool", *call, folder=tmp_path)
    loaded = {line.rpartition("|")[2].strip() for line in done.err.splitlines()}
    assert done.code == (2 if words == ["convert"] else 0)
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
    shell: Shell, monkeypatch: pytest.MonkeyPatch, words: Sequence[object], package: str, extra: str
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


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="nothing tells the memory of all processes")
@pytest.mark.parametrize(("suffix", "kind"), [("bag", "lz4"), ("mcap", "ros1")])
def test_a_minute_takes_little_memory(tmp_path: Path, suffix: str, kind: str) -> None:
    log = tmp_path / f"walk.{suffix}"
    assert python("benchmarks/make_log.py", log, 60, kind).code == 0
    words = ("convert", log, "-o", tmp_path / "out.mcap", "-q", "--jobs", "2")
    tool = (sys.executable, "-m", "dogbot_logtool")
    assert float(python("benchmarks/memory.py", *tool, *words).out) < LIMIT_MIB


# --- What other systems lack ----------------------------------------------------------------------


LACKING = """
import io, os, signal, sys
for module, names in (
    (os, "fork forkpty pread preadv fchown fchmod O_TMPFILE O_NONBLOCK sched_getaffinity geteuid"
         " getuid symlink"),
    (signal, "pthread_sigmask pthread_kill setitimer SIGALRM SIGHUP"),
):
    for name in names.split():
        if hasattr(module, name):
            delattr(module, name)
for name in ("fcntl", "resource", "termios", "pwd", "grp"):
    sys.modules[name] = None

for name in ("stdout", "stderr"):
    stream = getattr(sys, name)
    setattr(sys, name, io.TextIOWrapper(stream.buffer, encoding="cp1252", newline="\\r\\n"))

"""


@pytest.mark.parametrize(
    "call",
    [
        # Letters that Windows' output lacks, and a log of several batches at once.
        "stats dogbot_trot.bag",
        "convert dogbot_walk.mcap --jobs 2 -o made/ --json",
        "export dogbot_trot.bag dogbot_troubled.bag --jobs 2 --dataset made -q",
    ],
)
def test_what_is_written_is_the_same(tmp_path: Path, call: str) -> None:
    """Workers lack what the program lacks."""
    for log in (first_seconds(TROT), first_seconds(TROUBLED), WALK):
        shutil.copy(log, tmp_path / log.name)
    usual = forked_cli.run(*call.split(), folder=tmp_path)
    expected = files_in(tmp_path / "made")
    (tmp_path / "sitecustomize.py").write_text(LACKING)
    environment = {
        "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)]),
        "PYTHONWARNDEFAULTENCODING": "1",
        "PYTHONWARNINGS": "error::EncodingWarning",
    }
    words = [sys.executable, "-m", "dogbot_logtool", *call.split()]
    lacking = subprocess.run(  # noqa: S603
        words, cwd=tmp_path, env={**os.environ, **environment}, capture_output=True, check=False
    )
    assert (usual.returncode, lacking.returncode) == (0, 0), lacking.stderr
    assert lacking.stdout == usual.stdout.encode()
    assert files_in(tmp_path / "made") == expected


def files_in(folder: Path) -> dict[str, bytes]:
    """What a folder holds, which is removed."""
    files = [file for file in sorted(folder.rglob("*")) if file.is_file()]
    found = {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}
    shutil.rmtree(folder, ignore_errors=True)
    return found


@pytest.mark.parametrize("word", [r"C:\logs\walk.bag", "C:/logs/walk.bag", "C://logs/walk.bag"])
def test_a_drive_is_no_scheme(word: str) -> None:
    assert storage.location(word) == Path(word)
    assert storage.name_of(word) == word
    assert storage.without_secrets(f"C:/runs/a@b.bag and {word}") == f"C:/runs/a@b.bag and {word}"
