"""What the times of each topic's messages say."""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Ints, median_of, percentiles_of
from dogbot_logtool.core.clock import (
    FEWEST_INTERVALS,
    GAP_INTERVALS,
    SILENCE_NS,
    ClockStep,
    TimeSource,
    check_stamps,
    first_at_each_tick,
)

LONGEST_KNOWN_NS: Final = 10e9
"""ns between two messages of a sensor, from which what it measures is not known between them."""
OFFSET_RATE_HZ: Final = 1.0
"""Rate at which the offset of the two clocks is looked at."""
SHORTEST_DRIFT_S: Final = 5.0
"""A drift is not measured over less."""


def gap_ns(usual_ns: float | None) -> float:
    """Return from when on an interval is a gap, ns: infinite where no interval is usual."""
    return float("inf") if usual_ns is None else max(float(SILENCE_NS), GAP_INTERVALS * usual_ns)


def usual_interval_ns(steps: Ints) -> float | None:
    """Return after which time, ns, the next message of a topic is usually there, at the latest.

    A usual interval is the 95th percentile, or median + 2 x interquartile range if that is less:
    a few gaps do not move the latter, and Poisson's irregular intervals are not beyond it. Where
    longer silences fill over half of the time and are many, messages come in bursts, and the
    usual interval is that of these silences. Where they are few, and the messages between them
    irregular or there for less than 50 ms, messages come on events, of which none is late.

    Args:
        steps: (n,) ns from each message to the next; only those above 0 count.
    """
    intervals = steps[steps > 0]
    if len(intervals) < FEWEST_INTERVALS:
        return None
    low, median, high = percentiles_of(intervals, (25.0, 50.0, 75.0)).tolist()
    silences = intervals[intervals > max(GAP_INTERVALS * low, SILENCE_NS)]
    silent_ns = _total(silences)
    speaking_ns = _total(intervals) - silent_ns
    if silent_ns > speaking_ns:
        if len(silences) >= FEWEST_INTERVALS:
            return _usual(silences)
        if high - low > median or speaking_ns < SILENCE_NS * (len(silences) + 1):
            return None
    return _usual(intervals)


def steady_gap_ns(steps: Ints) -> float:
    """Return from when on a silence of a sensor is a gap, ns.

    A sensor is sampled steadily, so that even a few messages tell how often, and nothing is known
    of a robot that sent none for `LONGEST_KNOWN_NS`: known time is bounded by the messages.

    Args:
        steps: (n,) ns from each message to the next; only those above 0 count.
    """
    usual_ns = usual_interval_ns(steps)
    if usual_ns is None:
        intervals = steps[steps > 0]
        usual_ns = float(median_of(intervals)) if len(intervals) else 0.0
    return min(gap_ns(usual_ns), LONGEST_KNOWN_NS)


def _usual(intervals: Ints) -> float:
    low, median, high, latest = percentiles_of(intervals, (25.0, 50.0, 75.0, 95.0)).tolist()
    return float(min(latest, median + 2.0 * (high - low)))


def _total(intervals: Ints) -> float:
    """Add up intervals, ns; those of wild stamps would not fit in 64 bits."""
    return float(intervals.sum(dtype=np.float64))


def mean_rate_hz(number: int, span_ns: int) -> float | None:
    """Return messages a second; None where they are too few, or all within 50 ms.

    Args:
        number: of messages, or of intervals between them: of `FEWEST_INTERVALS` messages one less.
        span_ns: ns, the time in which they were recorded.
    """
    known = number + 1 >= FEWEST_INTERVALS and span_ns >= SILENCE_NS
    return number * 1e9 / span_ns if known else None


