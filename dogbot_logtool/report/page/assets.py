"""Scripts and templates of the page, and how values get into them safely.

All scripts of a page are one script, so that the pages of a directory can share its file. Texts of
a log are escaped by the templates, and by the figures' labels; data travel as JSON in which no
``<`` is left. A content security policy names the scripts that may run and forbids everything else,
the network included.
"""

import base64
import hashlib
from functools import cache
from pathlib import Path
from typing import Final

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from dogbot_logtool import __version__
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.printable import printable

_PLOTTING: Final = "vendor/plotly-basic.min.js"
_PARTS: Final = ("cursor.js", "figures.js", "csv.js", "replay.js", "player.js", "start.js")
"""Files of the page's script, in this order; they share one scope."""


def own(name: str) -> str:
    """Return a file of this folder."""
    return (Path(__file__).parent / name).read_text(encoding="utf-8")


@cache
def page_script() -> str:
    """Return the script of a page with figures: the plotting library and ours."""
    parts = "\n".join(own(f"scripts/{name}") for name in _PARTS)
    script = f'{own(_PLOTTING)}\n(() => {{\n"use strict";\n{parts}}})();\n'
    # A script ends at the first closing tag, wherever that stands.
    return script.replace("</script", "<\\/script")


def shared_name() -> str:
    """Return the file name of the script that pages share; it changes with its content."""
    return f"dogbot-logtool-{hashlib.sha256(page_script().encode()).hexdigest()[:12]}.js"


def policy_of(script: str) -> Markup:
    """Return the source of a content security policy that lets a script inside the page run."""
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return Markup(f"'sha256-{digest}'")  # noqa: S704 - a hash


def json_in_html(value: object) -> Markup:
    """Return JSON that no HTML parser takes for markup."""
    text = to_json(value, compact=True)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)  # noqa: S704 - nothing of markup is left in it


def rendered(template: str, script: str = "", **values: object) -> bytes:
    """Return a page made from a template of this folder, with our style and a script."""
    own_files = {"css": Markup(own("page.css")), "script": Markup(script)}  # noqa: S704
    filled = _environment().from_string(own(template))
    return filled.render(version=__version__, **own_files, **values).encode()


@cache
def _environment() -> Environment:
    return Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        keep_trailing_newline=True,
        finalize=_made_printable,
    )


def _made_printable(value: object) -> object:
    return printable(value) if isinstance(value, str) and not isinstance(value, Markup) else value
