"""Sensors that are stuck, saturated or sound, against forces in closed form."""

from collections.abc import Callable

import numpy as np
import pytest

from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.load.load_figures import is_saturated, is_stuck
from tests.core.load.feet import foot, seconds, vertical

TIME = seconds(8.0)


def recorded(change: Callable[[Floats], Floats] = lambda force: force) -> FootHistory:
    """A trotting foot as a sensor reports it."""
    return foot(TIME, change(vertical(TIME, 0.0)))


def sound() -> FootHistory:
    return foot(TIME, vertical(TIME, 0.5))


def constant(force: Floats) -> Floats:
    return np.where(force > 0.0, 55.0, 0.0)


@pytest.mark.parametrize("limit", [40.0, 80.0, 110.0])
def test_a_sensor_at_its_limit_is_saturated(limit: float) -> None:
    at_limit = recorded(lambda force: np.minimum(force, limit))
    assert is_saturated(at_limit, [sound()])
    assert not is_saturated(at_limit, [recorded(constant)])


@pytest.mark.parametrize("step", [0.1, 1.0, 5.0, 10.0, 20.0])
def test_a_force_that_is_recorded_in_steps_is_not_saturated(step: float) -> None:
    """Every stance has the same peak, and many samples at it."""
    coarse = recorded(lambda force: np.round(force / step) * step)
    assert not is_saturated(coarse, [sound()])


def test_a_coarse_sensor_at_its_limit_is_saturated() -> None:
    coarse = recorded(lambda force: np.minimum(np.round(force), 60.0))
    assert is_saturated(coarse, [sound()])


def test_a_sound_sensor_is_not_saturated() -> None:
    assert not is_saturated(sound(), [sound()])


def test_a_constant_force_is_stuck_while_others_vary() -> None:
    assert is_stuck(recorded(constant), [sound()])
    assert not is_saturated(recorded(constant), [sound()])
    assert not is_stuck(sound(), [recorded(constant)])


def test_a_robot_that_stands_without_noise_has_no_stuck_sensor() -> None:
    still = foot(TIME, np.full(len(TIME), 50.0))
    assert not is_stuck(still, [still, still, still])
    assert is_stuck(still, [still, sound()])
