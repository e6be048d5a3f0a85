"""Can a recording be trusted? What the times of each topic's messages say."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.aggregates import IntervalHistogram
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.blocks import BLOCK_ROWS, GrowingTable
from dogbot_logtool.core.geometry.clock import (
    FEWEST_INTERVALS,
    GAP_INTERVALS,
    SILENCE_NS,
    TimeSource,
    first_at_each_tick,
)
from dogbot_logtool.core.geometry.order_statistics import median_of
from dogbot_logtool.core.quality.clocks import OffsetRecorder, OffsetTrack
from dogbot_logtool.core.quality.stamps import ClockStep, StampFilter
from dogbot_logtool.dataclass import dataclass

_FAR_QUARTILES: Final = 10.0
"""Intervals whose quartiles are further apart are of two kinds: within bursts and between them."""
LONGEST_SHOWN: Final = 5
"""Gaps that are reported with their times."""
OFFSET_RATE_HZ: Final = 1.0
"""Rate at which the offset of the two clocks is looked at."""
SHORTEST_DRIFT_S: Final = 5.0
"""A drift is not measured over less."""


@dataclass(frozen=True, slots=True)
class Rhythm:
    """How a topic's messages follow one another."""

    usual_ns: float | None
    """ns: the next message is usually there after this time; None where nothing is usual."""
    in_bursts: bool = False
    """Whether messages come in bursts, so that the median interval says nothing of their rate."""

    @property
    def gap_ns(self) -> float:
        """ns: a longer interval is a gap; infinite where nothing is usual."""
        if self.usual_ns is None:
            return float("inf")
        return max(float(SILENCE_NS), GAP_INTERVALS * self.usual_ns)


def rhythm(intervals: IntervalHistogram) -> Rhythm:
    """Find how a topic's messages follow one another.

    A usual interval is the 95th percentile, or median + 2 x interquartile range if that is less:
    a few gaps do not move the latter, and Poisson's irregular intervals are not beyond it. Where
    longer silences fill over half of the time and are many, messages come in bursts, and the
    usual interval is that of these silences. Where they are few, and the messages between them
    irregular or there for less than 50 ms, messages come on events, of which none is late.
    """
    if intervals.count < FEWEST_INTERVALS:
        return Rhythm(None)
    low, median, high = _quartiles(intervals)
    within = low if high > _FAR_QUARTILES * low else median
    breaks = intervals.longer_than(GAP_INTERVALS * within)
    in_bursts = 2 * breaks.total > intervals.total
    silences = breaks.longer_than(SILENCE_NS)
    if 2 * silences.total > intervals.total:
        if silences.count >= FEWEST_INTERVALS:
            return Rhythm(_usual(silences), in_bursts)
        run_ns = (intervals.total - silences.total) / (silences.count + 1)
        if high - low > median or run_ns < SILENCE_NS:
            return Rhythm(None)
    return Rhythm(_usual(intervals), in_bursts)


def steady_rhythm(intervals: IntervalHistogram) -> Rhythm:
    """Find the rhythm of a sensor that is sampled steadily, so that even a few messages tell it."""
    found = rhythm(intervals)
    return found if found.usual_ns is not None else Rhythm(intervals.percentile(50.0) or 0.0)


def _usual(intervals: IntervalHistogram) -> float:
    low, median, high = _quartiles(intervals)
    return min(intervals.percentile(95.0) or 0.0, median + 2.0 * (high - low))


def _quartiles(intervals: IntervalHistogram) -> tuple[float, float, float]:
    low, median, high = (intervals.percentile(percent) or 0.0 for percent in (25.0, 50.0, 75.0))
    return low, median, high


def mean_rate_hz(number: int, span_ns: int) -> float | None:
    """Return messages a second; None where they are too few, or all within 50 ms.

    Args:
        number: of messages, or of intervals between them: of `FEWEST_INTERVALS` messages one less.
        span_ns: ns, the time in which they were recorded.
    """
    known = number + 1 >= FEWEST_INTERVALS and span_ns >= SILENCE_NS
    return number * 1e9 / span_ns if known else None


@dataclass(frozen=True, slots=True)
class Gap:
    """A silence of a topic."""

    start: int
    """ns, the last message before it."""
    length_s: float


@dataclass(frozen=True, slots=True)
class TopicQuality:
    """The timing of one topic."""

    topic: str
    messages: int
    clock: TimeSource
    """The clock of all that follows, but for what names its clock."""
    first: int
    """ns, the earliest time. Also `last`, the latest."""
    last: int
    rate_hz: float | None
    """1/s, (messages - 1) / (last - first); None where that means nothing: see `mean_rate_hz`."""
    median_rate_hz: float | None
    """1/s, 1 / median interval; in bursts, messages over the time without gaps; None where no
    interval is usual."""
    interval_s: dict[str, float] | None
    """s, the 50th, 95th and 99th percentile and the longest interval."""
    gaps: int
    """Silences longer than max(5 x usual interval, 50 ms): see `rhythm`."""
    gaps_total_s: float
    longest_gaps: tuple[Gap, ...]
    duplicate_stamps: int | None
    """Messages whose header stamp equals the one before; None where messages have none."""
    backward_stamps: int | None
    zero_stamps: int | None
    stamps_ahead: int | None
    """Messages whose header stamp is higher than most of those that follow."""
    clock_steps: tuple[ClockStep, ...]
    """Moments at which the clock of the header stamps was set."""
    duplicate_log_times: int
    backward_log_times: int
    offset_median_s: float | None
    """s, log time minus header stamp."""
    offset_drift_ppm: float | None
    """Millionths by which log time runs faster than the header stamps."""
    frame_ids: tuple[str, ...]


