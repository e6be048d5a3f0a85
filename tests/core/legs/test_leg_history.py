"""Joints' states against sums worked out by hand."""

from typing import Any

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Float32s, Floats, Ints
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.frames.transforms import TransformBuffer
from dogbot_logtool.core.legs.joint_history import joint_histories
from dogbot_logtool.core.legs.joint_track import (
    MOST_JOINTS,
    JointHistory,
    JointLimits,
    JointSamples,
    JointTable,
)
from dogbot_logtool.core.legs.leg_history import leg_history
from dogbot_logtool.core.legs.settings import LegSettings
from dogbot_logtool.core.legs.silences import silent_before

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
) -> dict[str, JointHistory]:
    known = dict.fromkeys(NAMES, limits)
    return joint_histories(NAMES, "/joint_states", given, TimeSource.HEADER, known)


def recorded(
    given: JointSamples,
    limits: JointLimits = JointLimits(),  # noqa: B008 - frozen
) -> JointHistory:
    (found,) = histories(given, limits).values()
    return found


def same(one: JointHistory, other: JointHistory) -> bool:
    columns = ("time", "position", "positive_work", "absolute_work")
    tracks = all(
        np.array_equal(getattr(one.track, name), getattr(other.track, name), equal_nan=True)
        for name in columns
    )
    names = [n for n in JointHistory.__dataclass_fields__ if n != "track"]
    return tracks and all(getattr(one, name) == getattr(other, name) for name in names)


def irregular() -> JointSamples:
    """Six joints: of a leg that rests at first, with silences and numbers that are missing."""
    whole = wave(9_000, len(NAMES))
    whole.position[:4300, 1:3] = 0.25
    whole.position[:, 5] = -0.5
    whole.velocity[:, 3] = 0.0
    whole.effort[2000:2100, 4] = np.nan
    rows = np.delete(np.arange(9_000), np.s_[1001:1100])
    whole = whole.pick(np.delete(rows, np.s_[4095:4200]))
    whole.stamp[[5, 3000]] = 0
    whole.stamp[2500:2503] -= 500 * STEP
    whole.position[700:705, 2] = np.nan
    whole.position[5000:, 4] = np.nan
    return whole


def test_work_of_a_wave() -> None:
    whole = wave()
    found = recorded(whole)
    power, time = (whole.effort * whole.velocity)[:, 0], whole.stamp / 1e9
    assert found.absolute_work_j == pytest.approx(np.trapezoid(np.abs(power), time))
    positive = np.trapezoid(power.clip(0.0), time)
    assert found.track.positive_work.sum() == pytest.approx(positive, rel=1e-5)
    assert found.track.absolute_work.sum() == pytest.approx(found.absolute_work_j, rel=1e-5)
    assert found.squared_effort / found.effort_s == pytest.approx(12.5, rel=0.01)
    assert (found.lowest, found.highest) == (whole.position.min(), whole.position.max())
    assert np.diff(found.track.time).max() == 10_000_000


def test_joints_together_are_as_each_alone() -> None:
    whole = irregular()
    found = histories(whole)
    assert sorted(found) == sorted(NAMES)
    for column, name in enumerate(NAMES):
        alone = whole.only(np.array([column]))
        expected = joint_histories([name], "/joint_states", alone, TimeSource.HEADER, {})
        assert same(found[name], expected[name]), name


