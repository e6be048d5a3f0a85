"""Runs the command in forked copies of a process that has the program loaded.

That saves most of what a short call costs, the imports; all else is as in a process of its own. The
process that is forked starts with the first call, and ends with the tests.
"""

import atexit
import functools
import gc
import importlib
import io
import json
import os
import pkgutil
import pty
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final, NoReturn

from tests.paths import ROOT

CLOSED: Final = -100
"""Stands for a stream that is not open, beside the constants of `subprocess`."""
_NOT_FLUSHED: Final = 120
"""Exit code of an interpreter that cannot write what its streams still hold."""
_SLOW: Final = ("dogbot_logtool.run.cluster",)
"""Modules that few calls need, and that take long to load."""
_ALSO: Final = ("pandas",)
"""What the libraries load that write a dataset, where it is installed: as much as a call takes."""


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
    stdin: int = subprocess.DEVNULL,
    timeout: float = 120.0,
) -> Ended:
    """Run the command; return how it ended.

    Args:
        words: of the call, behind the name of the program.
        folder: in which it runs.
        environment: variables that differ from ours.
        stdout: PIPE, of which the result has the text, DEVNULL, CLOSED or a file descriptor.
        stderr: as `stdout`; or STDOUT.
        stdin: DEVNULL, CLOSED or a file descriptor.
        timeout: in seconds, after which it is killed.

    Raises:
        subprocess.TimeoutExpired: it was killed.
    """
    with (
        tempfile.TemporaryFile() as out,
        tempfile.TemporaryFile() as err,
        open(os.devnull, "r+b") as nothing,  # noqa: PTH123 - reads as the others do
    ):
        special = {subprocess.DEVNULL: nothing.fileno(), subprocess.PIPE: out.fileno()}
        stdout = special.get(stdout, stdout)
        special |= {subprocess.STDOUT: stdout, subprocess.PIPE: err.fileno()}
        streams = special.get(stdin, stdin), stdout, special.get(stderr, stderr)
        code, peak_mb = _server().run(words, folder, environment or {}, streams, timeout)
        return Ended(code, _text(out), _text(err), peak_mb)


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode("utf-8", "surrogateescape")


def run_on_terminal(
    *words: object, folder: Path, environment: Mapping[str, str] | None = None
) -> tuple[int, bytes]:
    """Run the command on a terminal of its own; return its exit code and what it showed."""
    ours, theirs = pty.openpty()
    server = _server()
    server.begin(words, folder, environment or {}, (theirs, theirs, theirs))
    os.close(theirs)
    shown = b""
    with suppress(OSError):
        while data := os.read(ours, 1 << 16):
            shown += data
    os.close(ours)
    return server.end()[0], shown


class _Server:
    """The process that is forked; it runs one command at a time."""

    def __init__(self) -> None:
        self._socket, theirs = socket.socketpair()
        with theirs:
            number = theirs.fileno()
            self._process = subprocess.Popen(  # noqa: S603 - our own interpreter
                [sys.executable, "-W", "error", "-m", "tests.forked_cli", str(number)],
                pass_fds=[number],
                cwd=ROOT,
                env={**os.environ, "PYTHONPATH": str(ROOT)},
            )
        self._answers = self._socket.makefile("r")
        self._pid = 0

    def run(
        self,
        words: Sequence[object],
        folder: Path,
        environment: Mapping[str, str],
        streams: Sequence[int],
        timeout: float,
    ) -> tuple[int, float]:
        """Run a command to its end."""
        self.begin(words, folder, environment, streams)
        self._socket.settimeout(timeout)
        try:
            ended = self.end()
        except TimeoutError:
            self.close()
            # The next call starts another server.
            _server.cache_clear()
            os.killpg(self._pid, signal.SIGKILL)
            raise subprocess.TimeoutExpired([*map(str, words)], timeout) from None
        self._socket.settimeout(None)
        return ended

    def begin(
        self,
        words: Sequence[object],
        folder: Path,
        environment: Mapping[str, str],
        streams: Sequence[int],
    ) -> None:
        """Start a command."""
        request = {
            "words": [*map(str, words)],
            "folder": str(folder),
            "environment": {**os.environ, "PYTHONPATH": str(ROOT), **environment},
            "is_open": [stream != CLOSED for stream in streams],
        }
        socket.send_fds(self._socket, [b"\n"], [each for each in streams if each != CLOSED])
        self._socket.sendall(json.dumps(request).encode() + b"\n")
        self._pid = int(self._answers.readline())

    def end(self) -> tuple[int, float]:
        """Wait for the end of the command; return its exit code and its peak of memory in MB."""
        code, peak_mb = json.loads(self._answers.readline())
        return code, peak_mb

    def close(self) -> None:
        """End the process."""
        self._answers.close()
        self._socket.close()
        self._process.kill()
        self._process.wait()


