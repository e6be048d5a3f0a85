"""Whole walks in closed form, recorded with faults: they are told, and the rest is measured."""

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.corrections.clock import TimeSource
from tests.analysed import analysed, feet_of
from tests.oracles.straight_walk import (
    SETTINGS,
    Walk,
    codes,
    measure,
)


def test_added_up_physics_steps_show_in_the_impulse() -> None:
    stats = Walk(load=(4.0,) * 4).measure()
    assert stats.loads.vertical_impulse_over_weight == pytest.approx(4.0, abs=0.05)
    texts = [each.text for each in findings_of(stats) if each.code == "IMPULSE_IS_NOT_WEIGHT"]
    assert "physics steps" in texts[0]


def test_duplicate_stamps_are_dropped_and_said() -> None:
    walk = Walk()
    feet = [walk.samples(foot) for foot in range(4)]
    twice = np.sort(np.concatenate([np.arange(len(feet[0].stamp)), [500, 501, 502]]))
    feet[0] = feet[0].pick(twice)
    stats = measure(feet, walk.odometry())
    assert stats.settings.clock is TimeSource.HEADER
    assert stats.feet[0].record.not_advancing == 3
    assert {"BAD_STAMPS"} <= codes(stats)
    sound = walk.measure().feet[0]
    assert stats.feet[0].touchdown.tolist() == sound.touchdown.tolist()
    assert feet_of(stats)[0].vertical_impulse_ns == feet_of(walk.measure())[0].vertical_impulse_ns


def test_an_empty_log_is_measured_without_complaint() -> None:
    stats = analysed(SETTINGS)
    assert stats.main is None
    assert {"NO_MESSAGES", "CLASS_UNKNOWN"} <= codes(stats)
