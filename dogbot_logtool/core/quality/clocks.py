"""Whether the clocks of several topics agree: each one's stamps against log time, compared."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct, median_of
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


def offset_track(log_time: Ints, stamp: Ints) -> OffsetTrack:
    """Return how far stamps lie behind log time.

    Args:
        log_time: (n,) ns, of the messages with usable stamps.
        stamp: (n,) ns.
    """
    if not len(log_time):
        return OffsetTrack(log_time, stamp)
    window, offset = log_time // WINDOW_NS, log_time - stamp
    # Messages nearly always stand in the order of their windows: few runs are left to sort.
    first = np.flatnonzero(np.diff(window, prepend=window[0] - 1))
    window, least = window[first], np.minimum.reduceat(offset, first)
    order = np.lexsort((least, window))
    window, least = window[order], least[order]
    lowest = np.flatnonzero(np.diff(window, prepend=window[0] - 1))
    return OffsetTrack(window[lowest], least[lowest])


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
