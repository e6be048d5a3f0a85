from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import (
    distinct,
    median_of,
    median_of_known,
    percentiles_of,
)

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
