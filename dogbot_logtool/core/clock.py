"""The clock that a log is measured on: header stamps where they can be used, else log time.

One clock serves all feet and the base, since phases and support compare feet with each other.
"""

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Final, NamedTuple, Protocol

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, distinct, median_of

SILENCE_NS: Final = 50_000_000
"""ns: a shorter interval between messages is never a gap."""
GAP_INTERVALS: Final = 5.0
"""A gap is longer than this many usual intervals, and than `SILENCE_NS`."""
SLOWEST_S: Final = 0.011
"""Sampling interval up to which a touchdown is resolved: 100 Hz, and some jitter."""
FEWEST_INTERVALS: Final = 10
"""Messages or intervals from which a rate, or what is usual, means something."""


class Stamped(Protocol):
    """Columns that are placed in time."""

    @property
    def stamp(self) -> Ints:
        """(n,) ns, header stamp as recorded."""

    @property
    def log_time(self) -> Ints:
        """(n,) ns."""


class TimeSource(StrEnum):
    """The clock of a message's time."""

    HEADER = "header"
    LOG = "log"

    def of(self, columns: Stamped) -> Ints:
        """Return the times on this clock; (n,) ns."""
        return columns.stamp if self is TimeSource.HEADER else columns.log_time


def advancing(time: Ints) -> Flags:
    """Tell which samples advance the clock: those later than every one before them.

    A repeated time, or one that steps back, cannot be integrated over; such samples are left
    out. With log time, or stamps that are forced, this is what makes time increase strictly.

    Args:
        time: (n,) ns.
    """
    latest = np.maximum.accumulate(np.concatenate([[np.iinfo(np.int64).min], time]))[:-1]
    later: Flags = time > latest
    return later


