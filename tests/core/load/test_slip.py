"""Slip of feet whose contact points go known ways."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.stances import Stances
from dogbot_logtool.core.loads import slip_m
from tests.core.load.feet import foot, seconds, stance_phase, vertical

TIME = seconds(8.0)
STANCE = stance_phase(TIME, 0.0)


def stances(way_m: Floats) -> Stances:
    """Stances of a foot whose contact point goes the same way along x in each."""
    point = np.stack([way_m, 0.0 * way_m, 0.0 * way_m], axis=1)
    return foot(TIME, vertical(TIME, 0.0), point).stances


def ways(way_m: Floats) -> tuple[float, float]:
    """Median travel and reach of the contact point, m."""
    found = stances(way_m)
    figures = found.figures
    return (
        float(np.median(figures.contact_travel_m[found.whole])),
        float(np.median(figures.contact_reach_m[found.whole])),
    )


@pytest.mark.parametrize("slip", [0.0, 0.005, 0.05])
def test_a_steady_slip_is_its_way_from_a_tenth_to_nine_tenths(slip: float) -> None:
    travel, reach = ways(slip * STANCE)
    assert travel == pytest.approx(0.8 * slip, rel=0.05, abs=1e-9)
    assert reach == pytest.approx(travel, abs=1e-9)


def test_a_foot_that_slips_and_comes_back_has_the_largest_slip_only() -> None:
    travel, reach = ways(0.04 * np.sin(np.pi * STANCE))
    assert travel < 0.005
    # Contact begins at the threshold, 3 % of the way into the half sine.
    assert reach == pytest.approx(0.04 * (1.0 - np.sin((0.03 + 0.1 * 0.97) * np.pi)), rel=0.03)


def test_a_round_foot_that_rolls_does_not_slip() -> None:
    found = stances(0.012 * STANCE)
    travel = found.figures.contact_travel_m[found.whole]
    assert slip_m(travel, 0.012).max() == 0.0
    assert slip_m(travel, 0.002) == pytest.approx(travel - 0.002)


def test_slip_is_not_known_where_rolling_is_not() -> None:
    assert np.isnan(slip_m(np.array([0.0, 0.02, 0.5]), None)).all()


def test_slip_is_not_known_without_contact_points() -> None:
    assert np.isnan(slip_m(np.array([np.nan]), 0.01)).all()
