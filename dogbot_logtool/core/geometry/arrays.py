"""The array types of the columns, and the few vector formulas that everything shares."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""float64; the docstring of the field gives shape and unit."""
Float32s = NDArray[np.float32]
Ints = NDArray[np.int64]
"""int64: times in nanoseconds, or row numbers."""
Flags = NDArray[np.bool_]
Bytes = NDArray[np.uint8]


def norms(vectors: Floats) -> Floats:
    """Euclidean lengths.

    Squares by multiplication and sums left to right, so that the result equals
    ``math.sqrt(x * x + y * y + z * z)`` to the bit.

    Args:
        vectors: (n, 3), any unit.

    Returns:
        (n,), the same unit. Overflow gives inf, NaN stays NaN.
    """
    x, y, z = vectors[:, 0], vectors[:, 1], vectors[:, 2]
    with np.errstate(over="ignore", invalid="ignore"):
        length: Floats = np.sqrt(x * x + y * y + z * z)
    return length


def dots(first: Floats, second: Floats) -> Floats:
    """Scalar products, row by row, added up left to right.

    Column by column: numpy reduces short rows ten times slower.

    Args:
        first: (n, 3).
        second: (n, 3).

    Returns:
        (n,).
    """
    product: Floats = first[:, 0] * second[:, 0]
    product += first[:, 1] * second[:, 1]
    product += first[:, 2] * second[:, 2]
    return product


def sum_by_group(values: Floats, group: Ints, groups: int) -> Floats:
    """Sum rows that share a group number, in the order in which they stand.

    Args:
        values: (m, k) or (m,).
        group: (m,) group numbers in [0, groups).
        groups: the number of groups.

    Returns:
        (groups, k) or (groups,); zero where a group has no rows.
    """
    if values.ndim == 2:
        return np.stack([sum_by_group(column, group, groups) for column in values.T], axis=1)
    total = np.bincount(group, weights=values, minlength=groups)
    return total.astype(np.float64, copy=False)


def header_time(stamp: Ints, log_time: Ints) -> Ints:
    """Return the time of each message: its header stamp, or its log time where that is zero.

    Old simulations record zero stamps throughout; a viewer cannot place those.

    Args:
        stamp: (n,) ns.
        log_time: (n,) ns.

    Returns:
        (n,) ns.
    """
    return np.where(stamp == 0, log_time, stamp)


def stable_order(values: Ints) -> Ints:
    """Return the rows in the order of some small numbers, equal ones as they stand.

    numpy sorts 16-bit numbers by their digits, several times faster than longer ones.

    Args:
        values: (n,), not negative.
    """
    short = not len(values) or int(values.max()) < 1 << 16
    return np.argsort(values.astype(np.uint16) if short else values, kind="stable")


def rows_by_group(group: Ints) -> Iterator[tuple[int, Ints]]:
    """Yield each group number, ascending, with its rows as they stand.

    Args:
        group: (n,) small numbers, not negative.
    """
    order = stable_order(group)
    ordered = group[order]
    bounds = [0, *(np.flatnonzero(ordered[1:] != ordered[:-1]) + 1).tolist(), len(order)]
    for first, last in pairwise(bounds):
        if first < last:
            yield int(ordered[first]), order[first:last]


def all_finite(vectors: Floats | Float32s) -> Flags:
    """(n,) whether all numbers of each row are finite.

    Column by column: numpy reduces short rows ten times slower.
    """
    finite = np.ones(len(vectors), np.bool_)
    for column in vectors.T:
        finite &= np.isfinite(column)
    return finite


def nearest_rows(among: Ints, times: Ints) -> Ints:
    """(n,) row of the nearest of sorted times, at least one, to each of others."""
    after = np.minimum(np.searchsorted(among, times), len(among) - 1)
    before = np.maximum(after - 1, 0)
    later = np.abs(among[after] - times) < np.abs(among[before] - times)
    return np.where(later, after, before)
