"""Sensors that are stuck, saturated or sound, against forces in closed form."""

from collections.abc import Callable

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.loads import is_stuck
from tests.core.load.feet import foot, seconds, vertical

TIME = seconds(8.0)


def recorded(change: Callable[[Floats], Floats] = lambda force: force) -> FootHistory:
    """A trotting foot as a sensor reports it."""
    return foot(TIME, change(vertical(TIME, 0.0)))


def sound() -> FootHistory:
    return foot(TIME, vertical(TIME, 0.5))


def constant(force: Floats) -> Floats:
    return np.where(force > 0.0, 55.0, 0.0)


def test_a_constant_force_is_stuck_while_others_vary() -> None:
    assert is_stuck(recorded(constant), [sound()])
    assert not is_stuck(sound(), [recorded(constant)])


def test_a_robot_that_stands_without_noise_has_no_stuck_sensor() -> None:
    still = foot(TIME, np.full(len(TIME), 50.0))
    assert not is_stuck(still, [still, still, still])
    assert is_stuck(still, [still, sound()])
