"""How forces swing with an accelerometer of which only a part is known."""

from dataclasses import astuple

import numpy as np
import pytest

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.delay import Delay
from dogbot_logtool.core.imu.forces import Sensed, _curve
from dogbot_logtool.core.imu.running import Running

MS = 1_000_000
HALF_NS = 340 * MS
LATEST_NS = 85 * MS
"""The largest delay that is tried, of a stride of 0.68 s."""
SECONDS = 12.0
KNOWN_S = 2.0, 9.0


def swinging(time_s: Floats) -> Floats:
    return np.asarray(9.81 + 2.0 * np.sin(2.0 * np.pi * 2.5 * time_s))


def curve_with(nonsense: float, late_s: float = 0.0) -> Delay | None:
    """Compare with an accelerometer that reads nonsense in all time that is not known.

    Args:
        nonsense: m/s^2.
        late_s: by which forces come later.
    """
    time = np.arange(0.0, SECONDS, 0.005)
    reading = np.where((time >= KNOWN_S[0]) & (time < KNOWN_S[1]), swinging(time), nonsense)
    columns = np.zeros((len(time), 9))
    columns[1:, 2] = np.cumsum((reading[1:] + reading[:-1]) / 2.0 * 0.005)
    known = np.array([KNOWN_S]) * 1e9 + [[10 * MS, -10 * MS]]
    running = Running(0, time * 1e9, columns, known.astype(np.int64))
    at = np.arange(0, round(SECONDS * 1e9), 40 * MS)
    sensed = Sensed(running, at, HALF_NS, np.zeros((len(at), 3)), lacks_gravity=False)
    return _curve(swinging(at / 1e9 - late_s), at, sensed)


@pytest.mark.parametrize("late_s", [-1e-9 * LATEST_NS, 0.0, 1e-9 * LATEST_NS])
def test_what_is_read_in_unknown_time_is_left_out_of_every_window(late_s: float) -> None:
    found = curve_with(0.0, late_s)
    assert found is not None
    assert found.correlation > 0.99
    assert found.delay_s == pytest.approx(late_s, abs=0.002)
    other = curve_with(100.0, late_s)
    assert other is not None
    assert astuple(other) == pytest.approx(astuple(found), abs=1e-9)


def test_all_time_that_a_delay_can_be_tried_in_is_used() -> None:
    """Windows of a stride, moved by a delay, fit into what is known of 7 s; 4 of them must."""
    assert KNOWN_S[1] - KNOWN_S[0] - 2e-9 * (HALF_NS + LATEST_NS) > 4 * 2e-9 * HALF_NS
    assert curve_with(0.0) is not None
