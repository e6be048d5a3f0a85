"""Do two checkouts of this project say the same of the same logs?

    python benchmarks/compare_checkouts.py OLD NEW LOGS...

Every log below the folders LOGS is described, measured and converted by both checkouts. Exit codes,
findings, figures and the bytes of annotated files are compared; what differs is listed by log.
Exit code 1 if anything differs.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, Final

_SUFFIXES: Final = (".bag", ".mcap", ".db3", ".active", ".zstd")
_COMMANDS: Final = {
    "info": "info {log} --json",
    "stats": "stats {log} --json -q",
    "convert": "convert {log} -q --jobs 1 -o {out}/all.mcap",
    "annotate": "convert {log} -q -o {out}/own.mcap --no-copy --encoding ros1 --style force",
}
_UNLIKE: Final = {"tool", "path", "input"}
"""Keys of JSON that tell where and by which version it was made."""
_SERVER: Final = """
import json, os, sys
sys.path.insert(0, sys.argv[1])
from dogbot_logtool.cli import main
for line in sys.stdin:
    request = json.loads(line)
    child = os.fork()
    if child == 0:
        for stream, name in ((0, os.devnull), (1, request["out"]), (2, request["err"])):
            os.dup2(os.open(name, os.O_RDWR | os.O_CREAT | os.O_TRUNC), stream)
        sys.argv = ["dogbot-logtool", *request["words"]]
        os.setpgid(0, 0)
        main()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    print(code, flush=True)
"""
"""Runs commands in copies of a process that has loaded the checkout once."""


@dataclass(frozen=True, slots=True)
class Run:
    """What one command came to."""

    exit_code: int
    result: Any
    """Its JSON, or the hash of the file that it wrote."""
    error: str


class Checkout:
    """A checkout that is asked to run commands, one at a time."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._server = subprocess.Popen(
            [sys.executable, "-c", _SERVER, str(root)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(root), "COLUMNS": "100"},
        )

    def run(self, words: list[str], folder: Path) -> Run:
        """Run a command line; return what it came to."""
        out, err = folder / "stdout", folder / "stderr"
        request = {"words": words, "out": str(out), "err": str(err)}
        _pipe(self._server.stdin).write(json.dumps(request) + "\n")
        _pipe(self._server.stdin).flush()
        code = int(_pipe(self._server.stdout).readline())
        return Run(code, _result(out, folder), err.read_text(errors="replace"))

    def close(self) -> None:
        """End the process."""
        _pipe(self._server.stdin).close()
        self._server.wait()


def _pipe(pipe: IO[str] | None) -> IO[str]:
    if pipe is None:
        raise AssertionError
    return pipe


def _result(out: Path, folder: Path) -> Any:  # noqa: ANN401 - any JSON
    for written in sorted(folder.glob("*.mcap")):
        return hashlib.sha256(written.read_bytes()).hexdigest()
    text = out.read_text(errors="replace")
    try:
        return _without_origin(json.loads(text))
    except ValueError:
        return text


def _without_origin(value: Any) -> Any:  # noqa: ANN401 - any JSON
    if isinstance(value, dict):
        return {k: _without_origin(v) for k, v in value.items() if k not in _UNLIKE}
    return [_without_origin(each) for each in value] if isinstance(value, list) else value


def _logs(folders: list[Path]) -> Iterator[Path]:
    for folder in folders:
        if folder.is_file():
            yield folder
            continue
        for path in sorted(folder.rglob("*")):
            if path.name == "metadata.yaml":
                yield path.parent
            elif path.suffix in _SUFFIXES and path.is_file():
                yield path


def _differences(command: str, old: Run, new: Run) -> Iterator[str]:
    if old.exit_code != new.exit_code:
        yield f"{command}: exit code {old.exit_code} -> {new.exit_code}"
    if old.result != new.result:
        yield from (f"{command}: {text}" for text in _changed(old.result, new.result, ""))
    if old.error != new.error:
        yield f"{command}: stderr {old.error.strip()[:300]!r} -> {new.error.strip()[:300]!r}"


def _changed(old: Any, new: Any, key: str) -> Iterator[str]:  # noqa: ANN401 - any JSON
    if isinstance(old, dict) and isinstance(new, dict):
        for each in sorted(old.keys() | new.keys()):
            if old.get(each) != new.get(each):
                yield from _changed(old.get(each), new.get(each), f"{key}.{each}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for number, (one, other) in enumerate(zip(old, new, strict=True)):
            if one != other:
                yield from _changed(one, other, f"{key}[{number}]")
    else:
        yield f"{key or 'output'}: {str(old)[:200]} -> {str(new)[:200]}"


def _compare(log: Path, checkouts: list[Checkout], pool: ThreadPoolExecutor) -> list[str]:
    found: list[str] = []
    for command, words in _COMMANDS.items():
        with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
            folders = [Path(first), Path(second)]
            argv = [[w.format(log=log, out=folder) for w in words.split()] for folder in folders]
            old, new = pool.map(Checkout.run, checkouts, argv, folders)
            old = Run(old.exit_code, old.result, old.error.replace(first, "OUT"))
            new = Run(new.exit_code, new.result, new.error.replace(second, "OUT"))
            found += _differences(command, old, new)
    return found


def main() -> int:
    """Compare the checkouts that the command line names; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("logs", type=Path, nargs="+")
    arguments = parser.parse_args()
    checkouts = [Checkout(arguments.old.resolve()), Checkout(arguments.new.resolve())]
    counted: Counter[str] = Counter()
    with ThreadPoolExecutor(2) as pool:
        for log in _logs([folder.resolve() for folder in arguments.logs]):
            found = _compare(log, checkouts, pool)
            counted["differ" if found else "alike"] += 1
            for line in found:
                print(f"{log}\n    {line}", flush=True)
    for checkout in checkouts:
        checkout.close()
    print(f"{counted.total()} logs, {len(_COMMANDS)} commands each: {dict(counted)}")
    return 1 if counted["differ"] else 0


if __name__ == "__main__":
    sys.exit(main())
