"""The gait diagram: a bar a foot, filled where the foot is down, over a time axis.

Drawn in text, two steps of time a character, so that it can stand in a terminal, a mail or a log.
"""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from rich.text import Text

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.scene.feet import foot_colour
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.tables import nice_step

STRIDES_SHOWN: Final = 4
"""Strides in the window."""
WITHOUT_STRIDES_S: Final = 5.0
"""s, window without strides."""
UNICODE: Final = "·▐▌█?─┬"
"""Characters for up, down in the second half, in the first, down, not known; axis and tick."""
ASCII: Final = ".###?-+"


def default_window(walk: Walk) -> tuple[float, float]:
    """Return a window, s since the log's start, of a few strides from the main segment's middle."""
    main, whole = walk.main, (walk.end - walk.origin) / 1e9
    if main is None:
        return 0.0, min(whole, WITHOUT_STRIDES_S)
    start, end = walk.seconds(main.span[0])
    if not main.gait.stride_frequency_hz:
        return start, min(end, start + WITHOUT_STRIDES_S)
    length = STRIDES_SHOWN / main.gait.stride_frequency_hz
    touchdowns = walk.feet[walk.reference].strides.within(main.span).touchdown
    earliest = [each for each in walk.seconds(touchdowns) if each + length <= end]
    # With too few strides for a window of that length, what there is is shown.
    otherwise = max(min(start, whole - length), 0.0)
    begin = earliest[len(earliest) // 2] if earliest else otherwise
    return begin, min(begin + length, whole)


def gait_diagram(
    walk: Walk, width: int, *, window: tuple[float, float] | None = None, glyphs: str = UNICODE
) -> list[Text]:
    """Draw the diagram.

    Args:
        walk: of a log.
        width: characters of a line.
        window: s since the log's start, from and to; None chooses one.
        glyphs: characters that it is drawn with.

    Returns:
        a line a foot, the axis, and its labels.
    """
    start, end = window or default_window(walk)
    names = [printable(foot.name) for foot in walk.feet]
    margin = max((len(name) for name in names), default=0) + 1
    columns = max(width - margin - 2, 10)
    if not end > start:
        return [Text("no time to draw")]
    edges = np.linspace(start, end, 2 * columns + 1) * 1e9 + walk.origin
    cells = edges.astype(np.int64)
    lines = []
    for row, foot in enumerate(walk.feet):
        down, seen = (_mostly(each, cells) for each in (foot.record.in_contact, foot.known))
        shapes = np.where(seen.any(axis=1), down @ [2, 1], 4).tolist()
        bar = "".join(glyphs[shape] for shape in shapes)
        lines.append(Text.assemble(f"{names[row]:<{margin}}", (bar, foot_colour(row))))
    axis = (Text(line, style="dim") for line in _axis(start, end, margin, columns, glyphs))
    return [*lines, *axis]


def _mostly(spans: Ints, cells: Ints) -> Ints:
    """(characters, 2) 1 where spans cover at least half of half a character, else 0."""
    half: Ints = (timespans.covered(spans, cells) * 2.0 >= np.diff(cells)).astype(np.int64)
    return half.reshape(-1, 2)


def _axis(start: float, end: float, margin: int, columns: int, glyphs: str) -> Iterator[str]:
    step = nice_step((end - start) / max(columns // 10, 1))
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    ruler, labels = [glyphs[5]] * columns, [" "] * (columns + margin)
    for number in range(math.ceil(start / step - 1e-9), math.floor(end / step + 1e-9) + 1):
        column = min(int((number * step - start) / (end - start) * columns), columns - 1)
        ruler[column] = glyphs[6]
        label = f"{number * step:.{decimals}f}"
        first = min(max(margin + column - len(label) // 2, 0), len(labels) - len(label))
        labels[first : first + len(label)] = label
    yield " " * margin + "".join(ruler)
    yield "".join(labels).rstrip() + " s"
