"""The tree that frames and their parents form, and where it is none."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import accumulate
from typing import Final

from dogbot_logtool.core.frames.frame_edges import FrameEdge
from dogbot_logtool.dataclass import dataclass

DEEPEST: Final = 100
"""Levels of a tree that are walked down."""

Pair = tuple[str, str]
"""A parent and a child."""


@dataclass(frozen=True, slots=True)
class TreeRow:
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


def children_of(pairs: Iterable[Pair]) -> dict[str, list[str]]:
    """Return the sorted children of every parent."""
    children: dict[str, list[str]] = {}
    for parent, child in sorted(set(pairs)):
        children.setdefault(parent, []).append(child)
    return children


def roots(pairs: Iterable[Pair]) -> list[str]:
    """Return the frames that have children but no parent, sorted."""
    pairs = set(pairs)
    return sorted({parent for parent, _ in pairs} - {child for _, child in pairs})


def walk(pairs: Iterable[Pair]) -> Iterator[TreeRow]:
    """Yield every pair once, top down, with the roots first of all.

    A frame with several parents stands below each of them; what hangs below it is told once. A
    loop that hangs nowhere begins with its first frame in the order of the alphabet.
    """
    children = children_of(pairs)
    told: set[str] = set()
    for top in (*roots(pairs), *sorted(children)):
        if top not in told:
            yield from _walk_down(top, children, told)


def _walk_down(top: str, children: Mapping[str, list[str]], told: set[str]) -> Iterator[TreeRow]:
    waiting: list[tuple[str, str, tuple[bool, ...]]] = [(top, "", ())]
    while waiting:
        frame, parent, more = waiting.pop()
        again = frame in told
        told.add(frame)
        below = [] if again else children.get(frame, [])
        cut = bool(below) and len(more) >= DEEPEST
        yield TreeRow(frame, parent if more else None, more, again, cut)
        if not cut:
            last = len(below) - 1
            waiting += [(child, frame, (*more, index < last)) for index, child in enumerate(below)][
                ::-1
            ]


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
    children = children_of(pairs)
    done: set[str] = set()
    found: list[list[str]] = []
    named: set[str] = set()
    for top in sorted(children):
        path: list[str] = []
        index: dict[str, int] = {}
        waiting = [(top, False)]
        while waiting:
            frame, leaving = waiting.pop()
            if leaving:
                done.add(path.pop())
                del index[frame]
            elif frame in index:
                loop = path[index[frame] :]
                if named.isdisjoint(loop):
                    found.append(loop)
                    named.update(loop)
            elif frame not in done:
                index[frame] = len(path)
                path.append(frame)
                waiting.append((frame, True))
                waiting += [(child, False) for child in reversed(children.get(frame, []))]
    return found


@dataclass(frozen=True, slots=True)
class SecondParent:
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
            found.append(SecondParent(child, parents, _overlap(several)))
    return found


def _overlap(edges: Sequence[FrameEdge]) -> bool:
    """Tell whether edges, in the order in which they were first seen, hold at the same time."""
    ends = (math.inf if each.static else each.last_log_time for each in edges)
    latest = accumulate(ends, max)
    return any(each.first_log_time <= end for each, end in zip(edges[1:], latest, strict=False))
