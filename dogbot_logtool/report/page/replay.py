"""The walk in 3D: what the page's replay draws, thinned to what an eye sees."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, distinct, median_of
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.metrics import Event
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.core.scene.feet import foot_colour, short_names
from dogbot_logtool.core.settings import LegPosition
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.report.page.chart import FINE, is_hind, packed, seconds, thinned
from dogbot_logtool.report.page.over_time import MINOR, MOST_LISTED
from dogbot_logtool.report.text.gait_diagram import default_window
from dogbot_logtool.robot.description import Limbs

STEP_NS: Final = 40_000_000
"""ns between frames: 25 a second."""
MOST_FRAMES: Final = 4000
"""Frames of a log: 160 s in full; of a longer one the typical strides and what is near events."""
LONGEST_SILENCE_NS: Final = 1_000_000_000
"""ns without messages of base and feet that are shown; longer silences have no frames."""
BESIDE_NS: Final = 5_000_000_000
"""ns before and after an event that are shown in full."""
LONGEST_SWING_NS: Final = 1_500_000_000
"""ns without contact points across which no foot is drawn: it is lifted, or nothing is known."""
_SWING, _STANCE, _NOT_KNOWN = 0, 1, 2
_ALONG: Final = {"front": 1.0, "back": -1.0}
_ASIDE: Final = {"left": 1.0, "right": -1.0}


def frame_times(walk: Walk, events: Sequence[Event]) -> Ints:
    """Return the times of the frames, (n,) ns, increasing, at most `MOST_FRAMES`.

    Silences are left out. All that is made here is bounded: a log may last for decades, when a
    clock was set while it was recorded.
    """
    origin, recorded = walk.origin, _recorded(walk)
    if _frame_counts(recorded, origin).sum() <= MOST_FRAMES:
        return _frames(recorded, origin, MOST_FRAMES)
    spans = [default_window(walk)]
    spans += [(each.onset_s, each.onset_s + each.duration_s) for each in events[:MOST_LISTED]
              if each.type not in MINOR]  # fmt: skip
    parts = [_frames(recorded, origin, MOST_FRAMES // 4)]
    for start, end in spans:
        beside = round(start * 1e9) - BESIDE_NS, round(end * 1e9) + BESIDE_NS + 1
        near = timespans.intersect([recorded, np.array([beside], np.int64) + origin])
        if sum(map(len, parts)) + _frame_counts(near, origin).sum() > MOST_FRAMES:
            break
        parts.append(_frames(near, origin, MOST_FRAMES))
    return distinct(np.concatenate(parts))


def _recorded(walk: Walk) -> Ints:
    """(k, 2) ns, the log without silences of base and feet; its start is always in it."""
    whole = np.array([[walk.origin, walk.end + 1]], np.int64)
    start = np.array([[walk.origin, walk.origin + 1]], np.int64)
    known = [walk.base_history.known, *(foot.record.known for foot in walk.feet)]
    silent = timespans.subtract(whole, timespans.merge(np.concatenate([start, *known])))
    long = silent[:, 1] - silent[:, 0] > LONGEST_SILENCE_NS
    return timespans.subtract(whole, silent[long])


def _frame_counts(spans: Ints, origin: int) -> Ints:
    """(k,) how many frames each span has; frames are whole steps from the log's start."""
    first, last = -(-(spans - origin) // STEP_NS).T
    count: Ints = last - first
    return count


def _frames(spans: Ints, origin: int, most: int) -> Ints:
    """(n,) ns, the frames in spans; of more than `most`, so many that are evenly spaced."""
    behind = np.cumsum(_frame_counts(spans, origin))
    number = thinned(int(behind[-1]) if len(behind) else 0, most)
    row = np.searchsorted(behind, number, side="right")
    last = -(-(spans[row, 1] - origin) // STEP_NS)
    times: Ints = origin + STEP_NS * (last - behind[row] + number)
    return times


def replay(
    walk: Walk, events: Sequence[Event], time: Ints, limbs: Limbs | None
) -> dict[str, Any] | None:
    """Return what the replay draws, as JSON; None without poses of the base.

    Args:
        walk: what was measured.
        events: that are named.
        time: (n,) ns, of the frames; see `frame_times`.
        limbs: the robot's joints at these times; None: not known.
    """
    base = walk.base_history
    if len(base.time) == 0 or len(time) == 0:
        return None
    position, angles = base.position_at(time), base.angles_at(time)
    # Near the robot, 32 bits tell positions to less than a millimetre, wherever the world begins.
    origin = np.array([*np.round(base.position[0, :2]), 0.0])
    points = [
        _foot_points(walk, row, time, limbs, position, angles) for row in range(len(walk.feet))
    ]
    ground = _ground(points, position)
    height = float(np.nanmedian(position[:, 2])) - ground if np.isfinite(position).any() else 0.5
    is_schematic = bool(points) and not any(np.isfinite(each).any() for each in points)
    if is_schematic:
        points = [
            _in_world(_nominal(foot.leg_position, row, height), position, angles)
            for row, foot in enumerate(walk.feet)
        ]
    short = short_names([foot.name for foot in walk.feet])
    return {
        "time": packed(seconds(walk, time), FINE),
        "position": packed((position - origin).ravel(), FINE),
        "angles": packed(angles.ravel(), FINE),
        "forward": walk.settings.forward_rad,
        "ground": ground,
        "height": max(height, 0.05),
        "newtons_per_metre": _newtons_per_metre(walk, height),
        "schematic": is_schematic,
        "feet": [
            {
                "name": foot.name,
                "short": short[row],
                "colour": foot_colour(row),
                "hind": is_hind(walk, row),
                "point": packed((points[row] - origin).ravel(), FINE),
                "state": packed(_states(foot, time)),
                "load": packed(_loads(foot.record, time), np.inf),
            }
            for row, foot in enumerate(walk.feet)
        ],
        "limbs": limbs
        and {"parents": list(limbs.parents), "point": packed(limbs.point.ravel(), FINE)},
        "events": [
            {
                "at": each.onset_s,
                "what": f"{each.type.replace('_', ' ')} {each.foot or ''}".strip(),
                "minor": each.type in MINOR,
            }
            for each in events[:MOST_LISTED]
        ],
    }


def _foot_points(
    walk: Walk, row: int, time: Ints, limbs: Limbs | None, position: Floats, angles: Floats
) -> Floats:
    """(n, 3) m, in the world: the contact point in stance, the sole or a straight line in swing."""
    record = walk.feet[row].record
    point = np.full((len(time), 3), np.nan)
    at, contact_point = record.track.contact_points
    # Contact points and base may be in different worlds, or on different clocks.
    if len(at) and not walk.base_is_apart:
        for axis in range(3):
            point[:, axis] = np.interp(time - at[0], at - at[0], contact_point[:, axis])
        after = np.clip(np.searchsorted(at, time), 1, max(len(at) - 1, 1))
        apart = at[np.minimum(after, len(at) - 1)] - at[after - 1] > LONGEST_SWING_NS
        point[(time < at[0]) | (time > at[-1]) | apart] = np.nan
    sole = None if limbs is None else limbs.soles[row]
    if limbs is not None and sole is not None:
        swings = ~timespans.covers(record.in_contact, time) | np.isnan(point[:, 0])
        by_frames = _in_world(limbs.point[:, sole].astype(np.float64), position, angles)
        use: Flags = swings & np.isfinite(by_frames[:, 0])
        point[use] = by_frames[use]
    return point


def _in_world(point: Floats, position: Floats, angles: Floats) -> Floats:
    """(n, 3) m in the world of points in the base's frame, (n, 3) or (3,)."""
    points = np.broadcast_to(point, position.shape)
    return position + rotate(from_roll_pitch_yaw(angles), points)


def _nominal(leg_position: LegPosition | None, row: int, height: float) -> Floats:
    """(3,) m, in the base's frame: below the base, where a foot of its name may be."""
    end, side = leg_position or ("", ("left", "right")[row % 2])
    along, aside = _ALONG.get(end, 0.0), _ASIDE.get(side, 0.0)
    return np.array([0.4 * height * along, 0.15 * height * aside, -height])


def _ground(points: Sequence[Floats], position: Floats) -> float:
    """Return the height of the grid: that of the lowest feet, or 0 if the base is above it."""
    lowest = [
        float(np.nanpercentile(each[:, 2], 5.0)) for each in points if np.isfinite(each).any()
    ]
    if lowest:
        return float(median_of(lowest))
    middle = float(np.nanmedian(position[:, 2])) if np.isfinite(position).any() else 0.0
    return 0.0 if middle > 0.1 else middle - 0.5


def _newtons_per_metre(walk: Walk, height: float) -> float:
    """Return the N of an arrow of 1 m: a body weight is as long as the base is high."""
    weight = walk.loads.weight_n
    if weight is None:
        peaks = [
            float(foot.record.track.force.max())
            for foot in walk.feet
            if foot.record.has_force and len(foot.record.track.time)
        ]
        weight = max(peaks, default=100.0)
    return max(weight, 1.0) / max(height, 0.05)


def _states(foot: FootSteps, time: Ints) -> Any:  # noqa: ANN401 - int8
    state = np.where(timespans.covers(foot.record.in_contact, time), _STANCE, _SWING)
    return np.where(timespans.covers(foot.known, time), state, _NOT_KNOWN).astype(np.int8)


def _loads(record: FootHistory, time: Ints) -> Floats:
    """(n,) N, |F|; NaN where it is not known."""
    track = record.track
    if not record.has_force or not len(track.time):
        return np.full(len(time), np.nan)
    start = track.time[0]
    force: Floats = np.interp(time - start, track.time - start, track.force, np.nan, np.nan)
    force[timespans.covers(record.gaps, time)] = np.nan
    return force
