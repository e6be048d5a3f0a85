"""What happens to messages on their way into a log: clocks, losses, stamps."""

from dataclasses import replace
from typing import Any

import numpy as np

from tests.truth.recording import START_NS, Disturbance, FootRecording, Recording, of_all, of_feet


@of_feet
def late_clock(_: int, foot: FootRecording, seconds: float) -> FootRecording:
    """Let the feet's stamps be late against the odometry's, on another clock; log times stay."""
    return replace(foot, stamp=foot.stamp + round(seconds * 1e9))


@of_all
def no_stamps(sent: Any) -> Any:
    """Let all stamps be zero."""
    return replace(sent, stamp=np.zeros_like(sent.stamp))


@of_all
def slow_simulation(sent: Any, factor: float) -> Any:
    """Let a second of stamps take longer in log times."""
    since = ((sent.log_time - START_NS) * factor).astype(np.int64)
    return replace(sent, log_time=START_NS + since)


def stamped_in_part(*, feet: bool, slower: float = 1.0) -> Disturbance:
    """Let feet, or else the base, have no stamps, in a simulation that may be slow."""

    def change(recording: Recording) -> Recording:
        slow = slow_simulation(slower)(recording)
        bare = no_stamps()(slow)
        return replace(slow, feet=bare.feet) if feet else replace(slow, base=bare.base)

    return change


@of_feet
def late_delivery(
    row: int, foot: FootRecording, seconds: float, jitter_s: float = 0.0
) -> FootRecording:
    """Let the feet's messages be logged late, more or less, but in order; stamps stay."""
    random = np.random.default_rng((0, row))
    late = seconds + jitter_s * random.random(len(foot.time))
    log_time = np.maximum.accumulate(foot.log_time + np.round(late * 1e9).astype(np.int64))
    return replace(foot, log_time=log_time)


@of_feet
def in_bursts(_: int, foot: FootRecording, every_s: float) -> FootRecording:
    """Log the feet's messages in bursts; stamps stay."""
    tick = round(every_s * 1e9)
    return replace(foot, log_time=-(-foot.log_time // tick) * tick)


@of_feet
def lost(row: int, foot: FootRecording, fraction: float) -> FootRecording:
    """Lose messages of the feet at random."""
    return foot.pick(np.random.default_rng((0, row)).random(len(foot.time)) >= fraction)


@of_feet
def silent_between(_: int, foot: FootRecording, start_s: float, end_s: float) -> FootRecording:
    """Let feet say nothing for a while."""
    return foot.pick((foot.time < start_s) | (foot.time >= end_s))


@of_feet
def zero_stamp(_: int, foot: FootRecording, message: int) -> FootRecording:
    """Let one message of a foot have no stamp."""
    return replace(foot, stamp=np.where(np.arange(len(foot.stamp)) == message, 0, foot.stamp))


@of_feet
def two_publishers(_: int, foot: FootRecording, seconds: float) -> FootRecording:
    """Let every other message of a foot be stamped by a clock that is ahead."""
    ahead = np.where(np.arange(len(foot.stamp)) % 2 == 1, round(seconds * 1e9), 0)
    return replace(foot, stamp=foot.stamp + ahead)


@of_feet
def swapped_messages(_: int, foot: FootRecording, message: int) -> FootRecording:
    """Log one message of a foot after the next one, stamps and all."""
    rows = np.arange(len(foot.time))
    rows[[message, message + 1]] = rows[[message + 1, message]]
    return replace(foot.pick(rows), log_time=foot.log_time)


@of_feet
def sent_twice(_: int, foot: FootRecording, first: int, count: int) -> FootRecording:
    """Let some messages of a foot be in the log twice."""
    rows = np.arange(len(foot.time))
    twice = (rows >= first) & (rows < first + count)
    return foot.pick(np.repeat(rows, 1 + twice))


@of_all
def clock_set(sent: Any, at_s: float, by_s: float) -> Any:
    """Let the clock of all stamps be set, as where a simulation starts anew; log times go on."""
    by = np.where(sent.time < at_s, 0, round(by_s * 1e9))
    return replace(sent, stamp=sent.stamp + by)
