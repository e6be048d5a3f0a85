"""Messages without stamps beside stamped ones, of which the clock runs at another speed.

A simulation at a quarter of real time stamps a second while the recorder's clock goes four. What
comes without a stamp happened when the stamped clock read what it did at that log time.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import advancing
from dogbot_logtool.core.recording import Recording, has_own_stamps
from dogbot_logtool.finding import Finding, found

SAME_SPEED: Final = 0.02
"""Difference of a clock's speed from that of log time that does not matter."""
FEWEST: Final = 20
LONG_NS: Final = 1_000_000_000


def on_one_clock(recording: Recording, topic: str) -> tuple[Recording, tuple[Finding, ...]]:
    """Stamp unstamped feet by the clock of the base, or an unstamped base by that of the feet.

    Only where that clock runs at another speed than log time.

    Args:
        recording: the columns of a log.
        topic: of the base's poses.

    Returns:
        the recording, and what was done.
    """
    feet = [each for each in recording.feet if len(each.log_time)]
    base, stamped = recording.base, {has_own_stamps(each) for each in feet}
    base_is_stamped = has_own_stamps(base)
    if not len(base.log_time) or stamped != {not base_is_stamped}:
        return recording, ()
    source = base if base_is_stamped else max(feet, key=lambda each: len(each.log_time))
    rows = np.flatnonzero((source.stamp > 0) & advancing(source.stamp) & advancing(source.log_time))
    log_time, stamp = source.log_time[rows], source.stamp[rows]
    if len(rows) < FEWEST or log_time[-1] - log_time[0] < LONG_NS:
        return recording, ()
    speed = float(stamp[-1] - stamp[0]) / float(log_time[-1] - log_time[0])
    if abs(speed - 1.0) <= SAME_SPEED:
        return recording, ()
    if base_is_stamped:
        changed = replace(
            recording, feet=tuple(_stamped(each, log_time, stamp) for each in recording.feet)
        )
    else:
        own = _clock(base.log_time, log_time, stamp)
        changed = replace(recording, base=replace(base, stamp=own))
    others, stamped_ones = ("feet", "odometry")[:: 1 if base_is_stamped else -1]
    finding = found(
        "CLOCK_OFFSET",
        "little",
        say="others",
        where=topic,
        stamped=stamped_ones,
        others=others,
        speed=speed,
    )
    return changed, (finding,)


def _stamped(samples: Samples, log_time: Ints, stamp: Ints) -> Samples:
    return replace(samples, stamp=_clock(samples.log_time, log_time, stamp))


def _clock(at: Ints, log_time: Ints, stamp: Ints) -> Ints:
    """(n,) ns, what a clock reads at some log times; beyond its ends it goes on as it did."""
    begin, end = log_time[[0, -1]].tolist()
    speed = float(stamp[-1] - stamp[0]) / float(end - begin)
    since: Floats = np.interp(at - begin, log_time - begin, (stamp - stamp[0]).astype(np.float64))
    since += np.where(at < begin, (at - begin) * speed, 0.0)
    since += np.where(at > end, (at - end) * speed, 0.0)
    return np.asarray(stamp[0] + np.rint(since).astype(np.int64))
