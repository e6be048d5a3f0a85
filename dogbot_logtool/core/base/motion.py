"""How the base moved and fell: path, speed, height, attitude. From poses, never from the twist."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    aggregate,
    flagged_runs,
    median_of,
    percentiles_of,
)
from dogbot_logtool.core.base.ground import LOWEST_M, Footfalls, slope_rad
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.settings import GRAVITY_MPS2

AWAY_M: Final = 0.05
"""m, a base that does not get so far away goes nowhere: it stands, and sways."""
_LARGEST_NOISE: Final = 5.0
"""Times its standard deviation that noise may move a pose."""
_PACE_PERCENT: Final = 75.0
"""Quantile of the ways in a second that is the base's usual pace."""
_NEGLIGIBLE: Final = 0.005
"""Share by which noise may lengthen the path."""
_NORMAL_MEDIAN: Final = 0.6745
"""Median of |x| of a normal distribution, in standard deviations."""
_FEWEST_POSES: Final = 20
"""From which noise is told."""


class BaseTrack(NamedTuple):
    """The poses that the base's motion is measured on."""

    history: BaseHistory
    """Poses without jumps."""
    height_m: Floats
    """(n,) over the feet, at each pose; NaN where not known."""
    stood: Sequence[Footfalls]
    """Where the feet stand."""
    travels: Ints
    """(t, 2) ns, time in which the base may go somewhere: it does not stand, and gets away."""
    block: int
    """Poses whose mean makes one point of the path."""

    def path_length_m(self, moves: Flags) -> float:
        """Return the length of the base's horizontal path through means of some poses each, m.

        Args:
            moves: (n - 1,) which steps between poses count.
        """
        time, position = self.history.time, self.history.position[:, :2]
        runs = flagged_runs(moves & timespans.covers(self.travels, time[:-1]))
        return sum(self._path_length(position[start : end + 1]) for start, end in runs.tolist())

    def _path_length(self, path: Floats) -> float:
        """Length of an unbroken path, m."""
        size = min(self.block, max(1, len(path) // 4))
        blocks = len(path) // size
        points = path[: blocks * size].reshape(blocks, size, 2).mean(axis=1)
        points = np.concatenate([path[:1], points, path[-1:]])
        return float(np.hypot(*np.diff(points, axis=0).T).sum())


def base_track(
    base: BaseHistory, height_m: Floats, stood: Sequence[Footfalls], standing: Ints
) -> BaseTrack:
    """Find when the base goes somewhere, and how many poses make a point of its path.

    Of so many the mean is taken that white noise lengthens the path by 0.5 % at most. Third
    differences tell it, which smooth motion hardly shows in; their median keeps jumps out. At most
    those of a second are averaged.
    """
    position, block, noise_m = base.position[:, :2], 1, 0.0
    if len(position) > _FEWEST_POSES:
        third = np.diff(position, n=3, axis=0)
        noise_m = float(median_of(np.abs(third))) / (_NORMAL_MEDIAN * np.sqrt(20.0))
    away_m = np.hypot(*(position - position[:1]).T).max(initial=0.0)
    goes = away_m >= AWAY_M + _LARGEST_NOISE * noise_m
    if goes and noise_m:
        a_second = 1e9 / float(median_of(np.diff(base.time)))
        apart = min(max(1, round(a_second)), len(position) - 1)
        moved_m = np.hypot(*(position[apart:] - position[:-apart]).T)
        step_m = max(float(percentiles_of(moved_m, _PACE_PERCENT)) / apart, noise_m * 1e-3)
        size = (2.0 * noise_m**2 / (_NEGLIGIBLE * step_m**2)) ** (1.0 / 3.0)
        block = int(np.clip(np.ceil(size), 1, max(1.0, a_second)))
    travels = timespans.subtract(base.known, standing) if goes else timespans.no_spans()
    return BaseTrack(base, height_m, stood, travels, block)


def base_motion(
    track: BaseTrack, forward_rad: float, within: Ints = timespans.ALWAYS
) -> Base | None:
    """Measure the motion of the base; None without two poses.

    Args:
        track: poses, and what the feet say of them.
        forward_rad: from the body's x axis to the axis that points forward.
        within: (w, 2) ns, a part of the log.
    """
    base = track.history
    inside = timespans.covers(within, base.time)
    rows = np.flatnonzero(inside)
    if len(rows) < 2:
        return None
    first, last = int(rows[0]), int(rows[-1])
    moves = inside[:-1] & inside[1:] & ~np.isin(base.time[:-1], base.gaps[:, 0])
    duration = float(np.diff(base.time)[moves].sum() / 1e9)
    travelled = (float(each[moves].sum()) for each in base.steps(forward_rad))
    forward_speed, left_speed, yaw_rate = (
        each / duration if duration > 0.0 else None for each in travelled
    )
    height = aggregate(track.height_m[rows])
    roll, pitch = roll_and_pitch(base.angles[rows], forward_rad)
    net = base.position[last] - base.position[first]
    return Base(
        duration_s=duration,
        path_length_m=track.path_length_m(moves),
        net_displacement_m=float(np.hypot(net[0], net[1])),
        forward_speed_mps=forward_speed,
        lateral_speed_mps=left_speed,
        yaw_change_rad=float(base.angles[last, 2] - base.angles[first, 2]),
        yaw_rate_radps=yaw_rate,
        height_m=height,
        climb_m=float(net[2]),
        slope_rad=slope_rad(track.stood, within),
        roll_rad=aggregate(roll),
        pitch_rad=aggregate(pitch),
        froude=froude_number(forward_speed, height.mean if height else None),
    )


def roll_and_pitch(angles: Floats, forward_rad: float) -> tuple[Floats, Floats]:
    """Return roll and pitch about the robot's own forward axis and the axis to its left.

    Args:
        angles: (n, 3) rad, roll, pitch, yaw of the body's x, y, z axes (REP-103).
        forward_rad: from the body's x axis to the axis that points forward.

    Returns:
        (n,) rad each.
    """
    roll, pitch = angles[:, 0], angles[:, 1]
    # Heights of the ends of the body's unit vectors.
    x, y, z = -np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)
    forward = np.cos(forward_rad) * x + np.sin(forward_rad) * y
    left = np.cos(forward_rad) * y - np.sin(forward_rad) * x
    return np.arctan2(left, z), -np.arcsin(np.clip(forward, -1.0, 1.0))


def froude_number(speed_mps: float | None, height_m: float | None) -> float | None:
    """Return v^2 / (g h); None without a speed, or a height over the ground."""
    if speed_mps is None or height_m is None or height_m < LOWEST_M:
        return None
    return speed_mps**2 / (GRAVITY_MPS2 * height_m)


TILT_RAD: Final = np.pi / 3.0
"""A base that leans further lies."""
UPRIGHT_RAD: Final = np.pi / 6.0
"""A base that leans less may stand."""
LYING: Final = 0.4
"""A base below this share of its standing height over the feet lies, or sits."""
STANDING: Final = 0.8
"""A base above this share stands."""
SWAYS: Final = 0.95
"""A base below this share of its standing height is on its way down."""
SWAYS_RAD: Final = 0.1
"""rad more than its usual lean: the same."""
STANDING_PERCENT: Final = 90.0
"""Quantile of the height while feet are loaded that is the standing height."""
LASTING_NS: Final = 300_000_000
"""A fall lasts; a single wrong pose does not make one."""
SLOWEST_FALL: Final = 4.0
"""Times the duration of a free fall from which a descent is sitting down."""
SLOWEST_UPRIGHT_FALL: Final = 2.0
"""The same of a base that keeps upright: legs that give way all at once."""
LEANS_RAD: Final = 0.25
"""A base that leans less on its way down, and when it is down, keeps upright."""
TOPPLES_NS: Final = 3_000_000_000
"""From upright to lying on a side, at most; what is slower is laid down."""
LOADED_NS: Final = 500_000_000
"""Time before a fall in which a foot must be loaded: a robot that is carried does not fall."""


@np.errstate(invalid="ignore")
def fallen_spans(base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats) -> Ints:
    """Find the spans in which the robot lies because it fell.

    A fall is a descent from standing to lying, of a robot whose feet were loaded: as fast as a
    fall is where the height tells it, or over onto a side. Sitting down is slower; a robot that is
    lifted or carried has no loaded foot; one that lies from the beginning did not fall here.

    Args:
        base: poses.
        feet: histories of all feet.
        height_m: (n,) of the base over the feet, at each pose; NaN where not known.

    Returns:
        (f, 2) ns, from the beginning of the descent until it lies no more.
    """
    time, tilt = base.time, tilt_rad(base.angles)
    if len(time) < 2 or not (tilt < UPRIGHT_RAD).any():
        return timespans.no_spans()
    usual_m = _standing_height_m(base, feet, height_m)
    stands = _stands(tilt, height_m / usual_m)
    sways = (tilt >= median_of(tilt[tilt < UPRIGHT_RAD]) + SWAYS_RAD) | (height_m < SWAYS * usual_m)
    lies = (tilt > TILT_RAD) | (height_m < LYING * usual_m)
    free_fall_ns = 1e9 * np.sqrt(2.0 * (STANDING - LYING) * usual_m / GRAVITY_MPS2)
    falls = []
    for start, end in timespans.spans_where(time, lies[:-1]).tolist():
        row, settled = np.searchsorted(time, [start, start + LASTING_NS + 1]).tolist()
        stood = np.flatnonzero(stands[:row])
        if end - start < LASTING_NS or not len(stood):
            continue
        since, topples = int(time[stood[-1]]), tilt[row] > TILT_RAD
        leans = (tilt[stood[-1] : settled] > LEANS_RAD).any()
        slowest = SLOWEST_FALL if leans else SLOWEST_UPRIGHT_FALL
        # Of a height that is not known no descent is fast.
        is_fast = start - since <= (TOPPLES_NS if topples else slowest * free_fall_ns)
        if is_fast and _are_loaded(feet, since - LOADED_NS, start):
            steady = time[: stood[-1] + 1][~sways[: stood[-1] + 1]]
            began = int(steady[-1]) if len(steady) else since
            falls.append((began if since - began <= TOPPLES_NS else since, end))
    return timespans.merge(np.array(falls, np.int64).reshape(-1, 2))


def down_spans(base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats) -> Ints:
    """(k, 2) ns, spans in which the robot does not stand upright and high: it lies, or goes down.

    Args:
        base: poses.
        feet: histories of all feet.
        height_m: (n,) of the base over the feet, at each pose; NaN where not known.
    """
    if len(base.time) < 2:
        return timespans.no_spans()
    share = height_m / _standing_height_m(base, feet, height_m)
    return timespans.spans_where(base.time, ~_stands(tilt_rad(base.angles), share)[:-1])


def _stands(tilt: Floats, share: Floats) -> Flags:
    """(n,) whether it is upright, and as high over its feet as a robot that stands, if known."""
    return np.asarray((tilt < UPRIGHT_RAD) & ~(share < STANDING))


def tilt_rad(angles: Floats) -> Floats:
    """(n,) rad, angle of the body's z axis against the vertical."""
    up = np.cos(angles[:, 0]) * np.cos(angles[:, 1])
    return np.asarray(np.arccos(np.clip(up, -1.0, 1.0)))


def _standing_height_m(base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats) -> float:
    """Return the height at which the robot stands, high and with a loaded foot; NaN: not known."""
    loaded = timespans.merge(np.concatenate([timespans.no_spans(), *(f.in_contact for f in feet)]))
    known = height_m[timespans.covers(loaded, base.time) & np.isfinite(height_m)]
    return float(percentiles_of(known, STANDING_PERCENT)) if len(known) else np.nan


def _are_loaded(feet: Sequence[FootHistory], start: int, end: int) -> bool:
    """Tell whether a foot is loaded between two times, ns; yes where that is not known."""
    loaded = [foot.contact_fraction(np.array([[start, end]], np.int64)) for foot in feet]
    return any(loaded) or all(share is None for share in loaded)


LAST_S: Final = 2.0
"""s before the end in which tipping begins; what was before is usual."""
USUAL_S: Final = 2.0
"""s that must come before."""
BEYOND_RAD: Final = 0.1
"""rad beyond the usual range."""
RISING_S: Final = 0.3
"""s before the end in which the angle must grow."""
_RISES_RAD: Final = 0.02


class Tipping(NamedTuple):
    """A roll or pitch that leaves its usual range and does not return."""

    since: int
    """ns, when it leaves its usual range."""
    angle: str
    """``roll`` or ``pitch``."""
    last_rad: float
    """rad, at the end of the recording."""


def find_tipping(base: BaseHistory, forward_rad: float) -> Tipping | None:
    """Return how the robot tips at the end of the recording; None: it does not.

    An angle counts that leaves the range of all the time before, and is still growing at the end.
    """
    if len(base.time) < 3 or base.time[-1] - base.time[0] < (LAST_S + USUAL_S) * 1e9:
        return None
    angles = np.stack(roll_and_pitch(base.angles, forward_rad), axis=1)
    usual = angles[base.time < base.time[-1] - LAST_S * 1e9]
    beyond = np.maximum(angles - usual.max(axis=0), usual.min(axis=0) - angles)
    earlier = np.searchsorted(base.time, base.time[-1] - RISING_S * 1e9)
    tips = (beyond[-1] >= BEYOND_RAD) & (beyond[-1] - beyond[earlier] >= _RISES_RAD)
    if not tips.any():
        return None
    angle = int(np.where(tips, np.abs(angles[-1]), -1.0).argmax())
    first = np.flatnonzero(beyond[:, angle] <= 0.0)[-1] + 1
    return Tipping(int(base.time[first]), ("roll", "pitch")[angle], float(angles[-1, angle]))


STEEP_RAD: Final = np.radians(45.0)
"""No legged robot walks with its back so steep."""
FEWEST_STEPS: Final = 4
"""Touchdowns of a foot, while the base leans so far."""


def leaning_walk_rad(base: BaseHistory, feet: Sequence[FootHistory]) -> float | None:
    """Return how far the base leans at most while most feet walk on, rad.

    A robot that fell may move its legs for a while. One that takes most of its steps so has poses
    whose z axis is not up: those of motion capture with y up, say.

    Args:
        base: poses.
        feet: histories of all feet.

    Returns:
        None where it does not lean, or hardly any foot walks on.
    """
    if not len(base.time):
        return None
    tilt = tilt_rad(base.angles)
    steep = timespans.spans_where(base.time, tilt[:-1] > STEEP_RAD)
    if not len(steep):
        return None
    down = [foot.stances.touchdown for foot in feet if len(foot.stances.touchdown)]
    leaning = [int(timespans.covers(steep, each).sum()) for each in down]
    walking = [n >= max(FEWEST_STEPS, len(each) / 2) for n, each in zip(leaning, down, strict=True)]
    return float(tilt.max()) if 2 * sum(walking) > len(walking) else None
