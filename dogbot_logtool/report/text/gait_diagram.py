"""The gait diagram: a bar a foot, filled where the foot is down, over a time axis.

Drawn in text, two steps of time a character, so that it can stand in a terminal, a mail or a log.
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from rich.text import Text

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.numbers import nice_step

STRIDES_SHOWN: Final = 4
"""Strides in the window."""
WITHOUT_STRIDES_S: Final = 5.0
"""s, window without strides."""


@dataclass(frozen=True, slots=True)
class Glyphs:
    """Characters of the bars."""

    down: str
    first_half: str
    second_half: str
    up: str
    unknown: str
    axis: str
    tick: str


UNICODE: Final = Glyphs("█", "▌", "▐", "·", "?", "─", "┬")
ASCII: Final = Glyphs("#", "#", "#", ".", "?", "-", "+")


def default_window(stats: Walk) -> tuple[float, float]:
    """Return a window, s since the log's start, of a few strides from the main segment's middle."""
    main = stats.main
    if main is None:
        length = (stats.end - stats.origin) / 1e9
        return 0.0, min(length, WITHOUT_STRIDES_S)
    start, end = (each / 1e9 for each in (main.spans[0] - stats.origin).tolist())
    if not main.stride_frequency_hz:
        return start, min(end, start + WITHOUT_STRIDES_S)
    length = STRIDES_SHOWN / main.stride_frequency_hz
    touchdowns = stats.feet[stats.reference].strides.within(main.spans).touchdown
    earliest = [each for each in stats.seconds(touchdowns) if each + length <= end]
    whole = (stats.end - stats.origin) / 1e9
    # With too few strides for a window of that length, what there is is shown.
    otherwise = max(min(start, whole - length), 0.0)
    begin = earliest[len(earliest) // 2] if earliest else otherwise
    return begin, min(begin + length, whole)


def gait_diagram(
    stats: Walk,
    width: int,
    *,
    window: tuple[float, float] | None = None,
    glyphs: Glyphs = UNICODE,
) -> list[Text]:
    """Draw the diagram.

    Args:
        stats: figures of a log.
        width: characters of a line.
        window: s since the log's start, from and to; None chooses one.
        glyphs: characters of the bars.

    Returns:
        a line a foot, the axis, and its labels.
    """
    start, end = window or default_window(stats)
    names = [printable(foot.name) for foot in stats.feet]
    margin = max((len(name) for name in names), default=0) + 1
    columns = max(width - margin - 2, 10)
    if not end > start:
        return [Text("no time to draw")]
    lines = []
    edges = np.linspace(start, end, 2 * columns + 1) * 1e9 + stats.origin
    cells = edges.astype(np.int64)
    for row, foot in enumerate(stats.feet):
        line = Text(f"{names[row]:<{margin}}")
        known = timespans.no_spans() if foot.is_dead else foot.record.known
        bar = _bar(foot.record.in_contact, known, cells, glyphs)
        line.append(bar, style=foot_colour(row))
        lines.append(line)
    return [*lines, *_axis(start, end, margin, columns, glyphs)]


def _bar(in_contact: Ints, known: Ints, cells: Ints, glyphs: Glyphs) -> str:
    """Two cells make a character; a cell is down where contact covers most of it."""
    down = _mostly(in_contact, cells).reshape(-1, 2)
    seen = _mostly(known, cells).reshape(-1, 2)
    characters = []
    for (first, second), here in zip(down.tolist(), seen.max(axis=1).tolist(), strict=True):
        if not here:
            characters.append(glyphs.unknown)
        elif first and second:
            characters.append(glyphs.down)
        elif first or second:
            characters.append(glyphs.first_half if first else glyphs.second_half)
        else:
            characters.append(glyphs.up)
    return "".join(characters)


def _mostly(spans: Ints, cells: Ints) -> Ints:
    """(n,) 1 where spans cover at least half of the cell between an edge and the next."""
    half: Ints = (timespans.covered(spans, cells) * 2.0 >= np.diff(cells)).astype(np.int64)
    return half


def _axis(start: float, end: float, margin: int, columns: int, glyphs: Glyphs) -> list[Text]:
    step = nice_step((end - start) / max(columns // 10, 1))
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    ruler = [glyphs.axis] * columns
    labels = [" "] * (columns + margin)
    for number in range(math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9) + 1):
        column = min(int((number * step - start) / (end - start) * columns), columns - 1)
        ruler[column] = glyphs.tick
        label = f"{number * step:.{decimals}f}"
        first = min(max(margin + column - len(label) // 2, 0), len(labels) - len(label))
        labels[first : first + len(label)] = label
    return [
        Text(" " * margin + "".join(ruler), style="dim"),
        Text("".join(labels).rstrip() + " s", style="dim"),
    ]
