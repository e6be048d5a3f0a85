"""Without what Windows and macOS lack, the program gives the same results.

Calls of the system are taken away in each process before the program is loaded. What remains of
those systems (names of paths, open files that cannot be renamed, their libraries) is not tried.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.paths import ROOT, TROUBLED, WALK

LACKING = """
import os, signal, sys
for name in ("fork", "forkpty", "pread", "preadv", "fchown", "fchmod", "O_TMPFILE", "O_NONBLOCK",
             "O_PATH", "link"):
    if hasattr(os, name):
        delattr(os, name)
os.link = None
for name in ("pthread_sigmask", "pthread_kill", "setitimer", "SIGALRM"):
    if hasattr(signal, name):
        delattr(signal, name)
sys.modules["fcntl"] = None
"""


def run(folder: Path, *words: object, lacking: bool) -> subprocess.CompletedProcess[str]:
    """Run the program in a folder; its workers lack what it lacks."""
    site = folder / "site"
    site.mkdir(exist_ok=True)
    (site / "sitecustomize.py").write_text(LACKING if lacking else "")
    return subprocess.run(  # noqa: S603
        [sys.executable, "-m", "dogbot_logtool", *map(str, words)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(site), str(ROOT)])},
        capture_output=True,
        text=True,
        check=False,
    )


def made(folder: Path, *words: object) -> dict[str, bytes]:
    """What a call writes with and without, which must be the same."""
    results = []
    for lacking in (False, True):
        target = folder / "made"
        done = run(folder, *words, lacking=lacking)
        assert done.returncode == 0, done.stderr
        files = {
            file.relative_to(target).as_posix(): file.read_bytes()
            for file in sorted(target.rglob("*"))
            if file.is_file()
        }
        results.append({**files, "stdout": done.stdout.encode()})
        shutil.rmtree(target, ignore_errors=True)
    assert results[0] == results[1]
    return results[1]


@pytest.fixture
def logs(tmp_path: Path) -> Path:
    """A folder with two logs."""
    for log in (TROUBLED, WALK):
        shutil.copy(log, tmp_path / log.name)
    return tmp_path


def test_figures_and_a_dataset_by_two_processes(logs: Path) -> None:
    words = ("stats", TROUBLED.name, WALK.name, "--jobs", 2, "--parquet", "made", "-q")
    assert {name.split("/")[0] for name in made(logs, *words)} == {
        *("logs", "feet", "strides", "events", "stdout")
    }


def test_one_log_in_several_batches_at_once(logs: Path) -> None:
    words = ("convert", WALK.name, "--jobs", 2, "-o", "made/", "--json")
    assert len(made(logs, *words)["dogbot_walk.annotated.mcap"]) > 1_000_000
