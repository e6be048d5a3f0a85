"""Wrong signs of efforts, on a robot in a physics engine that walks on level and sloping ground."""

from functools import cache
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import free_walker, physics
from tests.truth.recording import Floats

SECONDS: Final = 5.0
AHEAD: Final[free_walker.Steps] = ((-9.0, (0.4, 0.0, 0.0)),)
DOWN_RAD, UP_RAD = np.radians(12.0), np.radians(-10.0)
ALL: Final = tuple(range(12))
LEG: Final = (3, 4, 5)
"""Joints of front_right."""
WAYS: Final = {
    "transforms": {"by_transforms": True},
    "joints": {"by_transforms": False, "points": True},
    "force sensors": {"by_transforms": False},
}
LOGS: Final = (
    (0.0, "transforms"),
    (0.0, "joints"),
    (0.0, "force sensors"),
    (DOWN_RAD, "transforms"),
    (UP_RAD, "force sensors"),
)


def robot(slope_rad: float) -> physics.Physics:
    return free_walker.walker(AHEAD, SECONDS, slope_rad=slope_rad)


@cache
def measured(slope_rad: float, way: str, turned: tuple[int, ...] = ()) -> dl.Walk:
    def change(position: Floats, velocity: Floats, effort: Floats) -> tuple[Floats, ...]:
        return position, velocity, np.where(np.isin(ALL, turned), -effort, effort)

    options: dict[str, Any] = WAYS[way]
    return physics.measured(robot(slope_rad), change=change, **options)


def doubts(walk: dl.Walk) -> list[str]:
    return [each["text"] for each in walk.stats["findings"] if each["code"] == "EFFORT_SIGN"]


def true_work(slope_rad: float) -> tuple[float, float]:
    """J a stride, positive and net, of all joints over the middle strides."""
    truth = robot(slope_rad)
    rows = slice(*(round(each * physics.PERIOD_S / free_walker.KEPT_S) for each in (1, 8)))
    power = (truth.torque * truth.velocity)[rows]
    a_stride = physics.PERIOD_S / len(power)
    return float(power.clip(0.0).sum() * a_stride), float(power.sum() * a_stride)


@pytest.mark.parametrize(("slope_rad", "way"), LOGS)
def test_right_signs_are_not_doubted(slope_rad: float, way: str) -> None:
    walk = measured(slope_rad, way)
    positive, net = true_work(slope_rad)
    assert (net < 0.0) == (slope_rad == DOWN_RAD)
    assert doubts(walk) == []
    legs = walk.stats["legs"]
    assert legs["positive_work_j"]["mean"] == pytest.approx(positive, rel=0.03)
    found = 2.0 * legs["positive_work_j"]["mean"] - legs["absolute_work_j"]["mean"]
    assert found == pytest.approx(net, abs=0.03 * legs["absolute_work_j"]["mean"])


@pytest.mark.parametrize(("slope_rad", "way"), LOGS)
def test_all_signs_wrong(slope_rad: float, way: str) -> None:
    walk, right = measured(slope_rad, way, ALL), measured(slope_rad, way)
    assert len(doubts(walk)) == 1
    legs, true = walk.stats["legs"], right.stats["legs"]
    assert legs["positive_work_j"] is None
    assert np.isnan(walk.strides["positive_work_j"]).all()
    # These are the same with either sign.
    assert legs["absolute_work_j"] == true["absolute_work_j"]
    assert legs["mechanical_cost_of_transport"] == true["mechanical_cost_of_transport"]
    np.testing.assert_array_equal(walk.strides["absolute_work_j"], right.strides["absolute_work_j"])


@pytest.mark.parametrize(
    ("way", "turned", "named"),
    [
        ("transforms", LEG, "FR_calf_joint, FR_thigh_joint"),
        ("joints", LEG[2:], "FR_calf_joint"),
        ("transforms", LEG[1:2], "FR_thigh_joint"),
    ],
    ids=["leg", "calf", "thigh"],
)
def test_a_leg_or_a_joint_with_the_wrong_sign(
    way: str, turned: tuple[int, ...], named: str
) -> None:
    walk, right = measured(0.0, way, turned), measured(0.0, way)
    (text,) = doubts(walk)
    assert f"({named})" in text
    assert walk.stats["legs"]["positive_work_j"] is None
    strides, true = walk.strides, right.strides
    doubted = strides["foot"] == "front_right"
    assert np.isnan(strides["positive_work_j"][doubted]).all()
    np.testing.assert_array_equal(
        strides["positive_work_j"][~doubted], true["positive_work_j"][~doubted]
    )
    np.testing.assert_array_equal(strides["absolute_work_j"], true["absolute_work_j"])


def test_what_nothing_contradicts_is_not_doubted() -> None:
    """Downhill motors may do any work, and force sensors tell no direction."""
    assert doubts(measured(DOWN_RAD, "force sensors", ALL)) == []
