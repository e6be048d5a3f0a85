"""Transforms of frames as recorded, poses at any time by their chain, and the tree they make."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from itertools import accumulate
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, distinct, picked
from dogbot_logtool.core.clock import TimeSource, advancing
from dogbot_logtool.core.quality import TopicQuality, topic_quality
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
DEEPEST: Final = 100
"""A chain of more frames is a loop, and no tree is walked down further."""


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


def track_of(parent: str, recorded: Transforms, clock: TimeSource) -> FrameTrack | None:
    """Return what can be used of a frame's transforms in a parent; None: nothing.

    Those that are not finite are left out, and those that step back in time. If some were sent to
    hold for ever, the latest of these does.
    """
    static = bool(recorded.static.any())
    sound = all_finite(recorded.translation) & all_finite(recorded.rotation)
    sound &= (recorded.rotation != 0.0).any(axis=1) & (recorded.static == static)
    rows, time = np.flatnonzero(sound), clock.of(recorded)
    rows = rows[-1:] if static else rows[advancing(time[rows])]
    if not len(rows):
        return None
    used, turned = picked(recorded, rows), normalised(recorded.rotation[rows])
    return FrameTrack(parent, static, time[rows], used.log_time, used.translation, turned)


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


def fixed_turn(
    tracks: Mapping[str, FrameTrack], frame: str, ancestor: str
) -> tuple[float, float, float, float] | None:
    """Return x, y, z, w of a frame in an ancestor by what never moves; None: not known."""
    fixed, now = {child: own for child, own in tracks.items() if own.static}, np.zeros(1, np.int64)
    pose = lookup(fixed, frame, ancestor, now, now)
    x, y, z, w = pose.rotation[0].tolist()
    return (x, y, z, w) if pose.known[0] else None


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
        if current not in parents or len(frames) > DEEPEST:
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


# --- the tree ---

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
    times = child, log_time[moving], recorded.stamp[moving]
    return FrameEdge(
        parent=parent,
        child=child,
        transforms=len(log_time),
        static=int(recorded.static.sum()),
        timing=topic_quality(*times, TimeSource.HEADER) if moving.any() else None,
        channels=tuple(distinct(recorded.channel).tolist()),
        first_log_time=int(log_time.min()),
        last_log_time=int(log_time.max()),
        not_finite=int((~finite).sum()),
        zero_rotations=int(zero.sum()),
        not_normalised=int((finite & ~zero & ~unit).sum()),
    )


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


def roots(pairs: Iterable[Edge]) -> list[str]:
    """Return the frames that have children but no parent, sorted."""
    pairs = set(pairs)
    return sorted({parent for parent, _ in pairs} - {child for _, child in pairs})


def walk(pairs: Iterable[Edge]) -> Iterator[TreeRow]:
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


def trees(pairs: Iterable[Edge]) -> list[list[str]]:
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


def loops(pairs: Iterable[Edge]) -> list[list[str]]:
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
