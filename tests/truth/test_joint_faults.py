"""Joint states with other units, signs, names and rates, of robots in a physics engine."""

from dataclasses import replace
from functools import cache
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import physics
from tests.truth.free_walker import PERIOD_S, quadruped, trot
from tests.truth.geometry import Floats
from tests.truth.physics import Physics

SECONDS: Final = 4.0
CALF: Final = np.arange(12) == 2
"""The first leg's."""


def measure(robot: Physics, **options: Any) -> dl.Walk:
    return physics.measured(robot, **{"by_transforms": True, "every": 2, **options})


def named(*first: str) -> Physics:
    """A trot whose first joints have other names."""
    robot = trot(SECONDS)
    return replace(robot, joints=(*first, *robot.joints[len(first) :]))


BY_JOINTS: Final = {"by_transforms": False}


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (lambda q, v, e: (np.degrees(q), np.degrees(v), e), "legs' joints move by 21"),
        (lambda q, v, e: (q, np.degrees(v), e), "times those of their positions"),
        (lambda q, v, e: (q, v / 8.0, e), "times those of their positions"),
        (lambda q, v, e: (q, np.where(CALF, -v, v), e), "positions: FL_calf_joint (-"),
        (lambda q, v, e: (q, v, e / 8.0), "times that of the forces on the feet"),
        (lambda q, v, e: (q, v, 1e3 * e), "which is no torque in N m"),
        (lambda q, v, e: (q, v, np.full_like(e, 1.5)), "efforts are empty, zero or constant"),
        (lambda q, v, e: (q, v, np.where(CALF, 1.5, e)), "tell no effort: FL_calf_joint"),
        (lambda q, v, e: (q, v, np.full_like(e, np.nan)), "efforts are empty, zero or constant"),
    ],
)  # fmt: skip
def test_work_is_null_where_numbers_are_no_torques_and_speeds(change: Any, cause: str) -> None:
    walk = measure(trot(SECONDS).telling(change))
    assert_no_work(walk, "JOINT_VALUES", cause)
    if "effort" not in cause:
        for joint in walk.stats["legs"]["joints"].values():
            assert joint["absolute_work_j"] is None


@pytest.mark.parametrize(
    ("names", "options", "code", "cause"),
    [
        (("knee_1",), {}, "JOINT_VALUES", "fewer joints of front_left (2) than of front_right"),
        (("FL_hip_joint",) * 2, {}, "JOINT_VALUES",
         "fewer joints of front_left (1) than of front_right"),
        (("knee_1",), BY_JOINTS, "JOINT_VALUES", "joint states do not tell of FL_hip_joint"),
        ((), {"every": 25}, "SAMPLED_SLOWLY",
         "joint states come 10.1 times in a stride of 0.50 s"),
    ],
)  # fmt: skip
def test_work_is_null_where_joints_are_missing(
    names: tuple[str, ...], options: dict[str, Any], code: str, cause: str
) -> None:
    assert_no_work(measure(named(*names), **options), code, cause)


def assert_no_work(walk: dl.Walk, code: str, cause: str) -> None:
    found = [f["text"] for f in walk.stats["findings"] if f["code"] == code and cause in f["text"]]
    assert len(found) == 1
    assert found[0].startswith("no work is known: ")
    for name in ("positive_work_j", "absolute_work_j", "mechanical_cost_of_transport"):
        assert walk.stats["legs"][name] is None
    assert np.isnan(walk.strides["absolute_work_j"]).all()


@pytest.mark.parametrize("told", [1.0, 0.0], ids=["velocities", "none"])
def test_positions_that_wrap_change_nothing(told: float) -> None:
    """As of continuous joints that swing about +-pi: a turn less above the middle."""

    def wrapped(position: Floats, velocity: Floats, effort: Floats) -> tuple[Floats, ...]:
        above = position > position.mean(axis=0)
        return position - 2.0 * np.pi * above, told * velocity, effort

    expected = measure(trot(SECONDS), **BY_JOINTS)
    found = measure(trot(SECONDS).telling(wrapped), **BY_JOINTS)
    for column in ("clearance_m", "swing_length_m", "absolute_work_j", "positive_work_j"):
        known = found.strides[column]
        assert np.isfinite(known).any()
        # Where no speeds are told, positions are differenced.
        within = 1e-3 if told else 0.02
        assert known == pytest.approx(expected.strides[column], rel=within, nan_ok=True)
    for name, joint in found.stats["legs"]["joints"].items():
        true = expected.stats["legs"]["joints"][name]
        # Joints are kept in float32, which near pi tells 2.4e-7 rad apart.
        assert joint["range_of_motion"] == pytest.approx(true["range_of_motion"], abs=1e-6)


def test_names_of_another_robot_do_not_place_its_feet() -> None:
    walk = measure(named(*(f"robot_{joint}" for joint in trot(SECONDS).joints)), **BY_JOINTS)
    because = walk.stats["null_because"]["feet.front_left.clearance_m"]
    assert because == "no transforms or joints of the legs"
    # Which leg each is of, their names still tell.
    assert np.isfinite(walk.strides["absolute_work_j"]).any()


LONGER: Final = 5.0
DOWN_RAD, UP_RAD = np.radians(12.0), np.radians(-10.0)
ALL: Final = tuple(range(12))
LEG: Final = (3, 4, 5)
"""Joints of front_right."""
WAYS: Final = {
    "transforms": {"by_transforms": True},
    "joints": {"points": True},
    "force sensors": {},
}


@cache
def measured(slope_rad: float, way: str, turned: tuple[int, ...] = ()) -> dl.Walk:
    signs = np.where(np.isin(ALL, turned), -1.0, 1.0)
    robot = quadruped(seconds=LONGER, slope_rad=slope_rad)
    options: dict[str, Any] = WAYS[way]
    return physics.measured(robot.telling(lambda q, v, e: (q, v, signs * e)), **options)


def doubts(walk: dl.Walk) -> list[str]:
    return [each["text"] for each in walk.stats["findings"] if each["code"] == "EFFORT_SIGN"]


def true_work(slope_rad: float) -> tuple[float, float]:
    """J a stride, positive and net, of all joints over the middle strides."""
    truth = quadruped(seconds=LONGER, slope_rad=slope_rad)
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
