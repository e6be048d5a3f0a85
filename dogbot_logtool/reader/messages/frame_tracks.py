"""Recorded transforms, sorted by frame."""

from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import (
    FrameTrack,
    RecordedTransforms,
    TransformBuffer,
    frame_track,
)


def static_tracks(recorded: RecordedTransforms, channels: AbstractSet[int]) -> TransformBuffer:
    """Return the transforms of channels whose transforms hold for ever."""
    held = np.flatnonzero(np.isin(recorded.channel, list(channels)))
    frames: dict[str, FrameTrack] = {}
    for parent, child, rows in _pairs(recorded, held):
        track = _track(recorded, parent, recorded.stamp, rows, static=True)
        if track is not None:
            frames.setdefault(child, track)
    return TransformBuffer(frames)


def moving_tracks(
    recorded: RecordedTransforms, parents: Mapping[str, str], clock: TimeSource
) -> TransformBuffer:
    """Return the transforms of some frames.

    Args:
        recorded: transforms of any frames.
        parents: parent of each wanted frame, without leading slashes; transforms into another
            one are left out.
        clock: the clock that they are placed on.
    """
    time = clock.of(recorded)
    frames: dict[str, FrameTrack] = {}
    for parent, child, rows in _pairs(recorded, np.arange(len(time))):
        if parents.get(child) == parent:
            track = _track(recorded, parent, time, rows, static=False)
            if track is not None:
                frames[child] = track
    return TransformBuffer(frames)


def _track(
    recorded: RecordedTransforms, parent: str, time: Ints, rows: Ints, *, static: bool
) -> FrameTrack | None:
    return frame_track(
        parent,
        time[rows],
        recorded.log_time[rows],
        recorded.translation[rows],
        recorded.rotation[rows],
        static=static,
    )


def _pairs(recorded: RecordedTransforms, rows: Ints) -> Iterator[tuple[str, str, Ints]]:
    """Yield parent and child, without leading slashes, and which of some rows have them."""
    if not len(rows):
        return
    parent = _without_slashes(recorded.parent[rows], recorded.parents)
    child = _without_slashes(recorded.child[rows], recorded.children)
    pair = parent * max(len(recorded.children), 1) + child
    order = np.argsort(pair, kind="stable")
    numbers, starts = np.unique(pair[order], return_index=True)
    for number, chosen in zip(numbers.tolist(), np.split(order, starts[1:]), strict=False):
        one, other = divmod(number, len(recorded.children))
        yield recorded.parents[one].lstrip("/"), recorded.children[other].lstrip("/"), rows[chosen]


def _without_slashes(code: Ints, names: tuple[str, ...]) -> Ints:
    """Give names that only differ in leading slashes the same code, that of the first one."""
    first: dict[str, int] = {}
    same = [first.setdefault(name.lstrip("/"), code) for code, name in enumerate(names)]
    return np.array(same, np.int64)[code] if same else code