class TopicQuality(NamedTuple):
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
    interval_s: float | None
    """s, the median interval; also its 95th percentile, and the longest. None of fewer than two
    times."""
    interval_p95_s: float | None
    interval_max_s: float | None
    gaps: int
    """Silences longer than max(5 x usual interval, 50 ms): see `usual_interval_ns`."""
    gaps_total_s: float
    longest_gap_s: float
    """0 without gaps."""
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
    clock_offset_s: float | None
    """s, log time minus header stamp."""
    clock_drift_ppm: float | None
    """Millionths by which log time runs faster than the header stamps."""

    @property
    def bad_stamps(self) -> int | None:
        """Header stamps that cannot be right; None where messages have none."""
        kinds = self.zero_stamps, self.duplicate_stamps, self.backward_stamps, self.stamps_ahead
        return None if None in kinds else sum(each or 0 for each in kinds)


def topic_quality(
    topic: str,
    log_time: Ints,
    stamp: Ints | None,
    clock: TimeSource,
    silences: Ints | None = None,
) -> TopicQuality:
    """Measure the timing of one topic.

    Args:
        topic: its name.
        log_time: (n,) ns, at least one, in the order of the log.
        stamp: (n,) ns, header stamps as recorded; None of messages without a header.
        clock: the clock that the log is measured on; a topic whose messages have no usable
            header stamps is measured on log time all the same.
        silences: (g, 2) ns, its gaps, where these are known better than from its messages' times.
    """
    check = None if stamp is None else check_stamps(topic, stamp, log_time)
    used, time, offset, drift, steps = TimeSource.LOG, log_time, None, None, None
    if stamp is not None and check is not None:
        # Zeros are no stamps that repeat or step back.
        steps = np.diff(stamp[stamp > 0])
        if check.mostly_usable:
            used, stamps = clock, stamp[check.usable]
            time = stamps if clock is TimeSource.HEADER else log_time
            offset, drift = _offset(log_time[check.usable], stamps)
    step, log_step = np.diff(time), np.diff(log_time)
    gaps = step[step > gap_ns(usual_interval_ns(step))]
    if silences is not None:
        gaps = silences[:, 1] - silences[:, 0]
    number, span = len(log_time) - 1, int(time.max()) - int(time.min())
    intervals = step[step > 0]
    middle, high, longest = None, None, None
    if len(intervals):
        middle, high, longest = (percentiles_of(intervals, (50.0, 95.0, 100.0)) / 1e9).tolist()
    return TopicQuality(
        topic=topic,
        messages=len(log_time),
        clock=used,
        first=int(time.min()),
        last=int(time.max()),
        rate_hz=mean_rate_hz(number, span),
        interval_s=middle,
        interval_p95_s=high,
        interval_max_s=longest,
        gaps=len(gaps),
        gaps_total_s=_total(gaps) / 1e9,
        longest_gap_s=int(gaps.max(initial=0)) / 1e9,
        duplicate_stamps=None if steps is None else int((steps == 0).sum()),
        backward_stamps=None if steps is None else int((steps < 0).sum()),
        zero_stamps=None if check is None else check.zeros,
        stamps_ahead=None if check is None else check.ahead,
        clock_steps=() if check is None else check.steps,
        duplicate_log_times=int((log_step == 0).sum()),
        backward_log_times=int((log_step < 0).sum()),
        clock_offset_s=offset,
        clock_drift_ppm=None if check is None or check.steps else drift,
    )


def _offset(log_time: Ints, stamp: Ints) -> tuple[float, float | None]:
    """Median of log time minus stamp, s, and its slope over the stamps' time, ppm."""
    rows = np.flatnonzero(first_at_each_tick(log_time, OFFSET_RATE_HZ))
    offset, since = (log_time - stamp)[rows], (stamp[rows] - stamp[0]) / 1e9
    first = int(offset[0])
    behind = (offset - first) / 1e9
    known = len(rows) >= 3 and np.ptp(since) >= SHORTEST_DRIFT_S
    drift = 1e6 * float(np.polyfit(since, behind, 1)[0]) if known else None
    return first / 1e9 + float(median_of(behind)), drift
