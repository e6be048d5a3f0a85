"""The index of several logs: a row for each, that can be sorted."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple
from urllib.parse import quote

import numpy as np

from dogbot_logtool.core.scene.feet import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.assets import own, policy_of, rendered
from dogbot_logtool.report.page.tables import INDEX
from dogbot_logtool.report.tables import NOTHING, recorded_at
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
    *(column.heading for column in INDEX),
)
_WORDS: Final = frozenset({"log", "gait", "data quality", "robot", "recorded (UTC)"})
"""Columns of words; the others are numbers."""
_WIDTH: Final = 120
"""Pixels of the miniature gait diagram; also `_ROW`, of a foot in it."""
_ROW: Final = 8


class IndexRow(NamedTuple):
    """A log in the index of several."""

    name: str
    page: str = ""
    """Relative URL of its page; empty: there is none, and `error` says why."""
    verdict: str = ""
    cells: tuple[str, ...] = ()
    """Of the columns from ``falls`` on."""
    quality: Quality | None = None
    bars: Sequence[tuple[float, float, float, str]] = ()
    """x, y and width of each stance in the miniature gait diagram, pixels, and its colour."""
    feet: int = 0
    error: str = ""


def index_row(measured: Measurement, page_name: str) -> IndexRow:
    """Return a log's row in the index."""
    walk, metrics = measured.walk, measured.metrics
    kinds = [event.type for event in metrics.events]
    falls = kinds.count("fall") + kinds.count("tipping")
    cells = (
        NOTHING if metrics.base.duration_s is None else str(falls),
        str(kinds.count("slip")),
        metrics.settings.robot or NOTHING,
        recorded_at(metrics.log.start_s),
        *(column.cell(metrics) for column in INDEX),
    )
    # The name of a file may be any bytes.
    address = quote(os.fsencode(page_name), safe="")
    name, bars = Path(metrics.log.path).name, tuple(_bars(walk))
    return IndexRow(
        name, address, headline(metrics), cells, quality_of(measured), bars, len(walk.feet)
    )


def _bars(walk: Walk) -> Iterator[tuple[float, float, float, str]]:
    """Yield the stances of the typical strides."""
    start, end = (walk.origin + each * 1e9 for each in default_window(walk))
    for row, foot in enumerate(walk.feet):
        if end > start:
            share = np.clip((foot.record.in_contact - start) / (end - start), 0.0, 1.0) * _WIDTH
            for first, last in np.round(share[share[:, 1] > share[:, 0]], 1).tolist():
                yield first, row * _ROW + 1, round(last - first, 1), foot_colour(row)


def index(rows: Sequence[IndexRow]) -> bytes:
    """Return the HTML page that leads to the pages of several logs."""
    script = own("scripts/index.js")
    return rendered(
        "index.html.j2",
        script,
        policy=policy_of(script),
        rows=rows,
        columns=[(name, name in _WORDS) for name in COLUMNS],
        width=_WIDTH,
        row_height=_ROW,
    )
