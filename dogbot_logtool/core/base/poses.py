"""Poses of the base: as recorded, as a history at up to 100 Hz, and without jumps."""

from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    header_time,
    interpolated,
    median_of,
    median_of_known,
    middles,
    picked,
)
from dogbot_logtool.core.clock import TimeSource, first_at_each_tick, rows_in_time
from dogbot_logtool.core.quality import steady_gap_ns
from dogbot_logtool.core.rotations import (
    along_heading,
    from_roll_pitch_yaw,
    normalised,
    roll_pitch_yaw,
    rotate,
)
from dogbot_logtool.core.settings import GRAVITY_MPS2


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Odometry:
    """Messages that give the pose of the robot's base, in the order of the log."""

    log_time: Ints
    """(n,) ns, when each was recorded."""
    stamp: Ints
    """(n,) ns, header stamp as recorded; 0 where the source never set one."""
    position: Floats
    """(n, 3) m, base origin in the world frame."""
    orientation: Floats
    """(n, 4) quaternion x, y, z, w, base in the world frame, as recorded (any norm)."""
    linear_velocity: Floats
    """(n, 3) m/s. World or body frame: sources differ, so never trust it blindly."""

    @property
    def time(self) -> Ints:
        """(n,) ns, header stamp, or log time where the stamp is zero."""
        return header_time(self.stamp, self.log_time)

    def pick(self, rows: Flags | Ints) -> "Odometry":
        """Return the chosen rows (a mask or row numbers)."""
        return picked(self, rows)


def no_odometry() -> Odometry:
    """Return none."""
    times: Ints = np.empty(0, np.int64)
    vectors, quaternions = np.empty((0, 3)), np.empty((0, 4))
    return Odometry(times, times, vectors, quaternions, vectors)


def scaled(odometry: Odometry, metres: float) -> Odometry:
    """Return poses whose unit of length is so many metres, in metres."""
    position, velocity = odometry.position * metres, odometry.linear_velocity * metres
    return replace(odometry, position=position, linear_velocity=velocity)


def usable_poses(odometry: Odometry) -> Flags:
    """Tell which poses can be a transform: all numbers finite and the quaternion not zero.

    Returns:
        (n,) bool.
    """
    finite = all_finite(odometry.position) & all_finite(odometry.orientation)
    return np.asarray(finite & (odometry.orientation != 0.0).any(axis=1))


