"""How feet hang on the base, and the path of each: in the base's frame, and in the world.

A path comes from transforms, or from joints with their robot description, at a low rate.
"""

from collections.abc import Mapping
from dataclasses import field
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Float32s, Floats, Ints, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.corrections.clock import advancing, first_at_each_tick
from dogbot_logtool.core.frames.kinematics import Joint, link_poses
from dogbot_logtool.core.frames.transforms import TransformBuffer, chain_of_frames
from dogbot_logtool.core.legs.joints import JointLimits, JointTrack, silent_before, unbroken
from dogbot_logtool.core.rotations import conjugate, from_roll_pitch_yaw, rotate
from dogbot_logtool.dataclass import dataclass

TRANSFORM_RATE_HZ: Final = 200.0
JOINT_RATE_HZ: Final = 100.0
SLOWEST_NS: Final = 11_000_000
"""ns: a foot that is told less often has no velocity at touchdown."""


@dataclass(frozen=True, slots=True)
class LegChain:
    """How a foot hangs on the base."""

    frames: tuple[str, ...]
    """From the foot's frame up to the child of the base, without leading slashes."""
    base: str
    point: tuple[float, float, float]
    """m, of the foot, in its frame."""
    touches: bool
    """Whether the point is where the foot touches the ground, as contacts or the robot's file tell;
    else it is the frame's origin, perhaps the middle of a ball."""
    joints: tuple[Joint, ...] = ()
    """Joints of a robot description, like `frames`; empty: transforms tell."""


@dataclass(frozen=True, slots=True)
class JointPair:
    """Two joints that are alike, one on each side of the robot."""

    name: str
    left: str
    """The joint's name; also `right`."""
    right: str


@dataclass(frozen=True, slots=True)
class LegSettings:
    """Sources of a log's legs."""

    chains: tuple[LegChain | None, ...]
    """How each foot hangs on the base; None: not known."""
    reasons: tuple[str, ...]
    """Why a foot has no chain; empty where it has one."""
    joint_topics: tuple[str, ...] = ()
    """Topics of joint states; the best first, whose states of a joint count."""
    foot_of_joint: Mapping[str, int] = field(default_factory=dict)
    """Index of the foot that a joint moves, by the joint's name."""
    pairs: tuple[JointPair, ...] = ()
    limits: Mapping[str, JointLimits] = field(default_factory=dict)
    """Limits by the robot description, by the joint's name."""
    untold: tuple[str, ...] = ()
    """Joints of legs that the robot description has and joint states leave out."""
    statics: TransformBuffer = field(default_factory=TransformBuffer)
    """Transforms that hold for ever."""


@dataclass(frozen=True, slots=True)
class FootPath:
    """The point of a foot over time, in the base's frame or in the world."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Floats | Float32s
    """(n, 3) m."""
    broken: Flags
    """(n,) whether a silence lies between a row and the one before."""

    def at(self, time: Ints) -> Floats:
        """Interpolate linearly; time's shape and 3, m; NaN in silences and outside."""
        if len(self.time) == 0:
            return np.full((*time.shape, 3), np.nan)
        most = len(self.time) - 1
        after = np.clip(np.searchsorted(self.time, time), min(1, most), most)
        before = np.maximum(after - 1, 0)
        step = np.maximum(self.time[after] - self.time[before], 1)
        share = ((time - self.time[before]) / step)[..., None]
        position = self.position[before] + share * (self.position[after] - self.position[before])
        outside = (time < self.time[0]) | (time > self.time[-1]) | self.broken[after]
        position[outside] = np.nan
        return np.asarray(position)

    @property
    def is_slow(self) -> bool:
        """Whether the path is told too rarely for velocities."""
        return len(self.time) < 2 or float(median_of(np.diff(self.time))) > SLOWEST_NS

    def unbroken(self, start: Ints, end: Ints) -> Flags:
        """(m,) whether the path is known all the way between two times each."""
        return unbroken(self.time, self.broken, start, end)

    def in_world(self, base: BaseHistory) -> "FootPath":
        """Place the path in the world by the base's poses; times without one are left out."""
        turn = from_roll_pitch_yaw(base.angles_at(self.time))
        position = base.position_at(self.time) + rotate(turn, self.position.astype(np.float64))
        return _path(self.time, position)


