"""Positions of the robot's joints over time, by transforms or by joint states."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, distinct, picked
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import (
    TransformBuffer,
    chain_of_frames,
    frame_track,
    moving_tracks,
)
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.legs.joints import JointTable
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.robot.robot_model.description import log_skeleton, model_feet
from dogbot_logtool.robot.robot_model.joint_motion import JointMotion
from dogbot_logtool.robot.selection import Selection

MOST_FRAMES: Final = 64
"""Frames of a robot that are followed."""


@dataclass(frozen=True, slots=True)
class Limbs:
    """The origins of frames below the base, and the feet's soles, over time."""

    point: Float32s
    """(n, k, 3) m, in the base's frame; NaN where not known."""
    parents: tuple[int, ...]
    """(k,) index of the point that each hangs on; -1: the base."""
    soles: tuple[int | None, ...]
    """Index of each foot's sole; None: its frame is not known."""


def find_limbs(
    recording: Recording,
    selection: Selection,
    probe: KnownFrames,
    motion: JointMotion | None,
    clock: TimeSource,
    time: Ints,
) -> Limbs | None:
    """Follow the frames of a robot; None where nothing connects any with its base.

    The log's transforms place them, or its joint states with its robot description.

    Args:
        recording: transforms and joint states.
        selection: the robot's feet.
        probe: the log's frames.
        motion: how joint states move links; None: they do not.
        clock: the clock of `time`.
        time: (n,) ns, increasing.
    """
    base = probe.base
    known = log_skeleton(selection, probe, base)
    legs = {frame for leg in known.legs for frame in leg}
    parents = {name: pose.parent for name, pose in known.frames.items()}
    drawn = [name for name, pose in known.frames.items() if name in legs or not pose.static]
    for joint in motion.joints if motion else ():
        parents.setdefault(joint.child, joint.parent)
        drawn += [joint.child] if joint.kind != "fixed" and joint.child not in drawn else []
    drawn = [frame for frame in drawn if chain_of_frames(parents, frame, base) is not None]
    if not drawn or len(drawn) > MOST_FRAMES:
        return None
    moving = {name: parent for name, parent in parents.items() if name not in probe.statics.frames}
    buffer = probe.statics.only(parents.keys())
    buffer = buffer.then(moving_tracks(recording.transforms, moving, clock))
    for table in recording.joints:
        if motion is not None and table.topic == motion.channel.topic:
            buffer = buffer.then(_link_tracks(_near_rows(table, time, clock), motion, clock))
    feet = [foot for foot in model_feet(selection, probe) if foot.frame in parents]
    points: list[Floats] = []
    for frame, point in (
        *((frame, (0.0, 0.0, 0.0)) for frame in drawn),
        *((foot.frame, foot.point) for foot in feet),
    ):
        pose = buffer.lookup(frame, base, time, _recorded(buffer, frame, time))
        offset = np.tile(np.array(point), (len(time), 1))
        points.append(pose.translation + rotate(pose.rotation, offset))
    above = [*(parents[frame] for frame in drawn), *(foot.frame for foot in feet)]
    sole = {foot.name: len(drawn) + index for index, foot in enumerate(feet)}
    return Limbs(
        np.stack(points, axis=1).astype(np.float32),
        tuple(_nearest(drawn, parents, base, frame) for frame in above),
        tuple(sole.get(foot.name) for foot in selection.robot.feet),
    )


def _near_rows(table: JointTable, time: Ints, clock: TimeSource) -> JointTable:
    """Return the joint states that times lie between, and the first one."""
    after = np.searchsorted(clock.of(table.samples), time)
    rows = np.concatenate([after - 1, after, [0]])
    rows = distinct(np.clip(rows, 0, len(table.samples.stamp) - 1))
    return replace(table, samples=picked(table.samples, rows))


def _link_tracks(table: JointTable, motion: JointMotion, clock: TimeSource) -> TransformBuffer:
    """Return the links that joint states move, as transforms."""
    tracks = {}
    own = table.samples
    links = motion.links(table.names, own.log_time, own.stamp, own.position.astype(np.float64))
    for column, joint in enumerate(motion.joints):
        translation = links.poses.translation[:, column]
        rotation = links.poses.rotation[:, column]
        times = clock.of(links), links.log_time
        track = frame_track(joint.parent, *times, translation, rotation)
        if track is not None:
            tracks[joint.child] = track
    return TransformBuffer(tracks)


def _recorded(buffer: TransformBuffer, frame: str, time: Ints) -> Ints:
    """(n,) ns, log times of some times: about when a frame's transforms were recorded."""
    track = buffer.frames.get(frame)
    if track is None or track.static:
        return time
    since = np.interp(time - time[0], track.time - time[0], track.log_time - track.log_time[0])
    recorded: Ints = track.log_time[0] + np.rint(since).astype(np.int64)
    return recorded


def _nearest(drawn: Sequence[str], parents: Mapping[str, str], base: str, frame: str) -> int:
    """Return the index of a frame or, where it is not drawn, of the next above; -1: the base."""
    while frame != base and frame not in drawn:
        frame = parents[frame]
    return -1 if frame == base else drawn.index(frame)
