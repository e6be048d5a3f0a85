"""Robots in a physics engine that only their feet keep from leaning: they sway, slip and bounce."""

from dataclasses import replace
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import physics
from tests.truth.free_walker import HEIGHT_M, PERIOD_S, quadruped
from tests.truth.geometry import Floats
from tests.truth.physics import BARE, Imu, Physics, resized
from tests.truth.robots import GRAVITY_MPS2

BIAS_RADPS: Final = 0.01
"""What a cheap gyroscope reads at rest, about each axis."""


def warnings(walk: dl.Walk) -> list[str]:
    found = walk.stats["findings"]
    return [each["code"] for each in found if each["severity"] == "warning"]


class BiasedImu(Imu):
    """An inertial unit of a robot that stands upright."""

    def read(self, robot: Physics) -> list[Floats]:
        at_rest = [0.0, 0.0, GRAVITY_MPS2, BIAS_RADPS, BIAS_RADPS, BIAS_RADPS]
        noise = np.random.default_rng(1).normal(size=(len(robot.time), 6))
        return np.hsplit(at_rest + noise * np.repeat([0.05, 0.002], 3), 2)


@pytest.mark.parametrize(
    "command", [(0.3, 0.0, 0.0), (0.0, 0.1, 0.0), (0.2, 0.0, -0.3), (0.4, 0.0, 0.3)]
)
@pytest.mark.parametrize("by_transforms", [True, False], ids=["points", "joints"])
def test_a_sound_trot_is_believed(command: Any, by_transforms: Any) -> None:
    truth = quadruped(command, leans=True)
    walk = physics.measured(truth, by_transforms=by_transforms, every=2)
    assert set(warnings(walk)) <= {"CHATTER"}
    assert walk.gait.name == "trot"
    base = walk.stats["base"]
    assert base["forward_speed_mps"] == pytest.approx(truth.speed_mps, abs=0.01)
    climbed = truth.base[-1, 2] - truth.base[0, 2]
    assert base["climb_m"] == pytest.approx(climbed, abs=0.005)
    down = [foot["contact_fraction"] for foot in walk.stats["feet"].values()]
    assert down == pytest.approx(truth.touching.tolist(), abs=0.05)


@pytest.mark.parametrize("slope_rad", [0.0, 0.08])
def test_a_robot_that_stands_stays_where_it_is(slope_rad: float) -> None:
    """Without sensors; the engine has no noise, but the gyroscope does not read zero at rest."""
    truth = quadruped((0.0, 0.0, 0.0), 20.0, gait="stand", leans=True, slope_rad=slope_rad)
    walk = physics.measured(truth, **{**BARE, "imu": BiasedImu()})
    assert not warnings(walk)
    assert walk.gait.name == "stand"
    base = walk.stats["base"]
    assert base["net_displacement_m"] == pytest.approx(0.0, abs=0.03)
    assert base["yaw_change_rad"] == pytest.approx(0.0, abs=0.02)
    assert base["height_m"]["median"] == pytest.approx(HEIGHT_M, abs=0.03)


@pytest.mark.parametrize("slope_rad", [-0.08, 0.1])
def test_forces_of_a_stand_in_an_engine_without_noise_tell_no_fault(slope_rad: float) -> None:
    """They differ in their last digits, and settle as the forces of a filter do."""
    truth = quadruped((0.0, 0.0, 0.0), 8.0, gait="stand", leans=True, slope_rad=slope_rad)
    for every in (1, 2, 5, 20):
        walk = physics.measured(truth, by_transforms=False, points=False, every=every)
        assert not warnings(walk)
        assert not [each for each in walk.stats["events"] if each["type"] == "sensor_fault"]
        assert [each["contact_fraction"] for each in walk.stats["feet"].values()] == [1.0] * 4


@pytest.mark.parametrize("scale", [0.5, 2.2])
def test_bounces_at_touchdown_are_no_strides(scale: float) -> None:
    """Contact by joints: a large robot bounces for longer."""
    truth = resized(quadruped((0.3, 0.0, 0.0), leans=True), scale)
    walk = physics.measured(truth, by_transforms=False, every=2, with_feet=False)
    assert not warnings(walk)
    frequency = walk.stats["gait"]["stride_frequency_hz"]
    assert frequency == pytest.approx(1.0 / (PERIOD_S * np.sqrt(scale)), rel=0.01)


def test_a_jump_of_the_odometry_is_no_slip() -> None:
    """Feet without sensors are placed by the poses, and jump with them."""
    truth = quadruped((0.3, 0.0, 0.0), leans=True)
    late = truth.time[:, None] >= 2.6
    jumps = replace(truth, base=truth.base + late * [0.5, 0.3, 0.0])
    walk = physics.measured(jumps, by_transforms=False, every=2, with_feet=False)
    assert set(warnings(walk)) == {"POSE_JUMP"}
    assert "slip" not in {each["type"] for each in walk.stats["events"]}


@pytest.mark.parametrize("with_feet", [True, False])
def test_poses_that_drift_while_legs_stay_or_walk_on_level_ground(with_feet: Any) -> None:
    stays = quadruped((0.0, 0.0, 0.0), leans=True)
    aside = replace(stays, base=stays.base + np.outer(stays.time, [0.0, 0.2, 0.0]))
    walk = physics.measured(aside, by_transforms=False, every=2, with_feet=with_feet)
    assert "POSE_SCALE" in warnings(walk)
    assert walk.stats["base"]["lateral_speed_mps"] is None
    goes = quadruped((0.3, 0.0, 0.0), leans=True)
    up = replace(goes, base=goes.base + np.outer(goes.time, [0.0, 0.0, 0.15]))
    walk = physics.measured(up, by_transforms=False, every=2, with_feet=with_feet)
    assert "WORLDS_DIFFER" in warnings(walk)
    assert walk.stats["base"]["climb_m"] is None


@pytest.mark.parametrize("points", [True, False])
def test_z_that_drifts_while_the_robot_stands(points: Any) -> None:
    truth = quadruped((0.0, 0.0, 0.0), 8.0, gait="stand", leans=True)
    up = replace(truth, base=truth.base + np.outer(truth.time, [0.0, 0.0, 0.1]))
    walk = physics.measured(up, points=points, every=5)
    assert "WORLDS_DIFFER" in warnings(walk)
    assert walk.stats["base"]["climb_m"] is None
