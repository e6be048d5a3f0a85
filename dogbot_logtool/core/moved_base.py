"""Poses of another link than the base, moved to the base by the log's own static transforms."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import lookup, track_of
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import conjugate, multiply, normalised, rotate
from dogbot_logtool.finding import Finding, found

_SENSORS: Final = frozenset(
    {"imu", "camera", "cam", "lidar", "laser", "gps", "gnss", "livox", "velodyne", "ouster"}
    | {"os", "sensor", "t265", "zed", "realsense", "optical", "marker", "antenna"}
)
"""Words of links that are no base."""
_FLOOR: Final = "base_footprint"


def poses_of_base(
    recording: Recording,
    topic: str,
    named: str | None,
    bases: Sequence[str],
) -> tuple[Recording, tuple[Finding, ...]]:
    """Move poses of another link to the base, where static transforms tell how.

    Args:
        recording: the columns of a log.
        topic: of the poses.
        named: the base's frame, if the robot's file tells it.
        bases: usual names of a base's frame, the best first.

    Returns:
        the recording, and what was done, or could not be.
    """
    frames = [name.lstrip("/") for name in recording.base_frames if name.strip("/")]
    if len(frames) != 1:
        return recording, ()
    statics = {
        child: track
        for (parent, child), own in recording.transforms.items()
        if own.static.any() and (track := track_of(parent, own, TimeSource.LOG))
    }
    parents = {child: track.parent for child, track in statics.items()}
    above = [frames[0]]
    while above[-1] in parents and parents[above[-1]] not in above:
        above.append(parents[above[-1]])
    base = _base_of(above, named and named.lstrip("/"), bases, parents)
    if base == above[0]:
        return recording, ()
    now = np.zeros(1, np.int64)
    own, other = (lookup(statics, each, above[-1], now, now) for each in (above[0], base or ""))
    if not (own.known[0] and other.known[0]):
        return recording, (found("POSE_FRAME", "unknown", topic=topic, frame=above[0]),)
    displacement, back = other.translation - own.translation, conjugate(own.rotation)
    slash = "/" if recording.base_frames[0].startswith("/") else ""
    moved = replace(
        recording,
        base=_moved(recording.base, rotate(back, displacement), multiply(back, other.rotation)),
        base_frames=(f"{slash}{base}",),
    )
    metres = float(np.linalg.norm(displacement))
    moving = found("POSE_FRAME", topic=topic, frame=above[0], base=base, metres=metres)
    return moved, (moving,)


def _base_of(
    above: Sequence[str], named: str | None, bases: Sequence[str], parents: Mapping[str, str]
) -> str | None:
    """Return the base that a link belongs to; itself, where it may be one; None: not known.

    Args:
        above: the link, its parent, its parent's parent, and so on.
        named: the base's frame by the robot's file.
        bases: usual names of bases.
        parents: by frame.
    """
    child = above[0]
    if named is not None and named != child:
        return named if named in {*parents, *parents.values()} else child
    for base in bases:
        if base in above and base != _FLOOR:
            return base
        if child == _FLOOR and parents.get(base) == child:
            return base
    words = frozenset(re.findall(r"[a-z0-9]+", child.lower()))
    return child if words.isdisjoint(_SENSORS) else None


def _moved(base: Odometry, translation: Floats, rotation: Floats) -> Odometry:
    """Return the poses of a point of the same body, whose own turn is part of it."""
    turned = base.orientation.any(axis=1)
    orientation, position = base.orientation.copy(), base.position.copy()
    unit = normalised(base.orientation[turned])
    position[turned] += rotate(unit, translation)
    orientation[turned] = multiply(unit, rotation)
    return replace(base, position=position, orientation=orientation)
