"""Forces whose axes are cut off, and others that only look like it."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.sensors.saturation import resolution_n, saturated_limit_n

NO_OFFSET = np.zeros(3)
LOAD_N = 90.0


def walk(offset_n: float = 0.0) -> Floats:
    """(800, 3) N: eight stances of 0.5 s at 200 Hz, braking and driving, with swings between."""
    phase = np.arange(800) / 100.0 % 1.0
    down = phase < 0.6
    vertical = np.where(down, 100.0 * np.sin(np.pi * phase / 0.6), 0.0)
    along = np.where(down, -10.0 * np.sin(2.0 * np.pi * phase / 0.6), 0.0)
    return np.stack([along, np.zeros(800), vertical + offset_n], axis=1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_axis_that_is_cut_off_shows_though_the_others_vary(sign: float) -> None:
    force = sign * walk()
    force[:, 2] = np.clip(force[:, 2], -80.0, 80.0)
    assert saturated_limit_n(force, NO_OFFSET, LOAD_N) == pytest.approx(sign * 80.0)


@pytest.mark.parametrize("step_n", [0.0, 2.0, 5.0])
def test_a_round_top_is_no_limit(step_n: float) -> None:
    force = walk() if step_n == 0.0 else np.round(walk() / step_n) * step_n
    assert saturated_limit_n(force, NO_OFFSET, LOAD_N) is None


def test_what_the_unloaded_sensor_reads_is_no_limit() -> None:
    offset = np.array([0.0, 0.0, -65.0])
    assert saturated_limit_n(walk(-65.0), offset, LOAD_N) is None


def test_the_resolution_is_that_of_the_coarsest_axis() -> None:
    force = walk()
    force[:, 2] = np.round(force[:, 2] / 4.0) * 4.0
    assert resolution_n(force) == pytest.approx(4.0)
    assert resolution_n(np.zeros((5, 3))) == 0.0