def first_at_each_tick(time: Ints, rate_hz: float) -> Flags:
    """Choose the first sample at or after each tick of a clock of a given rate.

    Ticks stand at whole multiples of 1/rate since the epoch, so the choice does not depend on
    where the log begins. Nothing is interpolated. A step backwards in time (a simulation that was
    reset) starts a new tick.

    Args:
        time: (n,) ns, in log order.
        rate_hz: ticks a second; 0 chooses every sample.

    Returns:
        (n,) bool.
    """
    chosen = np.ones(len(time), np.bool_)
    if rate_hz:
        chosen[1:] = np.diff(time // max(round(1e9 / rate_hz), 1)) != 0
    return chosen


def usual_interval_s(log_time: Ints) -> float | None:
    """Return the usual time between messages, s; None without two times.

    The median of all steps that go on; but messages that are logged in bursts share a time, so
    that their mean is shorter. Silences are left out of it.

    Args:
        log_time: (n,) ns.
    """
    steps = np.diff(log_time)
    usual = float(median_of(steps[steps > 0])) if (steps > 0).any() else None
    if usual is None:
        return None
    return min(usual, float(steps[(steps >= 0) & (steps < GAP_INTERVALS * usual)].mean())) / 1e9


NEIGHBOURS: Final = 10
"""Stamps before and after a stamp that it is compared with."""
FEWEST: Final = 3
"""Stamps on either side of a step that make it one; fewer are bad stamps."""
LARGEST_STEP_S: Final = 10.0
"""s: stamps that run ahead of log time by more, at once and for good, were set forward."""


MOST_BAD: Final = 0.25
"""Share of bad stamps up to which their messages are left out."""


class ClockStep(NamedTuple):
    """A moment at which the clock of the stamps was set: a simulation that was reset, say."""

    before: int
    """ns, log time of the last message before it. Also `after`, the first one after it."""
    after: int
    by_ns: int
    """ns by which the stamps stepped more than log time did; negative: back."""


class StampCheck(NamedTuple):
    """The header stamps of one topic, checked."""

    topic: str
    usable: Flags
    """(n,) whether each message's stamp can be used; those that are `behind` are kept, since they
    do not advance anyway."""
    zeros: int
    """Stamps that are zero or negative."""
    ahead: int
    """Stamps that most of those after them are lower than."""
    behind: int
    """Stamps lower than one before that is not bad."""
    steps: tuple[ClockStep, ...]

    @property
    def messages(self) -> int:
        """Messages that were checked."""
        return len(self.usable)

    @property
    def bad(self) -> int:
        """Messages whose stamps cannot be used."""
        return self.zeros + self.ahead + self.behind

    @property
    def mostly_usable(self) -> bool:
        """Whether there are stamps, most of which can be used."""
        return self.messages > 0 and 2 * self.bad <= self.messages


def check_stamps(topic: str, stamp: Ints, log_time: Ints) -> StampCheck:
    """Check the header stamps of one topic.

    A stamp is bad when it is zero, or when most of the `NEIGHBOURS` stamps after it are lower.
    Stamps that step back and stay there begin anew: the clock was set.

    Args:
        topic: its name.
        stamp: (n,) ns, in the order of the log.
        log_time: (n,) ns.
    """
    step = np.diff(stamp)
    rises = step.min(initial=0) >= 0 and step.max(initial=0) <= LARGEST_STEP_S * 1e9
    if rises and (stamp[:1] > 0).all():
        # Stamps only rise, and never far at once: nearly always.
        return StampCheck(topic, np.ones(len(stamp), np.bool_), 0, 0, 0, ())
    valid = np.flatnonzero(stamp > 0)
    own, own_log = stamp[valid], log_time[valid]
    ahead, rows = _judged(own, own_log)
    good, usable = own[~ahead], np.zeros(len(stamp), np.bool_)
    usable[valid[~ahead]] = True
    before, after = own_log[rows - 1], own_log[rows]
    by = own[rows] - own[rows - 1] - (after - before)
    return StampCheck(
        topic=topic,
        usable=usable,
        zeros=len(stamp) - len(valid),
        ahead=int(ahead.sum()),
        behind=int((good < np.maximum.accumulate(good)).sum()),
        steps=tuple(map(ClockStep, before.tolist(), after.tolist(), by.tolist())),
    )


def _judged(stamp: Ints, log_time: Ints) -> tuple[Flags, Ints]:
    """Tell which stamps are ahead, (n,), and the rows at which the clock was set.

    Args:
        stamp: (n,) ns, above 0.
        log_time: (n,) ns.
    """
    count, ahead, far = len(stamp), np.zeros(len(stamp), np.bool_), LARGEST_STEP_S * 1e9
    if not count:
        return ahead, np.empty(0, np.int64)
    # The clock was set where all stamps near are lower, or far higher, than all near before.
    near = sliding_window_view(np.pad(stamp, NEIGHBOURS, mode="edge"), NEIGHBOURS)
    before, after, row = near[:count], near[NEIGHBOURS : NEIGHBOURS + count], np.arange(count)
    back = after.max(axis=1) < before.min(axis=1)
    leap = np.maximum(far, 10.0 * np.diff(log_time, prepend=log_time[:1]))
    forward = after.min(axis=1) - before.max(axis=1) > leap
    ends = row > count - FEWEST
    begins_anew = np.flatnonzero((forward | (back & (row >= FEWEST))) & ~ends)
    # A stamp is ahead of most of those after it, up to where the clock is set.
    for part in np.split(row, begins_anew):
        later = np.pad(stamp[part[1:]], (0, NEIGHBOURS), constant_values=np.iinfo(np.int64).max)
        lower = sliding_window_view(later, NEIGHBOURS) < stamp[part][:, None]
        ahead[part] = 2 * lower.sum(axis=1) > np.minimum(NEIGHBOURS, part[-1] - part)
    # Too few stamps far ahead at the end.
    ahead |= np.maximum.accumulate(forward & ends)
    return ahead, begins_anew


def rows_in_time(columns: Stamped, clock: TimeSource, usable: Flags) -> Ints:
    """(k,) rows of messages whose time can be used, and is later than all before.

    Args:
        columns: of n messages, in the order of the log.
        clock: which time counts.
        usable: (n,) which messages can be used.
    """
    rows = np.flatnonzero(usable)
    if clock is TimeSource.HEADER:
        rows = rows[check_stamps("", columns.stamp[rows], columns.log_time[rows]).usable]
    return rows[advancing(clock.of(columns)[rows])]


def why_unusable(checks: Sequence[StampCheck]) -> str:
    """Say why header stamps cannot be the clock of the log; empty where they can.

    Args:
        checks: of all topics that are measured.
    """
    stamped = [check for check in checks if check.messages]
    bad = [check for check in stamped if check.bad > MOST_BAD * check.messages and not check.steps]
    if bad:
        topics = sorted({check.topic for check in bad})
        of = "" if len(bad) == len(stamped) else f" of {', '.join(topics)}"
        are = "zero" if all(check.bad == check.zeros for check in bad) else "zero or go backwards"
        return f"header stamps{of} are {are}"
    clock_set = sorted({check.topic for check in stamped if check.steps})
    return f"the clock of {', '.join(clock_set)} was set" if clock_set else ""


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


OffsetTrack = tuple[Ints, Ints]
"""How far a topic's stamps lie behind log time: (w,) number of each half second of log time with
messages, ascending, and (w,) ns, the smallest log time minus stamp in it: the shortest delay."""


def offset_track(log_time: Ints, stamp: Ints) -> OffsetTrack:
    """Return how far stamps lie behind log time.

    Args:
        log_time: (n,) ns, of the messages with usable stamps.
        stamp: (n,) ns.
    """
    if not len(log_time):
        return log_time, stamp
    window, offset = log_time // WINDOW_NS, log_time - stamp
    order = np.argsort(window, kind="stable")
    window, offset = window[order], offset[order]
    first = np.flatnonzero(np.diff(window, prepend=window[0] - 1))
    return window[first], np.minimum.reduceat(offset, first)


def clock_at(at: Ints, log_time: Ints, stamp: Ints) -> Ints:
    """Return what a clock reads at some log times, by what it read at others, one at least.

    Beyond its ends it goes on as it did.
    """
    begin, end = log_time[[0, -1]].tolist()
    speed = float(stamp[-1] - stamp[0]) / (end - begin) if end > begin else 1.0
    since: Floats = np.interp(at - begin, log_time - begin, (stamp - stamp[0]).astype(np.float64))
    since += speed * ((at - begin).clip(max=0) + (at - end).clip(min=0))
    return np.asarray(stamp[0] + np.rint(since).astype(np.int64))


class ClockDifference(NamedTuple):
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
    windows = distinct(np.concatenate([window for window, _ in tracks.values()]))
    origin = min(int(least_ns.min(initial=0)) for _, least_ns in tracks.values())
    offset = np.full((len(tracks), len(windows)), np.nan)
    for row, (window, least_ns) in enumerate(tracks.values()):
        offset[row, np.searchsorted(windows, window)] = (least_ns - origin) / 1e9
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
    mixed = " (wall time and simulation time are mixed)" if worst.most_s > 1e6 else ""
    return f"header stamps of {topics} are {worst.most_s:.2f} s off those of other topics{mixed}"


def too_far_apart(clocks: Sequence[ClockDifference], period_s: float | None) -> frozenset[str]:
    """Return the topics whose clocks differ by more than a few per cent of a stride."""
    least = max(CLOCK_SHARE_OF_STRIDE * (period_s or 0.0), LONGEST_DELAY_S)
    return frozenset(each.topic for each in clocks if each.is_apart and each.most_s > least)


def clock_breaks(checks: Sequence[StampCheck]) -> Ints:
    """(b, 2) ns of log time, spans in which the clock of some stamps was set.

    Nothing is measured across them on log time; on header stamps, their own steps show.
    """
    spans = [(step.before, step.after) for check in checks for step in check.steps]
    return timespans.merge(np.array(spans, np.int64).reshape(-1, 2))
