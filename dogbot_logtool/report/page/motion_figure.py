"""How the base moved over time: static margin, speed, height and attitude."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.base.base_motion import FORWARD_ANGLES, along_heading, roll_and_pitch
from dogbot_logtool.core.base.ground import height_over_feet
from dogbot_logtool.core.contact.curves import CurveDetail, CurveRecorder
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.stability.stability import margins
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.page.chart import Chart, Trace, scatter
from dogbot_logtool.report.page.drawing import (
    LINE,
    MARGIN,
    SECOND,
    Drawing,
    drawn_seconds,
    time_axis,
)

DETAIL: Final = CurveDetail(most_bins=1500)
"""More than the page has columns of pixels; the lowest and the highest value of each are drawn."""
BESIDE_S: Final = 0.1
"""s before and after a time between which its speed is measured."""


@dataclass(frozen=True, slots=True)
class _Line:
    name: str
    time: Ints
    """(n,) ns, strictly increasing."""
    value: Floats
    """(n,) NaN where it is not known."""
    colour: str = LINE
    dash: str = "solid"


@dataclass(frozen=True, slots=True)
class _Row:
    title: str
    unit: str
    decimals: int
    least: float
    """Span of values that fills the row at least, so that noise does not look like motion."""
    lines: tuple[_Line, ...]


def motion(stats: Stats) -> Drawing | None:
    """Draw what is known of margin, speed, height and attitude, one above the other.

    None without poses.
    """
    rows = [row for row in _rows(stats) if any(np.isfinite(line.value).any() for line in row.lines)]
    if not rows:
        return None
    figure = Chart(
        layout={
            "height": 110 * len(rows) + 50,
            "margin": MARGIN,
            "showlegend": False,
            "hovermode": "x unified",
            "hoversubplots": "axis",
            "xaxis": {**time_axis(stats), "anchor": f"y{len(rows)}" if len(rows) > 1 else "y"},
        }
    )
    share = 1.0 / len(rows)
    for number, row in enumerate(rows):
        end = str(number + 1) if number else ""
        figure.layout[f"yaxis{end}"] = {
            "domain": [1.0 - (number + 0.86) * share, 1.0 - number * share],
            "range": _extent(row),
            "fixedrange": True,
            "nticks": 4,
            "zeroline": True,
            "title": {"text": f"{row.title} ({row.unit})", "standoff": 2, "font": {"size": 11}},
        }
        figure.data.extend(_trace(stats, row, line, end) for line in row.lines)
    caption = _caption([row.title for row in rows])
    return Drawing("motion", "Motion", _words(stats), caption, figure, over_time=True)


def _rows(stats: Stats) -> Iterator[_Row]:
    base = stats.base_history
    if len(base.time) < 2:
        return
    axis = stats.settings.forward_axis
    if stats.stability is not None:
        offset = stats.settings.com_offset_m or (0.0, 0.0, 0.0)
        time, margin = margins([foot.record for foot in stats.feet], base, offset)
        yield _Row("margin", "mm", 0, 20.0, (_Line("static margin", time, margin * 1e3),))
    yield _Row("speed", "m/s", 3, 0.1, (_Line("speed forward", base.time, _speed(stats)),))
    feet = [foot.record for foot in stats.feet]
    height = np.full(len(base.time), np.nan)
    if feet and not stats.base_clock_is_apart:
        height = height_over_feet(base, feet)
    yield _Row("height", "m", 3, 0.02, (_Line("height over the feet", base.time, height),))
    roll, pitch = (np.degrees(each) for each in roll_and_pitch(base.angles, axis))
    lines = (_Line("roll", base.time, roll), _Line("pitch", base.time, pitch, SECOND, "dash"))
    yield _Row("attitude", "deg", 1, 2.0, lines)


def _extent(row: _Row) -> list[float]:
    """Return the range of a row's axis."""
    values = np.concatenate([line.value for line in row.lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    beside = max(0.06 * (high - low), (row.least - (high - low)) / 2.0)
    return [low - beside, high + beside]


def _speed(stats: Stats) -> Floats:
    """(n,) m/s along the forward axis at each pose, over `BESIDE_S` before and after it."""
    base, beside = stats.base_history, round(BESIDE_S * 1e9)
    first = np.maximum(base.time - beside, base.time[0])
    last = np.minimum(base.time + beside, base.time[-1])
    step = base.position_at(last)[:, :2] - base.position_at(first)[:, :2]
    heading = base.angles[:, 2] + FORWARD_ANGLES[stats.settings.forward_axis]
    forward, _ = along_heading(step, heading)
    speed: Floats = forward / ((last - first) / 1e9)
    speed[_across(base, stats.jumps.spans, first, last)] = np.nan
    return speed


def _across(base: BaseHistory, jumps: Ints, first: Ints, last: Ints) -> Flags:
    """(n,) whether a span holds a jump of the pose or a gap."""
    breaks = timespans.merge(np.concatenate([jumps, base.gaps]))
    return timespans.touches(breaks, first, last)


def _trace(stats: Stats, row: _Row, line: _Line, end: str) -> Trace:
    recorder = CurveRecorder(DETAIL)
    recorder.add(line.time, line.value)
    curve = recorder.finish()
    time, value = np.empty(0, np.int64), np.empty(0)
    if curve is not None:
        unknown = timespans.spans_where(line.time, np.isnan(line.value[:-1]))
        breaks = timespans.merge(np.concatenate([stats.base_history.gaps, unknown]))
        time, value = curve.line(breaks)
    return scatter(
        x=drawn_seconds(stats, time),
        y=value.astype(np.float32),
        mode="lines",
        line={"color": line.colour, "width": 1.5, "dash": line.dash},
        name=line.name,
        hovertemplate=f"%{{y:.{row.decimals}f}} {row.unit}",
        xaxis="x",
        yaxis=f"y{end}",
    )


def _words(stats: Stats) -> str:
    base = stats.base
    if base is None or base.roll_rad is None or base.pitch_rad is None:
        return "The motion of the base over time."
    roll, pitch = (np.degrees([each.min, each.max]) for each in (base.roll_rad, base.pitch_rad))
    return (
        f"The motion of the base over time. Roll from {roll[0]:.1f} to {roll[1]:.1f} degrees, "
        f"pitch from {pitch[0]:.1f} to {pitch[1]:.1f}."
    )


def _caption(rows: list[str]) -> str:
    words = {
        "margin": "Margin: distance of the base's projection from the edge of the support polygon, "
        "below 0 outside; none with fewer than three feet down.",
        "speed": f"Speed: forward, over {2.0 * BESIDE_S:g} s.",
        "height": "Height: over the feet's latest contact points.",
        "attitude": "Attitude: roll (line; positive with the left side higher) and pitch (dashed; "
        "positive with the front lower).",
    }
    return " ".join(words[row] for row in rows)
