"""Whether the clocks of several topics agree: each one's stamps against log time, compared."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.blocks import GrowingTable
from dogbot_logtool.core.geometry.order_statistics import distinct, median_of
from dogbot_logtool.dataclass import dataclass

WINDOW_NS: Final = 500_000_000
"""ns: of the messages logged within it, the one with the shortest delay is compared."""
FEWEST_WINDOWS: Final = 3
LEAST_APART_S: Final = 0.02
"""s: smaller differences are delays of transport."""
MOST_JITTERS: Final = 3.0
"""A difference beyond so many times its own jitter is none of chance."""
MOST_APART_S: Final = 1.0
"""s: topics whose stamps differ by more cannot be measured on header stamps."""
CLOCK_SHARE_OF_STRIDE: Final = 0.05
"""Share of a stride by which clocks may differ before figures of both are left out. Also
`LONGEST_DELAY_S`, since a message may be delayed by so much on its way."""
LONGEST_DELAY_S: Final = 0.06


@dataclass(frozen=True, slots=True)
class OffsetTrack:
    """How far a topic's stamps lie behind log time, over the log."""

    window: Ints
    """(w,) number of each half second of log time with messages, ascending."""
    least_ns: Ints
    """(w,) ns, the smallest log time minus stamp in it: the shortest delay."""


class OffsetRecorder:
    """Makes an `OffsetTrack` of times that stream past."""

    def __init__(self) -> None:
        self._table = GrowingTable(2)
        self._origin: tuple[int, int] | None = None

    def add(self, log_time: Ints, stamp: Ints) -> None:
        """Take in messages with usable stamps.

        Args:
            log_time: (n,) ns.
            stamp: (n,) ns.
        """
        if len(log_time) == 0:
            return
        window, offset = log_time // WINDOW_NS, log_time - stamp
        if self._origin is None:
            self._origin = int(window[0]), int(offset[0])
        first = np.flatnonzero(np.diff(window, prepend=window[0] - 1))
        least = np.minimum.reduceat(offset, first) - self._origin[1]
        self._table.append(np.column_stack([window[first] - self._origin[0], least]))

    def finish(self) -> OffsetTrack:
        """End the log."""
        table = self._table.stacked()
        window, offset = self._origin or (0, 0)
        numbers, row = np.unique(table[:, 0], return_inverse=True)
        least = np.full(len(numbers), np.inf)
        np.minimum.at(least, row, table[:, 1])
        return OffsetTrack(numbers.astype(np.int64) + window, least.astype(np.int64) + offset)


@dataclass(frozen=True, slots=True)
class ClockDifference:
    """How far a topic's clock is from that of the feet's topics."""

    topic: str
    behind_s: float
    """s, median over the log; positive: its stamps are the older ones."""
    drift_s: float
    """s by which that grows from the log's start to its end."""
    jitter_s: float
    """s, standard deviation about the drift, robustly estimated."""

    @property
    def most_s(self) -> float:
        """The largest difference in the log, s."""
        return abs(self.behind_s) + abs(self.drift_s) / 2.0

    @property
    def is_apart(self) -> bool:
        """Whether the clocks differ by more than their jitter."""
        return self.most_s > max(LEAST_APART_S, MOST_JITTERS * self.jitter_s)


def clock_differences(
    tracks: Mapping[str, OffsetTrack], feet: Sequence[str]
) -> tuple[ClockDifference, ...]:
    """Compare the clocks of topics with that of most of the feet's.

    Delays and a simulation's pace are in all offsets alike, and cancel.

    Args:
        tracks: offsets of topics with usable stamps.
        feet: topics of the feet; with none of them among the tracks all topics are compared.

    Returns:
        Those that have enough time in common with the feet, in the order of `tracks`.
    """
    if len(tracks) < 2:
        return ()
    windows = distinct(np.concatenate([track.window for track in tracks.values()]))
    origin = min(int(track.least_ns.min(initial=0)) for track in tracks.values())
    offset = np.full((len(tracks), len(windows)), np.nan)
    for row, track in enumerate(tracks.values()):
        offset[row, np.searchsorted(windows, track.window)] = (track.least_ns - origin) / 1e9
    chosen = [row for row, topic in enumerate(tracks) if topic in feet] or list(range(len(tracks)))
    behind = offset - _lower_median(offset[chosen])
    found = (
        _difference(topic, windows * (WINDOW_NS / 1e9), row)
        for topic, row in zip(tracks, behind, strict=True)
    )
    return tuple(each for each in found if each is not None)


def _lower_median(offset: Floats) -> Floats:
    """(w,) median over topics of (t, w) offsets, of an even number the lower; NaN of none."""
    ordered = np.sort(offset, axis=0)
    known = np.isfinite(offset).sum(axis=0)
    middle = np.maximum(known - 1, 0) // 2
    median: Floats = np.take_along_axis(ordered, middle[None, :], axis=0)[0]
    return median


def _difference(topic: str, time_s: Floats, behind_s: Floats) -> ClockDifference | None:
    known = np.isfinite(behind_s)
    time, behind = time_s[known], behind_s[known]
    if len(behind) < FEWEST_WINDOWS:
        return None
    third = max(len(behind) // 3, 1)
    grown = float(median_of(behind[-third:]) - median_of(behind[:third]))
    apart = float(median_of(time[-third:]) - median_of(time[:third]))
    drift = grown * float(time[-1] - time[0]) / apart
    middle = (time[-1] + time[0]) / 2.0
    rest = behind - drift * (time - middle) / (time[-1] - time[0])
    median = float(median_of(rest))
    jitter = 1.4826 * float(median_of(np.abs(rest - median)))
    return ClockDifference(topic, median, drift, jitter)


def why_clocks_cannot_be_joined(differences: Sequence[ClockDifference]) -> str:
    """Say which topics' stamps are too far from the others' to be compared; empty if none is."""
    far = [each for each in differences if each.most_s > MOST_APART_S]
    if not far:
        return ""
    worst = max(far, key=lambda each: each.most_s)
    topics = ", ".join(each.topic for each in far)
    text = f"header stamps of {topics} are {_apart(worst)} those of the other topics"
    mixed = worst.most_s > 1e6
    return f"{text} (wall time and simulation time are mixed)" if mixed else text


def _apart(difference: ClockDifference) -> str:
    where = "behind" if difference.behind_s > 0.0 else "ahead of"
    return f"{difference.most_s:.2f} s {where}"


def too_far_apart(clocks: Sequence[ClockDifference], period_s: float | None) -> frozenset[str]:
    """Return the topics whose clocks differ by more than a few per cent of a stride."""
    least = max(CLOCK_SHARE_OF_STRIDE * (period_s or 0.0), LONGEST_DELAY_S)
    return frozenset(each.topic for each in clocks if each.is_apart and each.most_s > least)
