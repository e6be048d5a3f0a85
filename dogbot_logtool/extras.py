"""How to install the libraries of an extra into the environment that the program runs in."""

import re
import shlex
import sys
from importlib.metadata import PackageNotFoundError, requires
from importlib.util import find_spec
from pathlib import Path
from typing import Final

_REQUIREMENT: Final = re.compile(r"""([\w.-]+).*;.*extra == ['"]([\w-]+)['"]""")


def install_command(extra: str) -> str:
    """Return the command that installs what an extra needs."""
    python = shlex.quote(sys.executable)
    pip = f"{python} -m pip install" if find_spec("pip") else f"uv pip install --python {python}"
    try:
        found = map(_REQUIREMENT.match, requires("dogbot-logtool") or ())
    except PackageNotFoundError:  # it runs from a clone
        clone = Path(__file__).resolve().parents[1]
        return f"{pip} -e {shlex.quote(f'{clone}[{extra}]')}"
    return " ".join([pip, *(match[1] for match in found if match and match[2] == extra)])
