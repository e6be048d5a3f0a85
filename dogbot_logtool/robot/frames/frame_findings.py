"""Findings about the frames of a log."""

from collections.abc import Iterable, Sequence
from typing import Final

from dogbot_logtool.core.frames import frame_tree
from dogbot_logtool.core.frames.frame_tree import MOST_EDGES, FrameEdge
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.robot.frames.frames import Frames

_NAMED: Final = 5
"""Frames that a finding names."""


def frame_findings(frames: Frames, added: tuple[str, str] | None) -> list[Finding]:
    """Return what is wrong with a log's frames.

    Args:
        frames: all frames.
        added: parent and child of the transform that `convert` adds.
    """
    edges = frames.recorded.edges
    pairs = [(edge.parent, edge.child) for edge in edges]
    return [
        *_shape_findings(edges, [*pairs, added] if added else pairs),
        *_rotation_findings(edges),
        *_timing_findings(edges),
        *_unread_findings(frames),
    ]


def _shape_findings(
    edges: Sequence[FrameEdge], pairs: Sequence[frame_tree.Pair]
) -> Iterable[Finding]:
    for loop in frame_tree.loops(pairs):
        more = ["..."] if len(loop) > _NAMED else []
        path = " -> ".join([*loop[:_NAMED], *more, loop[0]])
        yield Finding("FRAME_TREE", f"frames form a loop, so none of them has a place: {path}")
    for second in frame_tree.second_parents(edges):
        parents = listed(second.parents, _NAMED)
        if second.at_once:
            text = f"{second.child} has several parents at once, which break the tree: {parents}"
            yield Finding("FRAME_TREE", text)
        else:
            yield Finding(
                "FRAME_TREE",
                f"{second.child} has one parent after another: {parents}",
                cases=("new_parent",),
            )
    trees = frame_tree.trees(pairs)
    if len(trees) > 1:
        tops = [next(iter(_roots_in(tree, pairs)), tree[0]) for tree in trees]
        below = listed(tops, _NAMED)
        text = f"the frames are in {len(trees)} trees that nothing connects, below {below}"
        yield Finding("FRAME_TREE", text)
    both = [edge for edge in edges if 0 < edge.static < edge.transforms]
    if both:
        text = f"sent as static and as moving: {_edges(both)}"
        yield Finding("FRAME_TREE", text)


def _roots_in(tree: Sequence[str], pairs: Iterable[frame_tree.Pair]) -> list[str]:
    """Return the roots within a tree."""
    frames = set(tree)
    return frame_tree.roots(pair for pair in pairs if pair[0] in frames)


def _rotation_findings(edges: Sequence[FrameEdge]) -> Iterable[Finding]:
    for code, what, counts in (
        ("NOT_FINITE", "have numbers that are not finite", [edge.not_finite for edge in edges]),
        ("BAD_TRANSFORMS", "have a quaternion of zeros", [edge.zero_rotations for edge in edges]),
        (
            "BAD_TRANSFORMS",
            "have a quaternion that is not normalised",
            [edge.not_normalised for edge in edges],
        ),
    ):
        affected = [edge for edge, count in zip(edges, counts, strict=True) if count]
        if affected:
            text = f"{sum(counts):,} transforms {what}, and tf2 ignores them: {_edges(affected)}"
            yield Finding(code, text)


def _timing_findings(edges: Sequence[FrameEdge]) -> Iterable[Finding]:
    moving = [(edge, edge.timing) for edge in edges if edge.timing is not None]
    for what, affected, cases in (
        ("stamps go backwards", [e for e, t in moving if t.backward_stamps], ()),
        (
            "transforms have stamps of zero, their log time is used",
            [e for e, t in moving if t.zero_stamps],
            (),
        ),
        (
            "stamps are repeated, of which tf2 keeps the first",
            [e for e, t in moving if t.duplicate_stamps and not t.zero_stamps],
            ("repeated",),
        ),
    ):
        if affected:
            yield Finding("BAD_TRANSFORMS", f"{what}: {_edges(affected)}", cases=cases)
    gaps = [(edge, timing) for edge, timing in moving if timing.gaps]
    if gaps:
        longest = max(timing.longest_gap_s for _, timing in gaps)
        text = f"transforms have gaps, the longest {longest:.3g} s: {_edges([g[0] for g in gaps])}"
        yield Finding("BAD_TRANSFORMS", text)


def _unread_findings(frames: Frames) -> Iterable[Finding]:
    recorded = frames.recorded
    if recorded.unnamed:
        text = f"{recorded.unnamed:,} transforms do not name a parent or a child"
        yield Finding("FRAME_NAMES", text)
    if recorded.left_out:
        text = (
            f"{recorded.left_out:,} transforms were left out: there are over {MOST_EDGES:,} pairs"
        )
        yield Finding("FRAME_NAMES", f"{text} of frames")
    for channel in frames.unread:
        text = f"transforms on {channel.topic} are encoded as {channel.message_encoding!r}"
        yield Finding(
            "UNREADABLE", f"{text}, which is not read", channel.topic, cases=("one_topic",)
        )


def _edges(edges: Sequence[FrameEdge]) -> str:
    return listed([f"{edge.parent} -> {edge.child}" for edge in edges], _NAMED)
