"""Poses of a base: which can be used, and the ticks of a clock that thins them."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.base.poses import Odometry, usable_poses
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
        ((1, 2, 3), (NAN, 0.0, 0.0, 1.0), False),
        ((1, 2, 3), (0.0, 0.0, -INF, 0.0), False),
        ((NAN, 0, 0), UPRIGHT, False),
        ((1, 2, 3), UPRIGHT, True),
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
    )
    assert usable_poses(poses).tolist() == [usable]
