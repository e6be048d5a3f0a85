"""Columns, summaries, medians."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import (
    aggregate,
    circular_mean,
    distinct,
    median_of,
    median_of_known,
    nearest_rows,
    percentiles_of,
    rows_by_group,
    stable_order,
)


@pytest.mark.parametrize("highest", [0, 5, (1 << 16) - 1, 1 << 16, 1 << 40])
def test_equal_numbers_stay_in_order(highest: int) -> None:
    values = np.array([highest, 3, 0, highest, 3, 0], np.int64)

    np.testing.assert_array_equal(stable_order(values), np.argsort(values, kind="stable"))


@given(st.lists(st.sampled_from([0, 1, 3, 70_000])))
def test_rows_of_a_group_stand_in_their_order(numbers: list[int]) -> None:
    group = np.array(numbers, np.int64)

    rows = {number: rows.tolist() for number, rows in rows_by_group(group)}

    assert list(rows) == sorted(set(numbers))
    assert rows == {
        number: [row for row, each in enumerate(numbers) if each == number] for number in rows
    }


def test_the_nearest_row_is_found_between_and_beyond_all_rows() -> None:
    time = np.array([0, 10, 30], np.int64)
    at = np.array([-11, 4, 5, 6, 19, 21, 29, 41], np.int64)
    assert nearest_rows(time, at).tolist() == [0, 0, 0, 1, 1, 2, 2, 2]
    assert set(nearest_rows(time[:1], at).tolist()) == {0}


def test_an_aggregate_of_known_values() -> None:
    result = aggregate(np.array([1.0, 2.0, np.nan, 6.0]))
    assert result is not None
    assert (result.n, result.mean, result.median, result.min, result.max) == (3, 3.0, 2.0, 1.0, 6.0)
    assert result.std == pytest.approx(7.0**0.5)  # ((2^2 + 1^2 + 3^2) / 2)


def test_nothing_known_gives_nothing() -> None:
    assert aggregate(np.array([np.nan, np.inf])) is None
    assert circular_mean(np.array([np.nan])) is None


def test_phases_that_straddle_zero_average_to_zero_not_to_half() -> None:
    found = circular_mean(np.array([0.99, 0.01, 0.98, 0.02]))
    assert found is not None
    mean, consistency = found
    assert abs((mean + 0.5) % 1.0 - 0.5) < 1e-12
    assert consistency > 0.99


TABLES = st.one_of(
    arrays.arrays(np.float64, arrays.array_shapes(min_dims=2, max_dims=2, max_side=9)),
    arrays.arrays(np.int64, arrays.array_shapes(min_dims=2, max_dims=2, max_side=9)),
)
"""With NaN, infinities and numbers that overflow."""


def same(ours: Any, numpys: Any) -> bool:
    return bool(
        np.array_equal(ours, numpys, equal_nan=True)
        and np.asarray(ours).dtype == np.asarray(numpys).dtype
    )


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(TABLES, st.sampled_from([None, 0, 1]))
def test_median_is_numpys(values: NDArray[Any], axis: int | None) -> None:
    assert same(median_of(values, axis=axis), np.median(values, axis=axis))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(
    arrays.arrays(np.float64, arrays.array_shapes(min_dims=2, max_dims=3, max_side=9)),
    st.sampled_from([0, 1]),
)
def test_median_of_what_is_known_is_numpys(values: NDArray[Any], axis: int) -> None:
    assert same(median_of_known(values, axis), np.nanmedian(values, axis=axis))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(
    TABLES,
    st.sampled_from([None, 0, 1]),
    st.one_of(st.floats(0.0, 100.0), st.lists(st.floats(0.0, 100.0), min_size=1, max_size=4)),
)
def test_percentiles_are_numpys(
    values: NDArray[Any], axis: int | None, percents: float | list[float]
) -> None:
    expected = np.percentile(values, percents, axis=axis)
    assert same(percentiles_of(values, percents, axis=axis), expected)


@given(TABLES)
def test_distinct_values_are_numpys(values: NDArray[Any]) -> None:
    assert same(distinct(values), np.unique(values))


def test_nothing_has_no_median() -> None:
    assert np.isnan(median_of([]))
    assert np.isnan(median_of(np.empty((0, 3)), axis=0)).tolist() == [True] * 3
