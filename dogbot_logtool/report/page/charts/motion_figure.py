"""How the base moved over time: static margin, speed, height and attitude."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.base.ground import height_over_feet
from dogbot_logtool.core.base.motion import FORWARD_ANGLES, roll_and_pitch
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.core.stability.stability import margins
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.page.charts.drawing import SECOND, Drawing
from dogbot_logtool.report.page.charts.stacked_rows import Line, Row, stacked

BESIDE_S: Final = 0.1
"""s before and after a time between which its speed is measured."""


def motion(stats: Stats) -> Drawing | None:
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


def _rows(stats: Stats) -> Iterator[Row]:
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
