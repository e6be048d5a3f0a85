"""Motion of the base and its commands over time, in rows one above the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.base.ground import height_over_feet
from dogbot_logtool.core.base.motion import FORWARD_ANGLES, roll_and_pitch
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.curves import CurveDetail, curve_of
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.core.stability import margins
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.charts.drawing import (
    LINE,
    MARGIN,
    SECOND,
    Chart,
    Drawing,
    Trace,
    drawn_seconds,
    scatter,
    time_axis,
)

DETAIL: Final = CurveDetail(most_bins=1500)
"""More than the page has columns of pixels; the lowest and the highest value of each are drawn."""


@dataclass(frozen=True, slots=True)
class Line:
    """One curve."""

    name: str
    time: Ints
    """(n,) ns, strictly increasing."""
    value: Floats
    """(n,) NaN where it is not known."""
    colour: str = LINE
    dash: str = "solid"


@dataclass(frozen=True, slots=True)
class Row:
    """Curves of one quantity."""

    title: str
    unit: str
    decimals: int
    least: float
    """Span of values that fills the row at least, so that noise does not look like motion."""
    lines: tuple[Line, ...]


def stacked(stats: Walk, rows: Sequence[Row], breaks: Ints) -> Chart:
    """Draw rows one above the other.

    Args:
        stats: of the log, for its time.
        rows: from the top.
        breaks: (b, 2) ns, over which no line leads, beside unknown values.
    """
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
        figure.data.extend(_trace(stats, row, line, breaks, end) for line in row.lines)
    return figure


def _extent(row: Row) -> list[float]:
    """Return the range of a row's axis."""
    values = np.concatenate([line.value for line in row.lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    beside = max(0.06 * (high - low), (row.least - (high - low)) / 2.0)
    return [low - beside, high + beside]


def _trace(stats: Walk, row: Row, line: Line, breaks: Ints, end: str) -> Trace:
    curve = curve_of(line.time, line.value, DETAIL)
    time, value = np.empty(0, np.int64), np.empty(0)
    if curve is not None:
        unknown = timespans.spans_where(line.time, np.isnan(line.value[:-1]))
        time, value = curve.line(timespans.merge(np.concatenate([breaks, unknown])))
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


_VELOCITIES: Final = (
    ("forward", "m/s", 0.1),
    ("to the left", "m/s", 0.1),
    ("yaw rate", "rad/s", 0.1),
)
"""Title of each column of the velocities, unit, and the span that fills the row at least."""


def tracked_commands(stats: Walk) -> Drawing | None:
    """Draw commanded and measured velocity, an axis a row; None without commands."""
    track = stats.command_track
    if track is None or len(track.time) == 0:
        return None
    rows, words = [], []
    for column, (title, unit, least) in enumerate(_VELOCITIES):
        rms = track.errors(column)[3]
        if rms is None:
            continue
        lines = (
            Line("measured", track.time, track.measured[:, column]),
            Line("commanded", track.time, track.commanded[:, column], SECOND, "dash"),
        )
        rows.append(Row(title, unit, 3, least, lines))
        words.append(f"{title.capitalize()}: error {rms:.3f} {unit} (root mean square).")
    caption = (
        "Velocity of the base in its own axes (line) and as commanded (dashed), both averaged over "
        f"{track.window_ns / 1e9:.2f} s, so that the gait's own swing is left out. No line where "
        f"there is no command. {' '.join(words)}"
    )
    alt = f"Commanded and measured velocity over time. {' '.join(words)}"
    figure = stacked(stats, rows, track.breaks)
    return Drawing("commands", "Commands", alt, caption, figure, over_time=True)


BESIDE_S: Final = 0.1
"""s before and after a time between which its speed is measured."""


def motion(stats: Walk) -> Drawing | None:
    """Draw what is known of margin, speed, height and attitude, one above the other.

    None without poses.
    """
    rows = [row for row in _rows(stats) if any(np.isfinite(line.value).any() for line in row.lines)]
    if not rows:
        return None
    caption = _caption([row.title for row in rows])
    return Drawing(
        "motion",
        "Motion",
        _words(stats),
        caption,
        stacked(stats, rows, stats.base_history.gaps),
        over_time=True,
    )


def _rows(stats: Walk) -> Iterator[Row]:
    base = stats.base_history
    if len(base.time) < 2:
        return
    axis = stats.settings.forward_axis
    if stats.stability is not None:
        offset = stats.settings.com_offset_m or (0.0, 0.0, 0.0)
        time, margin = margins([foot.record for foot in stats.feet], base, offset)
        yield Row("margin", "mm", 0, 20.0, (Line("static margin", time, margin * 1e3),))
    yield Row("speed", "m/s", 3, 0.1, (Line("speed forward", base.time, _speed(stats)),))
    feet = [foot.record for foot in stats.feet]
    height = np.full(len(base.time), np.nan)
    if feet and not stats.base_clock_is_apart:
        height = height_over_feet(base, feet)
    yield Row("height", "m", 3, 0.02, (Line("height over the feet", base.time, height),))
    roll, pitch = (np.degrees(each) for each in roll_and_pitch(base.angles, axis))
    lines = (Line("roll", base.time, roll), Line("pitch", base.time, pitch, SECOND, "dash"))
    yield Row("attitude", "deg", 1, 2.0, lines)


def _speed(stats: Walk) -> Floats:
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


def _words(stats: Walk) -> str:
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
