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
