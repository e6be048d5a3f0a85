"""Figures of the transforms of each pair of frames, measured while they stream past."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.geometry.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    stable_order,
)
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.quality.quality import TopicQuality, TopicWatch
from dogbot_logtool.dataclass import dataclass

NORM_TOLERANCE: Final = 0.01
"""A quaternion whose squared norm is further from 1 is not normalised. tf2's tolerance: it
ignores such a transform (geometry2, buffer_core.cpp)."""
MOST_EDGES: Final = 10_000
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


class _EdgeWatch:
    """Measures one edge."""

    def __init__(self, parent: str, child: str) -> None:
        self._names = parent, child
        self._watch = TopicWatch(child)
        self._transforms = self._static = 0
        self._channels: set[int] = set()
        self._first = self._last = 0
        self._not_finite = self._zero = self._not_normalised = 0

    def add(self, recorded: RecordedTransforms, rows: Ints, static: Flags) -> None:
        log_time = recorded.log_time[rows]
        first, last = int(log_time.min()), int(log_time.max())
        self._first = min(self._first, first) if self._transforms else first
        self._last = max(self._last, last) if self._transforms else last
        self._transforms += len(rows)
        self._static += int(static[rows].sum())
        self._channels.update(distinct(recorded.channel[rows]).tolist())
        moving = rows[~static[rows]]
        self._watch.add(recorded.log_time[moving], recorded.stamp[moving])
        self._judge(recorded.translation[rows], recorded.rotation[rows])

    def _judge(self, translation: Floats, rotation: Floats) -> None:
        finite = all_finite(translation) & all_finite(rotation)
        zero = (rotation == 0.0).all(axis=1) & finite
        with np.errstate(over="ignore", invalid="ignore"):
            squared_norm = (rotation * rotation).sum(axis=1)
        unit = np.abs(squared_norm - 1.0) <= NORM_TOLERANCE
        self._not_finite += int((~finite).sum())
        self._zero += int(zero.sum())
        self._not_normalised += int((finite & ~zero & ~unit).sum())

    def finish(self) -> FrameEdge:
        moving = self._transforms > self._static
        return FrameEdge(
            *self._names,
            transforms=self._transforms,
            static=self._static,
            timing=self._watch.finish(TimeSource.HEADER) if moving else None,
            channels=tuple(sorted(self._channels)),
            first_log_time=self._first,
            last_log_time=self._last,
            not_finite=self._not_finite,
            zero_rotations=self._zero,
            not_normalised=self._not_normalised,
        )


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


class FrameRecorder:
    """Makes `RecordedFrames` of transforms that stream past in the order of the log."""

    def __init__(self, static_channels: frozenset[int]) -> None:
        """Set up.

        Args:
            static_channels: ids of the channels whose transforms hold for ever.
        """
        self._static = list(static_channels)
        self._edges: dict[tuple[str, str], _EdgeWatch] = {}
        self._slashed: set[str] = set()
        self._unnamed = self._left_out = 0

    def add(self, recorded: RecordedTransforms) -> None:
        """Take in transforms."""
        static: Flags = np.isin(recorded.channel, self._static)
        for rows in _pairs(recorded):
            names = (
                recorded.parents[recorded.parent[rows[0]]],
                recorded.children[recorded.child[rows[0]]],
            )
            self._slashed.update(name for name in names if name.startswith("/"))
            parent, child = (name.lstrip("/") for name in names)
            if not (parent and child):
                self._unnamed += len(rows)
                continue
            if (parent, child) not in self._edges:
                if len(self._edges) == MOST_EDGES:
                    self._left_out += len(rows)
                    continue
                self._edges[parent, child] = _EdgeWatch(parent, child)
            self._edges[parent, child].add(recorded, rows, static)

    def finish(self) -> RecordedFrames:
        """End the log."""
        return RecordedFrames(
            edges=tuple(watch.finish() for _, watch in sorted(self._edges.items())),
            slashed=tuple(sorted(self._slashed)),
            unnamed=self._unnamed,
            left_out=self._left_out,
        )


def _pairs(recorded: RecordedTransforms) -> Iterator[Ints]:
    """Yield the rows of each pair of parent and child, in the order of the log."""
    pair = recorded.parent * max(len(recorded.children), 1) + recorded.child
    order = stable_order(pair)
    edges = np.flatnonzero(np.diff(pair[order])) + 1
    yield from (rows for rows in np.split(order, edges) if len(rows))
