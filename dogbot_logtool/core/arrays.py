"""Columns: their types, records of columns, spans of rows, medians, summaries."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any, ClassVar, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
"""float64; the docstring of the field gives shape and unit."""
Float32s = NDArray[np.float32]
Complexes = NDArray[np.complex128]
Ints = NDArray[np.int64]
"""int64: times in nanoseconds, or row numbers."""
Flags = NDArray[np.bool_]
Bytes = NDArray[np.uint8]


def norms(vectors: Floats | Float32s) -> Floats:
    """Euclidean lengths.

    Squares by multiplication and sums left to right, so that the result equals
    ``math.sqrt(x * x + y * y + z * z)`` to the bit.

    Args:
        vectors: (n, 3), any unit.

    Returns:
        (n,), the same unit. Overflow gives inf, NaN stays NaN.
    """
    x, y, z = (column.astype(np.float64, copy=False) for column in vectors.T)
    with np.errstate(over="ignore", invalid="ignore"):
        length: Floats = np.sqrt(x * x + y * y + z * z)
    return length


def interpolated(at: Ints, time: Ints, values: Floats | Float32s) -> Floats:
    """Interpolate columns linearly; before the first row and after the last they stay.

    Args:
        at: any shape, ns.
        time: (n,) ns, increasing; at least one.
        values: (n, k).

    Returns:
        at's shape and k.
    """
    # Times since 1970 would lose digits.
    since, knots = at - time[0], time - time[0]
    return np.stack([np.interp(since, knots, column) for column in values.T], axis=-1)


def middles(values: Floats) -> Floats:
    """(n - 1, ...) means of each row and the next."""
    return np.asarray((values[1:] + values[:-1]) / 2.0)


def sum_by_group(values: Floats, group: Ints, groups: int) -> Floats:
    """(groups, k) or (groups,) sums of the rows, (n, k) or (n,), of each group; 0 of none."""
    if values.ndim == 2:
        return np.stack([sum_by_group(column, group, groups) for column in values.T], axis=1)
    total = np.bincount(group, weights=values, minlength=groups)
    return total.astype(np.float64, copy=False)


def means_by_group(values: Floats, group: Ints, groups: int) -> Floats:
    """(groups, k) means of the rows, (n, k), of each group; NaN of none."""
    with np.errstate(invalid="ignore"):
        return sum_by_group(values, group, groups) / np.bincount(group, minlength=groups)[:, None]


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


class Record(Protocol):
    """A dataclass, all of whose fields are columns."""

    __dataclass_fields__: ClassVar[dict[str, Any]]


AnyColumns = TypeVar("AnyColumns", bound=Record)


def picked(columns: AnyColumns, rows: Flags | Ints | slice) -> AnyColumns:
    """Return the chosen rows: copies, or views of a slice."""
    values: list[Any] = [getattr(columns, field.name) for field in fields(columns)]
    if isinstance(rows, slice):
        return type(columns)(*(column[rows] for column in values))
    if rows.dtype == np.bool_:
        rows = np.flatnonzero(rows)
    # Of vectors, `take` picks rows four times as fast as an index does.
    return type(columns)(*(column.take(rows, axis=0) for column in values))


def concatenated(parts: Sequence[AnyColumns]) -> AnyColumns:
    """Stack column tables of one type, at least one."""
    if len(parts) == 1:
        return parts[0]
    names = [field.name for field in fields(parts[0])]
    stacked: list[Any] = [np.concatenate([getattr(part, name) for part in parts]) for name in names]
    return type(parts[0])(*stacked)


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


def mean_of_known(values: Floats) -> Floats:
    """(n,) mean of each row's values that are finite, (n, k); NaN where none is."""
    known = np.isfinite(values)
    with np.errstate(invalid="ignore"):
        mean: Floats = np.where(known, values, 0.0).sum(axis=1) / known.sum(axis=1)
    return mean


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
    # Faster than `np.partition` for several of them.
    ordered = np.sort(rows, axis=0)
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


@dataclass(frozen=True, slots=True)
class Aggregate:
    """Summary of many values of one figure, in the figure's unit."""

    n: int
    mean: float
    std: float | None
    """Sample standard deviation (divisor n - 1); None for a single value."""
    median: float
    min: float
    max: float


def aggregate(values: Floats) -> Aggregate | None:
    """Aggregate the finite values; None where there are none.

    Args:
        values: (n,), any unit; NaN stands for "not known" and is left out.
    """
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return None
    std = float(np.std(known, ddof=1)) if len(known) > 1 else None
    return Aggregate(
        n=len(known),
        mean=float(np.mean(known)),
        std=std,
        median=float(median_of(known)),
        min=float(np.min(known)),
        max=float(np.max(known)),
    )


CircularMean = tuple[float, float]
"""Mean of phases, cycles in [0, 1), and its consistency R in [0, 1]: 1 when all phases are equal,
near 0 when they are spread evenly."""


def circular_mean(phases: Floats) -> CircularMean | None:
    """Average phases on the circle: R exp(2 pi i mean) = mean of exp(2 pi i phase).

    Source: Batschelet, Circular Statistics in Biology, 1981. Raw phases are never averaged:
    0.99 and 0.01 lie 0.02 apart, and their mean is 0.

    Args:
        phases: (n,) cycles; NaN is left out.

    Returns:
        The mean, or None without phases.
    """
    known = phases[np.isfinite(phases)]
    if len(known) == 0:
        return None
    angle = 2.0 * np.pi * known
    x, y = float(np.mean(np.cos(angle))), float(np.mean(np.sin(angle)))
    mean = float(np.arctan2(y, x)) / (2.0 * np.pi) % 1.0
    return mean if mean < 1.0 else 0.0, min(1.0, float(np.hypot(x, y)))