POSE_RATE_HZ: Final = 100.0
"""Interpolation between poses 10 ms apart misses 0.1 mm at 10 m/s^2; an hour of them is 20 MB."""
LOOKUP_S: Final = 0.1
"""A pose further from a time than this does not tell where the base was."""
SLOWEST_S: Final = 0.5
"""The same of poses that are so rare."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BaseHistory:
    """Poses of the base at up to 100 Hz."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Floats
    """(n, 3) m, world frame."""
    angles: Floats
    """(n, 3) rad, roll, pitch, yaw; yaw unwrapped."""
    gaps: Ints = field(default_factory=timespans.no_spans)
    """(g, 2) ns, silences: last pose before, first one after."""
    messages: int = 0
    """Recorded ones; of poses that are worked out, none."""
    not_usable: int = 0
    """Messages with a number that is not finite or a zero quaternion; left out."""
    not_advancing: int = 0
    """Messages that repeat a time or step back; left out."""
    velocity: Floats = field(default_factory=lambda: np.empty((0, 3)))
    """(n, 3) m/s, the twist beside each pose, in the world or the body; empty: there is none."""
    repeated: int = 0
    """Messages that repeat the pose before while the base moves; left out."""
    interval_s: float = 0.0
    """s, the usual time between two poses; 0: as often as they are kept."""

    @property
    def known(self) -> Ints:
        """(k, 2) ns, the time between first and last pose without the gaps."""
        if len(self.time) == 0:
            return timespans.no_spans()
        return timespans.subtract(self.time[[0, -1]][None, :], self.gaps)

    @property
    def _reach_ns(self) -> float:
        """How far a pose tells of, ns: further where poses are rare."""
        return max(LOOKUP_S, min(self.interval_s, SLOWEST_S)) * 1e9

    def pick(self, rows: Ints) -> "BaseHistory":
        """Return the poses of some rows, ascending; where others lay between are gaps."""
        time = self.time[rows]
        silent = np.isin(time[:-1], self.gaps[:, 0]) | (np.diff(rows) > 1)
        return replace(
            self,
            time=time,
            position=self.position[rows],
            angles=self.angles[rows],
            velocity=self.velocity[rows],
            gaps=timespans.steps_where(time, silent),
        )

    def without_poses(self) -> "BaseHistory":
        """Return the history of poses of which none can be used."""
        return self.pick(np.empty(0, np.int64))

    def steps(self, forward_rad: float) -> Floats:
        """(3, n - 1) m ahead and to the left, and rad turned, from each pose to the next.

        Args:
            forward_rad: from the body's x axis to the axis that points forward.
        """
        yaw = self.angles[:, 2]
        heading = middles(yaw) + forward_rad
        displacement = along_heading(np.diff(self.position[:, :2], axis=0), heading)
        return np.stack([*displacement.T, np.diff(yaw)])

    def position_at(self, time: Ints) -> Floats:
        """Interpolate the position linearly between poses.

        Args:
            time: (n,) ns.

        Returns:
            (n, 3) m, NaN in gaps, and before and after the poses.
        """
        return self._interpolated(time, self.position)

    def point_at(self, time: Ints, in_body_m: Floats) -> Floats:
        """Return where a point of the body is; (n, 3) m, NaN like `position_at`.

        Args:
            time: (n,) ns.
            in_body_m: (n, 3) m, or (3,), from the base's frame, in its axes.
        """
        position = self.position_at(time)
        if not in_body_m.any():
            return position
        turn = from_roll_pitch_yaw(self.angles_at(time))
        return position + rotate(turn, np.broadcast_to(in_body_m, position.shape))

    def angles_at(self, time: Ints) -> Floats:
        """Interpolate roll, pitch and unwrapped yaw; (n, 3) rad, NaN like `position_at`."""
        return self._interpolated(time, self.angles)

    def yaw_at(self, time: Ints) -> Floats:
        """Interpolate the unwrapped yaw; (n,) rad, NaN like `position_at`."""
        return self._interpolated(time, self.angles[:, 2:])[:, 0]

    def _interpolated(self, time: Ints, values: Floats) -> Floats:
        if len(self.time) == 0:
            return np.full((len(time), values.shape[1]), np.nan)
        at = interpolated(time, self.time, values)
        after = np.minimum(np.searchsorted(self.time, time), len(self.time) - 1)
        before = np.where(self.time[after] > time, np.maximum(after - 1, 0), after)
        # Both poses around a time must be near; beyond the ends there is only one.
        away = np.maximum(np.abs(time - self.time[before]), np.abs(self.time[after] - time))
        at[away > self._reach_ns] = np.nan
        return at

    def unplaced(self, spans: Ints) -> int:
        """Return the time in spans, ns, that lies further than 0.1 s from every pose."""
        reach = round(self._reach_ns)
        placed = timespans.merge(self.known + np.array([-reach, reach]))
        return timespans.total(timespans.subtract(spans, placed))


def base_history(odometry: Odometry, clock: TimeSource, breaks: Ints | None = None) -> BaseHistory:
    """Return the poses of a log.

    Args:
        odometry: in the order of the log.
        clock: which time counts; on header stamps zeros are unknown times.
        breaks: (b, 2) ns, spans that nothing is measured across, as if they were gaps.
    """
    time, usable = clock.of(odometry), usable_poses(odometry)
    in_time = rows = rows_in_time(odometry, clock, usable)
    fresh = _distinct(odometry, rows)
    rows = rows[fresh]
    longest = steady_gap_ns(np.diff(time[rows]))
    kept = odometry.pick(rows[first_at_each_tick(time[rows], POSE_RATE_HZ)])
    time = clock.of(kept)
    angles = roll_pitch_yaw(normalised(kept.orientation))
    angles[:, 2] = np.unwrap(angles[:, 2])
    broken = np.diff(time) > longest
    if breaks is not None:
        broken |= timespans.touches(breaks, time[:-1], time[1:])
    return BaseHistory(
        messages=len(usable),
        not_usable=int((~usable).sum()),
        not_advancing=int(usable.sum()) - len(in_time),
        time=time,
        position=kept.position,
        angles=angles,
        gaps=timespans.steps_where(time, broken),
        velocity=kept.linear_velocity,
        repeated=int((~fresh).sum()),
        interval_s=float(median_of(np.diff(time))) / 1e9 if len(time) > 1 else 0.0,
    )


