"""Sensors that speak only while in contact: their silence is told as swing.

The new Gazebo publishes contacts only while something touches. Everything after the reader expects
a sensor that also says that nothing touches, so a silence becomes samples without contact. A
silence that no swing lasts stays one: a drop-out cannot be told from a foot held up.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.geometry.blocks import concatenated

MISSED_INTERVALS: Final = 2.5
"""A silence of more than so many intervals is a swing."""
LONGEST_SWING_S: Final = 3.0
"""Longer silences are left as they are."""
_SPACING_NS: Final = 40_000_000
"""Samples without contact are told this far apart; more than 50 ms would be a gap."""


@dataclass(frozen=True, slots=True)
class Heard:
    """When a foot was last heard."""

    log_time: int
    """ns."""
    stamp: int
    """ns."""


LastHeard = Mapping[int, Heard]
"""By foot."""


def last_heard(samples: Samples, before: LastHeard) -> dict[int, Heard]:
    """Return when each foot was last heard up to the end of some samples."""
    heard = dict(before)
    for foot in np.unique(samples.foot).tolist():
        last = np.flatnonzero(samples.foot == foot)[-1]
        heard[foot] = Heard(int(samples.log_time[last]), int(samples.stamp[last]))
    return heard


def with_swings(
    samples: Samples, interval_ns: Mapping[int, int], before: LastHeard, log_start: int | None
) -> Samples:
    """Insert samples without contact into the silences of feet that are silent in swing.

    The first stands one interval after the last contact, and the last one interval before the
    next, where an always-speaking sensor would have said so. Both clocks are interpolated.

    Args:
        samples: a run of the log's samples.
        interval_ns: interval of the feet that are silent in swing; the others stay as they are.
        before: when each foot was last heard before these samples.
        log_start: ns, log time at which a foot that was not heard before may be said to swing.
    """
    parts = [samples]
    # A filling comes before the sample that ends its silence.
    keys: list[Ints] = [2 * np.arange(len(samples.foot))]
    for foot, interval in interval_ns.items():
        rows = np.flatnonzero(samples.foot == foot)
        if not len(rows):
            continue
        first = Heard(int(samples.log_time[rows[0]]), int(samples.stamp[rows[0]]))
        heard = before.get(foot) or _at_start(first, log_start, interval)
        log_time = np.concatenate([[heard.log_time], samples.log_time[rows]])
        stamp = np.concatenate([[heard.stamp], samples.stamp[rows]])
        silence, log_time, stamp = _swings(log_time, stamp, interval)
        parts.append(_free(foot, log_time, stamp))
        keys.append(2 * rows[silence] - 1)
    order = np.argsort(np.concatenate(keys), kind="stable")
    return concatenated(parts).pick(order) if len(order) > len(samples.foot) else samples


def trailing_swings(
    interval_ns: Mapping[int, int], before: LastHeard, log_end: int | None
) -> list[Samples]:
    """Return the samples without contact between the last contacts and the log's end."""
    found: list[Samples] = []
    for foot, heard in sorted(before.items()):
        if foot in interval_ns and log_end is not None:
            end = log_end + interval_ns[foot]
            log_time = np.array([heard.log_time, end])
            stamp = np.array([heard.stamp, heard.stamp + end - heard.log_time])
            _, log_time, stamp = _swings(log_time, stamp, interval_ns[foot])
            found.append(_free(foot, log_time, stamp))
    return found


class SwingTeller:
    """Tells the swings of a log that streams past, batch by batch and in order."""

    def __init__(
        self, interval_ns: Mapping[int, int], log_start: int | None, log_end: int | None
    ) -> None:
        """Set up.

        Args:
            interval_ns: interval of the feet that are silent in swing.
            log_start: ns, log time from which silence counts; None: from the first contact.
            log_end: ns, log time up to which it counts; None: up to the last contact.
        """
        self._interval_ns = interval_ns
        self._start, self._end = log_start, log_end
        self._heard: LastHeard = {}

    def add(self, batch: Sequence[Samples]) -> Sequence[Samples]:
        """Return the samples of a batch with their swings."""
        if not self._interval_ns:
            return batch
        told = []
        for samples in batch:
            told.append(with_swings(samples, self._interval_ns, self._heard, self._start))
            self._heard = last_heard(samples, self._heard)
        return told

    def finish(self) -> list[Samples]:
        """End the log: return what is left to be said."""
        return trailing_swings(self._interval_ns, self._heard, self._end)


def _at_start(first: Heard, log_start: int | None, interval: int) -> Heard:
    """Place a contact before the log's start, so that the foot swings from there on."""
    if log_start is None:
        return first
    time = log_start - interval
    stamp = first.stamp - (first.log_time - time)
    # A stamp of 0 or less would say that there are none.
    return Heard(time, stamp) if stamp > -interval and first.stamp > 0 else first


def _swings(log_time: Ints, stamp: Ints, interval: int) -> tuple[Ints, Ints, Ints]:
    """Fill the silences between n + 1 times.

    Returns:
        (m,) which silence each filling is in, (m,) its log time, ns, (m,) its stamp, ns.
    """
    step, stamp_step = np.diff(log_time), np.diff(stamp)
    swing = (step > MISSED_INTERVALS * interval) & (step <= LONGEST_SWING_S * 1e9)
    swing &= (stamp_step >= 0) & (stamp_step <= 2.0 * LONGEST_SWING_S * 1e9)
    spacing = max(interval, _SPACING_NS)
    fillings = np.where(swing, 1 - (2 * interval - step) // spacing, 0)
    silence = np.repeat(np.arange(len(step)), fillings)
    number = np.arange(len(silence)) - np.repeat(np.cumsum(fillings) - fillings, fillings)
    since = np.minimum(interval + number * spacing, step[silence] - interval)
    share: Floats = since / np.maximum(step[silence], 1)
    filled = stamp[silence] + np.round(share * stamp_step[silence]).astype(np.int64)
    return silence, log_time[silence] + since, filled


def _free(foot: int, log_time: Ints, stamp: Ints) -> Samples:
    """Return samples of a foot that touches nothing."""
    count = len(log_time)
    return Samples(
        foot=np.full(count, foot),
        log_time=log_time,
        stamp=stamp,
        in_contact=np.zeros(count, np.bool_),
        force=np.zeros((count, 3)),
        in_world=np.zeros(count, np.bool_),
        points=np.zeros(count, np.int64),
        position=np.full((count, 3), np.nan),
        normal=np.full((count, 3), np.nan),
    )
