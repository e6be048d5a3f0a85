"""Transforms are the recorded poses, thinned to the ticks of a clock that batches do not move."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.base.poses import Odometry, base_transforms, usable_poses
from dogbot_logtool.core.corrections.clock import first_at_each_tick

NAN: Final = math.nan
INF: Final = math.inf
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
EPOCH_NS: Final = 1_600_000_000 * 1_000_000_000

generated = settings(max_examples=100, deadline=None)


def odometry(
    *,
    position: tuple[float, ...] = (1, 2, 3),
    orientation: tuple[float, ...] = UPRIGHT,
    stamp: int = 50,
    count: int = 1,
) -> Odometry:
    return Odometry(
        log_time=np.arange(count) + 100,
        stamp=np.full(count, stamp),
        position=np.tile(np.array(position, np.float64), (count, 1)),
        orientation=np.tile(np.array(orientation, np.float64), (count, 1)),
        linear_velocity=np.full((count, 3), NAN),
        angular_velocity=np.full((count, 3), NAN),
    )


def chosen(times: list[int], rate_hz: float, previous: int | None = None) -> list[bool]:
    flags = first_at_each_tick(np.array(times, np.int64), rate_hz, previous)
    assert flags.dtype == np.bool_
    result: list[bool] = flags.tolist()
    return result


# --- ticks ------------------------------------------------------------------------------------


def test_the_first_sample_at_or_after_each_tick_is_chosen() -> None:
    milliseconds = [19, 20, 21, 39, 45, 59, 60, 61, 105]

    flags = chosen([ms * 1_000_000 for ms in milliseconds], 50)

    assert [ms for ms, flag in zip(milliseconds, flags, strict=True) if flag] == [
        19,
        20,
        45,
        60,
        105,
    ]


def test_a_rate_of_zero_chooses_every_sample() -> None:
    assert chosen([5, 5, 4, 6], 0) == [True] * 4
    assert chosen([5, 5], 0, previous=5) == [True] * 2


@pytest.mark.parametrize("rate_hz", [0, 50])
def test_no_samples_choose_none(rate_hz: float) -> None:
    assert chosen([], rate_hz) == []
    assert chosen([], rate_hz, previous=7) == []


def test_samples_of_one_time_are_chosen_once() -> None:
    assert chosen([EPOCH_NS] * 3, 50) == [True, False, False]


def test_a_step_backwards_starts_a_new_tick() -> None:
    second = 1_000_000_000
    times = [9 * second, 9 * second + 1, 0, 1, second // 50]

    assert chosen(times, 50) == [True, False, True, False, True]


def test_times_before_the_epoch_have_ticks_too() -> None:
    tick = 20_000_000

    assert chosen([-tick - 1, -tick, -1, 0, 1], 50) == [True, True, False, True, False]


def test_samples_slower_than_the_ticks_are_all_chosen() -> None:
    assert all(chosen([EPOCH_NS + row * 100_000_000 for row in range(20)], 50))


def test_a_kilohertz_is_thinned_to_fifty_hertz() -> None:
    flags = chosen([EPOCH_NS + row * 1_000_000 for row in range(1000)], 50)

    assert np.flatnonzero(flags).tolist() == list(range(0, 1000, 20))


@pytest.mark.parametrize("rate_hz", [1e9, 1.9e9, 3e9, 1e12, INF])
def test_a_rate_finer_than_nanoseconds_chooses_every_other_time(rate_hz: float) -> None:
    assert chosen([7, 8, 8, 9], rate_hz) == [True, True, False, True]


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


@generated
@given(data=st.data(), times=times_of_a_log, rate_hz=st.sampled_from([0.0, 1.0, 50.0, 999.0]))
def test_the_choice_does_not_depend_on_where_batches_begin(
    data: st.DataObject, times: list[int], rate_hz: float
) -> None:
    cuts = sorted(data.draw(st.lists(st.integers(0, len(times)), max_size=6)))

    pieces: list[bool] = []
    previous: int | None = None
    for start, end in zip([0, *cuts], [*cuts, len(times)], strict=True):
        batch = times[start:end]
        pieces += chosen(batch, rate_hz, previous)
        previous = batch[-1] if batch else previous

    assert pieces == chosen(times, rate_hz)


# --- poses ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "orientation",
    [
        (0.0, 0.0, 0.0, 0.0),
        (0.0, -0.0, 0.0, -0.0),
        (NAN, 0.0, 0.0, 1.0),
        (0.0, 0.0, 0.0, NAN),
        (0.0, INF, 0.0, 1.0),
        (0.0, 0.0, -INF, 0.0),
    ],
)
def test_a_zero_or_infinite_quaternion_is_no_pose(orientation: tuple[float, ...]) -> None:
    assert usable_poses(odometry(orientation=orientation)).tolist() == [False]


@pytest.mark.parametrize("position", [(NAN, 0, 0), (0, INF, 0), (0, 0, -INF)])
def test_a_position_that_is_not_finite_is_no_pose(position: tuple[float, ...]) -> None:
    assert usable_poses(odometry(position=position)).tolist() == [False]


@pytest.mark.parametrize("orientation", [UPRIGHT, (0, 0, 0, -1), (0.5, 0, 0, 0), (0, 1e-300, 0, 0)])
def test_any_other_quaternion_is_a_pose_whatever_its_norm(orientation: tuple[float, ...]) -> None:
    # Velocities do not matter to a transform: here they are NaN.
    assert usable_poses(odometry(orientation=orientation)).tolist() == [True]


def test_poses_become_transforms_verbatim() -> None:
    transforms = base_transforms(odometry(orientation=(0.1, 0.2, 0.3, 5.0), count=2))

    assert transforms.translation.tolist() == [[1, 2, 3]] * 2
    assert transforms.rotation.tolist() == [[0.1, 0.2, 0.3, 5.0]] * 2
    assert transforms.log_time.tolist() == [100, 101]
    assert transforms.stamp.tolist() == [50, 50]


def test_a_stamp_of_zero_gives_way_to_the_log_time() -> None:
    assert base_transforms(odometry(stamp=0, count=2)).stamp.tolist() == [100, 101]


def test_picked_rows_keep_every_column() -> None:
    every = odometry(count=4)

    assert every.pick(np.array([2, 0])).log_time.tolist() == [102, 100]
    assert every.pick(np.array([False, True, False, True])).time.tolist() == [50, 50]
    picked = every.pick(np.array([1]))
    assert picked.position.shape == picked.linear_velocity.shape == (1, 3)
    assert picked.angular_velocity.shape == (1, 3)
    assert picked.orientation.tolist() == [list(UPRIGHT)]
