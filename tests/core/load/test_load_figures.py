"""Shares, impulses and weights of feet whose loads are known in closed form."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.strides import strides_of
from dogbot_logtool.core.loads import (
    WalkLoads,
    loads_of,
    symmetry_index_percent,
    whole_strides,
)
from tests.core.load.feet import PERIOD_S, TROT, WEIGHT_N, foot, seconds, vertical


def strides(record: FootHistory) -> Ints:
    return strides_of(record.stances, record.gaps, timespans.no_spans())[0].spans


def trot(
    duration_s: float, shares: Sequence[float] = (0.25,) * 4, scale: float = 1.0
) -> list[FootHistory]:
    time = seconds(duration_s)
    return [
        foot(time, scale * vertical(time, phase, share))
        for phase, share in zip(TROT, shares, strict=True)
    ]


def figures(feet: Sequence[FootHistory], weight_n: float | None = WEIGHT_N) -> WalkLoads:
    return loads_of(feet, weight_n, strides(feet[0]))


@pytest.mark.parametrize("duration_s", [2.0, 2.3, 2.6, 3.05, 9.1])
def test_parts_of_strides_at_the_ends_do_not_shift_the_shares(duration_s: float) -> None:
    loads = figures(trot(duration_s, shares=(0.3, 0.3, 0.2, 0.2)))
    assert loads.over_strides
    assert loads.known_s / PERIOD_S == pytest.approx(round(loads.known_s / PERIOD_S), abs=0.01)
    assert loads.vertical_impulse_over_weight == pytest.approx(1.0, abs=0.003)
    assert loads.shares == pytest.approx((0.3, 0.3, 0.2, 0.2), abs=0.002)


def test_a_stride_with_a_gap_in_any_foot_is_left_out() -> None:
    feet = trot(9.0)
    time = seconds(9.0)
    heard = (time < 3.0) | (time > 3.3)
    feet[2] = foot(time[heard], vertical(time, TROT[2])[heard])
    spans = whole_strides(strides(feet[0]), feet, vertical=True)
    assert len(spans) == 2
    assert timespans.total(timespans.intersect([spans, feet[2].gaps])) == 0
    assert timespans.total(spans) / 1e9 == pytest.approx(9 * PERIOD_S, abs=0.02)
    assert figures(feet).shares == pytest.approx((0.25,) * 4, abs=0.002)


def test_the_index_is_positive_when_the_right_side_has_more() -> None:
    assert symmetry_index_percent(90.0, 110.0) == pytest.approx(20.0)
    assert symmetry_index_percent(110.0, 90.0) == pytest.approx(-20.0)


@pytest.mark.parametrize(
    ("vertical_n", "magnitude_n", "told"),
    [
        (200.0, 200.5, False),  # hardly leans
        (200.0, 260.0, False),  # the vertical force is the weight
        (154.0, 200.0, True),  # all of the force is
        (180.0, 215.0, True),  # neither is, all of the force is nearer
        (180.0, 240.0, False),  # neither is, the vertical force is nearer
    ],
)
def test_forces_that_lean_may_be_tilted_where_the_weight_says_so(
    vertical_n: float, magnitude_n: float, *, told: bool
) -> None:
    loads = replace(figures(trot(3.0)), mean_vertical_n=vertical_n, mean_magnitude_n=magnitude_n)
    assert loads.may_be_tilted == told
    leans = magnitude_n > 1.01 * vertical_n
    assert replace(loads, body_weight_n=None).may_be_tilted == leans