class _Clock:
    """One clock's times of a topic, as they stream past."""

    def __init__(self) -> None:
        self.histogram = IntervalHistogram()
        self.duplicates = self.backwards = 0
        self.longest = 0
        self.gaps: list[Gap] = []
        self.first = self.last = 0
        self._previous: int | None = None

    def add(self, time: Ints) -> None:
        step = np.diff(time, prepend=time[0] if self._previous is None else self._previous)
        fresh = 1 if self._previous is None else 0
        self.duplicates += int((step[fresh:] == 0).sum())
        self.backwards += int((step < 0).sum())
        self.histogram.add(step)
        self.longest = max(self.longest, int(step.max()))
        self._note_gaps(time, step)
        low, high = int(time.min()), int(time.max())
        self.first = low if self._previous is None else min(self.first, low)
        self.last = high if self._previous is None else max(self.last, high)
        self._previous = int(time[-1])

    def _note_gaps(self, time: Ints, step: Ints) -> None:
        silent = np.flatnonzero(step > SILENCE_NS)
        longest = silent[np.argsort(-step[silent], kind="stable")[:LONGEST_SHOWN]]
        for row in longest.tolist():
            self.gaps.append(Gap(int(time[row] - step[row]), step[row] / 1e9))
        self.gaps.sort(key=lambda gap: (-gap.length_s, gap.start))
        del self.gaps[LONGEST_SHOWN:]


@dataclass(frozen=True, slots=True)
class _Times:
    """When messages were logged, and what their headers say."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""

    def pick(self, rows: Ints) -> "_Times":
        """Return copies of some rows."""
        return _Times(self.log_time[rows], self.stamp[rows])


class _StampFaults:
    """Counts stamps that repeat or step back, as recorded; zeros are left out."""

    def __init__(self) -> None:
        self.duplicates = self.backwards = 0
        self._previous = np.empty(0, np.int64)

    def add(self, stamp: Ints) -> None:
        stamp = np.concatenate([self._previous, stamp[stamp > 0]])
        step = np.diff(stamp)
        self.duplicates += int((step == 0).sum())
        self.backwards += int((step < 0).sum())
        self._previous = stamp[-1:]


class TopicWatch:
    """Measures the timing of one topic, fed batch by batch."""

    def __init__(self, topic: str) -> None:
        self._topic = topic
        self._messages = 0
        self._waiting: list[tuple[Ints, Ints | None]] = []
        self._waiting_rows = 0
        self._log, self._header = _Clock(), _Clock()
        self._stamped = True
        self._stamps: StampFilter[_Times] = StampFilter(topic, TimeSource.HEADER)
        self._faults = _StampFaults()
        self._least_offsets = OffsetRecorder()
        self._frame_ids: set[str] = set()
        self._offsets = GrowingTable(2)
        self._origins: tuple[int, int] | None = None
        self._last_log: int | None = None

    def add(self, log_time: Ints, stamp: Ints | None, frame_ids: tuple[str, ...] = ()) -> None:
        """Take in messages, in the order of the log.

        Args:
            log_time: (n,) ns.
            stamp: (n,) ns, header stamps; None for messages without a header.
            frame_ids: header frame ids seen among them.
        """
        if len(log_time) == 0:
            return
        self._messages += len(log_time)
        self._frame_ids.update(frame_ids)
        self._stamped &= stamp is not None
        self._waiting.append((log_time, stamp))
        self._waiting_rows += len(log_time)
        if self._waiting_rows >= BLOCK_ROWS:
            self._look()

    def _look(self) -> None:
        """Look at the times that wait: many at once, since each look costs the same."""
        if not self._waiting:
            return
        log_time = np.concatenate([times for times, _ in self._waiting])
        stamps = [stamp for _, stamp in self._waiting if stamp is not None]
        self._waiting, self._waiting_rows = [], 0
        self._log.add(log_time)
        if self._stamped:
            stamp = np.concatenate(stamps)
            self._faults.add(stamp)
            for times in self._stamps.add(_Times(log_time, stamp)):
                self._note_stamps(times)

    def _note_stamps(self, times: _Times) -> None:
        """Take in stamps that were checked: bad ones are zero."""
        usable = times.stamp > 0
        log_time, stamp = times.log_time[usable], times.stamp[usable]
        if len(stamp):
            self._header.add(stamp)
            self._least_offsets.add(log_time, stamp)
            self._note_offsets(log_time, stamp)

    def _note_offsets(self, log_time: Ints, stamp: Ints) -> None:
        chosen = first_at_each_tick(log_time, OFFSET_RATE_HZ, self._last_log)
        self._last_log = int(log_time[-1])
        if self._origins is None:
            self._origins = int(log_time[0]), int(log_time[0] - stamp[0])
        since = (log_time - self._origins[0])[chosen]
        offset = (log_time - stamp - self._origins[1])[chosen]
        self._offsets.append(np.stack([since, offset], axis=1).astype(np.float64))

    def end(self) -> None:
        """End the log; what remains to be looked at is."""
        self._look()
        for times in self._stamps.finish():
            self._note_stamps(times)

    @property
    def has_stamps(self) -> bool:
        """Whether most messages have header stamps that can be used."""
        check = self._stamps.check
        return self._stamped and check.messages > 0 and 2 * check.bad <= check.messages

    def offset_track(self) -> OffsetTrack:
        """Return how far the stamps lie behind log time, at the end of the log."""
        return self._least_offsets.finish()

    def finish(self, clock: TimeSource) -> TopicQuality:
        """Sum up, at the end of the log.

        Args:
            clock: the clock that the log is measured on; a topic whose messages have no usable
                header stamps is measured on log time all the same.
        """
        self.end()
        usable = self.has_stamps
        check = self._stamps.check
        used = clock if usable else TimeSource.LOG
        times = self._header if used is TimeSource.HEADER else self._log
        found = rhythm(times.histogram)
        gaps = times.histogram.longer_than(found.gap_ns)
        span = times.last - times.first
        offset, drift = self._offset() if usable else (None, None)
        if check.steps:
            drift = None
        return TopicQuality(
            topic=self._topic,
            messages=self._messages,
            clock=used,
            first=times.first,
            last=times.last,
            rate_hz=mean_rate_hz(self._messages - 1, span),
            median_rate_hz=_usual_rate_hz(times.histogram, found, self._messages - 1, span),
            interval_s=_percentiles(times),
            gaps=gaps.count,
            gaps_total_s=gaps.total / 1e9,
            longest_gaps=tuple(gap for gap in times.gaps if gap.length_s * 1e9 > found.gap_ns),
            duplicate_stamps=self._faults.duplicates if self._stamped else None,
            backward_stamps=self._faults.backwards if self._stamped else None,
            zero_stamps=check.zeros if self._stamped else None,
            stamps_ahead=check.ahead if self._stamped else None,
            clock_steps=tuple(check.steps) if self._stamped else (),
            duplicate_log_times=self._log.duplicates,
            backward_log_times=self._log.backwards,
            offset_median_s=offset,
            offset_drift_ppm=drift,
            frame_ids=tuple(sorted(self._frame_ids)),
        )

    def _offset(self) -> tuple[float | None, float | None]:
        """Median of log time minus stamp, s, and its slope over the stamps' time, ppm."""
        if self._origins is None:
            return None, None
        table = self._offsets.stacked()
        offset = float(median_of(table[:, 1]) + self._origins[1]) / 1e9
        return offset, _slope_ppm(table[:, 0] - table[:, 1], table[:, 1])


