"""How to install the libraries of an extra, which depends on how the program was installed."""

import json
import re
import shlex
import sys
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from typing import Final
from urllib.parse import unquote, urlsplit

_PACKAGE: Final = "dogbot-logtool"


def install_command(extra: str) -> str:
    """Return the command that installs what an extra needs, into this environment."""
    try:
        installed = distribution(_PACKAGE)
    except PackageNotFoundError:
        installed = None
    return command_for(extra, installed, Path(sys.prefix), has_pip=find_spec("pip") is not None)


def command_for(
    extra: str, installed: Distribution | None, environment: Path, *, has_pip: bool
) -> str:
    """Return the command for an environment.

    Args:
        extra: its name.
        installed: what the environment knows of this program; None if that runs from a clone
            without being installed.
        environment: its directory.
        has_pip: whether pip is installed in it.
    """
    python = shlex.quote(sys.executable)
    pip = f"{python} -m pip install" if has_pip else f"uv pip install --python {python}"
    if installed is None:
        clone = Path(__file__).resolve().parents[1]
        return f"{pip} -e {shlex.quote(f'{clone}[{extra}]')}"
    folder, is_editable = _source(installed)
    libraries = _libraries(installed, extra)
    if (environment / "pipx_metadata.json").exists():
        return f"pipx inject {_PACKAGE} {' '.join(libraries)}"
    if (environment / "uv-receipt.toml").exists() and folder:
        editable = "--editable " if is_editable else ""
        wanted = " ".join(f"--with {library}" for library in libraries)
        return f"uv tool install {wanted} {editable}{shlex.quote(folder)}"
    if folder and is_editable:
        return f"{pip} -e {shlex.quote(f'{folder}[{extra}]')}"
    return f"{pip} {' '.join(libraries)}"


def _source(installed: Distribution) -> tuple[str, bool]:
    """Return the folder that the program was installed from, and whether it still runs there."""
    origin = json.loads(installed.read_text("direct_url.json") or "{}")
    url = urlsplit(origin.get("url", ""))
    folder = unquote(url.path) if url.scheme == "file" and "dir_info" in origin else ""
    return folder, bool(origin.get("dir_info", {}).get("editable"))


def _libraries(installed: Distribution, extra: str) -> list[str]:
    """Return the names of the libraries that an extra adds."""
    pattern = re.compile(rf"""([\w.-]+).*;.*extra == ['"]{re.escape(extra)}['"]""")
    found = [pattern.match(requirement) for requirement in installed.requires or ()]
    return [match[1] for match in found if match]
