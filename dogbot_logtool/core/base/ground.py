"""Where feet are and stand, by messages, transforms or joints, and what that tells of the ground.

Contact points in the world, and places in the base's axes put there by its poses, tell height and
slope of the ground, which way is forward, and whether the ground moves.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Float32s,
    Floats,
    Ints,
    all_finite,
    interpolated,
    median_of,
    trapezoids,
)
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.clock import advancing, first_at_each_tick
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.rotations import along_heading, conjugate, from_roll_pitch_yaw, rotate
from dogbot_logtool.core.settings import LegPosition, WalkSettings

RATE_HZ: Final = 200.0
"""At which paths that messages tell are kept."""
LONGEST_STEP_S: Final = 0.1
"""s between two messages; a longer step is a silence, across which nothing is interpolated."""


def without_silences(time: Ints) -> Ints:
    """(k, 2) ns, the time between messages that no silence lies between; time: (n,) ns."""
    return timespans.spans_where(time, np.diff(time) <= LONGEST_STEP_S * 1e9)


class FootPath(NamedTuple):
    """The point of a foot over time, in the base's frame or in the world."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Floats | Float32s
    """(n, 3) m."""
    known: Ints
    """(k, 2) ns, the time without silences."""

    def at(self, time: Ints) -> Floats:
        """Interpolate linearly; time's shape and 3, m; NaN in silences and outside."""
        if len(self.time) == 0:
            return np.full((*time.shape, 3), np.nan)
        position = interpolated(time, self.time, self.position)
        position[~self.unbroken(time, time)] = np.nan
        return position

    def unbroken(self, start: Ints, end: Ints) -> Flags:
        """Tell whether the path is known all the way between two times each, of any shape."""
        return timespans.hold_window(self.known, start, 0, end - start)

    def in_world(self, base: BaseHistory) -> "FootPath":
        """Place the path in the world by the base's poses; times without one are left out."""
        return known_path(self.time, base.point_at(self.time, self.position.astype(np.float64)))


def path_of(time: Ints, position: Floats | Float32s) -> FootPath:
    """Return the path of a foot by positions that messages tell, (n, 3) m; NaN: not known."""
    advances = advancing(time)
    rows = np.flatnonzero(advances)
    rows = rows[first_at_each_tick(time[rows], RATE_HZ)]
    return known_path(time[rows], position[rows])


def path_in_base(time: Ints, position: Floats | Float32s, base: BaseHistory) -> FootPath:
    """Return the path of a foot in the base's axes by its positions in the world, (n, 3) m."""
    turn = conjugate(from_roll_pitch_yaw(base.angles_at(time)))
    return path_of(time, rotate(turn, position.astype(np.float64) - base.position_at(time)))


def contact_path(foot: FootHistory) -> FootPath:
    """Return the path of a foot in the world by its contact points."""
    return known_path(*foot.track.contact_points)


def known_path(time: Ints, position: Floats | Float32s) -> FootPath:
    """Return the path of the times whose positions are known."""
    known = all_finite(position)
    return FootPath(time[known], position[known], without_silences(time[known]))


MIDDLE: Final = (0.2, 0.8)
"""Shares of a stance between which the foot is loaded and should be at rest."""


_SEEN: Final = (Cut.WHOLE, Cut.LOG_START, Cut.LOG_END, Cut.STANDING)
"""Stances between whose ends the foot is known to stand."""


class Footfalls(NamedTuple):
    """Position of a foot in each of its stances."""

    time: Ints
    """(stances,) ns, the middle of the stance."""
    position: Floats
    """(stances, 3) m, at that time; NaN where not known. Also `first` and `last`, at 20 % and 80 %
    of the stance."""
    first: Floats
    last: Floats
    travel_m: Floats
    """(stances,) m, distance between these two."""
    velocity: Floats
    """(stances, 2) m/s, horizontally, from the one to the other."""
    slip_m: Floats
    """(stances,) m, the same on the ground only; also `largest_slip_m`, the furthest that it is
    in between from where it is at 20 %."""
    largest_slip_m: Floats


