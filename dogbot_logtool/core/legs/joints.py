"""Legs and their joints: where they are told of, and what is measured of each joint."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Float32s,
    Floats,
    Integral,
    Ints,
    median_of,
    middles,
    picked,
)
from dogbot_logtool.core.base.ground import (
    LONGEST_STEP_S,
    Footfalls,
    FootPath,
    without_silences,
)
from dogbot_logtool.core.clock import (
    ClockDifference,
    TimeSource,
    first_at_each_tick,
    rows_in_time,
)
from dogbot_logtool.core.frames import kinematics
from dogbot_logtool.core.frames.transforms import FrameTrack
from dogbot_logtool.core.gait.feet import CYCLE, cycle_curve
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.metrics import Joint, Legs
from dogbot_logtool.core.recording import JointSamples, JointTable
from dogbot_logtool.core.records import Shape

NEAR_LIMIT: Final = 0.02
"""Share of a joint's range: closer to an end than this is near a limit."""
NEAR_FULL: Final = 0.95
"""Share of the highest effort or speed by the robot description: more is near a limit."""
LEAST_WRAP: Final = 1.5 * np.pi
"""rad between two messages: no joint is so fast, so it wraps at +-pi."""
_IMPLAUSIBLE: Final = 1e9
"""rad, rad/s and N m: no joint reaches it."""


class JointLimits(NamedTuple):
    """Limits of a joint by the robot's description; infinite where there are none."""

    lower: float = -np.inf
    """rad or m; also `upper`."""
    upper: float = np.inf
    effort: float = np.inf
    """N m or N."""
    velocity: float = np.inf
    """rad/s or m/s."""


class LegChain(NamedTuple):
    """How a foot hangs on the base."""

    frames: tuple[str, ...]
    """From the foot's frame up to the child of the base, without leading slashes."""
    base: str
    point: tuple[float, float, float]
    """m, where the foot touches the ground, in its frame, as contacts or the robot's file tell;
    else the origin, perhaps the middle of a ball."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LegSettings:
    """Sources of a log's legs."""

    chains: tuple[LegChain | None, ...]
    """How each foot hangs on the base; None: not known."""
    joints: tuple[kinematics.Joint, ...] = ()
    """Of a robot description, which place the frames of all chains; empty: transforms do."""
    foot_of_joint: Mapping[str, int] = field(default_factory=dict)
    """Index of the foot that a joint moves, by the joint's name."""
    pairs: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """Joints that are alike, left and right, by a name for both."""
    limits: Mapping[str, JointLimits] = field(default_factory=dict)
    """Limits by the robot description, by the joint's name."""
    lacking: tuple[str, ...] = ()
    """Joints of legs that the robot description has and joint states leave out."""


class JointTrack(NamedTuple):
    """What is measured of a joint over a log, of n usable messages."""

    name: str
    time: Ints
    """(n,) ns, strictly increasing; also `log_time`, when they were recorded."""
    log_time: Ints
    position: Float32s
    """(n,) rad or m; goes on where the recorded one wraps."""
    work: Float32s
    """(2, n) J, positive and absolute work since the row before; NaN where a silence or an unknown
    effort lies between."""
    metrics: Joint
    """Over the whole log; the foot and the gait cycle are not known yet."""
    rate_hz: float
    """Messages over the time without silences."""
    reported_squared: float
    """Sum of v^2 dt, with v the velocity that messages tell; 0: they tell none."""
    reported_moved: float
    """Sum of v dq: what `reported_squared` is where velocities are those of the positions."""
    foot: int | None
    """Index of the foot that it moves; None: it moves none."""
    follows: bool
    """Whether the robot's description says that another joint moves it."""

    @property
    def range(self) -> float:
        """Highest less lowest position, rad or m."""
        return self.metrics.range_of_motion or 0.0

    @property
    def has_effort(self) -> bool:
        """Whether its effort is told: not zero, and not constant while it moves."""
        return self.metrics.peak_effort is not None

    @property
    def moves(self) -> bool:
        """Whether its position ever changes."""
        return self.range > 0.0

    @property
    def works(self) -> bool:
        """Whether it moves, and not just as another one that moves it."""
        return self.moves and (self.has_effort or not self.follows)


