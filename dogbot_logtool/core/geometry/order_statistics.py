"""Medians and percentiles of float64 or int64, to the last bit as numpy's, and distinct values.

numpy's own ask for masked arrays, whose import alone takes as long as a third of numpy's, and
take many times as long for the few values that most of ours have.
"""

from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Values = TypeVar("Values", bound=np.generic)


def distinct(values: NDArray[Values]) -> NDArray[Values]:
    """Return the values that occur, ascending; NaN, if at all, once; see `np.unique`."""
    ordered = np.sort(values, axis=None)
    before, after = ordered[:-1], ordered[1:]
    # NaN differs from itself, too.
    new = np.concatenate([[True], (after != before) & (before == before)])  # noqa: PLR0124
    found: NDArray[Values] = ordered[new[: len(ordered)]]
    return found


def median_of(values: ArrayLike, axis: int | None = None) -> Any:  # noqa: ANN401 - as numpy has it
    """Return the middle value, or the mean of both; see `np.median`.

    NaN where one is among the values, or where there are none.
    """
    rows = _rows(values, axis)
    middle = len(rows) // 2
    ranks = [middle] if len(rows) % 2 else [middle - 1, middle]
    if not len(rows):
        return np.full(rows.shape[1:], np.nan)[()]
    ordered = np.partition(rows, [*ranks, -1], axis=0)
    return _nan_if_any(ordered, ordered[ranks].mean(axis=0))


def median_of_known(values: ArrayLike, axis: int) -> Any:  # noqa: ANN401 - as numpy has it
    """Return the median of the values that are not NaN, NaN where all are; see `np.nanmedian`."""
    ordered = np.sort(_rows(values, axis), axis=0)
    last = (~np.isnan(ordered)).sum(axis=0, keepdims=True) - 1
    middle = [np.take_along_axis(ordered, rank, axis=0) for rank in (last // 2, (last + 1) // 2)]
    return np.concatenate(middle).mean(axis=0)


def percentiles_of(
    values: ArrayLike, percents: float | Sequence[float], axis: int | None = None
) -> Any:  # noqa: ANN401 - as numpy has it
    """Return the values below which percentages lie, interpolated linearly; see `np.percentile`.

    Args:
        values: at least one.
        percents: one, or (k,), from 0 to 100.
        axis: along which they are; None: all are one sample.

    Returns:
        (k, ...), or as one percentage has it; NaN where one is among the values.
    """
    rows = _rows(values, axis)
    rank = np.atleast_1d(percents) / 100.0 * (len(rows) - 1)
    before = np.floor(rank).astype(np.intp)
    after = np.minimum(before + 1, len(rows) - 1)
    ordered = np.partition(rows, [*before.tolist(), *after.tolist(), -1], axis=0)
    low, high = ordered[before], ordered[after]
    part = (rank - before).reshape(-1, *[1] * (rows.ndim - 1))
    step = high - low
    found = np.where(part < 0.5, low + step * part, high - step * (1.0 - part))
    return _nan_if_any(ordered, found if np.ndim(percents) else found[0])


def _rows(values: ArrayLike, axis: int | None) -> NDArray[Any]:
    """Return the values with those of one sample along the first axis."""
    array = np.asarray(values)
    return array.ravel() if axis is None else np.moveaxis(array, axis, 0) if axis else array


def _nan_if_any(ordered: NDArray[Any], found: Any) -> Any:  # noqa: ANN401 - any number
    # NaN is sorted behind all others.
    last = ordered[-1]
    return np.where(np.isnan(last), last, found)[()]
