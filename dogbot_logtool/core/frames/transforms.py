"""Transforms of frames as recorded, and poses of frames at any time by the chain of frames."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, picked
from dogbot_logtool.core.corrections.clock import TimeSource, advancing
from dogbot_logtool.core.rotations import multiply, normalised, rotate, slerp

Edge = tuple[str, str]
"""Parent and child, without leading slashes."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Transforms:
    """Transforms of a frame in one parent as recorded: n rows in the order of their log times."""

    channel: Ints
    """(n,) channel id."""
    static: Flags
    """(n,) whether it was sent to hold for ever."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    translation: Floats
    """(n, 3) m."""
    rotation: Floats
    """(n, 4) quaternion x, y, z, w."""


LONGEST_STEP_S: Final = 0.1
"""Transforms further apart are not interpolated between."""
LONGEST_DELAY_S: Final = 2.0
"""A transform that was recorded longer before or after a sample is not used for it."""
_DEEPEST: Final = 100
"""A chain of more frames is a loop."""


class Poses(NamedTuple):
    """Poses of a frame in another one at n times."""

    known: Flags
    """(n,) whether the rest of the row is known."""
    translation: Floats
    """(n, 3) m; NaN where not known."""
    rotation: Floats
    """(n, 4) unit quaternion x, y, z, w; NaN where not known."""


class FrameTrack(NamedTuple):
    """The recorded transforms of one child frame in its parent."""

    parent: str
    static: bool
    """Whether its only row holds at any time."""
    time: Ints
    """(n,) ns, the time at which each row holds; strictly increasing."""
    log_time: Ints
    """(n,) ns, when it was recorded."""
    translation: Floats
    """(n, 3) m, in the parent."""
    rotation: Floats
    """(n, 4) unit quaternion x, y, z, w."""


def frame_track(
    parent: str,
    time: Ints,
    log_time: Ints,
    translation: Floats,
    rotation: Floats,
    *,
    static: bool = False,
) -> FrameTrack | None:
    """Return what can be used of one frame's transforms; None: nothing.

    Those that are not finite are left out, and those that step back in time.

    Args:
        parent: frame id, with or without a leading slash.
        time: (n,) ns, in the order of the log.
        log_time: (n,) ns.
        translation: (n, 3) m, in the parent.
        rotation: (n, 4) quaternion x, y, z, w.
        static: whether they hold at any time; the latest one does.
    """
    sound = all_finite(translation) & all_finite(rotation)
    rows = np.flatnonzero(sound & (rotation != 0.0).any(axis=1))
    rows = rows[-1:] if static else rows[advancing(time[rows])]
    if not len(rows):
        return None
    turned, above = normalised(rotation[rows]), parent.lstrip("/")
    return FrameTrack(above, static, time[rows], log_time[rows], translation[rows], turned)


def track_of(parent: str, recorded: Transforms, clock: TimeSource) -> FrameTrack | None:
    """Return the track of a frame: by its static transforms, if it has any; None of none."""
    static = bool(recorded.static.any())
    if static:
        recorded = picked(recorded, recorded.static)
    shift, turn = recorded.translation, recorded.rotation
    return frame_track(parent, clock.of(recorded), recorded.log_time, shift, turn, static=static)


def lookup(
    tracks: Mapping[str, FrameTrack], frame: str, ancestor: str, time: Ints, log_time: Ints
) -> Poses:
    """Interpolate the poses of a frame in an ancestor: lerp and slerp, frame by frame.

    Args:
        tracks: by child frame, without leading slashes.
        frame: frame id.
        ancestor: frame id of its parent, its parent's parent, and so on.
        time: (n,) ns.
        log_time: (n,) ns, when what the poses are for was recorded.

    Returns:
        n poses; not known where frames are not connected, before the first and after the last
        transform, between two that are too far apart, and where one was recorded too long
        before or after.
    """
    parents = {child: track.parent for child, track in tracks.items()}
    chain = chain_of_frames(parents, frame, ancestor)
    count = len(time)
    known = np.full(count, chain is not None)
    translation, rotation = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    with np.errstate(over="ignore", invalid="ignore"):
        for each in chain or ():
            here, shift, turn = _interpolated(tracks[each], time, log_time)
            known &= here
            translation = shift + rotate(turn, translation)
            rotation = multiply(turn, rotation)
    translation[~known] = np.nan
    rotation[~known] = np.nan
    return Poses(known, translation, rotation)


def chain_of_frames(
    parents: Mapping[str, str], frame: str, ancestor: str
) -> tuple[str, ...] | None:
    """Return the frames from one up to the child of an ancestor; None: not connected.

    Args:
        parents: parent by child frame, without leading slashes.
        frame: frame id; also `ancestor`.
        ancestor: where the chain ends.
    """
    frames: list[str] = []
    current = frame.lstrip("/")
    while current != ancestor.lstrip("/"):
        if current not in parents or len(frames) > _DEEPEST:
            return None
        frames.append(current)
        current = parents[current]
    return tuple(frames)


def _interpolated(track: FrameTrack, time: Ints, log_time: Ints) -> tuple[Flags, Floats, Floats]:
    count = len(time)
    if track.static:
        always = np.ones(count, np.bool_)
        only = np.zeros(count, np.int64)
        return always, track.translation[only], track.rotation[only]
    after = np.minimum(np.searchsorted(track.time, time), len(track.time) - 1)
    before = np.where(track.time[after] > time, np.maximum(after - 1, 0), after)
    step = track.time[after] - track.time[before]
    known = (time >= track.time[0]) & (time <= track.time[-1]) & (step <= LONGEST_STEP_S * 1e9)
    for row in (before, after):
        known &= np.abs(track.log_time[row] - log_time) <= LONGEST_DELAY_S * 1e9
    share = (time - track.time[before]) / np.maximum(step, 1)
    share = np.where(known, share, 0.0)
    first, second = track.translation[before], track.translation[after]
    shift = first + share[:, None] * (second - first)
    return known, shift, slerp(track.rotation[before], track.rotation[after], share)
