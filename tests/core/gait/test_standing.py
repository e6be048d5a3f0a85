import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.gait.standing import find_standing

S = 1_000_000_000
NONE = timespans.no_spans()
ALL_DOWN = np.array([[0, 20 * S]], np.int64)


def base(x: Floats, yaw: Floats | None = None) -> BaseHistory:
    count = len(x)
    time = np.round(np.arange(count) * 1e8).astype(np.int64)
    zero = np.zeros(count)
    angles = np.stack([zero, zero, zero if yaw is None else yaw], axis=1)
    position = np.stack([x, zero, zero + 0.4], axis=1)
    return BaseHistory(count, 0, 0, time, position, angles, NONE)


def seconds(spans: Ints) -> list[list[float]]:
    return [[round(start / S, 1), round(end / S, 1)] for start, end in spans.tolist()]


AT = np.arange(201) / 10.0


@pytest.mark.parametrize(
    "x",
    [0.0 * AT, 0.05 * np.sin(AT), 0.004 * AT],
    ids=["still", "sways", "drifts"],
)
def test_a_base_that_goes_nowhere_stands(x: Floats) -> None:
    standing = find_standing(ALL_DOWN, NONE, 1.0, base(x))
    assert seconds(standing.still) == [[0.0, 20.0]]
    assert len(standing.moving) == 0


def test_a_base_that_rolls_does_not_stand() -> None:
    standing = find_standing(ALL_DOWN, NONE, None, base(0.3 * AT))
    assert seconds(standing.moving) == [[0.0, 20.0]]
    assert len(standing.still) == 0


def test_a_base_that_turns_on_its_wheels_does_not_stand() -> None:
    standing = find_standing(ALL_DOWN, NONE, None, base(0.0 * AT, yaw=0.2 * AT))
    assert seconds(standing.moving) == [[0.0, 20.0]]


def test_a_stand_before_rolling_is_a_stand() -> None:
    standing = find_standing(ALL_DOWN, NONE, None, base(np.maximum(0.0, 0.3 * (AT - 10.0))))
    ((start, end),) = seconds(standing.still)
    assert start == 0.0
    assert end == pytest.approx(10.0, abs=1.1)
    assert seconds(standing.moving)[0][1] == 20.0


def test_time_with_all_feet_down_within_a_slow_stride_is_no_stand() -> None:
    assert len(find_standing(ALL_DOWN, NONE, 30.0, base(0.0 * AT)).still) == 0


def test_without_poses_the_feet_decide() -> None:
    empty = base(np.empty(0))
    assert seconds(find_standing(ALL_DOWN, NONE, None, empty).still) == [[0.0, 20.0]]


def test_a_leap_is_not_being_held_in_the_air() -> None:
    in_flight = np.array([[0, 3 * S // 10], [5 * S, 9 * S]], np.int64)
    assert seconds(find_standing(NONE, in_flight, 0.5, base(0.0 * AT)).lifted) == [[5.0, 9.0]]
