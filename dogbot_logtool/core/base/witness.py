"""The base's motion by the feet alone.

Contact points in the world rest while the base moves on. From footfall to footfall a foot goes as
far as the base, so that the centroid of all feet goes where the base goes, and their directions
from it turn as it turns. Places of feet in the base's axes tell its velocity (`leg_odometry`).
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Complexes,
    Floats,
    Ints,
    all_finite,
    distinct,
    median_of,
    norms,
)
from dogbot_logtool.core.base.comparison import motion_in, stride_windows
from dogbot_logtool.core.base.foot_path import RATE_HZ, FootPath
from dogbot_logtool.core.base.leg_odometry import dead_reckoned, leg_odometry
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory, stance_places
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.leg_position import LegPosition

TICK_NS: Final = 50_000_000
"""ns, how often feet that rest in the world are looked at."""
FEWEST_FOOTFALLS: Final = 3
"""Footfalls of a foot that tell of the base's motion."""
UNSURE: Final = 0.3
"""Share of its usual speed by which standing feet disagree from which they do not tell it."""
UNSURE_MPS: Final = 0.1
"""m/s, the same of a base that hardly moves."""
_SPREAD_M: Final = 0.05
"""m between feet from which their directions tell a turn."""


class Witness(NamedTuple):
    """The base's motion by its feet."""

    poses: BaseHistory
    """From any origin; the heading is that of the robot's forward axis if `tells_heading`."""
    by: str
    """``contact points`` or ``legs``."""
    tells_heading: bool
    """Whether the heading is the robot's own, and not only its changes are known."""
    tells_turn: bool
    """Whether the heading turns as the feet do; else it is that of the recorded poses."""

    def stand_in(self, recorded: BaseHistory, forward_rad: float) -> BaseHistory | None:
        """Return poses of the base in place of recorded ones, of which none can be used.

        Args:
            recorded: no poses.
            forward_rad: from the body's x axis to the axis that points forward.

        Returns:
            None where heading or turn are not known.
        """
        if len(recorded.time) or not (self.tells_heading and self.tells_turn):
            return None
        angles = self.poses.angles - np.array([0.0, 0.0, 0.0 if self.by == "legs" else forward_rad])
        return replace(
            self.poses,
            angles=angles,
            messages=recorded.messages,
            not_usable=recorded.not_usable,
            not_advancing=recorded.not_advancing,
        )


def by_points(
    feet: Sequence[FootHistory],
    positions: Sequence[LegPosition | None],
    base: BaseHistory,
) -> Witness | None:
    """Return the base's motion by contact points in the world.

    Args:
        feet: histories of feet whose contact points the recorded poses did not place.
        positions: of each foot on the body.
        base: recorded poses, whose heading stands in where one foot only is known.

    Returns:
        None where no foot's points are known over three footfalls.
    """
    tracks = [_footfalls(foot) for foot in feet]
    used = [row for row, (time, _) in enumerate(tracks) if len(time) >= FEWEST_FOOTFALLS]
    if not used:
        return None
    start = max(int(tracks[row][0][0]) for row in used)
    end = min(int(tracks[row][0][-1]) for row in used)
    # Of a clock that was set by years only the time in which feet are known has ticks.
    spans = [np.array([[start, max(end, start)]]), *(feet[row].known for row in used)]
    time = timespans.ticks(timespans.intersect(spans), TICK_NS)
    if len(time) < FEWEST_FOOTFALLS:
        return None
    # (t, f, 3) m, where each foot's point is.
    places = np.stack([_interpolated(*tracks[row], time) for row in used], axis=1)
    centre = places.mean(axis=1)
    away = places - centre[:, None, :]
    turns = len(used) > 1 and float(median_of(np.abs(away[:, :, :2]).max(axis=1))) > _SPREAD_M
    angles = np.zeros((len(time), 3))
    heading = None
    if turns:
        flat = away[:, :, 0] + 1j * away[:, :, 1]
        angles[:, 2] = np.unwrap(np.angle((flat * flat[:1].conj()).sum(axis=1)))
        unturned = flat * np.exp(-1j * angles[:, 2])[:, None]
        heading = _heading(unturned.mean(axis=0), [positions[row] for row in used])
        angles[:, 2] += heading or 0.0
    elif len(base.time):
        angles[:, 2] = np.interp(time - time[0], base.time - time[0], base.angles[:, 2])
    poses = BaseHistory(time, centre, angles)
    return Witness(poses, "contact points", heading is not None, turns)


