"""The tree of a log's frames: figures of each pair, and where it is no tree."""

import math
from collections.abc import Iterable, Iterator, Sequence
from graphlib import CycleError, TopologicalSorter
from itertools import accumulate
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import all_finite, distinct
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import Transforms
from dogbot_logtool.core.quality import TopicQuality, topic_quality, topic_times

NORM_TOLERANCE: Final = 0.01
"""A quaternion whose squared norm is further from 1 is not normalised. tf2's tolerance: it
ignores such a transform (geometry2, buffer_core.cpp)."""


class FrameEdge(NamedTuple):
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


def frame_edge(parent: str, child: str, recorded: Transforms) -> FrameEdge:
    """Measure the transforms of a frame in a parent."""
    rotation, log_time = recorded.rotation, recorded.log_time
    finite = all_finite(recorded.translation) & all_finite(rotation)
    zero = (rotation == 0.0).all(axis=1) & finite
    with np.errstate(over="ignore", invalid="ignore"):
        squared_norm = (rotation * rotation).sum(axis=1)
    unit = np.abs(squared_norm - 1.0) <= NORM_TOLERANCE
    moving = ~recorded.static
    times = topic_times(child, log_time[moving], recorded.stamp[moving])
    return FrameEdge(
        parent=parent,
        child=child,
        transforms=len(log_time),
        static=int(recorded.static.sum()),
        timing=topic_quality(times, TimeSource.HEADER) if moving.any() else None,
        channels=tuple(distinct(recorded.channel).tolist()),
        first_log_time=int(log_time.min()),
        last_log_time=int(log_time.max()),
        not_finite=int((~finite).sum()),
        zero_rotations=int(zero.sum()),
        not_normalised=int((finite & ~zero & ~unit).sum()),
    )


DEEPEST: Final = 100
"""Levels of a tree that are walked down."""

Pair = tuple[str, str]
"""A parent and a child."""


class TreeRow(NamedTuple):
    """One line of a drawn tree."""

    frame: str
    parent: str | None
    """None: it stands at the top."""
    more: tuple[bool, ...]
    """For it and, before it, each frame above but the topmost: whether a sibling follows."""
    again: bool
    """It stands further up already, with all that hangs below it."""
    cut: bool
    """Frames below it are too deep to be shown."""


def roots(pairs: Iterable[Pair]) -> list[str]:
    """Return the frames that have children but no parent, sorted."""
    pairs = set(pairs)
    return sorted({parent for parent, _ in pairs} - {child for _, child in pairs})


def walk(pairs: Iterable[Pair]) -> Iterator[TreeRow]:
    """Yield every pair once, top down, with the roots first of all.

    A frame with several parents stands below each of them; what hangs below it is told once. A
    loop that hangs nowhere begins with its first frame in the order of the alphabet.
    """
    children: dict[str, list[str]] = {}
    for parent, child in sorted(set(pairs)):
        children.setdefault(parent, []).append(child)
    visited: set[str] = set()

    def down(frame: str, parent: str | None, more: tuple[bool, ...]) -> Iterator[TreeRow]:
        again = frame in visited
        visited.add(frame)
        below = [] if again else children.get(frame, [])
        cut = bool(below) and len(more) >= DEEPEST
        yield TreeRow(frame, parent, more, again, cut)
        for child in below if not cut else ():
            yield from down(child, frame, (*more, child != below[-1]))

    for top in (*roots(pairs), *sorted(children)):
        if top not in visited:
            yield from down(top, None, ())


def trees(pairs: Iterable[Pair]) -> list[list[str]]:
    """Return the frames of every connected part, sorted, the largest part first."""
    group: dict[str, list[str]] = {}
    for parent, child in pairs:
        one, other = (group.setdefault(frame, [frame]) for frame in (parent, child))
        if one is not other:
            small, large = sorted((one, other), key=len)
            large += small
            group.update(dict.fromkeys(small, large))
    parts = {id(part): part for part in group.values()}
    return sorted(map(sorted, parts.values()), key=lambda part: (-len(part), part))


def loops(pairs: Iterable[Pair]) -> list[list[str]]:
    """Return frames that are each other's ancestors: each loop from a frame to its last child.

    Every frame is named in one loop at most, so there may be more loops than are told where
    they share frames.
    """
    left, found = sorted(set(pairs)), []
    while True:
        sorter = TopologicalSorter[str]()
        for parent, child in left:
            sorter.add(child, parent)
        try:
            sorter.prepare()
        except CycleError as error:
            loop: list[str] = error.args[1][1:]
            first = loop.index(min(loop))
            found.append(loop[first:] + loop[:first])
            left = [pair for pair in left if not set(pair) & set(loop)]
        else:
            return sorted(found)


class SecondParent(NamedTuple):
    """A frame that the log gives several parents."""

    child: str
    parents: tuple[str, ...]
    """In the order in which they were first seen."""
    at_once: bool
    """Whether some of them hold at the same time; else one follows the other."""


def second_parents(edges: Sequence[FrameEdge]) -> list[SecondParent]:
    """Return the frames with several parents.

    Two parents hold at once if the transforms of one begin before those of the other have
    ended; a static transform never ends.
    """
    of_child: dict[str, list[FrameEdge]] = {}
    for edge in edges:
        of_child.setdefault(edge.child, []).append(edge)
    found: list[SecondParent] = []
    for child, several in sorted(of_child.items()):
        if len(several) > 1:
            several.sort(key=lambda edge: (edge.first_log_time, edge.parent))
            parents = tuple(each.parent for each in several)
            ends = (math.inf if each.static else each.last_log_time for each in several)
            holds = zip(several[1:], accumulate(ends, max), strict=False)
            at_once = any(each.first_log_time <= end for each, end in holds)
            found.append(SecondParent(child, parents, at_once))
    return found
