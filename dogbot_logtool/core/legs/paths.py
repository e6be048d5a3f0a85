"""How feet hang on the base, and the path of each: in the base's frame, and in the world.

A path comes from transforms, or from joints with their robot description, at a low rate.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from dogbot_logtool.core.base.foot_path import FootPath, known_path, silent_before, unbroken
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.frames.kinematics import Joint, Leg, leg_motion
from dogbot_logtool.core.frames.transforms import TransformBuffer, chain_of_frames
from dogbot_logtool.core.legs.joints import JointLimits, JointTrack
from dogbot_logtool.core.rotations import rotate

TRANSFORM_RATE_HZ: Final = 200.0
JOINT_RATE_HZ: Final = 100.0


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
    return known_path(at.time, position.astype(np.float32)) if poses.known.any() else None


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
    if not len(time):
        return None
    leg = Leg(chain.joints[::-1], point=chain.point)
    positions = []
    for name in leg.measured:
        since = (told[name].time - told[name].time[0]).astype(np.float64)
        positions.append(np.interp(time - told[name].time[0], since, told[name].position))
    foot = leg_motion(leg, np.stack(positions, axis=1)).foot
    return known_path(time, foot.astype(np.float32))


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
