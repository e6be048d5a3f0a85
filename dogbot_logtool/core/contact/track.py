"""The load of a foot over the whole log: impulses, and the contact point at 25 Hz.

Impulses are integrated over every sample; their running totals are kept at a fixed low rate, so
that they can be asked for between any two times without keeping the samples.
"""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.geometry.blocks import GrowingTable
from dogbot_logtool.core.geometry.clock import SILENCE_NS, absolute_time, first_at_each_tick
from dogbot_logtool.dataclass import dataclass

TRACK_RATE_HZ: Final = 25.0
"""A day of four feet is half a gigabyte at this rate."""


@dataclass(frozen=True, slots=True)
class FootTrack:
    """Running totals and contact points of one foot at a low rate."""

    time: Ints
    """(n,) ns, strictly increasing."""
    force_impulse: Floats
    """(n,) N s, integral of |F| since the first sample, gaps left out."""
    vertical_impulse: Floats
    """(n,) N s, of the vertical force, where that is known."""
    vertical_force: Floats
    """(n,) N; NaN where its direction is not known."""
    point: Floats
    """(n, 3) m, contact point in the world; NaN where there is none."""
    vertical_unknown: Ints
    """(u, 2) ns, time with a load whose direction is not known."""

    def force_within(self, spans: Ints) -> float:
        """Return the integral of |F| over spans, N s."""
        return self._within(self.force_impulse, spans)

    def vertical_within(self, spans: Ints) -> float:
        """Return the integral of the vertical force over spans, N s."""
        return self._within(self.vertical_impulse, spans)

    def _within(self, totals: Floats, spans: Ints) -> float:
        if len(self.time) == 0:
            return 0.0
        at = np.interp(spans.ravel() - self.time[0], self.time - self.time[0], totals)
        return float((at[1::2] - at[0::2]).sum())


# Columns of the row that `TrackRecorder` remembers; the contact point follows. Times are ns since
# the first sample.
_TIME, _FORCE, _VERTICAL = 0, 1, 2
_KEPT_COLUMNS: Final = 7


class TrackRecorder:
    """Makes a `FootTrack` of samples that come in order, block by block."""

    def __init__(self) -> None:
        self._kept = GrowingTable(_KEPT_COLUMNS)
        self._silences = GrowingTable(4)
        self._unknown = GrowingTable(2)
        self._unknown_since: float | None = None
        self._origin: int | None = None
        self._last = np.empty((0, 6))
        self._last_is_kept = True
        self._totals = (0.0, 0.0)

    def add(self, time: Ints, force: Floats, vertical: Floats, point: Floats) -> None:
        """Take in samples.

        Args:
            time: (n,) ns, strictly increasing, later than all before.
            force: (n,) N, |F|.
            vertical: (n,) N; NaN where not known.
            point: (n, 3) m; NaN where there is none.
        """
        if len(time) == 0:
            return
        origin = self._origin if self._origin is not None else int(time[0])
        self._origin = origin
        carried = len(self._last)
        previous = origin + int(self._last[0, _TIME]) if carried else None
        chosen = first_at_each_tick(time, TRACK_RATE_HZ, previous)
        since = np.concatenate([self._last[:, _TIME], (time - origin).astype(np.float64)])
        force = np.concatenate([self._last[:, _FORCE], force])
        vertical = np.concatenate([self._last[:, _VERTICAL], vertical])
        self._find_unknown(since, vertical)

        step = np.diff(since)
        silent: Flags = step > SILENCE_NS
        # Both sides of a silence are kept, since totals are interpolated between the rows kept.
        if carried and silent[0]:
            self._keep_last()
        chosen[1 - carried :] |= silent
        chosen[:-1] |= silent[carried:]
        force_total, lost_force = self._integrated(force, step, silent, self._totals[0])
        vertical_total, lost_vertical = self._integrated(vertical, step, silent, self._totals[1])
        edges = since[:-1][silent], since[1:][silent]
        self._silences.append(np.column_stack([*edges, lost_force, lost_vertical]))

        rows = np.flatnonzero(chosen) + carried
        columns = since[rows], force_total[rows], vertical_total[rows], vertical[rows]
        self._kept.append(np.column_stack([*columns, point[chosen]]))
        self._last = np.column_stack([since[-1:], force[-1:], vertical[-1:], point[-1:]])
        self._last_is_kept = bool(chosen[-1])
        self._totals = float(force_total[-1]), float(vertical_total[-1])

    def _integrated(
        self, value: Floats, step: Floats, silent: Flags, before: float
    ) -> tuple[Floats, Floats]:
        """Running totals at each row, and what each silence would add.

        A silence adds nothing here: whether it is a gap is known when the log has ended.
        """
        part = np.nan_to_num((value[1:] + value[:-1]) * step / 2e9, copy=False)
        lost = part[silent]
        part[silent] = 0.0
        return np.cumsum(np.concatenate([[before], part])), lost

    def _keep_last(self) -> None:
        """Keep the last row, unless it is."""
        if not self._last_is_kept:
            self._kept.append(
                np.column_stack([self._last[:, :1], [self._totals], self._last[:, _VERTICAL:]])
            )
        self._last_is_kept = True

    def _find_unknown(self, time: Floats, vertical: Floats) -> None:
        """Note the spans from the last known vertical force to the next known one."""
        unknown = np.isnan(vertical)
        if len(self._last) == 0 and unknown[0]:
            self._unknown_since = float(time[0])
        starts = time[:-1][unknown[1:] & ~unknown[:-1]]
        ends = time[1:][unknown[:-1] & ~unknown[1:]]
        if self._unknown_since is not None:
            starts = np.concatenate([[self._unknown_since], starts])
        self._unknown_since = None
        if len(starts) > len(ends):
            self._unknown_since = float(starts[-1])
            starts = starts[:-1]
        self._unknown.append(np.stack([starts, ends], axis=1))

    def silences(self) -> Ints:
        """(s, 2) ns: last sample before and first sample after each silence so far."""
        return self._in_ns(self._silences.stacked()[:, :2])

    def finish(self, longest_interval_ns: float) -> FootTrack:
        """End the log.

        Args:
            longest_interval_ns: a silence up to this long is no gap: the sensor is merely slow.
        """
        self._keep_last()
        unknown = self._unknown.stacked()
        if self._unknown_since is not None:
            tail = [[self._unknown_since, float(self._last[0, _TIME])]]
            unknown = np.concatenate([unknown, tail])
        table = self._kept.stacked()
        silences = self._silences.stacked()
        slow = silences[silences[:, 1] - silences[:, 0] <= longest_interval_ns]
        if len(slow):
            passed = np.searchsorted(slow[:, 1], table[:, 0], side="right")
            for column, part in ((1, slow[:, 2]), (2, slow[:, 3])):
                table[:, column] += np.concatenate([[0.0], np.cumsum(part)])[passed]
        return FootTrack(
            time=self._in_ns(table[:, 0]),
            force_impulse=table[:, 1],
            vertical_impulse=table[:, 2],
            vertical_force=table[:, 3],
            point=table[:, 4:],
            vertical_unknown=self._in_ns(unknown),
        )

    def _in_ns(self, since_origin: Floats) -> Ints:
        return absolute_time(since_origin, self._origin)
