"""The plane through contact points."""

import numpy as np
import pytest

from dogbot_logtool.core.base.ground import slope_rad
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.geometry.arrays import Floats
from tests.core.load.feet import foot, seconds, vertical

TIME = seconds(8.0)


def walking_on(slope: float, bump_m: float = 0.0, left_m: float = 0.15) -> list[FootHistory]:
    """Four feet that step forward by 0.4 m a stride on a plane; one pair stands on bumps."""
    along = 0.4 * np.floor(TIME / 0.8)
    feet = []
    corners = ((0.3, left_m), (0.3, -left_m), (-0.3, left_m), (-0.3, -left_m))
    for number, (x, y) in enumerate(corners):
        way: Floats = along + x
        height = np.tan(slope) * way + (bump_m if number in {0, 3} else 0.0)
        point = np.stack([way, np.full(len(way), y), height], axis=1)
        feet.append(foot(TIME, vertical(TIME, 0.0), point))
    return feet


@pytest.mark.parametrize("slope", [0.0, 0.2, -0.5])
def test_a_plane_has_its_slope(slope: float) -> None:
    assert slope_rad(walking_on(slope)) == pytest.approx(abs(slope), abs=1e-6)


def test_points_off_a_plane_have_none() -> None:
    """The feet's plane leaves 0.03 m of a width of 0.15 m, each root mean square."""
    assert slope_rad(walking_on(0.0, bump_m=0.06)) is None
    assert slope_rad(walking_on(0.0, bump_m=0.02)) is not None


def test_feet_in_a_row_have_no_plane() -> None:
    """Less than 1 mm apart, root mean square."""
    assert slope_rad(walking_on(0.1, left_m=0.0009)) is None
    assert slope_rad(walking_on(0.1, left_m=0.0011)) == pytest.approx(0.1, abs=1e-6)


def test_three_points_are_enough_and_two_are_not() -> None:
    feet, one_stride = walking_on(0.2), np.array([[1_000_000_000, 1_800_000_000]])
    assert slope_rad(feet[:3], one_stride) == pytest.approx(0.2, abs=1e-6)
    assert slope_rad(feet[:2], one_stride) is None
