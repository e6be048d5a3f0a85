"""Where feet touch the ground in the frames of their links, and the first poses of frames."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import all_finite, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.transforms import RecordedTransforms, TransformBuffer
from dogbot_logtool.core.rotations import conjugate, normalised, rotate
from dogbot_logtool.core.world_frames import WorldFrames

_MOST_SAMPLES: Final = 2000
"""Contacts of a foot that are used, evenly spread over the recording."""
_FEWEST: Final = 5
_SPREAD_M: Final = 0.05
"""m, median distance from the median beyond which points tell no sole."""
STANCE_SPREAD_M: Final = 0.3
"""m, the same in the base's frame, in which a foot moves back while it stands."""
_GRID_M: Final = 0.02
"""m, to which the points of soles are rounded."""
_FARTHEST_M: Final = 1.5
"""m, from a link's origin; contact points farther away lie in another world than the link."""
Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class FramePose:
    """The first recorded pose of a frame in its parent."""

    parent: str
    """Frame ids have no leading slash."""
    translation: Point
    """m."""
    rotation: tuple[float, float, float, float]
    """Unit quaternion x, y, z, w."""
    static: bool


def first_poses(
    recorded: RecordedTransforms, static_channels: AbstractSet[int]
) -> dict[str, FramePose]:
    """Return the first usable pose of each frame, by name without a leading slash."""
    usable = all_finite(recorded.translation) & all_finite(recorded.rotation)
    rows = np.flatnonzero(usable & (recorded.rotation != 0.0).any(axis=1))
    _, first = np.unique(recorded.child[rows], return_index=True)
    rows = rows[first]
    turned = normalised(recorded.rotation[rows]).tolist()
    poses: dict[str, FramePose] = {}
    for row, rotation in zip(rows.tolist(), turned, strict=True):
        child = recorded.children[recorded.child[row]].lstrip("/")
        poses[child] = FramePose(
            parent=recorded.parents[recorded.parent[row]].lstrip("/"),
            translation=tuple(recorded.translation[row].tolist()),
            rotation=tuple(rotation),
            static=int(recorded.channel[row]) in static_channels,
        )
    return poses


def find_soles(
    feet: Sequence[Samples],
    frames: WorldFrames,
    tracks: TransformBuffer,
    spread_m: float = _SPREAD_M,
    in_base: AbstractSet[int] = frozenset(),
) -> dict[int, Point]:
    """Return the median contact point, m, of each foot whose points agree in its link's frame.

    Args:
        feet: contact samples of each.
        frames: how the links hang in the world.
        tracks: their transforms.
        spread_m: m, median distance from the median beyond which a foot has no sole.
        in_base: feet whose points are in the base's frame as they are recorded.
    """
    buffer = frames.statics.then(tracks)
    found: dict[int, Point] = {}
    for foot, (samples, link) in enumerate(zip(feet, frames.links, strict=True)):
        rows = np.flatnonzero(samples.in_contact & all_finite(samples.position))
        rows = rows[:: len(rows) // _MOST_SAMPLES + 1]
        if link is None or not len(rows):
            continue
        picked = samples.pick(rows)
        points = picked.position
        if foot not in in_base:
            time = frames.clock.of(picked)
            poses = buffer.lookup(link, frames.world, time, picked.log_time)
            offset = (points - poses.translation)[poses.known]
            points = rotate(conjugate(poses.rotation[poses.known]), offset)
        if len(points) < _FEWEST:
            continue
        middle = median_of(points, axis=0)
        spread = float(median_of(np.sqrt(((points - middle) ** 2).sum(axis=1))))
        if spread <= spread_m and float(np.sqrt((middle**2).sum())) <= _FARTHEST_M:
            found[foot] = tuple(middle.tolist())
    return found


def rounded(soles: Mapping[int, Point]) -> dict[int, Point]:
    """Return soles to the nearest 2 cm: a picture needs no more."""
    return {
        foot: tuple((np.round(np.array(point) / _GRID_M) * _GRID_M + 0.0).tolist())
        for foot, point in soles.items()
    }
