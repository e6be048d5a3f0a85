"""Joints' states against sums worked out by hand."""

from typing import Any

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Float32s, Floats, Ints, picked
from dogbot_logtool.core.base.foot_path import silent_before, unbroken
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.legs.joints import (
    MOST_JOINTS,
    JointLimits,
    JointSamples,
    JointTable,
    JointTrack,
    joint_tracks,
)

START = 7_000_000_000
STEP = 2_000_000
NAMES = ("hip", "thigh", "knee", "ankle", "toe", "neck")


def samples(
    position: Floats | Float32s,
    velocity: Floats | Float32s,
    effort: Floats | Float32s,
    time: Ints | None = None,
) -> JointSamples:
    times = START + STEP * np.arange(len(position)) if time is None else time
    columns: list[Any] = [each.reshape(len(times), -1) for each in (position, velocity, effort)]
    return JointSamples(times, times, *columns)


def wave(count: int = 12_000, joints: int = 1) -> JointSamples:
    phase = 3.0 * STEP / 1e9 * np.arange(count)[:, None] + np.arange(joints)
    return samples(np.sin(phase), 3.0 * np.cos(phase), 5.0 * np.cos(phase + 1.0))


def histories(
    given: JointSamples,
    limits: JointLimits = JointLimits(),  # noqa: B008 - frozen
) -> dict[str, JointTrack]:
    known = dict.fromkeys(NAMES, limits)
    table = JointTable("/joint_states", NAMES[: given.position.shape[1]], given)
    return joint_tracks([table], TimeSource.HEADER, known)


def recorded(
    given: JointSamples,
    limits: JointLimits = JointLimits(),  # noqa: B008 - frozen
) -> JointTrack:
    (found,) = histories(given, limits).values()
    return found


def test_work_of_a_wave() -> None:
    whole = wave()
    found = recorded(whole)
    power, time = (whole.effort * whole.velocity)[:, 0], whole.stamp / 1e9
    work_j, effort = found.metrics.absolute_work_j, found.metrics.rms_effort
    assert work_j == pytest.approx(np.trapezoid(np.abs(power), time))
    positive = np.trapezoid(power.clip(0.0), time)
    assert found.work[0].sum() == pytest.approx(positive, rel=1e-5)
    assert found.work[1].sum() == pytest.approx(work_j, rel=1e-5)
    assert effort == pytest.approx(np.sqrt(12.5), rel=0.01)
    assert found.range == np.ptp(whole.position)


def test_no_more_joints_are_followed_than_allowed() -> None:
    many = wave(5, MOST_JOINTS + 3)
    tables = [
        JointTable(topic, tuple(f"{topic}{joint}" for joint in range(MOST_JOINTS + 3)), many)
        for topic in ("/one", "/other")
    ]
    found = joint_tracks(tables, TimeSource.HEADER, {})
    assert list(found) == sorted(tables[0].names[:MOST_JOINTS])


def test_positions_that_wrap_go_on() -> None:
    """A continuous joint that swings about pi, and one that turns on and on."""
    whole = wave(joints=2)
    whole.position[:, 0] += 3.0
    whole.position[:, 1] = 2.0 * STEP / 1e9 * np.arange(len(whole.stamp))
    wrapped = samples(
        (whole.position + np.pi) % (2.0 * np.pi) - np.pi, whole.velocity, whole.effort
    )
    expected, found = histories(whole), histories(wrapped)
    assert np.abs(np.diff(wrapped.position, axis=0)).max() > 6.0
    for name in NAMES[:2]:
        moved = found[name].position - expected[name].position
        assert moved == pytest.approx(moved[0], abs=1e-5)
        assert found[name].told_moved == pytest.approx(expected[name].told_moved)
        assert found[name].range == pytest.approx(expected[name].range)


def test_a_silence_is_not_bridged() -> None:
    whole = wave(2000)
    kept = np.ones(2000, np.bool_)
    kept[1001:1100] = False
    found = recorded(picked(whole, kept))
    (row,) = np.flatnonzero(silent_before(found.time))
    assert np.flatnonzero(np.isnan(found.work[1])).tolist() == [row] == [1001]
    begin = np.array([whole.stamp[10], whole.stamp[900], whole.stamp[1200]])
    whole_spans = unbroken(found.time, silent_before(found.time), begin, begin + 300 * STEP)
    assert whole_spans.tolist() == [True, False, True]


def test_a_joint_that_never_moves_does_no_work() -> None:
    found = recorded(samples(np.full(900, 0.5), np.full(900, 0.1), np.full(900, 2.0)))
    assert not found.moves
    assert found.has_effort
    assert not found.work.any()
    assert found.metrics.rms_effort == pytest.approx(2.0)


def test_time_near_limits() -> None:
    whole = wave()
    near = recorded(whole, limits=JointLimits(-1.0, 1.0)).metrics.near_limit_fraction
    assert near == pytest.approx((np.abs(whole.position[:, 0]) > 0.96).mean(), abs=1e-3)
    assert recorded(whole).metrics.near_limit_fraction is None
    for limits, values in (
        (JointLimits(velocity=3.0), whole.velocity / 3.0),
        (JointLimits(effort=5.0), whole.effort / 5.0),
    ):
        near = recorded(whole, limits=limits).metrics.near_limit_fraction
        assert near == pytest.approx((np.abs(values) > 0.95).mean(), abs=1e-3)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
def test_hostile_numbers_cost_their_rows(bad: float) -> None:
    whole = wave(3000)
    for name in ("position", "velocity", "effort"):
        getattr(whole, name)[[0, 7, 1500, 2999]] = bad
    found = recorded(whole)
    expected = recorded(wave(3000)).metrics.absolute_work_j
    assert found.metrics.absolute_work_j == pytest.approx(expected, rel=0.02)
    assert found.metrics.peak_speed == pytest.approx(3.0, rel=0.01)
    assert found.position.max() <= 1.0
    assert found.peak_effort <= 5.0
