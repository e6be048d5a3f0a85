import numpy as np
import pytest

from dogbot_logtool.core.arrays import (
    aggregate,
    circular_mean,
    wrapped,
)


def test_an_aggregate_of_known_values() -> None:
    result = aggregate(np.array([1.0, 2.0, np.nan, 6.0]))
    assert result is not None
    assert (result.n, result.mean, result.median, result.min, result.max) == (3, 3.0, 2.0, 1.0, 6.0)
    assert result.std == pytest.approx(7.0**0.5)  # ((2^2 + 1^2 + 3^2) / 2)


def test_nothing_known_gives_nothing() -> None:
    assert aggregate(np.array([np.nan, np.inf])) is None
    assert circular_mean(np.array([np.nan])) is None


def test_a_single_value_has_no_spread() -> None:
    result = aggregate(np.array([4.0]))
    assert result is not None
    assert result.std is None


def test_phases_that_straddle_zero_average_to_zero_not_to_half() -> None:
    mean = circular_mean(np.array([0.99, 0.01, 0.98, 0.02]))
    assert mean is not None
    assert abs((mean.mean + 0.5) % 1.0 - 0.5) < 1e-12
    assert mean.consistency > 0.99


def test_phases_spread_evenly_have_no_consistency() -> None:
    mean = circular_mean(np.arange(8) / 8.0)
    assert mean is not None
    assert mean.consistency < 1e-12


def test_wrapped_differences_lie_around_zero() -> None:
    assert wrapped(np.array([0.75, -0.75, 0.25])).tolist() == [-0.25, 0.25, 0.25]
