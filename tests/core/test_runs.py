import numpy as np
import pytest

from dogbot_logtool.core.arrays import (
    added_within,
    first_where,
    highest,
    quantiles,
    sorted_runs,
    sums,
    trapezoids,
)

VALUES = np.array([9.0, 3.0, 1.0, 2.0, 9.0, 7.0, 5.0, 9.0])
BEGIN, END = np.array([1, 5]), np.array([4, 7])
"""Two runs, 3 1 2 and 7 5, and a 9 before, between and behind them."""


def test_runs_are_reduced_without_what_lies_around_them() -> None:
    assert highest(VALUES, BEGIN, END).tolist() == [3.0, 7.0]
    assert sums(VALUES, BEGIN, END).tolist() == [6.0, 12.0]
    assert sorted_runs(VALUES, BEGIN, END).tolist() == [9.0, 1.0, 2.0, 3.0, 9.0, 5.0, 7.0, 9.0]


def test_the_first_flagged_row_is_found_at_or_after_each_start() -> None:
    assert first_where(VALUES == 9.0, np.array([0, 1, 4, 5])).tolist() == [0, 4, 4, 7]
    assert first_where(VALUES == 3.0, np.array([2])).tolist() == [len(VALUES)]


def test_the_impulse_uses_real_sample_times() -> None:
    time = np.array([0.0, 0.001, 0.5, 1.0, 7.0, 8.0])
    value = np.array([0.0, 0.002, 1.0, 2.0, 3.0, 5.0])
    assert trapezoids(value, time, np.array([0, 4])) == pytest.approx([1.0, 4.0])


def test_quantiles_are_interpolated() -> None:
    ordered = np.array([0.0, 10.0, 7.0])
    begin, end = np.array([0, 2]), np.array([2, 3])
    assert quantiles(ordered, begin, end, 0.25).tolist() == [2.5, 7.0]
    assert quantiles(ordered, begin, end, 0.95).tolist() == [9.5, 7.0]
    later = np.array([7.0, 0.0, 10.0, 20.0, 90.0])
    rows = np.array([0, 1]), np.array([1, 5])
    assert quantiles(later, *rows, 0.5).tolist() == [7.0, 15.0]
    assert quantiles(later, *rows, 0.9).tolist() == pytest.approx([7.0, 69.0])


def test_running_totals_grow_within_windows() -> None:
    total, knots = np.array([[0.0, 1.0], [2.0, 1.0], [2.0, 9.0]]), np.array([0.0, 1.0, 3.0])
    added = added_within(total, knots, np.array([0.5, 1.0, 9.0]), 0.5)
    assert added == pytest.approx(np.array([[2.0, 0.0], [1.0, 2.0], [0.0, 0.0]]))
