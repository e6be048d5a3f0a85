"""Sensors that stop in the midst of a trot, and legs that are lifted or planted instead."""

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.consistency.stopped import without_stopped
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import Cut
from tests.core.consistency.poses import base
from tests.core.load.feet import PERIOD_S, TROT, WEIGHT_N, foot, seconds, vertical

TIME = seconds(16.0)
AT_S = 8.0
STILL = base(16.0, 0.0)


def feet(first: Floats, others: Floats | float = 1.0) -> list[FootHistory]:
    """Return a foot with its own force, and three that trot with a factor."""
    forces = [first, *(vertical(TIME, phase) * others for phase in TROT[1:])]
    return [foot(TIME, force) for force in forces]


def stopped_s(found: FootHistory) -> list[list[float]]:
    return (((found.stopped - 1_000_000_000) / 1e9).round(3)).tolist()  # type: ignore[no-any-return]


@pytest.mark.parametrize("share", [0.0, 0.11])
def test_a_sensor_that_dies_is_unknown_from_its_last_touchdown_on(share: float) -> None:
    """It dies in swing, at zero, or in stance."""
    dies = AT_S + PERIOD_S * (0.7 - share)
    sound = vertical(TIME, 0.0)
    first, *others = without_stopped(feet(sound * (dies > TIME)), STILL)
    assert stopped_s(first) == [[pytest.approx(8.004, abs=0.02), 16.0]]
    assert timespans.total(first.known) / 1e9 == pytest.approx(8.004, abs=0.02)
    assert first.contact_fraction() == pytest.approx(0.6, abs=0.02)
    assert (first.stances.cut[-1], first.stances.liftoff[-1]) == (Cut.GAP, 17_000_000_000)
    assert not any(len(each.stopped) for each in others)


def test_a_sensor_that_freezes_under_load_is_unknown() -> None:
    sound = vertical(TIME, 0.0)
    frozen = np.where(TIME < AT_S + 0.2, sound, sound[np.searchsorted(TIME, AT_S + 0.2)])
    first, *_ = without_stopped(feet(frozen), STILL)
    assert stopped_s(first) == [[pytest.approx(8.004, abs=0.02), 16.0]]


def test_a_sensor_that_comes_back_is_known_again() -> None:
    away = (TIME > 4.1) & (TIME < 9.7)
    first, *_ = without_stopped(feet(np.where(away, 0.0, vertical(TIME, 0.0))), STILL)
    assert stopped_s(first) == [[pytest.approx(4.004, abs=0.02), pytest.approx(9.704, abs=0.02)]]
    whole = first.stances.touchdown[first.stances.whole]
    assert not ((whole > 5.0e9) & (whole < 10.71e9)).any()


def test_a_lifted_leg_is_no_stopped_sensor() -> None:
    """The other feet carry its load."""
    lifted = TIME > AT_S
    own = np.where(lifted, 0.0, vertical(TIME, 0.0))
    found = without_stopped(feet(own, 1.0 + lifted / 3.0), STILL)
    assert not any(len(each.stopped) for each in found)


def test_a_foot_is_planted_only_while_the_base_stays() -> None:
    """It feels the load shift."""
    shifts = 0.25 * WEIGHT_N * (1.0 + 0.3 * np.sin(2.0 * np.pi * TIME / PERIOD_S))
    planted = feet(np.where(TIME > AT_S, shifts, vertical(TIME, 0.0)))
    assert not any(len(each.stopped) for each in without_stopped(planted, STILL))
    first, *others = without_stopped(planted, base(16.0, 0.3))
    assert stopped_s(first) == [[pytest.approx(8.004, abs=0.02), 16.0]]
    assert not any(len(each.stopped) for each in others)


def test_a_robot_that_stands_still_has_no_stopped_sensor() -> None:
    walks = TIME < AT_S
    forces = [np.where(walks, vertical(TIME, phase), 0.25 * WEIGHT_N) for phase in TROT]
    found = without_stopped([foot(TIME, force) for force in forces], STILL)
    assert not any(len(each.stopped) for each in found)