def wrapped(phases: Floats) -> Floats:
    """Return phases or their differences wrapped into [-0.5, 0.5) cycles."""
    wrapped_phases: Floats = (phases + 0.5) % 1.0 - 0.5
    return wrapped_phases


def rows_of_runs(begin: Ints, end: Ints) -> tuple[Ints, Ints, Ints]:
    """Lay runs of rows end to end.

    Args:
        begin: (k,) first row of each run.
        end: (k,) row after its last.

    Returns:
        (n,) rows, (n,) the run of each, and (k,) where each run begins among them.
    """
    length = end - begin
    first = np.cumsum(length) - length
    run = np.repeat(np.arange(len(begin)), length)
    return np.arange(len(run)) + (begin - first)[run], run, first


def runs_of(numbers: Ints) -> tuple[Ints, Ints]:
    """(k,) first row and (k,) length of each run of equal numbers, (n,) not negative."""
    first = np.flatnonzero(np.diff(numbers, prepend=-1))
    return first, np.diff(first, append=len(numbers))


def flagged_runs(flags: Flags) -> Ints:
    """(k, 2) the first row of each run of true flags, and the row behind it."""
    return np.flatnonzero(np.diff(flags, prepend=False, append=False)).reshape(-1, 2)


def latched(on: Flags, off: Flags) -> Flags:
    """(n, ...) states that last from on to off; at first off."""
    row = np.arange(len(on)).reshape(-1, *[1] * (on.ndim - 1))
    last = np.maximum.accumulate(np.where(on | off, row, -1), axis=0)
    state = np.take_along_axis(on, np.maximum(last, 0), axis=0)
    return np.asarray(state & (last >= 0))


def sorted_runs(values: Floats, first: Ints) -> Floats:
    """Sort the values of each run.

    Args:
        values: (n,) any unit.
        first: (k,) where each run begins.
    """
    ordered = values.copy()
    for begin, end in pairwise([*first.tolist(), len(values)]):
        ordered[begin:end].sort()
    return ordered


def quantiles(ordered: Floats, begin: Ints, end: Ints, share: float) -> Floats:
    """Quantile of each run of sorted values, interpolated linearly between neighbours.

    Args:
        ordered: (n,) any unit, each run in ascending order.
        begin: (k,) first row of each run.
        end: (k,) row after its last.
        share: 0.5 for the median.
    """
    rank = share * (end - begin - 1)
    below = begin + rank.astype(np.int64)
    above = np.minimum(below + 1, end - 1)
    between: Floats = ordered[below] + (ordered[above] - ordered[below]) * (rank - (below - begin))
    return between


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Integral:
    """Running totals of k columns, so that they can be asked for between any two times."""

    time: Ints | Floats
    """(n,) increasing, ns or s."""
    total: Floats
    """(n, k) the columns' unit times s; between rows they grow evenly, outside not at all."""

    def added(self, begin: Ints, end: Ints) -> Floats:
        """(m, k) by how much the totals grow from some times to others."""
        before, after = self._at(self._since(np.stack([begin, end])))
        return np.asarray(after - before)

    def within(self, spans: Ints) -> Floats:
        """(k,) by how much the totals grow within spans, (n, 2)."""
        return np.asarray(self.added(*spans.T).sum(axis=0))

    def mean(self, time: Ints, window_ns: int) -> Floats:
        """(m, k) means over a window about each time; ask only where the columns are known."""
        since, half = self._since(time), window_ns / 2.0
        before, after = self._at(np.stack([since - half, since + half]))
        return np.asarray((after - before) / (window_ns / 1e9))

    def _since(self, time: Ints | Floats) -> Floats:
        """Of any shape, from the first row on: times since 1970 would lose digits."""
        return np.asarray(time - self.time[:1].max(initial=0)).astype(np.float64)

    def _at(self, since: Floats) -> Floats:
        """Times' shape and k."""
        if not len(self.time):
            return np.zeros((*since.shape, self.total.shape[1]))
        knots = self._since(self.time)
        return np.stack([np.interp(since, knots, column) for column in self.total.T], axis=-1)


def integral(time: Ints, values: Floats) -> Integral:
    """Add up values, (n, k), over times, (n,) ns."""
    return Integral(time, trapezoids(np.diff(time) / 1e9, values))


@np.errstate(over="ignore")
def trapezoids(seconds: Floats, values: Floats | Float32s) -> Floats:
    """(n, k) running totals of columns by the trapezoidal rule.

    Args:
        seconds: (n - 1,) s, from each row to the next; 0 where nothing is to be added.
        values: (n, k) any unit.
    """
    # Each column lies in one piece, which is how it is added up and asked for.
    total = np.zeros(values.shape, order="F")
    half_steps = seconds / 2.0
    for column, added in zip(values.T, total.T, strict=True):
        np.cumsum(np.add(column[1:], column[:-1], dtype=np.float64) * half_steps, out=added[1:])
    return total