def test_joints_of_two_senders_on_one_topic() -> None:
    whole = wave(8_000, 4)
    whole.position[::2, :2] = np.nan
    whole.position[1::2, 2:] = np.nan
    found = histories(whole)
    for column, name in enumerate(NAMES[:4]):
        rows = np.arange(1 - column // 2, 8_000, 2)
        assert same(
            found[name],
            histories(whole.pick(rows).only(np.arange(column + 1)))[name],
        )
        assert found[name].messages == 4_000


def test_no_more_joints_are_followed_than_allowed() -> None:
    many = wave(5, MOST_JOINTS + 3)
    tables = [
        JointTable(topic, tuple(f"{topic}{joint}" for joint in range(MOST_JOINTS + 3)), many)
        for topic in ("/one", "/other")
    ]
    found = leg_history(tables, TransformBuffer(), LegSettings((), ()), TimeSource.HEADER)
    assert [joint.name for joint in found.joints] == sorted(tables[0].names[:MOST_JOINTS])


def test_no_velocity_means_differences() -> None:
    whole = wave()
    found = recorded(samples(whole.position, np.zeros(len(whole.stamp)), whole.effort))
    assert not found.velocity_told
    assert found.absolute_work_j == pytest.approx(recorded(whole).absolute_work_j, rel=1e-3)
    assert found.peak_speed == pytest.approx(3.0, rel=1e-3)


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
        moved = found[name].track.position - expected[name].track.position
        assert moved == pytest.approx(moved[0], abs=1e-5)
        assert found[name].told_moved == pytest.approx(expected[name].told_moved)
        widths = (each[name].highest - each[name].lowest for each in (found, expected))
        assert next(widths) == pytest.approx(next(widths))


def test_a_silence_is_not_bridged() -> None:
    whole = wave(2000)
    kept = np.ones(2000, np.bool_)
    kept[1001:1100] = False
    found = recorded(whole.pick(kept))
    assert found.known_s == pytest.approx((1999 - 100) * STEP / 1e9)
    assert silent_before(found.track.time).sum() == 1
    row = int(np.flatnonzero(silent_before(found.track.time))[0])
    assert np.isnan(found.track.absolute_work[row])
    assert found.track.time[row - 1] == whole.stamp[1000]
    assert found.track.time[row] == whole.stamp[1100]


def test_a_joint_that_never_moves_keeps_no_rows() -> None:
    still = samples(np.full(9000, 0.5), np.zeros(9000), np.full(9000, 2.0))
    found = recorded(still)
    assert len(found.track.time) == 0
    assert not found.moves
    assert found.has_effort
    assert found.squared_effort / found.effort_s == pytest.approx(4.0)


def test_rest_before_the_first_motion_is_not_kept() -> None:
    whole = wave(1000)
    rest = np.zeros((8000, 1))
    late = samples(
        np.concatenate([rest, whole.position]),
        np.concatenate([rest, whole.velocity]),
        np.concatenate([rest, whole.effort]),
    )
    found = recorded(late)
    assert found.track.time[0] == late.stamp[8000]
    assert found.absolute_work_j == pytest.approx(recorded(whole).absolute_work_j, rel=1e-2)


def test_time_near_limits() -> None:
    whole = wave()
    near = recorded(whole, limits=JointLimits(-1.0, 1.0)).near_limit_s
    expected = (np.abs(whole.position[1:, 0]) > 0.96).sum() * STEP / 1e9
    assert near == pytest.approx(expected, abs=2 * STEP / 1e9)
    assert recorded(whole).near_limit_s == 0.0


@pytest.mark.parametrize(
    ("limits", "of", "most"),
    [
        (JointLimits(velocity=3.0), "velocity", 3.0),
        (JointLimits(effort=5.0), "effort", 5.0),
    ],
)
def test_time_near_the_limit_of_velocity_or_effort(
    limits: JointLimits, of: str, most: float
) -> None:
    """Near is beyond 95 % of it; one is enough."""
    whole = wave()
    values = np.abs(getattr(whole, of)[1:, 0])
    expected = (values > 0.95 * most).sum() * STEP / 1e9
    assert recorded(whole, limits=limits).near_limit_s == pytest.approx(
        expected, abs=2 * STEP / 1e9
    )


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e300])
def test_hostile_numbers_cost_their_rows(bad: float) -> None:
    whole = wave(3000)
    for name in ("position", "velocity", "effort"):
        getattr(whole, name)[[0, 7, 1500, 2999]] = bad
    found = recorded(whole)
    for value in (found.absolute_work_j, found.peak_speed, found.peak_effort, found.highest):
        assert np.isfinite(value)
    assert found.highest <= 1.0
    assert found.peak_effort <= 5.0


def test_one_stamp_far_ahead_costs_its_message() -> None:
    whole = wave(3000)
    time = whole.stamp.copy()
    time[700] += 3_600_000_000_000
    found = recorded(samples(whole.position, whole.velocity, whole.effort, time))
    assert found.end == time[-1]
    assert found.absolute_work_j == pytest.approx(recorded(whole).absolute_work_j, rel=1e-3)


def test_times_that_step_back_are_left_out() -> None:
    whole = wave(3000)
    time = whole.stamp.copy()
    time[1000:1010] -= 500 * STEP
    found = recorded(samples(whole.position, whole.velocity, whole.effort, time))
    assert found.not_advancing == 10
    assert np.diff(found.track.time).min() > 0
