"""Braking, propulsion and curves of a foot whose force is known in closed form."""

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import BaseHistory, Odometry, base_history
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.gait.feet import (
    CycleCurve,
    fore_aft_impulses,
    forward_forces,
    stance_headings,
    stride_curve,
)
from dogbot_logtool.core.gait.strides import strides_of
from tests.core.load.feet import DUTY, PERIOD_S, RATE_HZ, RULE, foot, seconds, stance_phase

TOP_N = 120.0
FORE_AFT_N = 30.0
STANCE_S = PERIOD_S * DUTY
TIME = seconds(8.0)


def heading_base(yaw: float, time: Floats = TIME) -> BaseHistory:
    count = len(time)
    stamp = 1_000_000_000 + np.round(time * 1e9).astype(np.int64)
    turn = np.tile([0.0, 0.0, np.sin(yaw / 2.0), np.cos(yaw / 2.0)], (count, 1))
    still = np.zeros((count, 3))
    poses = Odometry(stamp, stamp, still, turn, still, still)
    return base_history(poses, TimeSource.HEADER)


def walking_foot(yaw: float, lateral_n: float = 0.0, *, world: bool = True) -> FootHistory:
    """A foot that brakes in the first half of its stance and propels in the second one.

    Args:
        yaw: rad, where forward is.
        lateral_n: N, amplitude of a force to the left.
        world: whether its forces are in the world frame.
    """
    stance = stance_phase(TIME, 0.0)
    forward = -FORE_AFT_N * np.sin(2.0 * np.pi * stance)
    left = lateral_n * np.sin(np.pi * stance)
    x = forward * np.cos(yaw) - left * np.sin(yaw)
    y = forward * np.sin(yaw) + left * np.cos(yaw)
    force = np.stack([x, y, TOP_N * np.sin(np.pi * stance)], axis=1)
    return foot(TIME, np.where((stance < 1.0)[:, None], force, 0.0), world=world)


def headings(record: FootHistory, base: BaseHistory, axis: str = "+x") -> Floats:
    return stance_headings(record.stances, base, axis)


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.5, -1.6])
@pytest.mark.parametrize("lateral_n", [0.0, 40.0])
def test_braking_and_propulsion_are_the_halves_of_a_sine(yaw: float, lateral_n: float) -> None:
    record = walking_foot(yaw, lateral_n)
    found = fore_aft_impulses(record, headings(record, heading_base(yaw)))
    whole = record.stances.whole
    # The integral of a half sine is 2 / pi of its height times its duration.
    expected = 2.0 / np.pi * FORE_AFT_N * STANCE_S / 2.0
    assert found.braking[whole] == pytest.approx(expected, rel=0.01)
    assert found.propulsive[whole] == pytest.approx(expected, rel=0.01)


def value_at(curve: CycleCurve | None, percent: float) -> float:
    assert curve is not None
    return float(np.interp(percent, curve.percent, curve.median))


def test_curves_follow_the_force_over_the_stride() -> None:
    record = walking_foot(0.4)
    forward = forward_forces(record, headings(record, heading_base(0.4), "+x"))
    strides = strides_of(record.stances, record.gaps, timespans.no_spans())[0]
    upward = stride_curve(record.stance_forces[:, 2], strides)
    ahead = stride_curve(forward, strides)
    # Contact begins where the force reaches the threshold.
    late = np.arcsin(RULE.on_n / TOP_N) / np.pi + 0.5 / (RATE_HZ * STANCE_S)
    for percent in (10.0, 30.0, 50.0, 90.0):
        stance = late + percent / 100.0 * (1.0 - late)
        vertical, along = np.sin(np.pi * stance), -np.sin(2.0 * np.pi * stance)
        at_stride = percent * DUTY * (1.0 - late)
        near = pytest.approx(TOP_N * vertical, abs=0.1 * TOP_N)
        assert value_at(upward, at_stride) == near
        near = pytest.approx(FORE_AFT_N * along, abs=0.2 * FORE_AFT_N)
        assert value_at(ahead, at_stride) == near
    assert value_at(upward, 80.0) == 0.0
