"""Where the robot's joints are over time: its frames, by the log's own transforms."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.transform_buffer import FrameTrack, TransformBuffer
from dogbot_logtool.core.geometry.arrays import Float32s, Floats, Ints
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.geometry.rotations import rotate
from dogbot_logtool.pipeline.frames import useful_spans
from dogbot_logtool.pipeline.probe import Probe, frame_names
from dogbot_logtool.pipeline.robot_model.description import log_skeleton
from dogbot_logtool.pipeline.robot_model.skeleton import Skeleton
from dogbot_logtool.pipeline.selection import Selection
from dogbot_logtool.reader.containers.log import Log, Span
from dogbot_logtool.reader.messages.frame_tracks import moving_tracks
from dogbot_logtool.reader.messages.transforms import decode_transforms, transform_columns
from dogbot_logtool.run.in_order import in_order

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


def read_limbs(
    log: Log, selection: Selection, probe: Probe, clock: TimeSource, time: Ints, jobs: int
) -> Limbs | None:
    """Follow the frames of a robot; None where no transforms connect any with its base.

    Args:
        log: the log.
        selection: its transforms, and the robot's feet.
        probe: the log's frames.
        clock: the clock of `time`.
        time: (n,) ns, increasing.
        jobs: how many batches are read at once.
    """
    _, base = frame_names(selection.robot, probe)
    bones = log_skeleton(selection, probe, base)
    legs = {frame for leg in bones.legs for frame in leg}
    shown = [name for name, pose in bones.frames.items() if name in legs or not pose.static]
    if not shown or len(shown) > MOST_FRAMES:
        return None
    moving = {
        name: pose.parent for name, pose in bones.frames.items() if name not in probe.statics.frames
    }
    channels = {channel.id: channel for channel in selection.transforms}

    def work(span: Span) -> TransformBuffer:
        batch = log.read(span)
        found = TransformBuffer()
        for messages in decode_transforms(batch, selection.transforms):
            found = found.then(moving_tracks(transform_columns(messages), moving, clock))
        return TransformBuffer({name: _near(track, time) for name, track in found.frames.items()})

    buffer = probe.statics.only(bones.frames.keys())
    for part in in_order(work, useful_spans(log, channels), jobs, forks=log.can_fork):
        buffer = buffer.then(part)
    return _limbs(buffer, bones, shown, time, [foot.name for foot in selection.robot.feet])


def _near(track: FrameTrack, time: Ints) -> FrameTrack:
    """Return the rows of a track that times lie between, and its ends."""
    after = np.searchsorted(track.time, time)
    rows = np.concatenate([after - 1, after, [0]])
    kept = np.zeros(len(track.time), np.bool_)
    kept[np.clip(rows, 0, len(kept) - 1)] = True
    return track.pick(kept)


def _limbs(
    buffer: TransformBuffer, bones: Skeleton, shown: list[str], time: Ints, names: list[str]
) -> Limbs:
    number = {name: index for index, name in enumerate(shown)}
    points: list[Floats] = []
    parents: list[int] = []
    for name in shown:
        points.append(
            buffer.lookup(name, bones.base, time, _recorded(buffer, name, time)).translation
        )
        parents.append(_ancestor(bones, name, number))
    soles: list[int | None] = [None] * len(names)
    for foot in bones.feet:
        if foot.frame not in number:
            continue
        pose = buffer.lookup(foot.frame, bones.base, time, _recorded(buffer, foot.frame, time))
        offset = np.tile(np.array(foot.point), (len(time), 1))
        soles[names.index(foot.name)] = len(points)
        points.append(pose.translation + rotate(pose.rotation, offset))
        parents.append(number[foot.frame])
    return Limbs(np.stack(points, axis=1).astype(np.float32), tuple(parents), tuple(soles))


def _recorded(buffer: TransformBuffer, frame: str, time: Ints) -> Ints:
    """(n,) ns, log times of some times: about when a frame's transforms were recorded."""
    track = buffer.frames.get(frame)
    if track is None or track.static:
        return time
    since = np.interp(time - time[0], track.time - time[0], track.log_time - track.log_time[0])
    recorded: Ints = track.log_time[0] + np.rint(since).astype(np.int64)
    return recorded


def _ancestor(bones: Skeleton, name: str, number: dict[str, int]) -> int:
    """Return the index of the nearest frame above one that is shown; -1: the base."""
    above = bones.frames[name].parent
    while above != bones.base and above not in number:
        above = bones.frames[above].parent
    return number.get(above, -1)