def _footfalls(foot: FootHistory) -> tuple[Ints, Floats]:
    """Return when and where a foot rests: once a stance, twice in a stance that is long."""
    time, place = stance_places(foot)
    known = all_finite(place)
    time, place = time[known], place[known]
    duration = (foot.stances.liftoff - foot.stances.touchdown)[known]
    if not len(time):
        return time, place
    longer = np.maximum(duration - 2 * int(median_of(duration)), 0)
    twice = np.stack([time, time + longer], axis=1).ravel()
    both = np.repeat(place, 2, axis=0)
    kept = np.concatenate([[True], np.diff(twice) > 0])
    return twice[kept], both[kept]


def _interpolated(at: Ints, place: Floats, time: Ints) -> Floats:
    """(t, 3) m, linearly between footfalls."""
    since = (at - at[0]).astype(np.float64)
    return np.stack([np.interp(time - at[0], since, axis) for axis in place.T], axis=1)


def _heading(places: Complexes, positions: Sequence[LegPosition | None]) -> float | None:
    """Return the direction of forward by where fore and hind, left and right feet are, rad.

    Args:
        places: (f,) m, x + iy of each foot.
        positions: of each foot on the body.

    Returns:
        None where the names of the feet do not tell.
    """
    ends: dict[str, list[complex]] = {}
    for place, position in zip(places.tolist(), positions, strict=True):
        for word in position or ():
            ends.setdefault(word, []).append(place)
    ahead = 0.0j
    for first, second, turn in (("front", "back", 1.0), ("left", "right", -1.0j)):
        if first in ends and second in ends:
            ahead += turn * complex(np.mean(ends[first]) - np.mean(ends[second]))
    return float(np.angle(ahead)) if abs(ahead) > _SPREAD_M else None


def by_legs(
    places: Sequence[FootPath | None], feet: Sequence[FootHistory], base: BaseHistory
) -> Witness | None:
    """Return the base's motion by the feet's places in its own axes.

    Args:
        places: of each foot, from the base's origin along its axes; None: not known.
        feet: histories of the same feet.
        base: recorded poses, whose lean turns what legs tell, and whose turn stands in where a
            single foot stands.

    Returns:
        None where no foot's places are known.
    """
    known = [row for row, path in enumerate(places) if path is not None and len(path.time) > 2]
    if not known:
        return None
    paths = [path for path in places if path is not None and len(path.time) > 2]
    # Some messages tell the place of a foot only while it stands.
    time = distinct(np.concatenate([path.time for path in paths]))
    time = time[first_at_each_tick(time, RATE_HZ)]
    place = np.stack([path.at(time) for path in paths], axis=1)
    standing = np.stack([timespans.covers(feet[row].in_contact, time) for row in known], axis=1)
    legs = leg_odometry(time, place, standing)
    tells_turn = bool(np.isfinite(legs.turn_rate[:, 2]).mean() > 0.5)
    angles = np.zeros((len(time), 3))
    if len(base.time):
        columns = [np.interp(time - time[0], base.time - time[0], each) for each in base.angles.T]
        angles = np.stack(columns, axis=1)
    if not tells_turn and len(base.time) > 1:
        rates = np.zeros((len(time), 3))
        rates[:, 2] = np.gradient(angles[:, 2], (time - time[0]) / 1e9)
        legs = leg_odometry(time, place, standing, rates)
    speed = norms(legs.velocity[np.isfinite(legs.velocity[:, 0])])
    if not len(speed) or legs.noise_mps > max(UNSURE_MPS, UNSURE * float(median_of(speed))):
        return None
    poses = dead_reckoned(legs, angles[:, :2])
    return Witness(poses, "legs", tells_heading=True, tells_turn=tells_turn)


