import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.geometry.aggregates import (
    IntervalHistogram,
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


def test_constant_intervals_are_told_exactly() -> None:
    histogram = IntervalHistogram()
    histogram.add(np.full(1000, 4_000_000, np.int64))
    assert histogram.percentile(50.0) == 4_000_000
    assert histogram.percentile(99.0) == 4_000_000
    assert histogram.total == 4_000_000_000


def test_percentiles_of_random_intervals_are_within_two_per_mille() -> None:
    intervals = np.random.default_rng(1).lognormal(15.0, 2.0, 20_000).astype(np.int64)
    histogram = IntervalHistogram()
    for part in np.array_split(intervals, 7):
        histogram.add(part)
    ordered = np.sort(intervals)
    for percent in (5.0, 50.0, 95.0, 99.0):
        true = ordered[int(np.ceil(len(ordered) * percent / 100.0)) - 1]
        assert histogram.percentile(percent) == pytest.approx(true, rel=2e-3)


def test_long_intervals_are_counted_and_added_up() -> None:
    histogram = IntervalHistogram()
    histogram.add(np.array([10, 10, 10, 1000, 2000], np.int64) * 1_000_000)
    longer = histogram.longer_than(50e6)
    assert (longer.count, longer.total) == (2, 3_000_000_000)
    assert histogram.longer_than(float("inf")).count == 0


@given(st.lists(st.integers(1, 10**18), min_size=1, max_size=30))
def test_the_order_of_intervals_does_not_matter(intervals: list[int]) -> None:
    first, second = IntervalHistogram(), IntervalHistogram()
    first.add(np.array(intervals, np.int64))
    for interval in reversed(intervals):
        second.add(np.array([interval], np.int64))
    assert first.percentile(50.0) == second.percentile(50.0)
    assert first.total == second.total == sum(intervals)


def test_repeated_times_are_no_intervals() -> None:
    histogram = IntervalHistogram()
    histogram.add(np.array([0, 5_000_000, 0, 5_000_000]))
    histogram.add(np.array([5_000_000]))
    assert histogram.count == 3
    assert histogram.percentile(0.0) == pytest.approx(5_000_000)
