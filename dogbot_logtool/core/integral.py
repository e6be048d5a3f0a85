"""Integrals of columns over time."""

from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats, Ints


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Integral:
    """Running totals of k columns, so that they can be asked for between any two times."""

    time: Ints | Floats
    """(n,) increasing, ns or s."""
    total: Floats
    """(n, k) the columns' unit times s; between rows they grow evenly, outside not at all."""

    def added(self, begin: Ints, end: Ints) -> Floats:
        """(m, k) by how much the totals grow from some times to others."""
        return self._at(self._since(end)) - self._at(self._since(begin))

    def within(self, spans: Ints) -> Floats:
        """(k,) by how much the totals grow within spans, (n, 2)."""
        return np.asarray(self.added(*spans.T).sum(axis=0))

    def mean(self, time: Ints, window_ns: int) -> Floats:
        """(m, k) means over a window about each time; ask only where the columns are known."""
        since, half = self._since(time), window_ns / 2.0
        return np.asarray((self._at(since + half) - self._at(since - half)) / (window_ns / 1e9))

    def _since(self, time: Ints | Floats) -> Floats:
        """(m,) from the first row on: times since 1970 would lose digits."""
        return np.asarray(time - self.time[:1].max(initial=0)).astype(np.float64)

    def _at(self, since: Floats) -> Floats:
        if not len(self.time):
            return np.zeros((len(since), self.total.shape[1]))
        knots = self._since(self.time)
        return np.stack([np.interp(since, knots, column) for column in self.total.T], axis=1)


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
