"""Rates, gaps and faults of frames, against a plain loop over the same transforms."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames import frame_tree as frame_edges
from dogbot_logtool.core.frames.frame_tree import FrameEdge, RecordedFrames, recorded_frames
from dogbot_logtool.core.frames.transforms import (
    RecordedTransforms,
    concatenate_transforms,
)

STATIC = 9
UNIT = (0.0, 0.0, 0.0, 1.0)
Row = tuple[str, str, int]
"""Parent, child, and stamp in ms; log time is 1 ms later."""


def columns(
    rows: Sequence[Row],
    *,
    channel: int = 1,
    rotations: Sequence[tuple[float, ...]] | None = None,
    shift: float = 0.0,
) -> RecordedTransforms:
    parents = tuple(dict.fromkeys(parent for parent, _, _ in rows))
    children = tuple(dict.fromkeys(child for _, child, _ in rows))
    stamp = np.array([each for _, _, each in rows], np.int64) * 1_000_000
    return RecordedTransforms(
        channel=np.full(len(rows), channel, np.int64),
        log_time=stamp + 1_000_000,
        stamp=stamp,
        parent=np.array([parents.index(parent) for parent, _, _ in rows], np.int64),
        parents=parents,
        child=np.array([children.index(child) for _, child, _ in rows], np.int64),
        children=children,
        translation=np.full((len(rows), 3), shift),
        rotation=np.array(rotations or [UNIT] * len(rows)).reshape(-1, 4),
    )


def record(*parts: RecordedTransforms) -> RecordedFrames:
    return recorded_frames(concatenate_transforms(parts), {STATIC})


def only_edge(*parts: RecordedTransforms) -> FrameEdge:
    (edge,) = record(*parts).edges
    return edge


def test_rate_intervals_and_gaps() -> None:
    times = [*range(1000, 2000, 20), *range(3000, 4000, 20)]
    edge = only_edge(columns([("world", "base", time) for time in times]))
    assert edge.timing is not None
    assert edge.transforms == 100
    assert edge.timing.rate_hz == pytest.approx(99 / 2.98)
    assert edge.timing.interval_s is not None
    assert edge.timing.interval_s["p50"] == pytest.approx(0.02)
    assert edge.timing.interval_s["max"] == pytest.approx(1.02)
    assert (edge.timing.gaps, edge.timing.clock) == (1, TimeSource.HEADER)
    assert edge.timing.gaps_total_s == pytest.approx(1.02)


def test_static_transforms_have_no_rate() -> None:
    edge = only_edge(columns([("a", "b", 0), ("a", "b", 5)], channel=STATIC))
    assert (edge.transforms, edge.static, edge.timing, edge.is_static) == (2, 2, None, True)
    both = only_edge(
        columns([("a", "b", 1)], channel=STATIC), columns([("a", "b", 2), ("a", "b", 3)])
    )
    assert (both.transforms, both.static, both.is_static) == (3, 1, False)
    assert both.timing is not None
    assert both.timing.messages == 2
    assert both.channels == (1, STATIC)


def test_slashes_are_taken_off_and_told() -> None:
    frames = record(columns([("/world", "base", 1), ("world", "/base", 2)]))
    assert [(edge.parent, edge.child) for edge in frames.edges] == [("world", "base")]
    assert frames.edges[0].transforms == 2
    assert frames.slashed == ("/base", "/world")


def test_frames_without_a_name_are_counted() -> None:
    frames = record(columns([("", "base", 1), ("world", "/", 2), ("world", "base", 3)]))
    assert (frames.unnamed, len(frames.edges)) == (2, 1)


def test_what_tf2_ignores_is_counted_once_a_transform() -> None:
    rotations = [
        UNIT,
        (0.0, 0.0, 0.0, 0.0),
        (np.nan, 0.0, 0.0, 1.0),
        (0.0, 0.0, 0.0, 1.1),
        (0.0, 0.0, 0.0, 1.004),  # within tf2's tolerance
        (1e200, 0.0, 0.0, 1.0),
    ]
    rows = [("a", "b", each) for each in range(len(rotations))]
    edge = only_edge(columns(rows, rotations=rotations))
    assert (edge.not_finite, edge.zero_rotations, edge.not_normalised) == (1, 1, 2)
    lost = only_edge(columns(rows[:1], shift=np.inf))
    assert lost.not_finite == 1


def test_stamps_of_zero_make_log_time_the_clock() -> None:
    edge = only_edge(columns([("a", "b", 0)] * 3))
    assert edge.timing is not None
    assert (edge.timing.clock, edge.timing.zero_stamps) == (TimeSource.LOG, 3)
    assert edge.timing.first == 1_000_000


def test_stamps_that_step_back_or_repeat_are_counted() -> None:
    edge = only_edge(columns([("a", "b", each) for each in (10, 20, 20, 15, 30)]))
    assert edge.timing is not None
    assert (edge.timing.duplicate_stamps, edge.timing.backward_stamps) == (1, 1)


def test_pairs_beyond_the_most_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(frame_edges, "MOST_EDGES", 3)
    frames = record(columns([("a", f"b{number % 5}", number) for number in range(20)]))
    assert [edge.child for edge in frames.edges] == ["b0", "b1", "b2"]
    assert frames.left_out == 8


def test_parts_are_joined_in_the_order_of_their_log_times() -> None:
    one = columns([("a", "b", 10), ("a", "c", 30)])
    other = columns([("x", "b", 5), ("a", "b", 20)], channel=2)
    joined = concatenate_transforms([one, other])
    told = [
        (joined.parents[parent], joined.children[child], channel)
        for parent, child, channel in zip(
            joined.parent, joined.child, joined.channel.tolist(), strict=True
        )
    ]
    assert told == [("x", "b", 2), ("a", "b", 1), ("a", "b", 2), ("a", "c", 1)]
    assert (np.diff(joined.log_time) > 0).all()
    edge = next(each for each in record(joined).edges if (each.parent, each.child) == ("a", "b"))
    assert edge.timing is not None
    assert edge.timing.backward_stamps == 0


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(st.sampled_from("ab"), st.sampled_from("cde"), st.integers(1, 3000)),
        min_size=1,
        max_size=60,
    )
)
def test_it_is_what_a_plain_loop_counts(rows: list[Row]) -> None:
    found = record(columns(rows))
    by_hand: dict[tuple[str, str], list[int]] = {}
    for parent, child, time in rows:
        by_hand.setdefault((parent, child), []).append(time)
    assert [(edge.parent, edge.child) for edge in found.edges] == sorted(by_hand)
    for edge in found.edges:
        times = by_hand[edge.parent, edge.child]
        steps = [b - a for a, b in pairwise(times)]
        assert edge.timing is not None
        assert edge.transforms == len(times)
        assert edge.timing.backward_stamps == sum(step < 0 for step in steps)
        assert edge.timing.duplicate_stamps == sum(step == 0 for step in steps)
        if times == sorted(times):
            # One that is out of order costs its message.
            assert edge.timing.first == min(times) * 10**6
            assert edge.timing.last == max(times) * 10**6
        forward = [step for step in steps if step > 0]
        if forward and times == sorted(times):
            assert edge.timing.interval_s is not None
            assert edge.timing.interval_s["max"] == pytest.approx(max(forward) / 1e3)
        assert (edge.first_log_time, edge.last_log_time) == (
            (min(times) + 1) * 10**6,
            (max(times) + 1) * 10**6,
        )
