"""How feet hang on the base, and the path of each: in the base's frame, and in the world.

A path comes from transforms, or from joints with their robot description, at a low rate. A
swing is a foot's way in the world, above the line between its footfalls.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of
from dogbot_logtool.core.base.foot_path import Footfalls, FootPath, known_path
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.frames.kinematics import Joint, link_poses
from dogbot_logtool.core.frames.transforms import FrameTrack, frame_track, lookup
from dogbot_logtool.core.gait.feet import CYCLE, cycle_curve
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.joints import JointLimits, JointTrack
from dogbot_logtool.core.records import Shape
from dogbot_logtool.core.rotations import rotate

TRANSFORM_RATE_HZ: Final = 200.0
JOINT_RATE_HZ: Final = 100.0
SLOWEST_NS: Final = 11_000_000
"""ns: a foot that is told less often has no velocity at touchdown."""


class LegChain(NamedTuple):
    """How a foot hangs on the base."""

    frames: tuple[str, ...]
    """From the foot's frame up to the child of the base, without leading slashes."""
    base: str
    point: tuple[float, float, float]
    """m, of the foot, in its frame."""
    touches: bool
    """Whether the point is where the foot touches the ground, as contacts or the robot's file tell;
    else it is the frame's origin, perhaps the middle of a ball."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LegSettings:
    """Sources of a log's legs."""

    chains: tuple[LegChain | None, ...]
    """How each foot hangs on the base; None: not known."""
    reasons: tuple[str, ...]
    """Why a foot has no chain; empty where it has one."""
    joints: tuple[Joint, ...] = ()
    """Of a robot description, which place the frames of all chains; empty: transforms do."""
    joint_topics: tuple[str, ...] = ()
    """Topics of joint states; the best first, whose states of a joint count."""
    foot_of_joint: Mapping[str, int] = field(default_factory=dict)
    """Index of the foot that a joint moves, by the joint's name."""
    pairs: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """Joints that are alike, left and right, by a name for both."""
    limits: Mapping[str, JointLimits] = field(default_factory=dict)
    """Limits by the robot description, by the joint's name."""
    lacking: tuple[str, ...] = ()
    """Joints of legs that the robot description has and joint states leave out."""


def link_tracks(joints: Sequence[Joint], tracks: Mapping[str, JointTrack]) -> dict[str, FrameTrack]:
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
        shift, turn = link_poses([joint], position[:, None])
        found = frame_track(joint.parent, *times, shift[:, 0], turn[:, 0], static=not moves)
        links |= {joint.child: found} if found else {}
    return links


def foot_path(chain: LegChain | None, frames: Mapping[str, FrameTrack]) -> FootPath | None:
    """Return the path of a foot in the base's frame; None where too little is known.

    Args:
        chain: of the foot.
        frames: by transforms and joints.
    """
    if chain is None or not frames.keys() >= set(chain.frames):
        return None
    moving = [frame for frame in chain.frames if not frames[frame].static]
    if not moving:
        return None
    last = frames[moving[0]]
    rows = first_at_each_tick(last.time, TRANSFORM_RATE_HZ)
    time, log_time = last.time[rows], last.log_time[rows]
    poses = lookup(frames, chain.frames[0], chain.base, time, log_time)
    position = poses.translation + rotate(poses.rotation, np.array([chain.point]))
    position[~poses.known] = np.nan
    return known_path(time, position.astype(np.float32)) if poses.known.any() else None


APPROACH: Final = np.linspace(-0.03, 0.0, 4)
"""s before a touchdown at which the foot's places tell its velocity."""
SHORTEST_STEP_M: Final = 0.05
"""m: a shorter swing does not tell the direction of walking."""
SWINGS: Final = ("clearance_m", "swing_length_m", "touchdown_down_mps", "touchdown_along_mps")
STEPS: Final = ("step_length_m", "step_width_m")


