"""Curves and events over time, and the figures of the base: its motion, and its commands."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Float32s, Floats, Ints
from dogbot_logtool.core.base.motion import roll_and_pitch
from dogbot_logtool.core.events import EventType
from dogbot_logtool.core.metrics import Event
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.curves import Curve, curve_of
from dogbot_logtool.report.page.chart import (
    BAD,
    NEUTRAL,
    SECOND,
    Drawing,
    Row,
    Trace,
    extent_of,
    grid,
    line,
    note,
    seconds,
    time_axis,
    translucent,
)
from dogbot_logtool.report.text.gait_diagram import default_window

ROW_PIXELS: Final = 105
_FIRST: Final = {"color": "#6f7680"}
_OTHER: Final = {"color": SECOND, "dash": "dash"}
"""Styles of lines that are about no foot."""
_BINS: Final = 600
"""Bins of a curve, each with its lowest and highest value: twice as many points."""
_BESIDE_S: Final = 0.1
"""s before and after a time between which its speed is measured."""


class Line(NamedTuple):
    """A quantity over time, reduced to what can be seen."""

    curve: Curve
    trace: Trace


def line_over_time(
    walk: Walk,
    name: str,
    points: tuple[Ints, Floats | Float32s],
    breaks: Ints,
    hover: str,
    style: Trace,
    more: Trace | None = None,
) -> Line | None:
    """Reduce a quantity: the typical strides have every sample; None where nothing is known.

    Args:
        walk: of the log.
        name: of the quantity.
        points: (n,) ns, strictly increasing, and (n,) values, NaN where not known.
        breaks: (b, 2) ns, over which no line leads, beside unknown values.
        hover: how a value is written.
        style: see `line`; also `more`.
        more: of the trace.
    """
    first, last = (walk.origin + round(each * 1e9) for each in default_window(walk))
    curve = curve_of(*points, breaks, _BINS, (first, last))
    if curve is None:
        return None
    words = {"hovertemplate": hover, **(more or {})}
    return Line(curve, line(seconds(walk, curve.time), curve.value, name, style, words))


def _row(title: str, lines: Sequence[Line | None], least: float) -> Iterator[Row]:
    """Yield a row of curves, if any is known; noise below `least` does not fill it."""
    known = [each for each in lines if each is not None]
    if known:
        values = np.concatenate([each.curve.value for each in known])
        yield Row(title, [(0, each.trace) for each in known], extent_of(values, least))


_MOTION_WORDS: Final = {
    "margin (mm)": "Margin: distance of the base's projection from the edge of the support "
    "polygon, below 0 outside; none with fewer than three feet down.",
    "speed (m/s)": f"Speed: forward, over {2.0 * _BESIDE_S:g} s.",
    "height (m)": "Height: over the feet's latest contact points.",
    "attitude (deg)": "Attitude: roll (line; positive with the left side higher) and pitch "
    "(dashed; positive with the front lower).",
}


def motion(walk: Walk) -> Drawing | None:
    """Draw what is known of margin, speed, height and attitude; None without poses."""
    rows = list(_motion_rows(walk)) if len(walk.base_history.time) > 1 else []
    if not rows:
        return None
    caption = " ".join(_MOTION_WORDS[row.title] for row in rows)
    alt, base = "The motion of the base over time.", walk.base
    if base is not None and base.roll_rad is not None and base.pitch_rad is not None:
        roll, pitch = (np.degrees([each.min, each.max]) for each in (base.roll_rad, base.pitch_rad))
        alt += (
            f" Roll from {roll[0]:.1f} to {roll[1]:.1f} degrees, pitch from {pitch[0]:.1f} to "
            f"{pitch[1]:.1f}."
        )
    drawn = grid(rows, time_axis(walk), ROW_PIXELS)
    return Drawing("motion", "Motion", alt, caption, *drawn, over_time=True)


def _motion_rows(walk: Walk) -> Iterator[Row]:
    base = walk.base_history

    def curve(name: str, value: Floats, hover: str, style: Trace = _FIRST) -> Line | None:
        return line_over_time(walk, name, (base.time, value), base.gaps, hover, style)

    if walk.instants is not None:
        points = walk.instants.time, walk.instants.margin * 1e3
        margin = line_over_time(walk, "static margin", points, base.gaps, "%{y:.0f} mm", _FIRST)
        yield from _row("margin (mm)", [margin], 20.0)
    yield from _row("speed (m/s)", [curve("speed forward", _speed(walk), "%{y:.3f} m/s")], 0.1)
    if walk.feet and not walk.base_clock_is_apart:
        height = curve("height over the feet", walk.track.height_m, "%{y:.3f} m")
        yield from _row("height (m)", [height], 0.02)
    roll, pitch = np.degrees(roll_and_pitch(base.angles, walk.settings.forward_rad))
    lines = (
        curve("roll", roll, "%{y:.1f} deg"),
        curve("pitch", pitch, "%{y:.1f} deg", _OTHER),
    )
    yield from _row("attitude (deg)", lines, 2.0)


def _speed(walk: Walk) -> Floats:
    """(n,) m/s along the forward axis at each pose, over `_BESIDE_S` before and after it."""
    base, beside = walk.base_history, round(_BESIDE_S * 1e9)
    first = np.maximum(base.time - beside, base.time[0])
    last = np.minimum(base.time + beside, base.time[-1])
    step = base.position_at(last)[:, :2] - base.position_at(first)[:, :2]
    heading = base.angles[:, 2] + walk.settings.forward_rad
    forward = along_heading(step, heading)[:, 0]
    speed: Floats = forward / ((last - first) / 1e9)
    breaks = timespans.merge(np.concatenate([walk.jumps.spans, base.gaps]))
    speed[timespans.touches(breaks, first, last)] = np.nan
    return speed


_VELOCITIES: Final = (("forward", "m/s"), ("to the left", "m/s"), ("yaw rate", "rad/s"))
"""Title and unit of each column of the velocities."""


def tracked_commands(walk: Walk) -> Drawing | None:
    """Draw commanded and measured velocity, an axis a row; None without commands."""
    track = walk.command_track
    if track is None or len(track.time) == 0:
        return None
    rows: list[Row] = []
    words = []
    for column, (title, unit) in enumerate(_VELOCITIES):
        rms = track.errors(column)[3]
        if rms is None:
            continue
        hover = f"%{{y:.3f}} {unit}"
        lines = [
            line_over_time(walk, name, (track.time, value[:, column]), track.breaks, hover, style)
            for name, value, style in (
                ("measured", track.measured, _FIRST),
                ("commanded", track.commanded, _OTHER),
            )
        ]
        rows += _row(f"{title} ({unit})", lines, 0.1)
        words.append(f"{title.capitalize()}: error {rms:.3f} {unit} (root mean square).")
    caption = (
        "Velocity of the base in its own axes (line) and as commanded (dashed), both averaged over "
        f"{track.window_ns / 1e9:.2f} s, so that the gait's own swing is left out. No line where "
        f"there is no command. {' '.join(words)}"
    )
    alt = f"Commanded and measured velocity over time. {' '.join(words)}"
    drawn = grid(rows, time_axis(walk), ROW_PIXELS)
    return Drawing("commands", "Commands", alt, caption, *drawn, over_time=True)


MOST_LISTED: Final = 200
"""Events in the list, and marks in each figure."""
_LABELLED: Final = 12
"""Most bands that are named in the gait diagram."""
MINOR: Final = frozenset({EventType.GAIT_CHANGE, EventType.GAP, EventType.EARLY_CONTACT})
"""Types that are no fault of the walk."""
_FALLS: Final = frozenset({EventType.FALL, EventType.TIPPING})


def mark_events(events: Sequence[Event], drawings: Iterable[Drawing], feet: Sequence[str]) -> None:
    """Mark events in all figures over time, and name them in that with the rows of the feet.

    A fall is darkest; what only the recording does is grey. Events of one foot stand in its row;
    in figures without rows they have no more than an outline.
    """
    marked = events[:MOST_LISTED]
    for drawing in drawings:
        if drawing.over_time:
            drawing.layout["shapes"] = [_mark(each, drawing, feet) for each in marked]
        if drawing.name == "gait":
            drawing.layout["annotations"] = _names(marked)


def _mark(event: Event, drawing: Drawing, feet: Sequence[str]) -> dict[str, Any]:
    colour = NEUTRAL if event.type in MINOR else BAD
    filled = 0.28 if event.type in _FALLS else 0.12
    edges = {"yref": "paper", "y0": 0.0, "y1": 1.0}
    if event.foot is not None and drawing.feet:
        edges = dict(drawing.feet[feet.index(event.foot)])
    elif event.foot is not None:
        filled = 0.0
    return {
        "type": "rect",
        "xref": "x",
        "x0": event.onset_s,
        "x1": event.onset_s + event.duration_s,
        **edges,
        "fillcolor": translucent(colour, filled),
        "line": {"width": 1, "color": colour},
        "layer": "below",
    }


def _names(events: Sequence[Event]) -> list[dict[str, Any]]:
    """Name the first event of each kind, and every fall."""
    first: dict[str, Event] = {}
    for each in events:
        first.setdefault(each.type, each)
    named = [
        each
        for each in events
        if each.type in _FALLS or (each.type not in MINOR and first[each.type] is each)
    ]
    return [
        note(each.type.replace("_", " "), x=each.onset_s, xref="x", xanchor="left")
        for each in named[:_LABELLED]
    ]
