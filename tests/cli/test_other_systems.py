"""Without what Windows and macOS lack, and with what Windows refuses, the results are the same.

Each process is changed before the program is loaded: calls of the system are taken away, files that
are open are neither removed nor renamed, standard output has the letters and line ends of Windows,
and a text file that is opened without naming its encoding is an error. What remains of those
systems (drives, the libraries themselves) is not tried.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from dogbot_logtool.io import storage
from tests import forked_cli
from tests.oracles.small_logs import first_seconds
from tests.paths import ROOT, TROT, TROUBLED, WALK

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


def refusing(call):
    def refuse_open_files(*paths, **others):
        for path in paths:
            try:
                wanted = os.stat(path)
            except OSError:
                continue
            if "pym-" in str(path):
                continue  # memory that processes share, which Windows does otherwise
            for number in os.listdir("/proc/self/fd"):
                try:
                    opened = os.fstat(int(number))
                except OSError:
                    continue
                if (opened.st_dev, opened.st_ino) == (wanted.st_dev, wanted.st_ino):
                    raise PermissionError(13, "it is used by another process", path)
        return call(*paths, **others)
    return refuse_open_files


for name in ("unlink", "remove", "rename", "replace"):
    setattr(os, name, refusing(getattr(os, name)))
for name in ("stdout", "stderr"):
    stream = getattr(sys, name)
    setattr(sys, name, io.TextIOWrapper(stream.buffer, encoding="cp1252", newline="\\r\\n"))

"""


def run(folder: Path, *words: object) -> subprocess.CompletedProcess[bytes]:
    """Run the program in a folder without what it lacks; its workers lack that too."""
    site, scratch = folder / "site", folder / "scratch"
    for each in (site, scratch):
        each.mkdir(exist_ok=True)
    (site / "sitecustomize.py").write_text(LACKING)
    environment = {
        "PYTHONPATH": os.pathsep.join([str(site), str(ROOT)]),
        "PYTHONWARNDEFAULTENCODING": "1",
        "PYTHONWARNINGS": "error::EncodingWarning",
        "TMPDIR": str(scratch),
    }
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "dogbot_logtool", *map(str, words)],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        check=False,
    )
    assert list(scratch.iterdir()) == []
    return done


def files_in(folder: Path) -> dict[str, bytes]:
    """What a folder holds, which is removed."""
    files = [file for file in sorted(folder.rglob("*")) if file.is_file()]
    found = {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}
    shutil.rmtree(folder, ignore_errors=True)
    return found


@pytest.mark.parametrize(
    "call",
    [
        # Letters that Windows' output lacks, and a log of several batches at once.
        "stats dogbot_trot.bag",
        "convert dogbot_walk.mcap --jobs 2 -o made/ --overwrite --json",
        "export dogbot_trot.bag dogbot_troubled.bag --jobs 2 --dataset made -q",
        "report dogbot_trot.bag dogbot_troubled.bag -o made/ --overwrite --no-replay -q",
    ],
)
def test_what_is_written_is_the_same(tmp_path: Path, call: str) -> None:
    for log in (first_seconds(TROT), first_seconds(TROUBLED), WALK):
        shutil.copy(log, tmp_path / log.name)
    usual = forked_cli.run(*call.split(), folder=tmp_path)
    expected = files_in(tmp_path / "made")
    # What systems differ in is writing over what is there.
    for _ in range(2 if "--overwrite" in call else 1):
        lacking = run(tmp_path, *call.split())
        assert (usual.returncode, lacking.returncode) == (0, 0), lacking.stderr
        assert lacking.stdout == usual.stdout.encode()
    assert files_in(tmp_path / "made") == expected


@pytest.mark.parametrize("word", [r"C:\logs\walk.bag", "C:/logs/walk.bag", "C://logs/walk.bag"])
def test_a_drive_is_no_scheme(word: str) -> None:
    assert storage.location(word) == Path(word)
    assert storage.name_of(word) == word
    assert storage.without_secrets(f"C:/runs/a@b.bag and {word}") == f"C:/runs/a@b.bag and {word}"
