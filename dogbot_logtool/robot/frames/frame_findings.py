"""Findings about the frames of a log."""

from collections.abc import Iterator, Sequence
from typing import Final

from dogbot_logtool.core.frames import frame_tree
from dogbot_logtool.core.frames.frame_tree import MOST_EDGES, FrameEdge
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.robot.frames.frames import Frames

_NAMED: Final = 5
"""Frames that a finding names."""


def frame_findings(frames: Frames, added: tuple[str, str] | None) -> Iterator[Finding]:
    """Yield what is wrong with a log's frames.

    Args:
        frames: all frames.
        added: parent and child of the transform that `convert` adds.
    """
    recorded = frames.recorded
    pairs = [(edge.parent, edge.child) for edge in recorded.edges]
    yield from _of_tree(recorded.edges, [*pairs, added] if added else pairs)
    yield from _of_transforms(recorded.edges)
    if recorded.unnamed:
        yield found("FRAME_NAMES", say="unnamed", count=recorded.unnamed)
    if recorded.left_out:
        yield found("FRAME_NAMES", say="left_out", count=recorded.left_out, most=MOST_EDGES)
    for channel in frames.unread:
        encoding, topic = channel.message_encoding, channel.topic
        yield found("UNREADABLE", "one_topic", say="transforms", topic=topic, encoding=encoding)


def _of_tree(edges: Sequence[FrameEdge], pairs: Sequence[frame_tree.Pair]) -> Iterator[Finding]:
    for loop in frame_tree.loops(pairs):
        more = ["..."] if len(loop) > _NAMED else []
        path = " -> ".join([*loop[:_NAMED], *more, loop[0]])
        yield found("FRAME_TREE", say="loop", path=path)
    for second in frame_tree.second_parents(edges):
        cases, parents = () if second.at_once else ("new_parent",), listed(second.parents, _NAMED)
        say = "" if cases else "second"
        yield found("FRAME_TREE", *cases, say=say, child=second.child, parents=parents)
    trees = frame_tree.trees(pairs)
    if len(trees) > 1:
        roots = frame_tree.roots(pairs)
        tops = [next((root for root in roots if root in tree), tree[0]) for tree in trees]
        yield found("FRAME_TREE", say="trees", number=len(trees), tops=listed(tops, _NAMED))
    both = [edge for edge in edges if 0 < edge.static < edge.transforms]
    if both:
        yield found("FRAME_TREE", say="both", edges=_named(both))


def _of_transforms(edges: Sequence[FrameEdge]) -> Iterator[Finding]:
    for code, say, counts in (
        ("NOT_FINITE", "transforms", [edge.not_finite for edge in edges]),
        ("BAD_TRANSFORMS", "zero", [edge.zero_rotations for edge in edges]),
        ("BAD_TRANSFORMS", "not_normalised", [edge.not_normalised for edge in edges]),
    ):
        affected = [edge for edge, count in zip(edges, counts, strict=True) if count]
        if affected:
            yield found(code, say=say, count=sum(counts), edges=_named(affected))
    moving = [(edge, edge.timing) for edge in edges if edge.timing is not None]
    for say, affected, cases in (
        ("backward", [e for e, t in moving if t.backward_stamps], ()),
        ("unstamped", [e for e, t in moving if t.zero_stamps], ()),
        (
            "repeated",
            [e for e, t in moving if t.duplicate_stamps and not t.zero_stamps],
            ("repeated",),
        ),
    ):
        if affected:
            yield found("BAD_TRANSFORMS", *cases, say=say, edges=_named(affected))
    gaps = [(edge, timing) for edge, timing in moving if timing.gaps]
    if gaps:
        longest, late = max(timing.longest_gap_s for _, timing in gaps), [edge for edge, _ in gaps]
        yield found("BAD_TRANSFORMS", say="gaps", longest=longest, edges=_named(late))


def _named(edges: Sequence[FrameEdge]) -> str:
    return listed([f"{edge.parent} -> {edge.child}" for edge in edges], _NAMED)