def swings(
    path: FootPath, stood: Footfalls, strides: Strides, contact_interval_s: float
) -> tuple[dict[str, Floats], Shape]:
    """Measure a foot's swings.

    Args:
        path: of the foot in the world.
        stood: its footfalls, by stance.
        strides: of the foot, whose stances have one after them.
        contact_interval_s: s between its contact samples: touchdowns may be so much earlier.

    Returns:
        (strides,) each of `SWINGS`, NaN where not known; and the height over the stride above the
        line between the footfalls before and after, m.
    """
    before, after = stood.position[strides.stance], stood.position[strides.stance + 1]
    known = path.unbroken(strides.touchdown, strides.end)
    known &= np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)

    def height_from(start: Ints) -> Floats:
        """(strides, points) m, above the line between the footfalls, from some times to the end."""
        time = start[:, None] + np.rint((strides.end - start)[:, None] * CYCLE).astype(np.int64)
        return _above_line(path.at(time), before[:, None], after[:, None])

    length = np.hypot(*(after - before)[:, :2].T)
    velocity = _approach(path, strides, contact_interval_s)
    values = (
        np.where(known, height_from(strides.liftoff).max(axis=1), np.nan),
        np.where(known, length, np.nan),
        -velocity[:, 2],
        np.hypot(velocity[:, 0], velocity[:, 1]),
    )
    return dict(zip(SWINGS, values, strict=True)), cycle_curve(
        height_from(strides.touchdown)[known]
    )


def is_slow(path: FootPath, contact_interval_s: float) -> bool:
    """Tell whether path or contacts are sampled too rarely for velocities at touchdown."""
    if len(path.time) < 2 or contact_interval_s * 1e9 > SLOWEST_NS:
        return True
    return float(median_of(np.diff(path.time))) > SLOWEST_NS


def _above_line(position: Floats, before: Floats, after: Floats) -> Floats:
    """Return how high points lie above the line between two footfalls; shapes broadcast, m."""
    displacement = after - before
    squared = displacement[..., 0] ** 2 + displacement[..., 1] ** 2
    since = position - before
    along = since[..., 0] * displacement[..., 0] + since[..., 1] * displacement[..., 1]
    share = np.where(squared > 1e-6, along / np.maximum(squared, 1e-6), 0.5)
    height: Floats = since[..., 2] - np.clip(share, 0.0, 1.0) * displacement[..., 2]
    return height


def _approach(path: FootPath, strides: Strides, contact_interval_s: float) -> Floats:
    """(n, 3) m/s, velocity of the foot when it was last known to be in the air.

    It is the slope there of the parabola that fits its places at the times of `APPROACH`. NaN where
    path or contacts are told too rarely, or the swing is shorter.
    """
    if is_slow(path, contact_interval_s):
        return np.full((len(strides.end), 3), np.nan)
    aloft = strides.end - round(contact_interval_s * 1e9)
    time = aloft[:, None] + np.rint(APPROACH * 1e9).astype(np.int64)
    slope = np.linalg.pinv(np.stack([APPROACH**0, APPROACH, APPROACH**2], axis=-1))[1]
    velocity = np.einsum("t,ntc->nc", slope, path.at(time))
    velocity[time[:, 0] < strides.liftoff] = np.nan
    return np.asarray(velocity)


def steps(
    strides: Strides, stood: Footfalls, other: Footfalls, other_touchdown: Ints
) -> dict[str, Floats]:
    """Measure the steps that a foot's swings end with, against the other foot of its pair.

    Args:
        strides: of the foot.
        stood: its footfalls, by stance.
        other: those of the other foot.
        other_touchdown: (k,) ns, of the other foot.

    Returns:
        (strides,) each of `STEPS`: m from the other foot's footfall along the foot's own swing, and
        across it; NaN where not known.
    """
    before, after = stood.position[strides.stance], stood.position[strides.stance + 1]
    row = np.searchsorted(other_touchdown, strides.end) - 1
    there = np.full((len(row), 3), np.nan)
    there[row >= 0] = other.position[row[row >= 0]]
    displacement, step = (after - before)[:, :2], (after - there)[:, :2]
    length = np.hypot(displacement[:, 0], displacement[:, 1])
    length[~(length >= SHORTEST_STEP_M)] = np.nan
    along = (step * displacement).sum(axis=1) / length
    across = np.abs(step[:, 0] * displacement[:, 1] - step[:, 1] * displacement[:, 0]) / length
    return dict(zip(STEPS, (along, across), strict=True))
