"""Poses of another link than the base, moved to the base by the log's own static transforms."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.frames.transforms import TransformBuffer, chain_of_frames, static_tracks
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.rotations import conjugate, multiply, normalised, rotate
from dogbot_logtool.finding import Finding
from dogbot_logtool.robot.base_candidates import BASES
from dogbot_logtool.robot.selection import Selection

_SENSORS: Final = frozenset(
    {"imu", "camera", "cam", "lidar", "laser", "gps", "gnss", "livox", "velodyne", "ouster"}
    | {"os", "sensor", "t265", "zed", "realsense", "optical", "marker", "antenna"}
)
"""Words of links that are no base."""
_FLOOR: Final = ("base_footprint",)


def with_poses_of_base(
    recording: Recording, selection: Selection
) -> tuple[Recording, tuple[Finding, ...]]:
    """Move poses of another link to the base, where static transforms tell how.

    Returns:
        the recording, and what was done, or could not be.
    """
    recording = _in_metres(recording, selection.robot.odometry_scale)
    frames = [name.lstrip("/") for name in recording.base_frames if name.strip("/")]
    if len(frames) != 1:
        return recording, ()
    child, statics = frames[0], TransformBuffer()
    parents: dict[str, str] = {}
    if selection.static_transforms:
        statics = static_tracks(recording.transforms, selection.static_transforms)
        pairs = [(a.lstrip("/"), b.lstrip("/")) for a, b in recording.transforms.pairs()]
        parents = {below: above for above, below in pairs if below in statics.frames}
    base = _base_of(child, selection.robot.base_frame, parents)
    if base == child:
        return recording, ()
    topic = selection.base_name or ""
    found = None if base is None else _between(child, base, parents, statics)
    if base is None or found is None:
        text = (
            f"the poses of {topic} are those of {child}, not of the base, and no static transform "
            "of the log tells where it is on the base"
        )
        return recording, (Finding("POSE_FRAME", text, topic, cases=("unknown",)),)
    translation, rotation = found
    metres = float(np.linalg.norm(translation))
    text = (
        f"the poses of {topic} are those of {child}; they are moved to {base} by the log's static "
        f"transform ({metres:.2f} m)"
    )
    slash = "/" if recording.base_frames[0].startswith("/") else ""
    moved = replace(
        recording,
        base=_moved(recording.base, translation, rotation),
        base_frames=(slash + base,),
    )
    return moved, (Finding("POSE_FRAME", text, topic),)


def _in_metres(recording: Recording, scale: float | None) -> Recording:
    """Return poses in metres, where the robot's file says in what they are."""
    if scale is None:
        return recording
    base = recording.base
    moved = replace(
        base, position=base.position * scale, linear_velocity=base.linear_velocity * scale
    )
    return replace(recording, base=moved)


def _base_of(child: str, named: str | None, parents: Mapping[str, str]) -> str | None:
    """Return the base that a link belongs to; itself, where it may be one; None: not known."""
    if named is not None and named.lstrip("/") != child:
        tree = {*parents, *parents.values()}
        return named.lstrip("/") if named.lstrip("/") in tree else child
    above = [child]
    while above[-1] in parents and parents[above[-1]] not in above:
        above.append(parents[above[-1]])
    for base in BASES:
        if base in above and base not in _FLOOR:
            return base
    if child in _FLOOR:
        below = [base for base in BASES if parents.get(base) == child]
        return below[0] if below else child
    words = frozenset(re.findall(r"[a-z0-9]+", child.lower()))
    return child if words.isdisjoint(_SENSORS) else None


def _between(
    child: str, base: str, parents: Mapping[str, str], statics: TransformBuffer
) -> tuple[Floats, Floats] | None:
    """Return where the base is in a link's frame, (1, 3) m and (1, 4); None: not connected."""
    now = np.zeros(1, np.int64)
    if chain_of_frames(parents, base, child):
        pose = statics.lookup(base, child, now, now)
        return (pose.translation, pose.rotation) if pose.known[0] else None
    if not chain_of_frames(parents, child, base):
        return None
    pose = statics.lookup(child, base, now, now)
    if not pose.known[0]:
        return None
    back = conjugate(pose.rotation)
    return -rotate(back, pose.translation), back


def _moved(base: Odometry, translation: Floats, rotation: Floats) -> Odometry:
    """Return the poses of a point of the same body, whose own turn is part of it."""
    turned = base.orientation.any(axis=1)
    orientation, position = base.orientation.copy(), base.position.copy()
    unit = normalised(base.orientation[turned])
    position[turned] += rotate(unit, np.broadcast_to(translation, (len(unit), 3)))
    orientation[turned] = multiply(unit, np.broadcast_to(rotation, (len(unit), 4)))
    return replace(base, position=position, orientation=orientation)