def joint_tracks(
    tables: Sequence[JointTable], clock: TimeSource, settings: LegSettings
) -> dict[str, JointTrack]:
    """Measure the joints of a log, by name.

    Args:
        tables: joint states, one table a topic, the best first: its states of a joint are used.
        clock: which time counts.
        settings: which feet joints move, and their limits.
    """
    found: dict[str, JointTrack] = {}
    for table in tables:
        samples = table.samples
        used: dict[bytes, Ints] = {}
        """Rows by the messages that have states: those of most joints are the same."""
        for column, name in enumerate(table.names):
            recorded = np.abs(samples.position[:, column]) <= _IMPLAUSIBLE
            key = recorded.tobytes()
            if key not in used:
                used[key] = rows_in_time(samples, clock, recorded)
            if len(used[key]) and name not in found:
                own = picked(table.of([name]), used[key])
                found[name] = _track(name, own, clock, settings)
    return dict(sorted(found.items()))


def _track(name: str, states: JointSamples, clock: TimeSource, settings: LegSettings) -> JointTrack:
    """Measure a joint.

    Power is effort times velocity, by the trapezoidal rule. Without velocities, or with none but
    zeros, work is the mean effort times the step between two positions.

    Args:
        name: of the joint.
        states: (n,) of this joint only.
        clock: which time counts.
        settings: with the limits of joints.
    """
    time, limits = clock.of(states), settings.limits.get(name, JointLimits())
    step_s = np.diff(time) / 1e9
    step_s[step_s > LONGEST_STEP_S] = np.nan
    values = np.stack([states.position, states.velocity, states.effort])[:, :, 0].astype(np.float64)
    position, velocity, effort = np.where(np.abs(values) <= _IMPLAUSIBLE, values, np.nan)
    position = np.unwrap(position, LEAST_WRAP)
    displacement, known_s = np.diff(position), float(np.nansum(step_s))
    moves = bool(displacement.any())
    if (np.isfinite(velocity) & (velocity != 0.0)).any():
        power = effort * velocity
        positive = middles(np.maximum(power, 0.0)) * step_s
        absolute = middles(np.abs(power)) * step_s
        speed = np.abs(velocity[1:])
    else:
        work = middles(effort) * displacement + 0.0 * step_s
        positive, absolute = work.clip(0.0), np.abs(work)
        speed = np.abs(displacement / step_s)
    middle, squared = middles(velocity), middles(effort**2) * step_s
    near_s = float(np.nansum(step_s[_near_limit(limits, position[1:], effort[1:], speed)]))
    lowest, highest = float(np.fmin.reduce(effort)), float(np.fmax.reduce(effort))
    has_effort = lowest < highest or (lowest == highest != 0.0 and not moves)
    effort_s = float(step_s[np.isfinite(squared)].sum())
    rms = np.sqrt(np.nansum(squared) / effort_s) if has_effort and effort_s > 0.0 else None
    # A joint that never moves does no work, whatever noise its velocity has.
    works = np.stack([positive, absolute]) if moves else np.zeros((2, len(displacement)))
    return JointTrack(
        name=name,
        time=time,
        log_time=states.log_time,
        position=position.astype(np.float32),
        work=np.concatenate([np.zeros((2, 1)), works], axis=1).astype(np.float32),
        metrics=Joint(
            foot=None,
            range_of_motion=float(position.max() - position.min()),
            peak_speed=float(np.fmax.reduce(speed, initial=0.0)),
            peak_effort=max(abs(lowest), abs(highest)) if has_effort else None,
            rms_effort=None if rms is None else float(rms),
            absolute_work_j=float(np.nansum(absolute)) if has_effort else None,
            near_limit_fraction=min(near_s / known_s, 1.0)
            if limits != JointLimits() and known_s
            else None,
            position_over_stride=None,
        ),
        rate_hz=len(time) / max(known_s, 1e-9),
        reported_squared=float(np.nansum(middle**2 * step_s)),
        reported_moved=float(np.nansum(middle * displacement + 0.0 * step_s)),
        foot=settings.foot_of_joint.get(name),
        follows=any(each.source for each in settings.joints if each.name == name),
    )


def _near_limit(limits: JointLimits, position: Floats, effort: Floats, speed: Floats) -> Flags:
    """(n,) which rows are near a limit that is known."""
    margin = NEAR_LIMIT * (limits.upper - limits.lower)
    margin = margin if np.isfinite(margin) else 0.0
    near: Flags = (position < limits.lower + margin) | (position > limits.upper - margin)
    near |= np.abs(effort) > NEAR_FULL * limits.effort
    near |= speed > NEAR_FULL * limits.velocity
    return near