FEWEST_DISTINCT: Final = 5
"""Changes of the pose from which it is told how often a topic repeats one."""


def _distinct(odometry: Odometry, rows: Ints) -> Flags:
    """Tell which messages tell a pose anew, where a topic sends each pose several times.

    Args:
        odometry: messages.
        rows: (n,) those that can be used.

    Returns:
        (n,) all, where poses change from message to message. Of a pose that lasts, as that of a
        robot that stands, some are kept, so that it is no gap.
    """
    fresh = np.ones(len(rows), np.bool_)
    same = (np.diff(odometry.position[rows], axis=0) == 0.0).all(axis=1)
    if same.any():
        same &= (np.diff(odometry.orientation[rows], axis=0) == 0.0).all(axis=1)
    first = np.flatnonzero(np.concatenate([[True], ~same]))
    length = np.diff(first, append=len(rows))
    if len(first) > FEWEST_DISTINCT and (usual := int(median_of(length[1:-1]))) > 1:
        since = np.arange(len(rows)) - np.repeat(first, length)
        fresh = since % (2 * usual) == 0
    return fresh


SMALLEST_JUMP_M: Final = 0.05
"""m, what is smaller may be noise."""
SMALLEST_TURN_RAD: Final = 0.02
"""rad, the same."""
FALLS_AT_MPS: Final = 3.0
"""m/s, a falling base is not faster."""
COARSE_M: Final = 0.5
"""m, smallest jump at rates so low that the base may change its speed between poses."""
SMALLEST_STEP_RAD: Final = np.radians(5.0)
"""rad, a turn without a step of the position is one from here on."""
COURSE_STEPS: Final = 30
"""Poses before and after a jump between which the course is told."""
COURSE_M: Final = 0.02
"""m, the shortest way that tells a course."""
UNUSUAL: Final = 5.0
"""Times by which a jump exceeds the third largest of the deviations around it."""
_AROUND: Final = np.concatenate([np.arange(-10, 0), np.arange(1, 11)])
"""Steps before and after that tell the base's own speed."""
_FEWEST: Final = 6
_CHUNK: Final = 20_000


class PoseJumps(NamedTuple):
    """Steps between neighbouring poses that are no motion of the base."""

    rows: Ints
    """(j,) the pose before each jump."""
    spans: Ints
    """(j, 2) ns, the pose before and the one after each jump."""
    size_m: Floats
    """(j, 3) m, the step less what the base's own speed explains."""
    turn_rad: Floats
    """(j,) rad, by how much the yaw jumps, too."""


def find_jumps(base: BaseHistory) -> PoseJumps:
    """Find the steps that the median of the velocities around them does not explain.

    A step counts that deviates from it by more than the other steps around do, more than a fall
    explains, and more than a change of speed between two poses may be; a turn, by more than the
    other turns around do.
    """
    seconds = np.diff(base.time) / 1e9
    change = np.minimum(GRAVITY_MPS2 * seconds**2 / 2.0, COARSE_M)
    size = _jumps(base, np.diff(base.position, axis=0), SMALLEST_JUMP_M, change)
    turn = _jumps(base, np.diff(base.angles[:, 2:], axis=0), SMALLEST_TURN_RAD, 0.0 * change)[:, 0]
    found = size.any(axis=1) | (np.abs(turn) > SMALLEST_STEP_RAD)
    spans = timespans.steps_where(base.time, found)
    return PoseJumps(np.flatnonzero(found), spans, size[found], turn[found])


