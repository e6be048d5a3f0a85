"""Medians, spans of time, rotations: against numpy and sets."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Ints,
    aggregate,
    distinct,
    median_of,
    median_of_known,
    nearest_rows,
    percentiles_of,
)
from dogbot_logtool.core.rotations import normalised, slerp
from tests.truth.geometry import about_axis

PERCENTS = [0.0, 12.5, 95.0, 100.0]


def test_the_nearest_row_is_found_between_and_beyond_all_rows() -> None:
    time = np.array([0, 10, 30], np.int64)
    at = np.array([-11, 4, 5, 6, 19, 21, 29, 41], np.int64)
    assert nearest_rows(time, at).tolist() == [0, 0, 0, 1, 1, 2, 2, 2]


TABLES = st.one_of(
    *(
        arrays.arrays(kind, arrays.array_shapes(min_dims=2, max_dims=2, max_side=9))
        for kind in (np.float64, np.int64)
    )
)
"""With NaN, infinities and numbers that overflow."""


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@given(TABLES, st.sampled_from([None, 0, 1]))
def test_summaries_are_numpys(values: NDArray[Any], axis: int | None) -> None:
    pairs = [
        (median_of(values, axis=axis), np.median(values, axis=axis)),
        (percentiles_of(values, PERCENTS, axis=axis), np.percentile(values, PERCENTS, axis=axis)),
        (distinct(values), np.unique(values)),
    ]
    if axis is not None and values.dtype == np.float64:
        pairs.append((median_of_known(values, axis), np.nanmedian(values, axis=axis)))
    for ours, numpys in pairs:
        np.testing.assert_array_equal(ours, numpys, strict=True)


def test_nothing_has_no_median_and_no_summary() -> None:
    assert aggregate(np.array([np.nan, np.inf])) is None
    assert np.isnan(median_of([]))
    assert np.isnan(median_of(np.empty((0, 3)), axis=0)).tolist() == [True] * 3


LENGTH = 40


@st.composite
def spans(draw: st.DrawFn) -> Ints:
    edges = sorted(draw(st.sets(st.integers(0, LENGTH), max_size=12)))
    pairs = edges[: len(edges) // 2 * 2]
    return np.array(pairs, np.int64).reshape(-1, 2)


def cells(table: Ints) -> set[int]:
    """Unit cells that spans cover: the oracle counts them one by one."""
    return {cell for start, end in table.tolist() for cell in range(start, end)}


@given(spans(), spans(), st.integers(0, LENGTH), st.integers(1, 5))
def test_spans_are_sets_of_time(first: Ints, second: Ints, start: int, length: int) -> None:
    for found, expected in (
        (timespans.intersect([first, second]), cells(first) & cells(second)),
        (timespans.subtract(first, second), cells(first) - cells(second)),
        (timespans.merge(np.concatenate([first, second])), cells(first) | cells(second)),
    ):
        assert cells(found) == expected
        assert (found[1:, 0] > found[:-1, 1]).all()
        assert timespans.total(found) == len(expected)
    held = [a <= start and start + length <= b for a, b in first.tolist()]
    touched = [b >= start and a < start + length for a, b in first.tolist()]
    at, behind = np.array([start]), np.array([start + length])
    assert timespans.hold_window(first, at + 1, 1, length - 1).tolist() == [any(held)]
    assert timespans.touches(first, at, behind).tolist() == [any(touched)]
    assert timespans.covers(first, at)[0] == (start in cells(first))


def test_ticks_are_whole_multiples_in_spans() -> None:
    table = np.array([[5, 21], [30, 31], [40, 41]], np.int64)
    assert timespans.ticks(table, 10).tolist() == [10, 20, 30, 40]
    assert len(timespans.ticks(timespans.no_spans(), 10)) == 0


ABOUT_Z = about_axis(2, np.array([0.2, 0.3, 0.4]))


def test_interpolation_takes_the_shorter_arc() -> None:
    half = slerp(ABOUT_Z[:1], -ABOUT_Z[2:], np.array([0.5]))
    assert abs((half * ABOUT_Z[1]).sum()) == pytest.approx(1.0)


@pytest.mark.parametrize("scale", [1e-200, 1e200])
def test_any_length_is_normalised(scale: float) -> None:
    np.testing.assert_allclose(normalised(ABOUT_Z * scale), ABOUT_Z, rtol=1e-12)