JOINT_RATE_HZ: Final = 100.0


def link_tracks(
    joints: Sequence[kinematics.Joint], tracks: Mapping[str, JointTrack]
) -> dict[str, FrameTrack]:
    """Return the links that joints move, `JOINT_RATE_HZ` times a second, and those that rest.

    Args:
        joints: of a robot description; those that nothing tells are left out.
        tracks: by name.
    """
    links: dict[str, FrameTrack] = {}
    start = np.zeros(1, np.int64)
    for joint in joints:
        position, times, moves = np.zeros(1), (start, start), False
        if joint.kind != "fixed":
            track = tracks.get(joint.measured)
            if track is None:
                continue
            # A joint that never moves is where it is, in its silences, too.
            moves = track.moves
            rows = np.flatnonzero(first_at_each_tick(track.time, JOINT_RATE_HZ)) if moves else [0]
            position = track.position[rows].astype(np.float64)
            times = track.time[rows], track.log_time[rows]
        shift, turn = kinematics.link_poses([joint], position[:, None])
        links[joint.child] = FrameTrack(joint.parent, not moves, *times, shift[:, 0], turn[:, 0])
    return links


class LegFoot(NamedTuple):
    """The leg of a foot."""

    name: str
    reason: str
    """Why its swings are not known; empty where they are."""
    path: FootPath | None
    """Of the foot in the base's frame; None: not known."""
    swings: Mapping[str, Floats]
    """(strides,) each, by the name of the metric; empty: not known."""
    moves: bool = False
    """The reason is that the frame is not at rest in stances."""
    stood: Footfalls | None = None
    """Where it stands, by its frame; None: not known."""
    height: Shape = None
    """m above the line between the footfalls, over the stride."""
    is_slow: bool = False
    """Whether the foot is told too rarely for velocities."""


class LegFigures(NamedTuple):
    """What is known of all legs, whether or not the log gives reasons to doubt it."""

    settings: LegSettings
    feet: tuple[LegFoot, ...]
    joints: Mapping[str, JointTrack]
    """Each joint, by its name."""
    links: Mapping[str, FrameTrack]
    """The links that joints move, and those that rest on them."""
    work: Floats
    """(2, strides) J, positive and absolute work of all joints in strides of the reference foot."""
    metrics: Legs
    clocks_apart: Mapping[str, ClockDifference]
    """Topics of joint states whose clock is too far from that of the feet."""

    @property
    def moving(self) -> list[JointTrack]:
        """Joints that motors move."""
        return [joint for joint in self.joints.values() if joint.works]


def joint_work(joint: JointTrack, begin: Ints, end: Ints) -> Floats:
    """(2, m) J, positive and absolute work of a joint in some spans, (m,) ns each.

    A span with a silence of the joint's states, or with an effort that is not known, has none:
    NaN.
    """
    totals = np.nancumsum(joint.work, axis=1, dtype=np.float64)
    done = Integral(joint.time, totals.T).added(begin, end).T
    told = timespans.spans_where(joint.time, np.isfinite(joint.work[0, 1:]))
    known = timespans.hold_window(told, begin, 0, end - begin)
    work: Floats = np.where(known, done, np.nan)
    return work


def summed_work(joints: Sequence[JointTrack], strides: Strides) -> Floats:
    """(2, strides) J, positive and absolute work of several joints; NaN of none."""
    if not joints:
        return np.full((2, len(strides.end)), np.nan)
    works = [joint_work(joint, strides.touchdown, strides.end) for joint in joints]
    return np.asarray(np.sum(works, axis=0))


def joint_curve(joint: JointTrack, strides: Strides) -> tuple[Shape, float] | None:
    """Return the usual motion of a joint over whole strides; None where none is known.

    Returns:
        Its position over the gait cycle, and the median range of motion in a stride, rad or m.
    """
    start, period = strides.touchdown, strides.end - strides.touchdown
    whole = timespans.hold_window(without_silences(joint.time), start, 0, period)
    if not joint.moves or not whole.any():
        return None
    time = (start[whole] - joint.time[0])[:, None] + period[whole, None] * CYCLE
    since = (joint.time - joint.time[0]).astype(np.float64)
    position = np.interp(time, since, joint.position.astype(np.float64))
    return cycle_curve(position), float(median_of(np.ptp(position, axis=1)))