def feet_witness(
    feet: Sequence[FootHistory],
    places: Sequence[FootPath | None],
    positions: Sequence[LegPosition | None],
    base: BaseHistory,
) -> Witness | None:
    """Return the base's motion by the feet; None where their places are not known.

    Args:
        feet: histories of all feet.
        places: of each foot in the base's axes, where its messages tell that; None: they do not,
            and its contact points, if any, are the world's.
        positions: of each foot on the body.
        base: recorded poses.
    """
    if any(path is not None for path in places):
        return by_legs(places, feet, base)
    return by_points(feet, positions, base)


SHORTEST_STRIDES: Final = 1.5
"""Strides that one pose must last for."""
FEWEST_TOUCHDOWNS: Final = 2
STAYS_MPS: Final = 0.02
"""m/s: feet that walk on less quickly stay where they are."""
STAYS_RADPS: Final = 0.03
"""rad/s, the same of a turn."""


class Frozen(NamedTuple):
    """Time in which one pose is repeated although the robot walks, or may walk, on."""

    spans: Ints
    """(s, 2) ns."""
    whole: bool
    """Whether no other poses are left."""
    moves_mps: float | None
    """m/s, how fast the witness says that the base moves in that time; None: there is none."""
    turns_radps: float | None
    """rad/s, how fast it turns, likewise."""
    by: str
    """The witness; empty: none tells whether the base moves."""


def find_frozen(
    base: BaseHistory, feet: Sequence[FootHistory], witness: Witness | None, period_s: float | None
) -> Frozen | None:
    """Find the time in which poses are frozen; None: they are not.

    Args:
        base: poses as recorded.
        feet: histories of all feet.
        witness: the base's motion by its feet; None: not known.
        period_s: s, the usual stride; None: there is none.
    """
    if not period_s or len(base.time) < 2:
        return None
    spans = _one_pose(base, SHORTEST_STRIDES * period_s * 1e9)
    steps = [_touchdowns(feet, span) >= FEWEST_TOUCHDOWNS for span in spans]
    spans = spans[np.array(steps, np.bool_)]
    if not len(spans):
        return None
    speeds = turns = np.empty(0)
    by = ""
    if witness is not None:
        motion = motion_in(witness.poses, stride_windows(spans, period_s))
        known = np.isfinite(motion.turn)
        speeds = np.abs(motion.displacement[known]) / period_s
        turns = np.abs(motion.turn[known]) / period_s
        by = witness.by if known.any() else ""
    moves, turned = (float(median_of(each)) if by else None for each in (speeds, turns))
    if by and (moves or 0.0) < STAYS_MPS and (turned or 0.0) < STAYS_RADPS:
        return None
    return Frozen(spans, len(without_frozen(base, spans).time) < 2, moves, turned, by)


def without_frozen(base: BaseHistory, spans: Ints) -> BaseHistory:
    """Return poses without those of some spans, (s, 2) ns, which become gaps."""
    inside = timespans.covers(spans, base.time - 1) | timespans.covers(spans, base.time)
    rows = np.flatnonzero(~inside)
    return base.pick(rows) if len(rows) > 1 else base.without_poses()


def _one_pose(base: BaseHistory, shortest_ns: float) -> Ints:
    """(s, 2) ns, spans of one pose."""
    same = (np.diff(base.position, axis=0) == 0.0).all(axis=1)
    same &= (np.diff(base.angles, axis=0) == 0.0).all(axis=1)
    spans = timespans.spans_where(base.time, same)
    return spans[spans[:, 1] - spans[:, 0] >= shortest_ns]


def _touchdowns(feet: Sequence[FootHistory], span: Ints) -> int:
    """Return the most touchdowns of one foot in a span, (2,) ns."""
    counts = [
        int(((each.stances.touchdown > span[0]) & (each.stances.touchdown < span[1])).sum())
        for each in feet
    ]
    return max(counts, default=0)
