"""The command that installs an extra can be typed as it stands."""

import shlex
import sys
from importlib.metadata import PackageNotFoundError

import pytest

from dogbot_logtool import extras
from tests.paths import ROOT


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