def footfalls(path: FootPath, stances: Stances) -> Footfalls:
    """Return where a foot stands, by its path in the world."""
    duration = stances.liftoff - stances.touchdown
    steps = np.linspace(*MIDDLE, 13)
    time = stances.touchdown[:, None] + np.rint(duration[:, None] * steps).astype(np.int64)
    position = path.at(time)
    known = path.unbroken(time[:, 0], time[:, -1]) & np.isin(stances.cut, _SEEN)
    position[~known] = np.nan
    displacement = position - position[:, :1]
    flat = np.hypot(displacement[:, :, 0], displacement[:, :, 1])
    seconds = np.ptp(time, axis=1) / 1e9
    return Footfalls(
        time=stances.middle,
        position=position[:, len(steps) // 2],
        first=position[:, 0],
        last=position[:, -1],
        velocity=displacement[:, -1, :2] / np.where(seconds, seconds, np.nan)[:, None],
        travel_m=np.sqrt((displacement[:, -1] ** 2).sum(axis=1)),
        slip_m=flat[:, -1],
        largest_slip_m=flat.max(axis=1, initial=0.0),
    )


LOWEST_M: Final = 1e-3
"""m, lowest usual height of a base over its feet."""
LOWEST: Final = 0.15
"""The same as a share of the feet's spread: poses that count z from the ground are lower."""
FLAT: Final = 0.1
"""Share of their extent by which points may deviate from a plane."""
FEWEST_POINTS: Final = 3
STEEPEST: Final = 0.5
"""Cosine of the steepest plane that is taken for ground."""


def height_over_feet(
    base: BaseHistory, feet: Sequence[FootHistory], stood: Sequence[Footfalls]
) -> Floats:
    """Return the height of the base over the feet's latest contact points.

    Args:
        base: poses.
        feet: histories of all feet.
        stood: where they stand.

    Returns:
        (n,) m, at each pose; NaN before any contact point, and throughout where the contact
        points are in another world than the base, not below it.
    """
    latest = np.full((len(feet), len(base.time), 3), np.nan)
    for row, foot in enumerate(feet):
        time, point = foot.track.contact_points
        newest = np.searchsorted(time, base.time, side="right")
        latest[row] = np.concatenate([np.full((1, 3), np.nan), point]).take(newest, axis=0)
    seen = np.isfinite(latest[:, :, :1])
    with np.errstate(invalid="ignore"):
        centre = np.where(seen, latest, 0.0).sum(axis=0) / seen.sum(axis=0)
    offset = base.position - centre
    if not (known := all_finite(offset)).any():
        return np.asarray(offset[:, 2])
    away = np.hypot(*np.moveaxis((latest - centre)[:, known, :2], 2, 0))
    spread = np.fmax.reduce(away, axis=0)
    if median_of(offset[known, 2]) < max(LOWEST_M, LOWEST * median_of(spread)):
        return np.full(len(base.time), np.nan)
    normal = _ground_normal(stood, timespans.ALWAYS)
    # The feet's centre lies higher or lower than the ground below the base.
    return np.asarray(offset[:, 2] if normal is None else offset @ (normal / normal[2]))


def slope_rad(stood: Sequence[Footfalls], within: Ints) -> float | None:
    """Return the angle of the plane through the feet's footfalls against the horizontal.

    Args:
        stood: where all feet stand.
        within: (w, 2) ns, a part of the log.

    Returns:
        rad; None without points that span a plane, and where they do not lie in one.
    """
    normal = _ground_normal(stood, within)
    return None if normal is None else float(np.arccos(min(1.0, normal[2])))


def _ground_normal(stood: Sequence[Footfalls], within: Ints) -> Floats | None:
    """(3,) unit normal, upwards, of the plane through the feet's footfalls."""
    points = [
        each.position[timespans.covers(within, each.time) & all_finite(each.position)]
        for each in stood
    ]
    if sum(map(len, points)) < FEWEST_POINTS:
        return None
    all_points = np.concatenate(points)
    about = all_points - all_points.mean(axis=0)
    _, extent, axes = np.linalg.svd(about, full_matrices=False)
    rms = extent / np.sqrt(len(about))
    # Two directions on the ground must be known, and hardly anything off it.
    if rms[1] < LOWEST_M or rms[2] > FLAT * rms[1]:
        return None
    normal: Floats = axes[2] * np.copysign(1.0, axes[2, 2])
    return normal if normal[2] > STEEPEST else None


def seen_from_base(foot: FootHistory, base: BaseHistory) -> tuple[Ints, Floats]:
    """Return when and where a foot touches, as far as that is known.

    Returns:
        (n,) ns; and (n, 2) m along the body's x and y (yaw only), from the base.
    """
    time, point = foot.track.contact_points
    away = point - base.position_at(time)
    place = along_heading(away, base.yaw_at(time))[:, :2]
    known = all_finite(away) & all_finite(place)
    return time[known], place[known]


FEWEST_STANCES: Final = 6
SLOWEST_MPS: Final = 0.05
ALIKE: Final = 0.3
"""Share of the ground's speed by which half of the stances may differ from it."""
RESTS: Final = 0.05
"""Share of the ground's speed that a resting base keeps below, on average."""


class MovingGround(NamedTuple):
    """The way of the ground over time."""

    time: Ints
    """(n,) ns."""
    displacement: Floats
    """(n, 2) m, horizontally in the world, since the first time."""
    speed_mps: float

    def displacement_at(self, time: Ints) -> Floats:
        """Return where the ground has moved to, (m, 3) m; before and after, it stands."""
        flat = interpolated(time, self.time, self.displacement)
        return np.column_stack([flat, np.zeros(len(time))])

    def on_ground(self, base: BaseHistory) -> BaseHistory:
        """Return poses against the ground."""
        return replace(base, position=base.position - self.displacement_at(base.time))


def find_moving_ground(
    stood: Sequence[Footfalls], base: BaseHistory, *, placed_by_poses: bool
) -> MovingGround | None:
    """Find how the ground moves; None: it rests, or the base does not.

    Args:
        stood: where all feet stand.
        base: poses without jumps.
        placed_by_poses: whether the feet's places in the world rest on these poses: then poses that
            are frozen would look the same.
    """
    if not stood or len(base.time) < 2:
        return None
    if placed_by_poses and not np.ptp(base.position, axis=0).any():
        return None
    time = np.concatenate([each.time for each in stood])
    velocity = np.concatenate([each.velocity for each in stood])
    known = all_finite(velocity)
    time, velocity = time[known], velocity[known]
    if len(time) < FEWEST_STANCES:
        return None
    usual = median_of(velocity, axis=0)
    speed = float(np.hypot(*usual))
    apart = float(median_of(np.hypot(*(velocity - usual).T)))
    seconds = float(base.time[-1] - base.time[0]) / 1e9
    travel = base.position[-1, :2] - base.position[0, :2]
    if speed < SLOWEST_MPS or apart > ALIKE * speed or np.hypot(*travel) > RESTS * speed * seconds:
        return None
    order = np.argsort(time, kind="stable")
    order = order[[0, *range(len(order)), -1]]
    time = np.concatenate([base.time[:1], time[order[1:-1]], base.time[-1:]])
    steps = np.maximum(np.diff(time), 0) / 1e9
    return MovingGround(time, trapezoids(steps, velocity[order]), speed)


CLEARLY: Final = 2.0
"""Times by which one direction exceeds the other where the forward axis is clear."""


def with_forward_axis(
    settings: WalkSettings, base: BaseHistory, feet: Sequence[FootHistory]
) -> WalkSettings:
    """Let the fore and hind feet's contact points correct a guessed forward axis.

    Args:
        settings: with the forward axis of the robot.
        base: poses, in one world with the contact points.
        feet: histories of all feet.
    """
    places = usual_places(base, feet, [foot.leg_position for foot in settings.feet])
    front, back = ([places[p] for p in places if p[0] == end] for end in ("front", "back"))
    if not (settings.forward_axis_is_assumed and front and back):
        return settings
    ahead = np.mean(front, axis=0) - np.mean(back, axis=0)
    aside_m, ahead_m = np.sort(np.abs(ahead))
    if ahead_m <= CLEARLY * aside_m:
        return settings
    along = int(np.abs(ahead).argmax())
    measured = f"{'+' if ahead[along] > 0.0 else '-'}{'xy'[along]}"
    if measured == settings.forward_axis:
        return replace(settings, forward_axis_is_assumed=False)
    because = "the fore feet are on that side of the hind feet"
    reason = f"{settings.forward_axis} of the guessed robot is not forward here: {because}"
    return replace(settings, forward_axis=measured, forward_axis_reason=reason)


def usual_places(
    base: BaseHistory, feet: Sequence[FootHistory], positions: Sequence[LegPosition | None]
) -> dict[LegPosition, Floats]:
    """Return the mean of each foot's contact points, (2,) m along the body's x and y."""
    seen = [seen_from_base(foot, base)[1] for foot in feet]
    return {
        position: place.mean(axis=0)
        for place, position in zip(seen, positions, strict=True)
        if position is not None and len(place)
    }