def _jumps(base: BaseHistory, step: Floats, smallest: float, change: Floats) -> Floats:
    """Return the part of each step that is a jump.

    Args:
        base: n + 1 poses.
        step: (n, k) from each pose to the next; a third column points upwards.
        smallest: what smaller steps are none.
        change: (n,) by which the base may change its step itself.

    Returns:
        (n, k) what the usual velocity around does not explain; zeros of steps that are no jumps.
    """
    in_gap, seconds = np.isin(base.time[:-1], base.gaps[:, 0]), np.diff(base.time) / 1e9
    found = np.zeros_like(step)
    far = np.flatnonzero((np.linalg.norm(step, axis=1) > smallest) & ~in_gap)
    for chunk in np.split(far, range(_CHUNK, len(far), _CHUNK)):
        around = chunk[:, None] + _AROUND
        outside = (around < 0) | (around >= len(step))
        around = np.clip(around, 0, len(step) - 1)
        velocity = step[around] / seconds[around][:, :, None]
        velocity[outside | in_gap[around]] = np.nan
        known = np.isfinite(velocity[:, :, 0]).sum(axis=1) >= _FEWEST
        rows, velocity = chunk[known], velocity[known]
        usual, duration = median_of_known(velocity, axis=1), seconds[rows][:, None]
        unusual = step[rows] - usual * duration
        deviation = np.nan_to_num(np.linalg.norm(velocity - usual[:, None], axis=2)) * duration
        limit = UNUSUAL * np.sort(deviation, axis=1)[:, -3]
        limit = np.maximum(np.maximum(smallest, change[rows]), limit)
        # What falls goes down by itself.
        jump, down = unusual.copy(), unusual[:, 2:]
        sinks = np.minimum(down + FALLS_AT_MPS * duration, 0.0)
        jump[:, 2:] = np.where(down < 0.0, sinks, down)
        found[rows] = np.where((np.linalg.norm(jump, axis=1) > limit)[:, None], unusual, 0.0)
    return found


def without_jumps(base: BaseHistory, jumps: PoseJumps) -> BaseHistory:
    """Return the poses with the jumps taken out: the motion that the base made itself.

    Where the course turns with the yaw, the world was turned: what comes after is turned back.
    """
    if len(jumps.rows) == 0:
        return base
    turns = np.where(_follows(base, jumps), jumps.turn_rad, 0.0)
    turned = np.concatenate([[0.0], np.cumsum(turns)])
    after = base.position[jumps.rows + 1]
    moves = along_heading(after - jumps.size_m, turned[:-1]) - along_heading(after, turned[1:])
    moved = np.concatenate([np.zeros((1, 3)), np.cumsum(moves, axis=0)])
    passed = np.searchsorted(jumps.rows, np.arange(len(base.time)) - 1, side="right")
    angles = base.angles.copy()
    angles[:, 2] -= np.concatenate([[0.0], np.cumsum(jumps.turn_rad)])[passed]
    position = along_heading(base.position, turned[passed]) + moved[passed]
    return replace(base, position=position, angles=angles)


def _follows(base: BaseHistory, jumps: PoseJumps) -> Flags:
    """(j,) whether the course turns with the yaw, or is not known."""
    rows, last = jumps.rows, len(base.time) - 1
    start = np.maximum(rows - COURSE_STEPS, np.concatenate([[0], rows[:-1] + 1]))
    end = np.minimum(rows + 1 + COURSE_STEPS, np.concatenate([rows[1:], [last]]))
    place = base.position[:, 0] + 1j * base.position[:, 1]
    before, after = place[rows] - place[start], place[end] - place[rows + 1]
    far = np.minimum(np.abs(before), np.abs(after)) > COURSE_M
    course = after * before.conj()
    off = np.abs(np.angle(course * np.exp(-1j * jumps.turn_rad)))
    return np.asarray(~far | (off < np.abs(np.angle(course))))
