"""How feet hang on the base, and the path of each: in the base's frame, and in the world.

A path comes from transforms, or from joints with their robot description, at a low rate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from dogbot_logtool.core.base.foot_path import FootPath, known_path
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.frames.kinematics import Joint, link_poses
from dogbot_logtool.core.frames.transforms import FrameTrack, frame_track, lookup
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


@dataclass(frozen=True, slots=True)
class JointPair:
    """Two joints that are alike, one on each side of the robot."""

    name: str
    left: str
    """The joint's name; also `right`."""
    right: str


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
    pairs: tuple[JointPair, ...] = ()
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
        poses = link_poses([joint], position[:, None])
        at = poses.translation[:, 0], poses.rotation[:, 0]
        found = frame_track(joint.parent, *times, *at, static=not moves)
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