def path_of(time: Ints, position: Floats | Float32s) -> FootPath:
    """Return the path of a foot by positions that messages tell, (n, 3) m; NaN: not known."""
    advances = advancing(time)
    rows = np.flatnonzero(advances)
    rows = rows[first_at_each_tick(time[rows], TRANSFORM_RATE_HZ)]
    return _path(time[rows], position[rows])


def path_in_base(time: Ints, position: Floats | Float32s, base: BaseHistory) -> FootPath:
    """Return the path of a foot in the base's axes by its positions in the world, (n, 3) m."""
    turn = conjugate(from_roll_pitch_yaw(base.angles_at(time)))
    return path_of(time, rotate(turn, position.astype(np.float64) - base.position_at(time)))


def _path(time: Ints, position: Floats | Float32s) -> FootPath:
    """Return the path of the times whose positions are known."""
    known = np.isfinite(position).all(axis=1)
    return FootPath(time[known], position[known], silent_before(time[known]))


def foot_path(
    chain: LegChain | None,
    joints: Mapping[str, JointTrack],
    frames: TransformBuffer,
    statics: TransformBuffer,
) -> FootPath | None:
    """Return the path of a foot in the base's frame; None where too little is known.

    Args:
        chain: of the foot.
        joints: by name.
        frames: of the legs that transforms move.
        statics: transforms that hold for ever.
    """
    if chain is None:
        return None
    if chain.joints:
        return _path_by_joints(chain, joints)
    moving = [frame for frame in chain.frames if frame not in statics.frames]
    if not moving or not frames.frames.keys() >= set(moving):
        return None
    last = frames.frames[moving[0]]
    at = last.pick(first_at_each_tick(last.time, TRANSFORM_RATE_HZ))
    poses = statics.then(frames).lookup(chain.frames[0], chain.base, at.time, at.log_time)
    position = poses.translation + rotate(poses.rotation, np.array([chain.point]))
    position[~poses.known] = np.nan
    return _path(at.time, position.astype(np.float32)) if poses.known.any() else None


def _path_by_joints(chain: LegChain, joints: Mapping[str, JointTrack]) -> FootPath | None:
    """Return the path of a foot by forward kinematics, at times that all of its joints tell of."""
    names = {joint.measured for joint in chain.joints if joint.kind != "fixed"}
    told = {name: joints[name] for name in names if name in joints}
    # A joint that never moves is where it is, in its silences, too.
    moving = [track for track in told.values() if track.moves]
    if len(told) < len(names) or not moving:
        return None
    time = max((track.time for track in moving), key=len)
    time = time[first_at_each_tick(time, JOINT_RATE_HZ)]
    known = np.ones(len(time), np.bool_)
    for track in moving:
        known &= unbroken(track.time, silent_before(track.time), time, time)
    time = time[known]
    positions = np.zeros((len(time), len(chain.joints)))
    for column, joint in enumerate(chain.joints):
        if joint.kind != "fixed":
            track = told[joint.measured]
            since = (track.time - track.time[0]).astype(np.float64)
            positions[:, column] = np.interp(time - track.time[0], since, track.position)
    links = link_poses(chain.joints, positions)
    point = np.tile(np.array(chain.point), (len(positions), 1))
    # Joint by joint from the foot upwards.
    for column in range(len(chain.joints)):
        point = links.translation[:, column] + rotate(links.rotation[:, column], point)
    return _path(time, point.astype(np.float32)) if len(time) else None


def chain_to(
    parents: Mapping[str, str],
    frame: str,
    base: str,
    point: tuple[float, float, float],
    *,
    touches: bool,
    joints: Mapping[str, Joint] | None = None,
) -> LegChain | None:
    """Return how a foot hangs on the base; None: nothing connects them.

    Args:
        parents: parent of each frame.
        frame: of the foot.
        base: the base's frame.
        point: m, of the foot in its frame.
        touches: whether that is where it touches the ground.
        joints: of a robot description by child; None: transforms tell.
    """
    frames = chain_of_frames(parents, frame, base)
    if not frames:
        return None
    held = () if joints is None else tuple(joints[each] for each in frames)
    return LegChain(frames, base.lstrip("/"), point, touches, held)
