"""Figures of the transforms of each pair of frames."""

from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Ints,
    all_finite,
    distinct,
    stable_order,
)
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.quality.quality import TopicQuality, topic_quality, topic_times
from dogbot_logtool.dataclass import dataclass

NORM_TOLERANCE: Final = 0.01
"""A quaternion whose squared norm is further from 1 is not normalised. tf2's tolerance: it
ignores such a transform (geometry2, buffer_core.cpp)."""
MOST_EDGES: Final = 2_000
"""Pairs of frames that are told apart; no robot has as many, and no viewer draws them."""


@dataclass(frozen=True, slots=True)
class FrameEdge:
    """All transforms of one frame in one parent."""

    parent: str
    """Without leading slashes, as `child`."""
    child: str
    transforms: int
    static: int
    """Those of them that were sent as static, to hold for ever."""
    timing: TopicQuality | None
    """Rate, intervals, gaps and stamps of those that were not; None without any."""
    channels: tuple[int, ...]
    """Ids of the channels that carried them, sorted."""
    first_log_time: int
    """ns. Also `last_log_time`."""
    last_log_time: int
    not_finite: int
    """Transforms with a number that is not finite."""
    zero_rotations: int
    """Finite transforms whose quaternion is all zero."""
    not_normalised: int
    """Finite transforms whose quaternion is not zero, and no rotation either."""

    @property
    def is_static(self) -> bool:
        """Whether all of them were sent as static."""
        return self.static == self.transforms


@dataclass(frozen=True, slots=True)
class RecordedFrames:
    """Figures of all transforms of a log."""

    edges: tuple[FrameEdge, ...]
    """Sorted by parent, then child."""
    slashed: tuple[str, ...]
    """Frame ids that begin with a slash, as recorded, sorted."""
    unnamed: int
    """Transforms without the name of a parent or of a child; left out."""
    left_out: int
    """Transforms of further pairs of frames, when there were `MOST_EDGES`."""


def recorded_frames(
    recorded: RecordedTransforms, static_channels: AbstractSet[int]
) -> RecordedFrames:
    """Measure all transforms of a log, pair by pair of frames.

    Args:
        recorded: transforms in the order of the log.
        static_channels: ids of the channels whose transforms hold for ever.
    """
    rows_of: dict[tuple[str, str], list[Ints]] = {}
    slashed, unnamed, left_out = set[str](), 0, 0
    for rows in _pairs(recorded):
        names = (
            recorded.parents[recorded.parent[rows[0]]],
            recorded.children[recorded.child[rows[0]]],
        )
        slashed.update(name for name in names if name.startswith("/"))
        parent, child = (name.lstrip("/") for name in names)
        if not (parent and child):
            unnamed += len(rows)
        elif (parent, child) in rows_of or len(rows_of) < MOST_EDGES:
            rows_of.setdefault((parent, child), []).append(rows)
        else:
            left_out += len(rows)
    static: Flags = np.isin(recorded.channel, list(static_channels))
    edges = (
        _edge(*names, recorded, np.sort(np.concatenate(rows)), static)
        for names, rows in sorted(rows_of.items())
    )
    return RecordedFrames(tuple(edges), tuple(sorted(slashed)), unnamed, left_out)


def _edge(
    parent: str, child: str, recorded: RecordedTransforms, rows: Ints, static: Flags
) -> FrameEdge:
    """Measure the transforms of a frame in a parent.

    Args:
        parent: without leading slashes, as `child`.
        child: the other frame.
        recorded: all transforms.
        rows: those of this pair.
        static: (n,) which of all are static.
    """
    log_time, moving = recorded.log_time[rows], rows[~static[rows]]
    rotation = recorded.rotation[rows]
    finite = all_finite(recorded.translation[rows]) & all_finite(rotation)
    zero = (rotation == 0.0).all(axis=1) & finite
    with np.errstate(over="ignore", invalid="ignore"):
        squared_norm = (rotation * rotation).sum(axis=1)
    unit = np.abs(squared_norm - 1.0) <= NORM_TOLERANCE
    times = topic_times(child, recorded.log_time[moving], recorded.stamp[moving])
    return FrameEdge(
        parent=parent,
        child=child,
        transforms=len(rows),
        static=len(rows) - len(moving),
        timing=topic_quality(times, TimeSource.HEADER) if len(moving) else None,
        channels=tuple(distinct(recorded.channel[rows]).tolist()),
        first_log_time=int(log_time.min()),
        last_log_time=int(log_time.max()),
        not_finite=int((~finite).sum()),
        zero_rotations=int(zero.sum()),
        not_normalised=int((finite & ~zero & ~unit).sum()),
    )


def _pairs(recorded: RecordedTransforms) -> Iterator[Ints]:
    """Yield the rows of each pair of parent and child, in the order of the log."""
    pair = recorded.parent * max(len(recorded.children), 1) + recorded.child
    order = stable_order(pair)
    edges = np.flatnonzero(np.diff(pair[order])) + 1
    yield from (rows for rows in np.split(order, edges) if len(rows))
