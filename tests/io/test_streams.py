"""Standard streams that are closed, full, in ASCII, or whose reader has gone.

What a shell gives the interpreter at its start is tried with some calls, the rest without one.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.forked_cli import CLOSED, run
from tests.oracles.small_logs import first_seconds
from tests.paths import SAMPLE_LOGS

TROT, TROUBLED = (
    first_seconds(SAMPLE_LOGS / f"dogbot_{name}.bag") for name in ("trot", "troubled")
)
CUT = "cut.bag"

RESULTS = {
    "version": ("--version", 0),
    "text": (f"info {TROUBLED}", 0),
    "damaged": (f"info {CUT} {CUT} --json", 3),
    "csv": (f"export {TROUBLED}", 0),
    "different": (f"compare {TROT} {TROUBLED}", 1),
}
"""Calls that print results, and their exit codes."""


def shell(folder: Path, command: str, **environment: str) -> tuple[int, str, str]:
    """Run a line of bash in which `logtool` is the command; return exit code, stdout and stderr."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(  # noqa: S603
        [
            "/bin/bash",
            "-c",
            f'logtool() {{ "{sys.executable}" -m dogbot_logtool "$@"; }}\n{command}',
        ],
        cwd=folder,
        env=os.environ | {"PATH": path} | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    return done.returncode, done.stdout, done.stderr


@contextmanager
def unwritable(kind: str) -> Iterator[int]:
    """Yield a stream that cannot be written to."""
    if kind == "closed":
        yield CLOSED
        return
    if kind == "full":
        stream = os.open("/dev/full", os.O_WRONLY)
    else:
        reader, stream = os.pipe()
        os.close(reader)
    yield stream
    os.close(stream)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / CUT).write_bytes(TROT.read_bytes()[:-1000])
    return tmp_path


def test_a_difference_is_seen_through_a_pipe(folder: Path) -> None:
    """Much is printed, so that the reader has gone long before the end."""
    call = f"logtool compare {TROT} {TROUBLED} --max-differences 9999"
    line = f"{call} | grep -q different; exit ${{PIPESTATUS[0]}}"
    assert shell(folder, line, PYTHONUNBUFFERED="1") == (1, "", "")


@pytest.mark.parametrize(("words", "code"), RESULTS.values(), ids=RESULTS)
def test_results_that_cannot_be_written_are_an_error(folder: Path, words: str, code: int) -> None:
    """But a reader that stops early changes nothing."""
    for kind, why in (("unread", ""), ("closed", "it is closed"), ("full", "No space left on")):
        with unwritable(kind) as stream:
            done = run(*words.split(), folder=folder, stdout=stream)
        assert done.returncode == (1 if why else code)
        if why:
            last = done.stderr.splitlines()[-1]
            assert last.startswith(f"error: stdout cannot be written: {why}")


def test_completion_that_cannot_be_written_is_an_error(folder: Path) -> None:
    line = "_DOGBOT_LOGTOOL_COMPLETE=bash_source dogbot-logtool"
    code, out, err = shell(folder, line)
    assert (code, err) == (0, "")
    assert "complete" in out
    assert shell(folder, f"{line} >/dev/full")[0] == 1
    assert shell(folder, f"{line} >&-")[0] == 1


def test_an_unwritable_stderr_changes_nothing(folder: Path) -> None:
    for words, code in (
        (f"info {CUT} {CUT} --jobs 1", 3),
        (f"stats {CUT} no.bag --json", 2),
    ):
        usual = run(*words.split(), folder=folder)
        assert usual.returncode == code
        for kind in ("closed", "full"):
            with unwritable(kind) as stream:
                done = run(*words.split(), folder=folder, stderr=stream)
            assert (done.returncode, done.stdout) == (code, usual.stdout)
        assert shell(folder, f"logtool {words} 2>&-") == (code, usual.stdout, "")


@pytest.mark.parametrize("streams", ["<&- >&- 2>&-", ">/dev/full 2>&1"])
def test_all_streams_may_be_unwritable(folder: Path, streams: str) -> None:
    assert shell(folder, f"logtool stats {TROUBLED} {TROT} --json {streams}") == (1, "", "")


def test_what_prints_no_result_needs_no_stdout(folder: Path) -> None:
    """Nor may the output get the number of a stream, and what is meant for that."""
    for name, streams in (("open", ""), ("closed", "<&- >&- 2>&-")):
        assert shell(folder, f"logtool convert {TROUBLED} -o {name}.mcap {streams}")[0] == 0
    assert (folder / "open.mcap").read_bytes() == (folder / "closed.mcap").read_bytes()


def test_a_wrong_call_stays_one(folder: Path) -> None:
    for word in ("no_such.bag", "--nonsense"):
        assert run("stats", word, folder=folder, stdout=CLOSED).returncode == 2
        for kind in ("closed", "full"):
            with unwritable(kind) as stream:
                assert run("stats", word, folder=folder, stderr=stream).returncode == 2


@pytest.mark.parametrize(
    ("encoding", "words"),
    [("ascii", "export *-*.bag"), ("latin-1", "info --frames *-*.bag")],
)
def test_any_encoding_will_do(folder: Path, encoding: str, words: str) -> None:
    name = os.fsdecode("\u81ea\u884c-é-\x9b1m-".encode() + b"\xff.bag")
    (folder / name).write_bytes((folder / CUT).read_bytes())
    code, out, err = shell(
        folder, f"logtool {words} 2>&1 | cat -v; exit ${{PIPESTATUS[0]}}", PYTHONIOENCODING=encoding
    )
    assert (code, err) == (3, "")
    assert "\\xff.bag" in out.replace("\n", "")
