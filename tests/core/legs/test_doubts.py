"""Energy of a robot that climbs and speeds up, in closed form, against the work of its joints."""

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.doubts import shortfall

WEIGHT_N = 200.0
CLIMB_M = 0.05
"""A stride, of 1 s."""
SECOND = 1_000_000_000


def base(climb_m: float = CLIMB_M, speeding_mps2: float = 0.0) -> BaseHistory:
    time = np.arange(0, 12 * SECOND, SECOND // 100)
    seconds = time / 1e9
    ahead = seconds + speeding_mps2 * seconds**2 / 2.0
    position = np.column_stack([ahead, np.zeros_like(seconds), climb_m * seconds])
    level = np.zeros_like(position)
    return BaseHistory(len(time), 0, 0, time, position, level, timespans.no_spans())


def strides(count: int = 8) -> Strides:
    start = np.arange(1, count + 1) * SECOND
    return Strides(np.arange(count), start, start + SECOND // 2, start + SECOND)


def work(net_j: Floats | float, absolute_j: float = 40.0, count: int = 8) -> Floats:
    absolute = np.full(count, absolute_j)
    return np.stack([(absolute + net_j) / 2.0, absolute])


def test_work_that_lifts_the_robot_is_not_short() -> None:
    for losses in (0.0, 3.0):
        done = work(WEIGHT_N * CLIMB_M + losses)
        assert shortfall(done, strides(), base(), WEIGHT_N) is None


def test_work_that_is_less_is_short() -> None:
    assert shortfall(work(0.0), strides(), base(), WEIGHT_N) == pytest.approx(WEIGHT_N * CLIMB_M)
    falling = base(-CLIMB_M)
    assert shortfall(work(-WEIGHT_N * CLIMB_M), strides(), falling, WEIGHT_N) is None
    assert shortfall(work(-25.0), strides(), falling, WEIGHT_N) == pytest.approx(15.0)


def test_what_speeds_the_robot_up_counts() -> None:
    faster = base(0.0, speeding_mps2=0.2)
    found = shortfall(work(0.0), strides(), faster, WEIGHT_N)
    before, after = 1.0 + 0.2 * 1.0, 1.0 + 0.2 * 9.0
    assert found == pytest.approx(WEIGHT_N / 9.81 * (after**2 - before**2) / 2.0 / 8.0, rel=1e-3)


def test_little_or_unsure_is_not_said() -> None:
    level = base(0.0)
    assert shortfall(work(-3.9), strides(), level, WEIGHT_N) is None
    assert shortfall(work(-4.1), strides(), level, WEIGHT_N) == pytest.approx(4.1)
    unsteady = -6.0 + 12.0 * np.tile([1.0, -1.0], 4)
    assert shortfall(work(unsteady), strides(), level, WEIGHT_N) is None


def test_few_strides_and_unknown_ones() -> None:
    assert shortfall(work(-9.0, count=3), strides(3), base(0.0), WEIGHT_N) is None
    unknown = np.where(np.arange(8) < 5, np.nan, -9.0)
    assert shortfall(work(unknown), strides(), base(0.0), WEIGHT_N) is None
    nothing = Strides(*(np.empty(0, np.int64) for _ in range(4)))
    assert shortfall(work(0.0, count=0), nothing, base(), WEIGHT_N) is None
