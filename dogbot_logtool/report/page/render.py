"""The page itself: figures and tables set in a template, all that it needs inside it.

Texts of a log are escaped by the template, and by the figures' labels; data travel as JSON in
which no ``<`` is left. A content security policy names the two scripts by their hashes and forbids
everything else, the network included.
"""

import base64
import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final
from urllib.parse import quote

import plotly.io
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from dogbot_logtool import __version__
from dogbot_logtool.core.scene.foot_style import foot_colour, short_names
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.figures.document import DOCUMENT, log_source
from dogbot_logtool.report.figures.figure import TableName
from dogbot_logtool.report.figures.tables import cells_of, headers
from dogbot_logtool.report.gait_diagram import default_window
from dogbot_logtool.report.numbers import NOTHING, span_of
from dogbot_logtool.report.page.drawing import Drawing
from dogbot_logtool.report.page.event_list import event_list, marks
from dogbot_logtool.report.page.ground_figure import walk_from_above
from dogbot_logtool.report.page.phase_clock import phase_clock
from dogbot_logtool.report.page.quality_figure import recording
from dogbot_logtool.report.page.summary import Trust, grouped, summary, trust
from dogbot_logtool.report.page.tables import (
    load_table,
    step_table,
    stride_table,
    symmetry_table,
    topic_table,
)
from dogbot_logtool.report.page.time_figures import gait_diagram, load_curves
from dogbot_logtool.report.verdict import headline
from dogbot_logtool.results import LogFacts

GLYPHS: Final = "▲▼■◆●✚"
"""The figures' markers of the feet, in text."""
FIGURES: Final = ("gait", "loads", "ground", "clock", "recording")
"""Names of all figures; a log may lack some."""
INDEX_COLUMNS: Final = ("log", "gait", "can it be trusted", *headers(TableName.INDEX))


@dataclass(frozen=True, slots=True)
class Damage:
    """Damage somewhere in the file."""

    offset: int
    """Byte. Also `size`, the bytes that gave nothing."""
    size: int
    what: str


@dataclass(frozen=True, slots=True)
class IndexRow:
    """A log in the index of several."""

    name: str
    page: str = ""
    """Relative URL of its page; empty: there is none, and `error` says why."""
    verdict: str = ""
    cells: tuple[str, ...] = ()
    """The numbers of `INDEX_COLUMNS`."""
    trust: Trust | None = None
    error: str = ""


def page(stats: Stats, log: LogFacts, damage: Sequence[Damage], file_size: int) -> bytes:
    """Return the HTML page of one log.

    Args:
        stats: figures, with load curves.
        log: what the reader knows of it.
        damage: where the file is damaged.
        file_size: bytes; 0 where it is not one file.
    """
    source = log_source(stats, log)
    document = DOCUMENT.plain(source)
    drawings = {
        each.name: each
        for each in (
            gait_diagram(stats),
            load_curves(stats),
            walk_from_above(stats),
            phase_clock(stats),
            recording(stats),
        )
        if each is not None
    }
    events = event_list(stats)
    for drawing in drawings.values():
        if drawing.over_time:
            drawing.figure.update_layout(shapes=marks(events))
    scripts = (_plotly_js(), _own("page.js"))
    names = [foot.name for foot in stats.feet]
    text = (
        _environment()
        .from_string(_own("page.html.j2"))
        .render(
            version=__version__,
            name=Path(log.path).name,
            about=_about(log),
            css=Markup(_own("page.css")),  # noqa: S704 - our own file
            plotly_js=Markup(scripts[0]),  # noqa: S704 - Plotly's
            page_js=Markup(scripts[1]),  # noqa: S704 - our own file
            script_hashes=Markup(" ".join(map(_hash, scripts))),  # noqa: S704 - hashes
            drawings={name: drawings.get(name) for name in FIGURES},
            drawings_json=_json([_drawing(each) for each in drawings.values()]),
            times_json=_json(
                {"typical": default_window(stats), "end": (stats.end - stats.origin) / 1e9}
            ),
            feet=[
                {
                    "name": name,
                    "short": short,
                    "colour": foot_colour(row),
                    "symbol": GLYPHS[row % len(GLYPHS)],
                }
                for row, (name, short) in enumerate(zip(names, short_names(names), strict=True))
            ],
            summary=summary(stats, log),
            findings=grouped([each for each in source.findings if each.code != "W_LOST"]),
            events=events,
            losses=log.losses,
            file_marks=_file_marks(damage, file_size),
            tables={
                "steps": step_table(document),
                "loads": load_table(document),
                "symmetry": symmetry_table(document),
                "strides": stride_table(stats),
                "topics": topic_table(document),
            },
            settings=_settings(stats),
        )
    )
    return text.encode()


def index_row(stats: Stats, log: LogFacts, page_name: str) -> IndexRow:
    """Return a log's row in the index."""
    cells = tuple(cells_of(TableName.INDEX, DOCUMENT.plain(log_source(stats, log))))
    name = Path(log.path).name
    # The name of a file may be any bytes.
    address = quote(os.fsencode(page_name), safe="")
    return IndexRow(name, address, headline(stats), cells, trust(stats, log))


def index(rows: Sequence[IndexRow]) -> bytes:
    """Return the HTML page that leads to the pages of several logs."""
    template = _environment().from_string(_own("index.html.j2"))
    css = Markup(_own("page.css"))  # noqa: S704 - our own file
    text = template.render(version=__version__, rows=rows, columns=INDEX_COLUMNS, css=css)
    return text.encode()


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


def _own(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


@cache
def _plotly_js() -> str:
    # A script ends at the first closing tag, wherever that stands.
    return str(get_plotlyjs()).replace("</script", "<\\/script")


def _hash(script: str) -> str:
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return f"'sha256-{digest}'"


def _drawing(drawing: Drawing) -> dict[str, Any]:
    figure = json.loads(plotly.io.to_json(drawing.figure, validate=False, engine="json"))
    return {
        "name": drawing.name,
        "over_time": drawing.over_time,
        "data": figure["data"],
        "layout": {key: each for key, each in figure["layout"].items() if key != "template"},
    }


def _json(value: object) -> Markup:
    """Return JSON that no HTML parser takes for markup."""
    text = to_json(value, compact=True)
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)  # noqa: S704 - nothing of markup is left in it


def _about(log: LogFacts) -> str:
    duration = NOTHING if log.duration_s is None else f"{log.duration_s:.2f} s"
    return f"{log.container}, {duration}, {log.messages:,} messages"


def _file_marks(damage: Sequence[Damage], file_size: int) -> list[dict[str, Any]]:
    """Return where damage lies along the file, in percent."""
    if not file_size:
        return []
    marks = []
    for part in damage:
        left = min(part.offset / file_size, 1.0) * 100.0
        width = min(part.size / file_size * 100.0, 100.0 - left)
        marks.append({"left": f"{left:.3f}", "width": f"{width:.3f}", "what": part.what})
    return marks


def _settings(stats: Stats) -> str:
    settings = stats.settings
    rules = [settings.sensor(row).rule for row in range(len(settings.feet))]
    on_n = span_of([rule.on_n for rule in rules])
    debounce_ms = span_of([rule.debounce_s * 1e3 for rule in rules])
    mass = "not known" if settings.mass_kg is None else f"{settings.mass_kg:g} kg"
    return (
        f"Measured on {settings.clock} time; mass {mass}; contact from {on_n} N, "
        f"debounced over {debounce_ms} ms; wrenches in the frame: "
        f"{settings.wrench_frame}; forward axis {settings.forward_axis}."
    )
