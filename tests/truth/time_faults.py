"""What happens to messages on their way into a log: clocks, losses, stamps."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from tests.truth.recording import (
    START_NS,
    Disturbance,
    Flags,
    FootRecording,
    Ints,
    Recording,
)


def late_clock(seconds: float) -> Disturbance:
    """Let the feet's stamps be late against the odometry's, on another clock; log times stay."""
    shift = round(seconds * 1e9)
    return lambda recording: recording.each_foot(
        lambda _, foot: replace(foot, stamp=foot.stamp + shift)
    )


def no_stamps(recording: Recording) -> Recording:
    """Let all stamps be zero."""
    base = recording.base
    changed = replace(recording, base=replace(base, stamp=np.zeros_like(base.stamp)))
    return changed.each_foot(lambda _, foot: replace(foot, stamp=np.zeros_like(foot.stamp)))


def slow_simulation(factor: float) -> Disturbance:
    """Let a second of stamps take longer in log times."""

    def stretched(log_time: Ints) -> Ints:
        return START_NS + ((log_time - START_NS) * factor).astype(np.int64)

    def change(recording: Recording) -> Recording:
        base = recording.base
        changed = replace(recording, base=replace(base, log_time=stretched(base.log_time)))
        return changed.each_foot(lambda _, foot: replace(foot, log_time=stretched(foot.log_time)))

    return change


def late_delivery(seconds: float, jitter_s: float = 0.0, seed: int = 0) -> Disturbance:
    """Let the feet's messages be logged late, more or less, but in order; stamps stay."""

    def change(row: int, foot: FootRecording) -> FootRecording:
        random = np.random.default_rng((seed, row))
        late = seconds + jitter_s * random.random(len(foot.time))
        log_time = np.maximum.accumulate(foot.log_time + np.round(late * 1e9).astype(np.int64))
        return replace(foot, log_time=log_time)

    return lambda recording: recording.each_foot(change)


def in_bursts(every_s: float) -> Disturbance:
    """Log the feet's messages in bursts; stamps stay."""
    tick = round(every_s * 1e9)
    return lambda recording: recording.each_foot(
        lambda _, foot: replace(foot, log_time=-(-foot.log_time // tick) * tick)
    )


def lost(fraction: float, *only: str, seed: int = 0) -> Disturbance:
    """Lose messages of the feet at random."""

    def keep(row: int, foot: FootRecording) -> Flags:
        random = np.random.default_rng((seed, row))
        return np.asarray(random.random(len(foot.time)) >= fraction)

    return _kept(keep, *only)


def silent_in_swing(recording: Recording) -> Recording:
    """Let the feet have sensors that speak in contact only."""
    return replace(recording, kind="gz_contacts")


def silent_between(start_s: float, end_s: float, *only: str) -> Disturbance:
    """Let feet, all of them unless some are named, say nothing for a while."""
    return _kept(lambda _, foot: (foot.time < start_s) | (foot.time >= end_s), *only)


def _kept(keep: Callable[[int, FootRecording], Flags], *only: str) -> Disturbance:
    return lambda recording: recording.each_foot(
        lambda row, foot: foot.pick(keep(row, foot)), *only
    )


def zero_stamp(message: int, *only: str) -> Disturbance:
    """Let one message of a foot have no stamp."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        stamp = foot.stamp.copy()
        stamp[message] = 0
        return replace(foot, stamp=stamp)

    return lambda recording: recording.each_foot(change, *only)


def swapped_messages(message: int, *only: str) -> Disturbance:
    """Log one message of a foot after the next one, stamps and all."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        rows = np.arange(len(foot.time))
        rows[[message, message + 1]] = rows[[message + 1, message]]
        return replace(foot.pick(rows), log_time=foot.log_time)

    return lambda recording: recording.each_foot(change, *only)


def reset(at_s: float) -> Disturbance:
    """Let the simulation's clock start anew: all stamps go back, log times go on."""
    back = round(at_s * 1e9)

    def change(recording: Recording) -> Recording:
        base = recording.base
        stamp = np.where(base.time < at_s, base.stamp, base.stamp - back)
        changed = replace(recording, base=replace(base, stamp=stamp))
        return changed.each_foot(
            lambda _, foot: replace(
                foot, stamp=np.where(foot.time < at_s, foot.stamp, foot.stamp - back)
            )
        )

    return change
