"""Poses of a base: which can be used, the ticks of a clock that thins them, jumps and noise."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.motion import base_track, pose_noise_m
from dogbot_logtool.core.base.poses import (
    BaseHistory,
    Odometry,
    find_jumps,
    usable_poses,
    without_jumps,
)
from dogbot_logtool.core.corrections.clock import first_at_each_tick

NAN: Final = math.nan
INF: Final = math.inf
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
EPOCH_NS: Final = 1_600_000_000 * 1_000_000_000

generated = settings(max_examples=100, deadline=None)


def chosen(times: list[int], rate_hz: float) -> list[bool]:
    flags = first_at_each_tick(np.array(times, np.int64), rate_hz)
    assert flags.dtype == np.bool_
    result: list[bool] = flags.tolist()
    return result


# --- ticks ------------------------------------------------------------------------------------


def test_a_step_backwards_starts_a_new_tick() -> None:
    second = 1_000_000_000
    times = [9 * second, 9 * second + 1, 0, 1, second // 50]

    assert chosen(times, 50) == [True, False, True, False, True]


times_of_a_log: Final = st.lists(
    st.integers(-3_000_000, 30_000_000) | st.just(20_000_000), max_size=30
).map(lambda steps: [EPOCH_NS + int(time) for time in np.cumsum(steps)])


@generated
@given(times_of_a_log, st.sampled_from([1.0, 29.97, 50.0, 60.0, 333.3, 1000.0]))
def test_a_sample_is_chosen_if_a_tick_lies_between_it_and_the_one_before(
    times: list[int], rate_hz: float
) -> None:
    period = round(1_000_000_000 / rate_hz)
    expected = []
    before: int | None = None
    for time in times:
        # The last tick at or before a time says in which interval it lies.
        expected.append(before is None or time - time % period != before - before % period)
        before = time

    assert chosen(times, rate_hz) == expected


# --- poses ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("position", "orientation", "usable"),
    [
        ((1, 2, 3), (0.0, 0.0, 0.0, 0.0), False),
        ((1, 2, 3), (0.0, -0.0, 0.0, -0.0), False),
        ((1, 2, 3), (NAN, 0.0, 0.0, 1.0), False),
        ((1, 2, 3), (0.0, 0.0, -INF, 0.0), False),
        ((NAN, 0, 0), UPRIGHT, False),
        ((0, 0, -INF), UPRIGHT, False),
        ((1, 2, 3), UPRIGHT, True),
        ((1, 2, 3), (0, 0, 0, -1), True),
        ((1, 2, 3), (0.5, 0, 0, 0), True),
        ((1, 2, 3), (0, 1e-300, 0, 0), True),
    ],
)
def test_any_finite_pose_but_a_zero_quaternion_can_be_used(
    position: tuple[float, ...], orientation: tuple[float, ...], *, usable: bool
) -> None:
    """Velocities do not matter to a transform: here they are NaN."""
    poses = Odometry(
        log_time=np.array([100]),
        stamp=np.array([50]),
        position=np.array([position], np.float64),
        orientation=np.array([orientation], np.float64),
        linear_velocity=np.full((1, 3), NAN),
        angular_velocity=np.full((1, 3), NAN),
    )
    assert usable_poses(poses).tolist() == [usable]


# --- jumps and noise ---------------------------------------------------------------------


def history(time_s: Floats, position: Floats) -> BaseHistory:
    time = 10**18 + np.round(time_s * 1e9).astype(np.int64)
    return BaseHistory(time, position, np.zeros((len(time), 3)))


def walk(rate_hz: float, seconds: float = 20.0, speed_mps: float = 0.5) -> BaseHistory:
    time = np.arange(round(seconds * rate_hz) + 1) / rate_hz
    zero = np.zeros_like(time)
    sway = 0.02 * np.sin(2.0 * np.pi * time)
    return history(time, np.stack([speed_mps * time, sway, zero + 0.45], axis=1))


@pytest.mark.parametrize("rate_hz", [1.0, 5.0, 10.0, 50.0, 100.0])
def test_a_jump_is_found_at_any_rate_and_taken_out(rate_hz: float) -> None:
    base = walk(rate_hz)
    assert len(find_jumps(base).spans) == 0
    base.position[base.time >= base.time[0] + 9_000_000_000] += (0.6, 0.8, 0.0)
    jumps = find_jumps(base)
    assert len(jumps.spans) == 1
    assert np.linalg.norm(jumps.size_m[0]) == pytest.approx(1.0, abs=0.06)
    motion = without_jumps(base, jumps).position
    assert motion[-1] - motion[0] == pytest.approx([10.0, 0.0, 0.0], abs=0.06)


@pytest.mark.parametrize("rate_hz", [10.0, 20.0, 100.0])
def test_a_start_a_stop_and_a_fall_are_no_jumps(rate_hz: float) -> None:
    time = np.arange(round(20.0 * rate_hz) + 1) / rate_hz
    x = np.interp(time, [5.0, 10.0], [0.0, 7.5])
    z = np.interp(time, [15.0, 15.3], [0.45, 0.1])
    assert len(find_jumps(history(time, np.stack([x, 0.0 * x, z], axis=1))).spans) == 0


def test_noise_is_no_jump() -> None:
    base = walk(100.0)
    base.position[:] += np.random.default_rng(1).normal(0.0, 0.01, base.position.shape)
    assert len(find_jumps(base).spans) == 0
    assert pose_noise_m(base) == pytest.approx(0.01, rel=0.05)


def path_m(base: BaseHistory) -> float:
    track = base_track(base, np.full(len(base.time), NAN), (), timespans.no_spans())
    return track.path_length_m(np.ones(len(base.time) - 1, np.bool_))


@pytest.mark.parametrize("noise_m", [0.0, 0.002, 0.01])
def test_the_path_is_that_of_the_motion_not_of_the_noise(noise_m: float) -> None:
    base = walk(100.0)
    sway = base.position[:, 1].copy()
    base.position[:, 1] -= sway
    base.position[:] += np.random.default_rng(2).normal(0.0, noise_m, base.position.shape)
    assert path_m(base) == pytest.approx(10.0, rel=0.025)


def test_a_robot_that_stands_and_sways_has_no_path() -> None:
    base = walk(100.0, speed_mps=0.0)
    base.position[:] += np.random.default_rng(3).normal(0.0, 0.002, base.position.shape)
    assert path_m(base) == 0.0


def test_noise_is_measured_at_uneven_intervals_too() -> None:
    base = walk(250.0)
    rows = np.flatnonzero(np.arange(len(base.time)) % 5 % 3 == 0)
    uneven = history((base.time[rows] - base.time[0]) / 1e9, base.position[rows])
    assert pose_noise_m(uneven) < 1e-4


@pytest.mark.parametrize("turn_rad", [0.3, -0.5, 0.0])
def test_a_jump_turns_the_base_too(turn_rad: float) -> None:
    """The robot's own turning is no part of it."""
    base = walk(50.0)
    late = base.time >= base.time[0] + 9_000_000_000
    base.angles[:, 2] = 0.2 * (base.time - base.time[0]) / 1e9
    base.position[late] += (0.6, 0.8, 0.0)
    base.angles[late, 2] += turn_rad
    jumps = find_jumps(base)
    assert jumps.turn_rad == pytest.approx([turn_rad], abs=1e-6)
    start, end = base.time[[0, -1]].tolist()
    yaw = without_jumps(base, jumps).angles[:, 2]
    assert yaw[-1] - yaw[0] == pytest.approx(0.2 * (end - start) / 1e9, abs=1e-6)
