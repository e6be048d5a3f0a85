"""Shares, impulses and weights of feet whose loads are known in closed form."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.strides import strides_of
from dogbot_logtool.core.loads import (
    WalkLoads,
    WeightSource,
    grouped_shares,
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


@pytest.mark.parametrize("scale", [0.85, 1.0, 1.15])
def test_a_mass_that_the_feet_bear_out_gives_body_weights(scale: float) -> None:
    loads = figures(trot(9.0, scale=scale))
    assert (loads.weight_n, loads.weight_source) == (WEIGHT_N, WeightSource.MASS)
    assert loads.vertical_impulse_over_weight == pytest.approx(scale, abs=0.003)


@pytest.mark.parametrize("scale", [0.75, 1.25, 3.0])
def test_a_mass_that_the_feet_refute_gives_none(scale: float) -> None:
    feet = trot(9.0, scale=scale)
    assert figures(feet).weight_n is None
    assert figures(feet).vertical_impulse_over_weight == pytest.approx(scale, abs=0.01)
    assumed = loads_of(feet, WEIGHT_N, strides(feet[0]), mass_is_assumed=True)
    assert assumed.weight_refuted
    assert assumed.mean_vertical_n == pytest.approx(scale * WEIGHT_N, rel=0.003)


def test_a_foot_that_is_never_seen_to_touch_does_not_refute_the_mass() -> None:
    feet = trot(9.0)
    time = seconds(9.0)
    feet[3] = foot(time, np.zeros(len(time)))
    assert figures(feet).weight_n == WEIGHT_N
    assert figures(feet).vertical_impulse_over_weight == pytest.approx(0.75, abs=0.01)
    assert figures(feet, None).weight_n is None


def test_without_a_mass_the_weight_is_that_of_whole_strides() -> None:
    loads = figures(trot(9.1), None)
    assert loads.weight_source is WeightSource.ESTIMATED
    assert loads.weight_n == pytest.approx(WEIGHT_N, rel=0.003)
    assert loads.vertical_impulse_over_weight is None


def test_forces_of_unknown_direction_tell_no_weight() -> None:
    time = seconds(9.0)
    feet = [foot(time, vertical(time, phase), world=False) for phase in TROT]
    loads = figures(feet, None)
    assert (loads.weight_n, loads.mean_vertical_n) == (None, None)
    assert loads.share_of == "force_impulse"
    assert loads.shares == pytest.approx((0.25,) * 4, abs=0.002)


def test_the_index_is_positive_when_the_right_side_has_more() -> None:
    assert symmetry_index_percent(90.0, 110.0) == pytest.approx(20.0)
    assert symmetry_index_percent(110.0, 90.0) == pytest.approx(-20.0)


def test_shares_are_added_up_by_place() -> None:
    places = [("front", "left"), ("front", "right"), ("back", "left"), ("back", "right")]
    shares = grouped_shares([0.2, 0.3, 0.1, 0.4], places)
    assert shares == pytest.approx({"fore": 0.5, "hind": 0.5, "left": 0.3, "right": 0.7})


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