def with_gaps(topic: TopicQuality, spans: Ints) -> TopicQuality:
    """Return a topic's timing with gaps that are known better than from its messages' times.

    Args:
        topic: the timing.
        spans: (g, 2) ns, the gaps.
    """
    lengths = spans[:, 1] - spans[:, 0]
    longest = np.argsort(-lengths, kind="stable")[:LONGEST_SHOWN].tolist()
    return replace(
        topic,
        gaps=len(spans),
        gaps_total_s=int(lengths.sum()) / 1e9,
        longest_gaps=tuple(Gap(int(spans[row, 0]), int(lengths[row]) / 1e9) for row in longest),
    )


def _usual_rate_hz(
    intervals: IntervalHistogram, found: Rhythm, number: int, span: int
) -> float | None:
    gaps = intervals.longer_than(found.gap_ns)
    rate_hz = mean_rate_hz(number - gaps.count, span - gaps.total)
    # Intervals of 0 are not in the histogram: most messages then share their times with others.
    in_bursts = found.in_bursts or number > 2 * intervals.count
    if found.usual_ns is None or rate_hz is None or in_bursts:
        return None if found.usual_ns is None else rate_hz
    median = intervals.percentile(50.0)
    return 1e9 / median if median else None


def _percentiles(times: _Clock) -> dict[str, float] | None:
    if times.histogram.count == 0:
        return None
    percentiles = {
        name: (times.histogram.percentile(percent) or 0.0) / 1e9
        for name, percent in (("p50", 50.0), ("p95", 95.0), ("p99", 99.0))
    }
    return {**percentiles, "max": times.longest / 1e9}


def _slope_ppm(time: Floats, offset: Floats) -> float | None:
    """Least-squares slope of an offset over time, both ns; None over too short a time."""
    if len(time) < 3 or time.max() - time.min() < SHORTEST_DRIFT_S * 1e9:
        return None
    centred = time - time.mean()
    return float((centred * (offset - offset.mean())).sum() / (centred * centred).sum() * 1e6)
