"""Whole walks in closed form, recorded with faults: they are told, and the rest is measured."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from tests.analysed import analysed, feet_of, metrics
from tests.oracles.straight_walk import (
    SETTINGS,
    START,
    Walk,
    codes,
    foot_samples,
    main_class,
    measure,
)


@cache
def usual() -> MeasuredWalk:
    return Walk().measure()


def test_added_up_physics_steps_show_in_the_impulse() -> None:
    stats = Walk(load=(4.0,) * 4).measure()
    assert stats.loads.vertical_impulse_over_weight == pytest.approx(4.0, abs=0.05)
    texts = [each.text for each in findings_of(stats) if each.code == "IMPULSE_IS_NOT_WEIGHT"]
    assert "physics steps" in texts[0]


def with_stamps(samples: Samples, stamp: Ints) -> Samples:
    return replace(samples, stamp=stamp)


@pytest.mark.parametrize("fault", ["zero", "swapped", "far ahead"])
@pytest.mark.parametrize("row", [0, 1000, 2999])
def test_one_bad_stamp_costs_one_message_and_no_clock(fault: str, row: int) -> None:
    walk = Walk()
    feet = [walk.samples(foot) for foot in range(4)]
    stamp = feet[2].stamp.copy()
    if fault == "zero":
        stamp[row] = 0
    elif fault == "swapped":
        stamp[[row, row + 1]] = stamp[[row + 1, row]]
    else:
        stamp[row] += 500 * 10**9
    feet[2] = with_stamps(feet[2], stamp)
    stats = measure(feet, walk.odometry())
    whole = usual()
    assert stats.settings.clock is TimeSource.HEADER
    assert stats.feet[2].record.not_advancing == 1
    assert main_class(stats) == "trot"
    found, true = (feet_of(each)[2].duty_factor for each in (stats, whole))
    assert found is not None
    assert true is not None
    assert found.n == true.n
    assert found.mean == pytest.approx(true.mean, rel=2e-3)
    assert stats.end - stats.origin == pytest.approx(whole.end - whole.origin, abs=10**7)


def test_a_reset_cuts_the_stride_that_it_falls_into() -> None:
    walk = Walk(period_s=0.8, seconds=12.0)

    def reset(stamp: Ints) -> Ints:
        return np.where(stamp >= START + 6 * 10**9, stamp - 5 * 10**9, stamp)

    feet = [walk.samples(foot) for foot in range(4)]
    feet = [with_stamps(samples, reset(samples.stamp)) for samples in feet]
    odometry = walk.odometry()
    teleported = odometry.position.copy()
    teleported[odometry.stamp >= START + 6 * 10**9, 0] -= 2.5
    odometry = replace(odometry, stamp=reset(odometry.stamp), position=teleported)
    stats = measure(feet, odometry)
    assert "set back by 5.00 s at 6.00 s" in stats.settings.time_source_reason
    whole = walk.measure()
    for foot, unbroken in zip(stats.feet, whole.feet, strict=True):
        assert len(foot.strides.stance) == len(unbroken.strides.stance) - 1
        assert foot.length_m == pytest.approx(0.4, abs=5e-3)
    assert stats.base is not None
    assert stats.base.path_length_m == pytest.approx(6.0, abs=0.05)


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


def test_a_foot_that_never_touches_is_dead_and_leaves_the_class_open() -> None:
    walk = Walk()
    feet = [walk.samples(foot) for foot in range(4)]
    nothing = np.zeros(len(walk.times()))
    feet[2] = foot_samples(2, walk.times(), nothing, np.zeros((len(nothing), 3)))
    stats = measure(feet, walk.odometry())
    assert stats.support is None
    walk_metrics = metrics(stats)
    assert walk_metrics.feet["back_left"].contact_fraction is None
    assert walk_metrics.forces.load_share.feet is None
    assert walk_metrics.null_because["forces.load_share.feet"] == "DEAD"
    assert main_class(stats) is None
    assert {"DEAD", "CLASS_UNKNOWN"} <= codes(stats)


def test_an_empty_log_is_measured_without_complaint() -> None:
    stats = analysed(SETTINGS)
    assert stats.main is None
    assert {"NO_MESSAGES", "CLASS_UNKNOWN"} <= codes(stats)
