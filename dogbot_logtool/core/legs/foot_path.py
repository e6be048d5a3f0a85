"""The path of each foot in the base's frame, at a low rate: 20 bytes a row, 14 MB a foot and hour.

It comes from transforms, or from joints (`joint_track.py`) with their robot description.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.frames.kinematics import Joint, link_poses
from dogbot_logtool.core.frames.transforms import TransformBuffer, chain_of_frames
from dogbot_logtool.core.legs.joint_track import JointTrack
from dogbot_logtool.core.legs.silences import silent_before
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.dataclass import dataclass

PATH_RATE_HZ: Final = 200.0


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
class FootPath:
    """The point of a foot in the base's frame."""

    time: Ints
    """(n,) ns, strictly increasing."""
    position: Float32s
    """(n, 3) m."""


def path_by_transforms(
    chain: LegChain, frames: TransformBuffer, statics: TransformBuffer
) -> FootPath | None:
    """Return the path of a foot by recorded transforms.

    Args:
        chain: of the foot, without joints.
        frames: that move.
        statics: transforms that hold for ever.

    Returns:
        None where a frame is missing, or none moves.
    """
    moving = [frame for frame in chain.frames if frame not in statics.frames]
    if not moving or not frames.frames.keys() >= set(moving):
        return None
    last = frames.frames[moving[0]]
    at = last.pick(first_at_each_tick(last.time, PATH_RATE_HZ, None))
    poses = statics.then(frames).lookup(chain.frames[0], chain.base, at.time, at.log_time)
    known = poses.known
    if not known.any():
        return None
    turned = rotate(poses.rotation[known], np.array([chain.point]))
    position = poses.translation[known] + turned
    return FootPath(at.time[known], position.astype(np.float32))


def moving_parents(
    chains: Sequence[LegChain | None], parents: Mapping[str, str], statics: TransformBuffer
) -> dict[str, str]:
    """Return the parents of the frames of legs that transforms move."""
    frames = {frame for chain in chains if chain for frame in chain.frames}
    return {frame: parents[frame] for frame in sorted(frames - statics.frames.keys())}


def path_by_joints(chain: LegChain, tracks: Mapping[str, JointTrack | float]) -> FootPath | None:
    """Return the way of a foot by its joints.

    Args:
        chain: of the foot, with joints.
        tracks: by name of a joint; the position, rad or m, of one that never moves.

    Returns:
        None where a joint is missing, or none moves.
    """
    moving = [joint for joint in chain.joints if joint.kind != "fixed"]
    told = {joint.measured: tracks[joint.measured] for joint in moving if joint.measured in tracks}
    if len(told) < len({joint.measured for joint in moving}):
        return None
    times = [track.time for track in told.values() if isinstance(track, JointTrack)]
    if not times or not all(map(len, times)):
        return None
    time = max(times, key=len)
    time = time[(time >= max(t[0] for t in times)) & (time <= min(t[-1] for t in times))]
    positions = np.zeros((len(time), len(chain.joints)))
    known = np.ones(len(time), np.bool_)
    for column, joint in enumerate(chain.joints):
        track = told.get(joint.measured) if joint.kind != "fixed" else None
        if isinstance(track, JointTrack):
            positions[:, column] = np.interp(
                (time - time[:1]).astype(np.float64),
                (track.time - time[:1]).astype(np.float64),
                track.position.astype(np.float64),
            )
            after = np.searchsorted(track.time, time)
            known &= ~(silent_before(track.time)[after] & (track.time[after] > time))
        elif track is not None:
            positions[:, column] = track
    time, positions = time[known], positions[known]
    return FootPath(time, _placed(chain, positions).astype(np.float32))


def _placed(chain: LegChain, positions: Floats) -> Floats:
    """(n, 3) m, the point in the base's frame, joint by joint from the foot upwards."""
    poses = link_poses(chain.joints, positions)
    point = np.tile(np.array(chain.point), (len(positions), 1))
    for column in range(len(chain.joints)):
        point = poses.translation[:, column] + rotate(poses.rotation[:, column], point)
    return point


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
