"""A sine that is late, smaller and noisy, against its own numbers."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.consistency.heave import fit_delay

TIME = np.arange(0.0, 20.0, 0.01)
LAGS = np.linspace(-0.3, 0.3, 61)


def sine(time: Floats) -> Floats:
    return np.asarray(np.sin(2.0 * np.pi * 0.7 * time))


@pytest.mark.parametrize("gain", [0.6, -0.6])
def test_delay_gain_and_correlation(gain: float) -> None:
    noise = np.random.default_rng(4).normal(0.0, 0.4, len(TIME))
    measured = gain * sine(TIME - 0.12) + noise
    found = fit_delay(measured, lambda lag: sine(TIME - lag), LAGS, 200.0)
    assert found is not None
    assert found.delay_s == pytest.approx(0.12, abs=0.01)
    assert found.low_s < 0.12 < found.high_s
    assert found.gain == pytest.approx(gain, abs=0.03)
    expected = np.corrcoef(measured, sine(TIME - 0.12))[0, 1]
    assert found.correlation == pytest.approx(expected, abs=0.005)


def test_what_does_not_vary_has_no_delay() -> None:
    assert fit_delay(np.ones(len(TIME)), lambda lag: sine(TIME - lag), LAGS, 200.0) is None
