"""Wrong signs of efforts, on a robot in a physics engine that walks on level and sloping ground."""

from functools import cache
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import physics
from tests.truth.free_walker import PERIOD_S, quadruped

SECONDS: Final = 5.0
DOWN_RAD, UP_RAD = np.radians(12.0), np.radians(-10.0)
ALL: Final = tuple(range(12))
LEG: Final = (3, 4, 5)
"""Joints of front_right."""
WAYS: Final = {
    "transforms": {"by_transforms": True},
    "joints": {"by_transforms": False, "points": True},
    "force sensors": {"by_transforms": False},
}


@cache
def measured(slope_rad: float, way: str, turned: tuple[int, ...] = ()) -> dl.Walk:
    signs = np.where(np.isin(ALL, turned), -1.0, 1.0)
    robot = quadruped(seconds=SECONDS, slope_rad=slope_rad)
    options: dict[str, Any] = WAYS[way]
    return physics.measured(robot.telling(lambda q, v, e: (q, v, signs * e)), **options)


def doubts(walk: dl.Walk) -> list[str]:
    return [each["text"] for each in walk.stats["findings"] if each["code"] == "EFFORT_SIGN"]


def true_work(slope_rad: float) -> tuple[float, float]:
    """J a stride, positive and net, of all joints over the middle strides."""
    truth = quadruped(seconds=SECONDS, slope_rad=slope_rad)
    rows = slice(*(round(each * PERIOD_S / physics.KEPT_S) for each in (1, 8)))
    power = (truth.torque * truth.velocity)[rows]
    a_stride = PERIOD_S / len(power)
    return float(power.clip(0.0).sum() * a_stride), float(power.sum() * a_stride)


@pytest.mark.parametrize(
    ("slope_rad", "way"),
    [*((0.0, way) for way in WAYS), (DOWN_RAD, "transforms"), (UP_RAD, "force sensors")],
)
def test_signs_of_all_efforts(slope_rad: float, way: str) -> None:
    right, wrong = measured(slope_rad, way), measured(slope_rad, way, ALL)
    positive, net = true_work(slope_rad)
    assert (net < 0.0) == (slope_rad == DOWN_RAD)
    legs, false = right.stats["legs"], wrong.stats["legs"]
    assert legs["positive_work_j"]["mean"] == pytest.approx(positive, rel=0.03)
    found = 2.0 * legs["positive_work_j"]["mean"] - legs["absolute_work_j"]["mean"]
    assert found == pytest.approx(net, abs=0.03 * legs["absolute_work_j"]["mean"])
    assert (len(doubts(right)), len(doubts(wrong))) == (0, 1)
    assert false["positive_work_j"] is None
    # These are the same with either sign.
    assert false["absolute_work_j"] == legs["absolute_work_j"]
    assert false["mechanical_cost_of_transport"] == legs["mechanical_cost_of_transport"]


@pytest.mark.parametrize(
    ("way", "turned", "named"),
    [
        ("transforms", LEG, "FR_calf_joint, FR_hip_joint, FR_thigh_joint"),
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
    found, true = (each.strides["positive_work_j"] for each in (walk, right))
    doubted = walk.strides["foot"] == "front_right"
    assert np.isnan(found[doubted]).all()
    np.testing.assert_array_equal(found[~doubted], true[~doubted])


def test_what_nothing_contradicts_is_not_doubted() -> None:
    """Downhill motors may do any work, and force sensors tell no direction."""
    assert doubts(measured(DOWN_RAD, "force sensors", ALL)) == []
