"""Joints' states against sums worked out by hand."""

import numpy as np
import pytest

from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.legs.joints import JointLimits, JointTrack, LegSettings, joint_tracks
from dogbot_logtool.core.recording import JointSamples, JointTable

START = 7_000_000_000
STEP = 2_000_000


def wave(count: int = 12_000) -> JointSamples:
    phase = 3.0 * STEP / 1e9 * np.arange(count)[:, None]
    time = START + STEP * np.arange(count)
    return JointSamples(time, time, np.sin(phase), 3.0 * np.cos(phase), 5.0 * np.cos(phase + 1.0))


def recorded(
    given: JointSamples,
    limits: JointLimits = JointLimits(),  # noqa: B008 - frozen
) -> JointTrack:
    table = JointTable("/joint_states", ("knee",), given)
    return joint_tracks([table], TimeSource.HEADER, LegSettings((), limits={"knee": limits}))[
        "knee"
    ]


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
    assert (found.metrics.peak_effort or 0.0) <= 5.0


def test_another_publisher_s_stamps_cost_no_states() -> None:
    """An arm's states stand on the same topic, more often, and come 50 ms late."""
    count = 500
    log_time = np.arange(count) * 10_000_000 + 10**18
    is_leg = np.arange(count) % 5 == 0
    stamp = log_time - np.where(is_leg, 0, 50_000_000)
    position = np.where(np.stack([is_leg, ~is_leg], axis=1), 0.5, np.nan)
    unknown = np.full_like(position, np.nan)
    states = JointSamples(log_time, stamp, position, unknown, unknown)
    table = JointTable("/joint_states", ("knee", "wrist"), states)
    found = joint_tracks([table], TimeSource.HEADER, LegSettings(()))
    assert {name: len(each.time) for name, each in found.items()} == {"knee": 100, "wrist": 400}