@functools.cache
def _server() -> _Server:
    server = _Server()
    atexit.register(server.close)
    return server


def _serve(connection: socket.socket) -> None:
    """Fork for each request, until there are no more."""
    _load_program()
    requests = connection.makefile("r")
    while True:
        _, streams, _, _ = socket.recv_fds(connection, 1, 3)
        if not (line := requests.readline()):
            return
        child = os.fork()
        if not child:
            requests.close()
            connection.close()
            _become(json.loads(line), streams)
            _run_to_its_end()
        for stream in streams:
            os.close(stream)
        connection.sendall(b"%d\n" % child)
        _, status, usage = os.wait4(child, 0)
        answer = os.waitstatus_to_exitcode(status), usage.ru_maxrss / 1024
        connection.sendall(json.dumps(answer).encode() + b"\n")


def _run_to_its_end() -> NoReturn:
    """Run the program, and end as the interpreter does, but for taking all modules apart.

    That would be most of what a short call costs. Calls that end in any other way end in full.
    """
    from dogbot_logtool.__main__ import main  # noqa: PLC0415 - loaded by the server

    try:
        main()
    except SystemExit as ended:
        code = ended.code
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    try:
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
    except OSError:
        code = _NOT_FLUSHED
    os._exit(code if isinstance(code, int) else int(code is not None))


def _load_program() -> None:
    import dogbot_logtool  # noqa: PLC0415 - those who only send requests do not need it

    for module in pkgutil.walk_packages(dogbot_logtool.__path__, "dogbot_logtool."):
        if module.name not in _SLOW:
            importlib.import_module(module.name)
    for name in _ALSO:
        importlib.import_module(name)
    # What is loaded stays as it is, and its memory is not copied.
    gc.collect()
    gc.freeze()


def _become(request: dict[str, Any], streams: Sequence[int]) -> None:
    """Make this process what the interpreter would be that is started for a request."""
    os.setsid()
    os.chdir(request["folder"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.argv = ["dogbot-logtool", *request["words"]]
    given = iter(streams)
    for number, is_open in enumerate(request["is_open"]):
        if is_open:
            os.dup2(next(given), number)
        else:
            os.close(number)
    for stream in streams:
        os.close(stream)
    names = ("stdin", "stdout", "stderr")
    for number, (name, is_open) in enumerate(zip(names, request["is_open"], strict=True)):
        file = _standard_stream(number) if is_open else None
        setattr(sys, name, file)
        setattr(sys, f"__{name}__", file)


def _standard_stream(number: int) -> io.TextIOWrapper:
    lines = number == 2 or os.isatty(number)
    errors = "backslashreplace" if number == 2 else "strict"
    stream = open(number, "w" if number else "r", encoding="utf-8", errors=errors, closefd=False)  # noqa: SIM115 - stays open
    stream.reconfigure(line_buffering=lines)
    return stream


if __name__ == "__main__":
    _serve(socket.socket(fileno=int(sys.argv[1])))
