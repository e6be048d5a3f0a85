"""The index of several logs: a row for each, that can be sorted."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final
from urllib.parse import quote

import numpy as np
from markupsafe import Markup

from dogbot_logtool import __version__
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.report.page.assets import own, policy_of, rendered
from dogbot_logtool.report.page.summary import recorded_at
from dogbot_logtool.report.tables import INDEX, cells_of, headers
from dogbot_logtool.report.text.gait_diagram import default_window
from dogbot_logtool.report.verdict import Quality, headline, quality_of
from dogbot_logtool.results import Measurement

COLUMNS: Final = (
    "log",
    "strides",
    "gait",
    "data quality",
    "falls",
    "slips",
    "robot",
    "recorded (UTC)",
    *headers(INDEX),
)
_WORDS: Final = frozenset({"log", "gait", "data quality", "robot", "recorded (UTC)"})
"""Columns of words; the others are numbers."""
_WIDTH: Final = 120
"""Pixels of the miniature gait diagram; also `_ROW`, of a foot in it."""
_ROW: Final = 8


@dataclass(frozen=True, slots=True)
class Bar:
    """A stance in the miniature gait diagram, in pixels."""

    x: float
    y: float
    width: float
    colour: str


@dataclass(frozen=True, slots=True)
class IndexRow:
    """A log in the index of several."""

    name: str
    page: str = ""
    """Relative URL of its page; empty: there is none, and `error` says why."""
    verdict: str = ""
    cells: tuple[str, ...] = ()
    """Falls, slips, robot, date, and the numbers of the figures' table."""
    quality: Quality | None = None
    bars: tuple[Bar, ...] = ()
    feet: int = 0
    error: str = ""


def index_row(measured: Measurement, page_name: str) -> IndexRow:
    """Return a log's row in the index."""
    stats, log = measured.walk, measured.metrics.log
    kinds = [event.type for event in measured.metrics.events]
    falls = kinds.count("fall") + kinds.count("tipping")
    cells = (
        str(falls) if measured.metrics.base.duration_s is not None else NOTHING,
        str(kinds.count("slip")),
        measured.metrics.settings.robot or NOTHING,
        recorded_at(log.start_s),
        *cells_of(INDEX, measured.metrics),
    )
    # The name of a file may be any bytes.
    address = quote(os.fsencode(page_name), safe="")
    walk, quality = measured.metrics, quality_of(measured)
    return IndexRow(
        Path(log.path).name, address, headline(walk), cells, quality, _bars(stats), len(stats.feet)
    )


def _bars(stats: Walk) -> tuple[Bar, ...]:
    """Return the stances of the typical strides."""
    start, end = (stats.origin + each * 1e9 for each in default_window(stats))
    found = []
    for row, foot in enumerate(stats.feet):
        if foot.is_dead or not end > start:
            continue
        share = np.clip((foot.record.in_contact - start) / (end - start), 0.0, 1.0) * _WIDTH
        for first, last in share[share[:, 1] > share[:, 0]].tolist():
            bar = Bar(round(first, 1), row * _ROW + 1, round(last - first, 1), foot_colour(row))
            found.append(bar)
    return tuple(found)


def index(rows: Sequence[IndexRow]) -> bytes:
    """Return the HTML page that leads to the pages of several logs."""
    script = own("scripts/index.js")
    return rendered(
        "index.html.j2",
        version=__version__,
        rows=rows,
        columns=[(name, name in _WORDS) for name in COLUMNS],
        width=_WIDTH,
        row_height=_ROW,
        css=Markup(own("page.css")),  # noqa: S704 - our own file
        script=Markup(script),  # noqa: S704 - our own file
        script_policy=Markup(policy_of(script)),  # noqa: S704 - a hash
    )
