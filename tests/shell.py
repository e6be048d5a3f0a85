"""The command, run in a folder of its own: exit code, stdout, stderr."""

import json
import os
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.cli import main
from tests.paths import ROOT

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass(frozen=True, slots=True)
class Outcome:
    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)


def python(*words: object, folder: Path = ROOT, **environment: str) -> Outcome:
    """Run Python in a process of its own, which can import what we can."""
    done = subprocess.run(  # noqa: S603
        [sys.executable, *map(str, words)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        check=False,
        timeout=120.0,
    )
    assert "Traceback" not in done.stderr, done.stderr
    return Outcome(done.returncode, done.stdout, done.stderr)


class Shell:
    """Runs the command in a folder of its own, in this process."""

    def __init__(
        self,
        folder: Path,
        monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str],
    ) -> None:
        self.folder = folder
        self._monkeypatch = monkeypatch
        self._capsys = capsys

    def __call__(self, *words: object) -> Outcome:
        self._monkeypatch.chdir(self.folder)
        self._monkeypatch.setattr(sys, "argv", ["dogbot-logtool", *map(str, words)])
        before = {number: signal.getsignal(number) for number in ENDING}
        try:
            with pytest.raises(SystemExit) as stopped:
                main()
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
        told = self._capsys.readouterr()
        assert "Traceback" not in told.err
        assert "\x1b" not in told.out + told.err, "there is no terminal"
        assert isinstance(stopped.value.code, int)
        return Outcome(stopped.value.code, told.out, told.err)

    def files(self) -> list[str]:
        return sorted(file.name for file in self.folder.iterdir())
