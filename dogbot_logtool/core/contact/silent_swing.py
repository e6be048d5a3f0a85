"""Sensors that send messages only while in contact: their silence is swing.

The new Gazebo publishes contacts only while something touches. Everything after the reader expects
a sensor that also reports that nothing touches, so a silence becomes samples without contact.
Lost messages are silence too. One is shorter than any swing of the foot; one of all feet at once is
a drop-out, unless it is no longer than the flight of every stride.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, median_of
from dogbot_logtool.core.contact.contacts import Samples, without_contact
from dogbot_logtool.core.corrections.clock import SILENCE_NS, TimeSource

MISSED_INTERVALS: Final = 2.5
"""A silence of more than so many intervals is a swing."""
LONGEST_SWING_NS: Final = 3_000_000_000
"""Longer silences are left as they are."""
_SPACING_NS: Final = 40_000_000
"""Samples without contact are told this far apart; more than 50 ms would be a gap."""
_LONG_INTERVALS: Final = 6.0
"""Silences longer than so many intervals are swings nearly always, not lost messages."""
_SURE_INTERVALS: Final = 10.0
"""Silences longer than so many intervals are swings, however long the usual swing."""
_BURST: Final = 0.5
"""Messages that are logged in less than this part of the time between their stamps come in
bursts."""
_USUAL_INTERVAL_NS: Final = 10_000_000
"""ns, assumed of a sensor that sent hardly any message."""
_FEWEST_SILENCES: Final = 3
_PART_OF_SWING: Final = 0.5
"""A swing is at least this part of the usual swing."""
_PART_OF_STRIDES: Final = 0.5
"""Part of the strides that must have a flight for flight to be usual."""
_LONGER_FLIGHT: Final = 1.5
"""A flight is no longer than the usual one by this factor."""


class _Silences(NamedTuple):
    """How the silences of one foot are to be understood, ns."""

    interval: int
    """Between messages in contact."""
    strides: int = 0
    """Silences that are swings nearly always; the rest is known with enough of them."""
    swing: int = 0
    """Half the usual swing."""

    @property
    def cut_swing(self) -> int:
        """Silence that is a swing and no lost message, where the log's start or end cuts it."""
        return round(MISSED_INTERVALS * self.interval)

    @property
    def long(self) -> int:
        """Silence that is a swing nearly always."""
        return round(_LONG_INTERVALS * self.interval)


def with_swings(
    feet: Sequence[Samples],
    silent: Iterable[int],
    log_start: int | None,
    log_end: int | None,
) -> tuple[Samples, ...]:
    """Insert samples without contact into the silences of feet that are silent in swing.

    The first sample without contact stands one interval after the last contact, and the last one
    interval before the next, where an always-speaking sensor would have said so. Header stamps and
    log times are interpolated. Silences are seen on the log's clock, on that of the stamps where
    messages are logged in bursts.

    Args:
        feet: samples of each foot, in the order of the log.
        silent: the feet that are silent in swing; the others stay as they are.
        log_start: ns, log time from which silence counts; None: from the first contact.
        log_end: ns, log time up to which it counts; None: up to the last contact.

    Returns:
        the samples and the inserted ones of each foot, in order.
    """
    silent = [foot for foot in silent if len(feet[foot].log_time)]
    if not silent:
        return tuple(feet)
    clock = _clock_of_silences([feet[foot] for foot in silent])
    times = [clock.of(samples) for samples in feet]
    usual = {foot: _usual(times[foot]) for foot in silent}
    dropouts = _dropouts(times, usual)
    return tuple(
        _swinging(samples, clock, usual[foot], dropouts, log_start, log_end)
        if foot in usual
        else samples
        for foot, samples in enumerate(feet)
    )


def _clock_of_silences(feet: Sequence[Samples]) -> TimeSource:
    """Return the log's clock, or header stamps where messages are logged in bursts."""
    log = np.concatenate([np.diff(samples.log_time) for samples in feet])
    stamp = np.concatenate([np.diff(samples.stamp) for samples in feet])
    apart = stamp > 0
    if not apart.any() or median_of(log[apart]) >= _BURST * median_of(stamp[apart]):
        return TimeSource.LOG
    return TimeSource.HEADER


