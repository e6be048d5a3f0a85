"""Running totals of an accelerometer, against closed forms."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.imu.running import Running, running_accelerations
from dogbot_logtool.core.recorded.vectors import VectorHistory
from tests.core.consistency.poses import base

S = 1_000_000_000


def added_up(time_s: Floats, vector: Floats, gap_s: float = 0.05) -> Running:
    """Readings of an accelerometer on a base that stands level for ten seconds."""
    time = np.round(time_s * S).astype(np.int64)
    sensed = VectorHistory("/imu", ("base",), len(time), 0, 0, time, vector, gap_s * S, False)  # noqa: FBT003
    found = running_accelerations(sensed, base(10.0, 0.0, start_s=0.0), None)
    assert found is not None
    return found


def test_a_constant_reading_is_its_own_mean() -> None:
    time = np.arange(2.0, 8.0, 0.01)
    found = added_up(time, np.tile([1.0, -2.0, 9.81], (len(time), 1)))
    means = found.mean(np.array([3 * S, 5 * S]), S // 2)
    # In the world and in the base's frame, which are one here; then the reaction to gravity.
    assert means == pytest.approx(
        np.tile([1.0, -2.0, 9.81, 1.0, -2.0, 9.81, 0, 0, 9.81], (2, 1)), rel=1e-3
    )
    assert found.known.tolist() == [[2 * S, round(time[-1] * S)]]


def test_nothing_is_known_in_a_silence() -> None:
    time = np.concatenate([np.arange(2.0, 4.0, 0.01), np.arange(5.0, 8.0, 0.01)])
    found = added_up(time, np.tile([0.0, 0.0, 9.81], (len(time), 1)))
    edges = [time[0], 3.99, 5.0, time[-1]]
    assert found.known.ravel().tolist() == [round(each * S) for each in edges]
