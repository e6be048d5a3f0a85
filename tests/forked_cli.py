"""Runs the command in forks of a process that has the program loaded.

That saves most of what a short call costs, the imports; all else is as in a process of its own.
"""

import functools
import gc
import multiprocessing
import os
import pkgutil
import pty
import resource
import shlex
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerContext, ForkServerProcess
from multiprocessing.sharedctypes import RawValue
from pathlib import Path
from typing import IO, Any, Final

import dogbot_logtool
from tests.paths import ROOT

CLOSED: Final = -100
"""Stands for a stream that is not open, beside the constants of `subprocess`."""
_LATE: Final = ("dogbot_logtool.run.cluster",)
"""Modules that few calls need, and that take long to load."""


@dataclass(frozen=True, slots=True)
class Ended:
    """How a command ended."""

    returncode: int
    stdout: str
    stderr: str
    peak_mb: float
    """The most memory of it or of one of its workers, with that of the program as it is loaded."""


def run(
    *words: object,
    folder: Path = ROOT,
    environment: Mapping[str, str] | None = None,
    stdout: int = subprocess.PIPE,
    stderr: int = subprocess.PIPE,
    timeout: float = 120.0,
) -> Ended:
    """Run the command; return how it ended.

    Args:
        words: of the call, behind the name of the program.
        folder: in which it runs.
        environment: variables that differ from ours.
        stdout: PIPE, of which the result has the text, CLOSED or a file descriptor.
        stderr: as `stdout`; or STDOUT.
        timeout: in seconds, after which it is killed.

    Raises:
        subprocess.TimeoutExpired: it was killed.
    """
    peak_mb = RawValue("d", 0.0)
    with (
        tempfile.TemporaryFile() as out,
        tempfile.TemporaryFile() as err,
        Path(os.devnull).open() as none,
    ):
        stdout = out.fileno() if stdout == subprocess.PIPE else stdout
        known = {subprocess.PIPE: err.fileno(), subprocess.STDOUT: stdout}
        streams = none.fileno(), stdout, known.get(stderr, stderr)
        process = _started(words, folder, environment or {}, streams, peak_mb)
        process.join(timeout)
        if process.is_alive():
            os.killpg(process.pid or 0, signal.SIGKILL)
            process.join()
            raise subprocess.TimeoutExpired([*map(str, words)], timeout)
        ended = Ended(process.exitcode or 0, _text(out), _text(err), peak_mb.value)
    assert "Traceback" not in ended.stderr, (words, ended.stderr)
    return ended


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", "surrogateescape")


def run_on_terminal(
    *words: object, folder: Path, environment: Mapping[str, str] | None = None
) -> tuple[int, bytes]:
    """Run the command on a terminal of its own; return its exit code and what it showed."""
    ours, theirs = pty.openpty()
    process = _started(words, folder, environment or {}, (theirs,) * 3, RawValue("d", 0.0))
    os.close(theirs)
    shown = b""
    with suppress(OSError):
        while data := os.read(ours, 1 << 16):
            shown += data
    os.close(ours)
    process.join()
    return process.exitcode or 0, shown


@functools.cache
def _forks() -> ForkServerContext:
    """Return what forks the process that has the program loaded."""
    context = multiprocessing.get_context("forkserver")
    modules = pkgutil.walk_packages(dogbot_logtool.__path__, "dogbot_logtool.")
    # The libraries that write a dataset load pandas where it is installed.
    context.set_forkserver_preload([*({each.name for each in modules} - {*_LATE}), "pandas"])
    return context


def _started(
    words: Sequence[object],
    folder: Path,
    environment: Mapping[str, str],
    streams: Sequence[int],
    peak_mb: Any,
) -> ForkServerProcess:
    # A connection is what takes a file descriptor along.
    sent = [None if each == CLOSED else Connection(os.dup(each)) for each in streams]
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    arguments = [*map(str, words)], folder, variables, sent, peak_mb
    process = _forks().Process(target=_run_program, args=arguments)
    process.start()
    return process


def _run_program(
    words: Sequence[str],
    folder: Path,
    environment: Mapping[str, str],
    streams: Sequence[Connection | None],
    peak_mb: Any,
) -> None:
    """Be what the interpreter would be that is started for a call."""
    from dogbot_logtool.__main__ import main  # noqa: PLC0415 - loaded by the server

    gc.freeze()
    warnings.simplefilter("error")
    os.setsid()
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = ["dogbot-logtool", *words]
    for number, (name, stream) in enumerate(
        zip(("stdin", "stdout", "stderr"), streams, strict=True)
    ):
        if stream is None:
            os.close(number)
            setattr(sys, name, None)
            setattr(sys, f"__{name}__", None)
        else:
            os.dup2(stream.fileno(), number)
            stream.close()
            setattr(sys, name, _standard_stream(number))
            setattr(sys, f"__{name}__", getattr(sys, name))
    try:
        main()
    finally:
        people = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
        peak_mb.value = max(resource.getrusage(who).ru_maxrss for who in people) / 1024


def _standard_stream(number: int) -> IO[str]:
    lines = number == 2 or os.isatty(number)
    errors = "backslashreplace" if number == 2 else "strict"
    return open(
        number,
        "w" if number else "r",
        1 if lines else -1,
        encoding="utf-8",
        errors=errors,
        closefd=False,
    )


def command(printed: str) -> list[str]:
    """Return the words after the program's name of the one command for feet that was printed."""
    lines = [line for line in printed.splitlines() if line.lstrip().startswith("dogbot-logtool ")]
    # Joints may tell the same with a description of the robot.
    lines = [line for line in lines if "--urdf ROBOT.urdf" not in line]
    assert len(lines) == 1
    return shlex.split(lines[0])[1:]