def _usual(time: Ints) -> _Silences:
    """Learn how long the swings and stances of a foot usually are, from its times, (n,) ns."""
    step = np.diff(time)
    known = step[step > 0]
    silences = _Silences(int(median_of(known)) if len(known) else _USUAL_INTERVAL_NS)
    long = step[(step > silences.long) & (step <= LONGEST_SWING_NS)]
    if len(long) < _FEWEST_SILENCES:
        return silences
    return silences._replace(
        strides=len(long), swing=round(_PART_OF_SWING * float(median_of(long)))
    )


def _dropouts(times: Sequence[Ints], usual: Mapping[int, _Silences]) -> Ints:
    """(d, 2) ns: the last message of any foot before each drop-out of all, and the next.

    A drop-out lasts longer than any flight; none is known where a foot's swings are not.
    """
    if not all(each.strides for each in usual.values()):
        return np.empty((0, 2), np.int64)
    together = np.diff(np.sort(np.concatenate([times[foot] for foot in usual])))
    longest = float(max(*(each.long for each in usual.values()), SILENCE_NS))
    flights = together[(together > longest) & (together <= LONGEST_SWING_NS)]
    if len(flights) >= _PART_OF_STRIDES * median_of([each.strides for each in usual.values()]):
        longest = max(_LONGER_FLIGHT * float(median_of(flights)), longest)
    every = np.sort(np.concatenate(times))
    last = np.flatnonzero(np.diff(every) > round(longest))
    return np.stack([every[last], every[last + 1]], axis=1)


def _swinging(
    samples: Samples,
    clock: TimeSource,
    usual: _Silences,
    dropouts: Ints,
    log_start: int | None,
    log_end: int | None,
) -> Samples:
    """Insert the swings of a foot, of which there are n samples; arguments as in `with_swings`."""
    interval, on_stamps = usual.interval, clock is TimeSource.HEADER
    times = np.stack([samples.log_time, samples.stamp])
    # The log's ends may cut a swing: the foot is silent from one interval before the log starts.
    # Where messages come in bursts it is not known when that is on the clock of their stamps, and
    # a stamp of 0 or less would say that there are none.
    ahead = 0 if log_start is None or on_stamps else int(times[0, 0]) - log_start + interval
    if times[1, 0] <= max(0, ahead - interval):
        ahead = 0
    behind = 0 if log_end is None else log_end + interval - int(times[0, -1])
    times = np.concatenate([times[:, :1] - ahead, times, times[:, -1:] + behind], axis=1)
    time, steps = times[1 if on_stamps else 0], np.diff(times)
    step = np.diff(time)
    since = np.searchsorted(dropouts[:, 0], time[:-1])
    known = np.searchsorted(dropouts[:, 1], time[1:], side="right") <= since
    # After the foot's last message, no other comes on any clock but the log's.
    known[-1] = since[-1] == len(dropouts)
    shortest = min(usual.swing, round(_SURE_INTERVALS * interval))
    lasts_from = np.full(len(step), max(usual.cut_swing, shortest))
    lasts_from[[0, -1]] = usual.cut_swing
    swing = known & (step > lasts_from) & (step <= LONGEST_SWING_NS)
    swing &= (steps[1] >= 0) & (steps[1] <= 2 * LONGEST_SWING_NS)
    spacing = max(interval, _SPACING_NS)
    count = np.where(swing, 1 - (2 * interval - step) // spacing, 0)
    silence = np.repeat(np.arange(len(step)), count)
    number = np.arange(len(silence)) - np.repeat(np.cumsum(count) - count, count)
    passed = np.minimum(interval + number * spacing, step[silence] - interval)
    share: Floats = passed / np.maximum(step[silence], 1)
    inserted = times[:, silence] + np.round(share * steps[:, silence]).astype(np.int64)
    # Each is placed behind the sample that begins its silence.
    own = np.arange(len(samples.log_time))
    row = np.concatenate([own, np.maximum(silence - 1, 0)])
    order = np.argsort(np.concatenate([2 * own, 2 * silence - 1]), kind="stable")
    log_time, stamp = np.concatenate([times[:, 1:-1], inserted], axis=1)[:, order]
    whole = replace(samples.pick(row[order]), log_time=log_time, stamp=stamp)
    return without_contact(whole, order >= len(own))
