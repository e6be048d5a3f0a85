"""Roots, trees, loops and second parents, against plain reachability."""

import string
from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.frames.transforms import (
    DEEPEST,
    Edge,
    FrameEdge,
    SecondParent,
    loops,
    roots,
    second_parents,
    trees,
    walk,
)

graphs = st.lists(
    st.tuples(*(st.sampled_from(string.ascii_lowercase[:7]) for _ in "ab")), max_size=14
)


def edge(parent: str, child: str, first: int, last: int, *, static: bool = False) -> FrameEdge:
    return FrameEdge(parent, child, 2, 2 * static, None, (1,), first, last, 0, 0, 0)


def reachable(pairs: list[Edge]) -> set[Edge]:
    """Every (ancestor, descendant), by Warshall's algorithm."""
    closed = set(pairs)
    frames = {frame for pair in pairs for frame in pair}
    for middle in frames:
        closed |= {(a, b) for a in frames for b in frames if {(a, middle), (middle, b)} <= closed}
    return closed


def test_parents_at_once_and_one_after_another() -> None:
    after = [edge("table", "cup", 0, 5), edge("hand", "cup", 6, 9)]
    assert second_parents(after) == [SecondParent("cup", ("table", "hand"), at_once=False)]
    mixed = [edge("odom", "base", 4, 9), edge("map", "base", 0, 5), edge("base", "leg", 0, 9)]
    assert second_parents(mixed) == [SecondParent("base", ("map", "odom"), at_once=True)]
    static = [edge("a", "b", 0, 1, static=True), edge("c", "b", 6, 9)]
    assert second_parents(static)[0].at_once


def test_a_chain_of_thousands_ends() -> None:
    names = [f"f{number}" for number in range(2000)]
    pairs = list(pairwise(names))
    assert loops(pairs) == []
    assert loops([*pairs, (names[-1], names[0])]) == [names]
    rows = list(walk(pairs))
    assert {row.frame for row in rows} == set(names)
    assert max(len(row.more) for row in rows) == DEEPEST
    assert rows[DEEPEST].cut


def test_a_ladder_of_second_parents_is_not_walked_again_and_again() -> None:
    pairs = [
        pair
        for level in range(40)
        for side in "ab"
        for pair in ((f"t{level}", f"{side}{level}"), (f"{side}{level}", f"t{level + 1}"))
    ]
    assert len(list(walk(pairs))) == len(pairs) + 1


@settings(max_examples=100, deadline=None)
@given(graphs)
def test_shapes_agree_with_reachability(pairs: list[Edge]) -> None:
    closed = reachable(pairs)
    frames = {frame for pair in pairs for frame in pair}
    looping = {frame for frame in frames if (frame, frame) in closed}

    found = loops(pairs)
    assert bool(found) == bool(looping)
    assert len({frame for loop in found for frame in loop}) == sum(map(len, found))
    for loop in found:
        assert set(zip(loop, [*loop[1:], loop[0]], strict=True)) <= set(pairs)

    connected = reachable([*pairs, *((b, a) for a, b in pairs)])
    parts = trees(pairs)
    assert sorted(frame for part in parts for frame in part) == sorted(frames)
    for part in parts:
        assert all({b for a, b in connected if a == frame} == set(part) for frame in part)

    assert roots(pairs) == sorted(frames - {child for _, child in pairs})
    rows = list(walk(pairs))
    assert sorted((row.parent, row.frame) for row in rows if row.parent) == sorted(set(pairs))
    assert sorted(row.frame for row in rows if not row.again) == sorted(frames)
