"""Sensors that send messages only while in contact: their silence is swing.

The new Gazebo publishes contacts only while something touches. Everything after the reader expects
a sensor that also reports that nothing touches, so a silence becomes samples without contact.
Lost messages are silence too. One is shorter than any swing of the foot; one of all feet at once is
a drop-out, unless it is no longer than the flight of every stride.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, concatenated, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import SILENCE_NS, TimeSource

MISSED_INTERVALS: Final = 2.5
"""A silence of more than so many intervals is a swing."""
LONGEST_SWING_NS: Final = 3_000_000_000
"""Longer silences are left as they are."""
_SPACING_NS: Final = 40_000_000
"""Samples without contact are told this far apart; more than 50 ms would be a gap."""
_LONG_INTERVALS: Final = 6.0
"""Silences longer than so many intervals are swings nearly always, not lost messages."""
_BURST: Final = 0.5
"""Messages that are logged in less than this part of the time between their stamps come in
bursts."""
_USUAL_INTERVAL_NS: Final = 10_000_000
"""ns, assumed of a sensor that sent hardly any message."""
_FEWEST_SILENCES: Final = 3
_PART_OF_SWING: Final = 0.5
"""A swing is at least this part of the usual swing."""
_PART_OF_STANCE: Final = 0.9
"""A stance may be over after this part of the usual stance."""
_PART_OF_STRIDES: Final = 0.5
"""Part of the strides that must have a flight for flight to be usual."""
_LONGER_FLIGHT: Final = 1.5
"""A flight is no longer than the usual one by this factor."""


@dataclass(frozen=True, slots=True)
class _Silences:
    """How the silences of one foot are to be understood, ns."""

    interval: int
    """Between messages in contact."""
    strides: int = 0
    """Silences that are swings nearly always; the rest is known with enough of them."""
    swing: int = 0
    """Silence from which the foot swings, by its usual swing."""
    stance: int = 0
    """The usual stance."""

    @property
    def cut_swing(self) -> int:
        """Silence that is a swing and no lost message, where the log's start or end cuts it."""
        return round(MISSED_INTERVALS * self.interval)

    @property
    def long(self) -> float:
        """Silence that is a swing nearly always."""
        return _LONG_INTERVALS * self.interval

    def are_swings(self, step: Ints) -> Flags:
        """(n,) tell which silences are certain swings."""
        return (step > max(self.cut_swing, self.swing)) & (step <= LONGEST_SWING_NS)


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
    log, stamp = (
        np.concatenate([np.diff(source.of(samples)) for samples in feet])
        for source in (TimeSource.LOG, TimeSource.HEADER)
    )
    apart = stamp > 0
    if not apart.any() or median_of(log[apart]) >= _BURST * median_of(stamp[apart]):
        return TimeSource.LOG
    return TimeSource.HEADER


def _usual(time: Ints) -> _Silences:
    """Learn how long the swings and stances of a foot usually are, from its times, (n,) ns."""
    step = np.diff(time)
    known = step[step > 0]
    interval = int(median_of(known)) if len(known) else _USUAL_INTERVAL_NS
    silences = _Silences(interval)
    long = step[(step > silences.long) & (step <= LONGEST_SWING_NS)]
    if len(long) < _FEWEST_SILENCES:
        return silences
    swing = round(_PART_OF_SWING * float(median_of(long)))
    ends = np.flatnonzero(step > swing)
    stance = round(float(median_of(time[ends[1:]] - time[ends[:-1] + 1])))
    return _Silences(interval, len(long), swing, stance)


def _dropouts(times: Sequence[Ints], usual: Mapping[int, _Silences]) -> Ints:
    """(d, 2) ns: the last message of any foot before each drop-out of all, and the next.

    A drop-out lasts longer than any flight; none is known where a foot's swings are not.
    """
    if not all(each.strides for each in usual.values()):
        return np.empty((0, 2), np.int64)
    together = np.diff(np.sort(np.concatenate([times[foot] for foot in usual])))
    shortest = max(*(each.long for each in usual.values()), SILENCE_NS)
    flights = together[(together > shortest) & (together <= LONGEST_SWING_NS)]
    longest = shortest
    if len(flights) >= _PART_OF_STRIDES * median_of([each.strides for each in usual.values()]):
        longest = max(_LONGER_FLIGHT * float(median_of(flights)), shortest)
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
    before = times[:, :1]
    # Where messages come in bursts it is not known when the log starts on the clock of their
    # stamps. A stamp of 0 or less would say that there are none.
    if log_start is not None and not on_stamps and before[1] > 0:
        placed = before - (before[0] - (log_start - interval))
        before = placed if placed[1] > -interval else before
    times = np.concatenate([before, times], axis=1)
    time = times[1 if on_stamps else 0]
    step = np.diff(time)
    since = np.searchsorted(dropouts[:, 0], time[:-1])
    known = np.searchsorted(dropouts[:, 1], time[1:], side="right") <= since
    lasts_from = np.full(len(step), max(usual.cut_swing, usual.swing))
    if usual.strides:
        # What comes before the foot's first message is no certain swing.
        lasts_from[_may_swing(np.maximum(time, time[1]), time, usual)] = round(usual.long)
    # The log's ends may cut a swing.
    lasts_from[0] = usual.cut_swing
    if log_end is not None:
        # No message comes on any clock but the log's.
        last = log_end + interval - times[0, -1]
        known = np.append(known, not (dropouts[:, 0] >= time[-1]).any())
        times = np.append(times, times[:, -1:] + last, axis=1)
        step, lasts_from = np.append(step, last), np.append(lasts_from, usual.cut_swing)
    steps = np.diff(times)
    swing = known & (step > lasts_from) & (step <= LONGEST_SWING_NS)
    swing &= (steps[1] >= 0) & (steps[1] <= 2 * LONGEST_SWING_NS)
    spacing = max(interval, _SPACING_NS)
    count = np.where(swing, 1 - (2 * interval - step) // spacing, 0)
    silence = np.repeat(np.arange(len(step)), count)
    if not len(silence):
        return samples
    number = np.arange(len(silence)) - np.repeat(np.cumsum(count) - count, count)
    passed = np.minimum(interval + number * spacing, step[silence] - interval)
    share: Floats = passed / np.maximum(step[silence], 1)
    inserted = times[:, silence] + np.round(share * steps[:, silence]).astype(np.int64)
    # A filling comes before the sample that ends its silence.
    keys = np.concatenate([2 * np.arange(len(samples.log_time)), 2 * silence - 1])
    whole = concatenated([samples, _free(samples.foot[0], *inserted)])
    return whole.pick(np.argsort(keys, kind="stable"))


def _may_swing(time: Ints, since: Ints, usual: _Silences) -> Flags:
    """(n,) tell in which silences a foot may swing, by its last swing that was certain.

    The swing is not over yet, as when the foot hits something in it; or the stance is.

    Args:
        time: (n + 1,) ns, when the foot sent messages.
        since: (n + 1,) ns, when it fell silent; of the last one nothing is asked.
        usual: its silences.
    """
    certain = usual.are_swings(np.diff(time, prepend=time[0]))
    row = np.maximum.accumulate(np.where(certain, np.arange(len(time)), -1))[:-1]
    begun, stands = since[:-1] - time[row - 1], since[:-1] - time[row]
    swing = usual.swing / _PART_OF_SWING
    over = (stands >= _PART_OF_STANCE * usual.stance) & (stands <= usual.stance + swing)
    may: Flags = (row >= 0) & ((begun < swing) | over)
    return may


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
