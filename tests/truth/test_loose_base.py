"""Robots in a physics engine that only their feet keep from leaning: they sway, slip and bounce."""

from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import physics
from tests.truth.free_walker import HEIGHT_M, quadruped
from tests.truth.geometry import Floats
from tests.truth.physics import BARE, Imu, Physics
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


def test_sensors_of_a_robot_that_stands_in_an_engine_without_noise_are_not_stuck() -> None:
    truth = quadruped((0.0, 0.0, 0.0), 20.0, gait="stand", leans=True, slope_rad=-0.08)
    for every in (1, 5, 20):
        walk = physics.measured(truth, by_transforms=False, points=False, every=every)
        assert not warnings(walk)
        assert not [each for each in walk.stats["events"] if each["type"] == "sensor_fault"]
