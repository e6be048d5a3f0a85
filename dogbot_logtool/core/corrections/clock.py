"""Which clock a walk is measured on: header stamps, or log time where stamps cannot be used.

One clock serves all feet and the base, since phases and support compare feet with each other.
Header stamps are used unless more than a few of a topic are bad, or its clock was set; see
`core/quality/log_clock.py`.
"""

from enum import StrEnum
from typing import Final, Protocol

import numpy as np

from dogbot_logtool.core.arrays import Flags, Ints, median_of

SILENCE_NS: Final = 50_000_000
"""ns: a shorter interval between messages is never a gap."""
GAP_INTERVALS: Final = 5.0
"""A gap is longer than this many usual intervals, and than `SILENCE_NS`."""
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


def advancing(time: Ints, latest: int | None) -> Flags:
    """Tell which samples advance the clock: those later than every one before them.

    A repeated time, or one that steps back, cannot be integrated over; such samples are left
    out. With log time, or stamps that are forced, this is what makes time increase strictly.

    Args:
        time: (n,) ns.
        latest: ns, the latest time before these samples, None at the start.
    """
    floor = np.iinfo(np.int64).min if latest is None else latest
    before = np.maximum.accumulate(np.concatenate([[floor], time]))[:-1]
    later: Flags = time > before
    return later


def first_at_each_tick(time: Ints, rate_hz: float, previous_time: int | None) -> Flags:
    """Choose the first sample at or after each tick of a clock of a given rate.

    Ticks stand at whole multiples of 1/rate since the epoch, so the choice does not depend on
    where the log, or a batch of it, begins. Nothing is interpolated. A step backwards in time
    (a simulation that was reset) starts a new tick.

    Args:
        time: (n,) ns, in log order.
        rate_hz: ticks a second; 0 chooses every sample.
        previous_time: ns, the sample before these, None at the start of the log.

    Returns:
        (n,) bool.
    """
    if rate_hz == 0:
        return np.ones(len(time), np.bool_)
    period = max(round(1e9 / rate_hz), 1)
    tick = time // period
    chosen = np.ones(len(time), np.bool_)
    chosen[1:] = tick[1:] != tick[:-1]
    if previous_time is not None and len(time):
        chosen[0] = tick[0] != previous_time // period
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
