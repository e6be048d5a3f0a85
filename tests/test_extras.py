"""The command that installs an extra can be typed as it stands, however we were installed."""

import json
import shlex
import sys
from importlib.metadata import PathDistribution
from pathlib import Path

import pytest

from dogbot_logtool.extras import command_for, install_command
from tests.paths import ROOT

METADATA = """\
Metadata-Version: 2.4
Name: dogbot-logtool
Version: 1
Requires-Dist: numpy>=1.26
Provides-Extra: plot
Requires-Dist: matplotlib>=3.8; extra == "plot"
Provides-Extra: report
Requires-Dist: jinja2>=3.1; extra == "report"
Requires-Dist: plotly>=6.0; extra == "report"
"""
PYTHON = shlex.quote(sys.executable)
CLONE = "/home/me/my logs/dogbot-logtool"


def installed(folder: Path, *, editable: bool | None = None, url: str = "") -> PathDistribution:
    """Write what an installer writes about us; `editable` only for a folder."""
    folder.mkdir(exist_ok=True)
    (folder / "METADATA").write_text(METADATA)
    origin: dict[str, object] = {"url": url or "file:///home/me/my%20logs/dogbot-logtool"}
    if editable is not None:
        origin["dir_info"] = {"editable": True} if editable else {}
    if editable is not None or url:
        (folder / "direct_url.json").write_text(json.dumps(origin))
    return PathDistribution(folder)


@pytest.mark.parametrize(
    ("editable", "marker", "command"),
    [
        (None, "", f"{PYTHON} -m pip install jinja2 plotly"),
        (False, "", f"{PYTHON} -m pip install jinja2 plotly"),
        (True, "", f"{PYTHON} -m pip install -e '{CLONE}[report]'"),
        (False, "pipx_metadata.json", "pipx inject dogbot-logtool jinja2 plotly"),
        (
            False,
            "uv-receipt.toml",
            f"uv tool install --with jinja2 --with plotly '{CLONE}'",
        ),
        (
            True,
            "uv-receipt.toml",
            f"uv tool install --with jinja2 --with plotly --editable '{CLONE}'",
        ),
    ],
)
def test_the_command_is_that_of_the_installer(
    tmp_path: Path,
    editable: bool | None,  # noqa: FBT001 - a parameter of the test
    marker: str,
    command: str,
) -> None:
    if marker:
        (tmp_path / marker).touch()
    us = installed(tmp_path / "us.dist-info", editable=editable)
    assert command_for("report", us, tmp_path, has_pip=True) == command


def test_an_environment_of_uv_has_no_pip(tmp_path: Path) -> None:
    us = installed(tmp_path / "us.dist-info", url="https://host/us.git")
    (tmp_path / "uv-receipt.toml").touch()
    command = f"uv pip install --python {PYTHON} matplotlib"
    assert command_for("plot", us, tmp_path, has_pip=False) == command


def test_a_clone_that_is_not_installed_is_named(tmp_path: Path) -> None:
    command = command_for("plot", None, tmp_path, has_pip=True)
    clone = ROOT.resolve()
    assert command.endswith(f" -e {shlex.quote(f'{clone}[plot]')}")


def test_this_environment_has_a_command() -> None:
    assert shlex.split(install_command("plot"))[1:]
