"""Positions of the robot's joints over time, by transforms or by joint states."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints
from dogbot_logtool.core.frames.transforms import (
    TransformBuffer,
    chain_of_frames,
    moving_tracks,
)
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.robot.robot_model.skeleton import model_feet, skeleton
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


def find_limbs(walk: Walk, selection: Selection, time: Ints) -> Limbs | None:
    """Follow the frames of a robot; None where nothing connects any with its base.

    The log's transforms place them, or its joint states with its robot description.

    Args:
        walk: what was measured.
        selection: the robot's feet.
        time: (n,) ns on the walk's clock, increasing.
    """
    probe, transforms = walk.frames, walk.recording.transforms
    links = walk.legs.links if walk.legs else TransformBuffer()
    known = skeleton(selection, probe, probe.base)
    legs = {frame for leg in known.legs for frame in leg}
    parents = {name: pose.parent for name, pose in known.frames.items()}
    drawn = [name for name, pose in known.frames.items() if name in legs or not pose.static]
    for child, track in links.frames.items():
        drawn += [child] if child not in parents and not track.static else []
        parents.setdefault(child, track.parent)
    drawn = [frame for frame in drawn if chain_of_frames(parents, frame, probe.base) is not None]
    if not drawn or len(drawn) > MOST_FRAMES:
        return None
    moving = {name: parent for name, parent in parents.items() if name not in probe.statics.frames}
    buffer = probe.statics.only(parents.keys())
    buffer = buffer.then(moving_tracks(transforms, moving, walk.settings.clock)).then(links)
    feet = [foot for foot in model_feet(selection, probe) if foot.frame in parents]
    points: list[Floats] = []
    for frame, point in (
        *((frame, (0.0, 0.0, 0.0)) for frame in drawn),
        *((foot.frame, foot.point) for foot in feet),
    ):
        pose = buffer.lookup(frame, probe.base, time, _recorded(buffer, frame, time))
        points.append(pose.translation + rotate(pose.rotation, np.array([point])))
    above = [*(parents[frame] for frame in drawn), *(foot.frame for foot in feet)]
    sole = {foot.name: len(drawn) + index for index, foot in enumerate(feet)}
    return Limbs(
        np.stack(points, axis=1).astype(np.float32),
        tuple(_nearest(drawn, parents, probe.base, frame) for frame in above),
        tuple(sole.get(foot.name) for foot in selection.robot.feet),
    )


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
