"""Trees of frames against plain reachability, poses of frames over time, and loops."""

import string
from itertools import pairwise
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.frames.kinematics import Joint, link_poses
from dogbot_logtool.core.frames.transforms import (
    DEEPEST,
    Edge,
    FrameEdge,
    FrameTrack,
    Poses,
    SecondParent,
    Transforms,
    lookup,
    loops,
    roots,
    second_parents,
    track_of,
    trees,
    walk,
)
from dogbot_logtool.core.rotations import rotate
from tests.oracles.frames import turn_of
from tests.truth.geometry import about_axis

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


MS = 1_000_000


def at(*milliseconds: float) -> Ints:
    return np.array([round(each * MS) for each in milliseconds], np.int64)


def tracks_of(
    parent: str,
    child: str,
    time: Ints,
    log_time: Ints,
    shift: Floats,
    turn: Floats,
    *,
    static: bool = False,
) -> dict[str, FrameTrack]:
    channel, is_static = np.zeros_like(time), np.full(len(time), static)
    recorded = Transforms(channel, is_static, log_time, time, shift, turn)
    track = track_of(parent, recorded, TimeSource.HEADER)
    return {child: track} if track else {}


def spinning(time: Ints, log_time: Ints | None = None) -> dict[str, FrameTrack]:
    """A base that turns about z at 1 rad/s and moves along x at 2 m/s; a link bent by 0.3 rad."""
    seconds = time / 1e9
    log_time = time if log_time is None else log_time
    shift = np.stack([2.0 * seconds, 0.0 * seconds, 0.0 * seconds], axis=1)
    bend, beside = about_axis(0, np.array([0.3])), np.array([[0.0, 1.0, 0.0]])
    base = tracks_of("world", "base_link", time, log_time, shift, about_axis(2, seconds))
    return base | tracks_of("base_link", "leg", at(0), at(0), beside, bend, static=True)


def look(tracks: dict[str, FrameTrack], time: Ints, world: str = "world") -> Poses:
    return lookup(tracks, "leg", world, time, time)


def test_poses_are_interpolated_along_the_chain() -> None:
    poses = look(spinning(at(0, 20, 40, 60)), at(33))
    angle = 0.033
    assert poses.known.all()
    assert poses.translation[0] == pytest.approx([0.066 - np.sin(angle), np.cos(angle), 0.0])
    # The link's z axis: bent about x by 0.3 rad, then turned about z.
    axis = rotate(poses.rotation, np.array([[0.0, 0.0, 1.0]]))[0]
    tilt = np.sin(0.3)
    assert axis == pytest.approx([tilt * np.sin(angle), -tilt * np.cos(angle), np.cos(0.3)])


def test_nothing_is_extrapolated_and_no_gap_is_bridged() -> None:
    tracks = spinning(at(20, 40, 240, 260))
    known = look(tracks, at(10, 20, 30, 40, 140, 240, 250, 270)).known
    assert known.tolist() == [False, True, True, True, False, True, True, False]


def test_what_was_recorded_long_before_or_after_is_not_used() -> None:
    tracks = spinning(at(0, 20, 40), at(0, 20, 2100))
    known = lookup(tracks, "leg", "world", at(10, 30, 30, 10), at(10, 30, 101, 2010)).known
    assert known.tolist() == [True, False, True, False]


def test_a_loop_of_frames_ends() -> None:
    still = np.zeros((1, 3)), about_axis(2, np.zeros(1))
    tracks = tracks_of("a", "b", at(0), at(0), *still) | tracks_of("b", "a", at(0), at(0), *still)
    assert not lookup(tracks, "a", "world", at(0), at(0)).known.any()


def test_what_cannot_be_a_transform_is_left_out() -> None:
    shift = np.zeros((6, 3))
    shift[1, 0] = np.nan
    turn = about_axis(2, np.zeros(6))
    turn[2] = 0.0
    time, log_time = at(0, 10, 20, 30, 30, 25), at(0, 10, 20, 30, 40, 50)
    tracks = tracks_of("world", "base", time, log_time, shift, turn)
    assert tracks["base"].time.tolist() == at(0, 30).tolist()


def test_the_latest_static_transform_holds() -> None:
    shift = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    tracks = tracks_of(
        "base", "leg", at(7, 7), at(7, 8), shift, about_axis(2, np.zeros(2)), static=True
    )
    assert lookup(tracks, "leg", "base", at(0), at(0)).translation[0].tolist() == [2.0, 0.0, 0.0]


def test_huge_numbers_are_no_error() -> None:
    still = about_axis(2, np.zeros(2))
    shift = np.full((2, 3), 1e308) * np.array([[1.0], [-1.0]])
    tracks = tracks_of("world", "leg", at(0, 20), at(0, 20), shift, still)
    assert look(tracks, at(10)).known.all()


def test_a_prismatic_joint_moves_along_its_axis_and_a_mimic_has_an_offset() -> None:
    turned = (0.0, 0.0, sin(pi / 6), cos(pi / 6))
    zero = (0.0, 0.0, 0.0)
    slides = Joint("j", "a", "b", "prismatic", (1.0, 0.0, 0.0), turned, (2 / 7, 3 / 7, 6 / 7))
    follows = Joint(
        "m", "b", "c", "revolute", zero, turned, source="j", multiplier=-2.0, offset=0.5
    )
    shift, turn = link_poses([slides, follows], np.array([[0.7, 0.4]]))
    along = turn_of(turned) @ (2 / 7, 3 / 7, 6 / 7)
    np.testing.assert_allclose(shift[0, 0], np.array([1.0, 0.0, 0.0]) + 0.7 * along, atol=1e-12)
    half = (-2.0 * 0.4 + 0.5) / 2.0
    expected = turn_of(turned) @ turn_of((sin(half), 0.0, 0.0, cos(half)))
    np.testing.assert_allclose(turn_of(turn[0, 1]), expected, atol=1e-12)
