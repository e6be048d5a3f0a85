"""The plane through contact points."""

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.ground import height_drift_m, slope_rad, swapped_pairs
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.leg_position import CORNERS
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


def base(yaw: float = 0.0) -> BaseHistory:
    """A base that walks between the feet, straight on, its x axis turned."""
    zero = np.zeros_like(TIME)
    way = 0.5 * TIME
    return BaseHistory(
        messages=len(TIME),
        not_usable=0,
        not_advancing=0,
        time=np.round(TIME * 1e9).astype(np.int64),
        position=np.stack([way, zero, zero + 0.45], axis=1),
        angles=np.stack([zero, zero, zero + yaw], axis=1),
        gaps=timespans.no_spans(),
    )


@pytest.mark.parametrize("forward_rad", [0.0, np.pi / 2.0, np.pi])
def test_left_feet_are_on_the_left(forward_rad: float) -> None:
    turned = base(-forward_rad)
    feet = walking_on(0.0)
    assert swapped_pairs(turned, feet, CORNERS, forward_rad) == ((), 2)
    assert swapped_pairs(turned, feet[:3], CORNERS[:3], forward_rad) == ((), 1)
    crossed = walking_on(0.0, left_m=0.005)
    assert swapped_pairs(turned, crossed, CORNERS, forward_rad) == ((), 2)


def test_swapped_feet_are_told_by_their_contact_points() -> None:
    front_left, front_right, *hind = walking_on(0.0)
    fore_swapped = [front_right, front_left, *hind]
    assert swapped_pairs(base(), fore_swapped, CORNERS, 0.0) == (((0, 1),), 2)
    assert swapped_pairs(base(), walking_on(0.0, left_m=-0.15), CORNERS, 0.0) == (
        ((0, 1), (2, 3)),
        2,
    )
    assert swapped_pairs(base(), fore_swapped, (None,) * 4, 0.0) == ((), 0)


def strides(until_s: float = 8.0) -> Ints:
    start = np.arange(0.0, until_s - 0.7, 0.8)
    return np.round(np.stack([start, start + 0.8], axis=1) * 1e9).astype(np.int64)


@pytest.mark.parametrize("rise_m", [0.3, -0.2])
def test_a_height_that_drifts(rise_m: float) -> None:
    height = 0.45 + rise_m * TIME / 8.0 + 0.01 * np.sin(9.0 * TIME)
    assert height_drift_m(base(), height, strides()) == pytest.approx(rise_m, rel=0.05)


def test_a_robot_that_crouches_or_hardly_rises_does_not_drift() -> None:
    crouches = np.where(TIME > 4.0, 0.25, 0.45)
    assert height_drift_m(base(), crouches, strides()) == 0.0
    assert height_drift_m(base(), 0.45 + 0.008 * TIME, strides()) == 0.0
    rises = 0.2 + 0.05 * TIME
    assert height_drift_m(base(), rises, timespans.no_spans()) == 0.0
    assert height_drift_m(base(), np.full_like(TIME, np.nan), strides()) == 0.0
