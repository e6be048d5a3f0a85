"""Segments of walks whose strides are known to the nanosecond."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.gait.segments import (
    FootEvents,
    GaitInput,
    Segment,
    find_segments,
    transition_strides,
)
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.gait.support import Standing

S = 1_000_000_000
TROT = (0.0, 0.5, 0.5, 0.0)
WALK = (0.0, 0.5, 0.75, 0.25)
PRONK = (0.0, 0.0, 0.0, 0.0)
NOWHERE = timespans.no_spans()
Part = tuple[tuple[float, ...], int, float, float]
"""Phases, strides, period in s, duty factor."""


def gait(parts: Sequence[Part], standing: Ints = NOWHERE, moving: Ints = NOWHERE) -> GaitInput:
    feet = []
    for foot in range(4):
        touchdown, liftoff, begin = [], [], 0.0
        for phases, strides, period_s, duty in parts:
            for stride in range(strides):
                at = begin + (stride + phases[foot]) * period_s
                touchdown.append(round(at * S))
                liftoff.append(round((at + duty * period_s) * S))
            begin += strides * period_s
        time = np.array(touchdown, np.int64)
        whole = Strides(
            np.arange(len(time) - 1), time[:-1], np.array(liftoff[:-1], np.int64), time[1:]
        )
        feet.append(FootEvents(whole, time))
    return GaitInput(
        feet=tuple(feet),
        reference=0,
        hind_reference=2,
        order=(0, 1, 2, 3),
        standing=Standing(standing, moving, NOWHERE),
        support=None,
    )


def split(foot: FootEvents, stride: int, at: float) -> FootEvents:
    """Lift a foot for 40 ms in a stance, so that the stride becomes two."""
    touchdown = np.insert(foot.touchdown, stride + 1, foot.touchdown[stride] + round(at * S))
    liftoff = np.insert(foot.strides.liftoff, stride, touchdown[stride + 1] - S // 25)
    strides = Strides(np.arange(len(liftoff)), touchdown[:-1], liftoff, touchdown[1:])
    return FootEvents(strides, touchdown)


def names(segments: Sequence[Segment]) -> list[str | None]:
    return [segment.gait.name for segment in segments]


def test_one_gait_is_one_segment() -> None:
    segments = find_segments(gait([(TROT, 10, 0.8, 0.6)]))
    assert names(segments) == ["trot"]
    assert segments[0].strides == 9
    assert segments[0].duty_factor == pytest.approx(0.6)
    assert segments[0].duty_below_half is False


def test_another_class_begins_another_segment_and_the_strides_between_belong_to_neither() -> None:
    walked = gait([(TROT, 10, 0.8, 0.6), (WALK, 10, 0.8, 0.6)])
    segments = find_segments(walked)
    assert names(segments) == ["trot", "walk"]
    assert segments[0].end <= 8 * S <= segments[1].start
    strides = walked.feet[0].strides
    between = transition_strides(segments, strides)
    assert between == len(strides.stance) - segments[0].strides - segments[1].strides
    assert 1 <= between <= 2


def test_another_period_begins_another_segment() -> None:
    segments = find_segments(gait([(TROT, 8, 0.8, 0.6), (TROT, 8, 0.5, 0.6)]))
    assert names(segments) == ["trot", "trot"]
    assert segments[0].stride_frequency_hz == pytest.approx(1.25)
    assert segments[1].stride_frequency_hz == pytest.approx(2.0)


def test_a_duty_factor_that_falls_below_one_half_makes_a_walk_an_amble() -> None:
    segments = find_segments(gait([(WALK, 8, 0.8, 0.7), (WALK, 8, 0.8, 0.4)]))
    assert names(segments) == ["walk", "amble"]


def test_a_single_odd_stride_does_not_cut() -> None:
    stumble = (TROT, 1, 1.2, 0.6)
    segments = find_segments(gait([(TROT, 8, 0.8, 0.6), stumble, (TROT, 8, 0.8, 0.6)]))
    assert names(segments) == ["trot"]


def test_a_stride_on_the_way_to_a_longer_period_is_no_segment() -> None:
    found = find_segments(
        gait([(PRONK, 8, 1.0, 0.4), (PRONK, 1, 1.25, 0.4), (PRONK, 6, 1.52, 0.4)])
    )
    assert [segment.strides for segment in found] == [8, 5]


def test_a_ramp_from_one_gait_to_another_is_a_transition() -> None:
    ramp = [((0.0, 0.5, 0.5 + step / 16, step / 16), 1, 0.8, 0.6) for step in (1, 2, 3)]
    walked = gait([(TROT, 8, 0.8, 0.6), *ramp, (WALK, 8, 0.8, 0.6)])
    assert names(find_segments(walked)) == ["trot", "walk"]


def test_two_strides_are_a_gait_where_there_are_no_more() -> None:
    assert names(find_segments(gait([(TROT, 3, 0.8, 0.6)]))) == ["trot"]
    assert names(find_segments(gait([(TROT, 2, 0.8, 0.6)]))) == ["trot"]


def test_phases_are_given_against_the_left_hind_foot_too() -> None:
    (segment,) = find_segments(gait([(WALK, 10, 0.8, 0.6)]))
    assert segment.hind_phases is not None
    means = [phase.mean for phase in segment.hind_phases if phase is not None]
    assert means == pytest.approx([0.25, 0.75, 0.0, 0.5], abs=1e-6)


def test_a_base_that_moves_without_steps_has_no_gait() -> None:
    moving = np.array([[20 * S, 30 * S]], np.int64)
    segments = find_segments(gait([(TROT, 5, 0.8, 0.6)], moving=moving))
    assert names(segments) == ["trot", None]
    assert segments[1].moves_without_steps


def test_a_slow_crawl_is_a_walk() -> None:
    (segment,) = find_segments(gait([(WALK, 4, 40.0, 0.9)]))
    assert (segment.gait.name, segment.strides) == ("walk", 3)


def test_a_stride_that_is_split_in_two_does_not_cut_and_is_left_out() -> None:
    walked = gait([(WALK, 16, 1.0, 0.7)])
    walked = replace(walked, feet=(split(walked.feet[0], 8, 0.5), *walked.feet[1:]))
    segments = find_segments(walked)
    assert names(segments) == ["walk"]
    assert segments[0].phases[1] is not None
    assert segments[0].phases[1].consistency > 0.99
    assert segments[0].stride_frequency_hz == pytest.approx(1.0)
    assert transition_strides(segments, walked.feet[0].strides) == 2


def test_two_strides_of_another_gait_between_are_a_segment() -> None:
    walked = gait([(WALK, 8, 1.0, 0.7), (PRONK, 3, 1.0, 0.7), (WALK, 8, 1.0, 0.7)])
    assert names(find_segments(walked)) == ["walk", "pronk", "walk"]
