"""Swings whose way is a parabola between footfalls on a slope: their figures in closed form."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.foot_path import FootPath
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.swings import Footfalls, swings

S = 1_000_000_000
RATE_HZ = 200.0
STRIDES = 4
STANCE_S, SWING_S = 0.6, 0.4
LENGTH_M, HEIGHT_M, SLOPE = 0.3, 0.08, 0.2


def places(time_s: Floats) -> Floats:
    """(n, 3) m: at rest in stance; in swing evenly along x and sideways, and up and down."""
    cycle = np.floor(time_s + 1e-9)
    share = np.clip((time_s - cycle - STANCE_S) / SWING_S, 0.0, 1.0)
    x = LENGTH_M * (cycle + share)
    return np.column_stack([x, 0.0 * x, SLOPE * x + 4.0 * HEIGHT_M * share * (1.0 - share)])


def found(
    *, broken_s: float | None = None, lost_s: tuple[float, float] = (9.0, 9.0)
) -> dict[str, Floats]:
    time = np.arange(round(STRIDES * RATE_HZ) + 1) / RATE_HZ
    time = time[(time < lost_s[0]) | (time > lost_s[1])]
    broken = np.zeros(len(time), np.bool_)
    if broken_s is not None:
        broken[round(broken_s * RATE_HZ)] = True
    path = FootPath(np.round(time * S).astype(np.int64), places(time), broken)
    first = np.arange(STRIDES, dtype=np.int64)
    strides = Strides(first, first * S, first * S + round(STANCE_S * S), (first + 1) * S)
    nothing = np.zeros(STRIDES + 1)
    stood = Footfalls(places(np.arange(STRIDES + 1.0)), nothing, nothing, nothing)
    return swings(path, stood, strides, 1.0 / RATE_HZ)[0]


def test_each_swing_is_as_high_above_its_footfalls_as_the_parabola() -> None:
    assert found()["clearance_m"] == pytest.approx([HEIGHT_M] * STRIDES)
    assert found()["swing_length_m"] == pytest.approx([LENGTH_M] * STRIDES)


def test_a_foot_comes_down_with_the_speed_of_the_parabola() -> None:
    """At the last sample that is known to be in the air, 5 ms before the touchdown."""
    share = 1.0 - 1.0 / RATE_HZ / SWING_S
    along = LENGTH_M / SWING_S
    down = 4.0 * HEIGHT_M / SWING_S * (2.0 * share - 1.0) - SLOPE * along
    assert found()["touchdown_down_mps"] == pytest.approx([down] * STRIDES)
    assert found()["touchdown_along_mps"] == pytest.approx([along] * STRIDES)


def test_a_swing_with_a_silence_is_not_known() -> None:
    clearance = found(broken_s=1.8)["clearance_m"]
    assert np.isnan(clearance).tolist() == [False, True, False, False]
    assert clearance[[0, 2, 3]] == pytest.approx([HEIGHT_M] * 3)


def test_a_foot_that_is_not_told_just_before_its_touchdown_has_no_velocity() -> None:
    """The time is too short to break the path: all else is known."""
    swings_found = found(lost_s=(1.96, 1.999))
    assert np.isnan(swings_found["touchdown_down_mps"]).tolist() == [False, True, False, False]
    assert not np.isnan(swings_found["clearance_m"]).any()
