"""Sensors that send messages only while in contact: their silence is swing.

The new Gazebo publishes contacts only while something touches. Everything after the reader expects
a sensor that also reports that nothing touches, so a silence becomes samples without contact.
Lost messages are silence too. One is shorter than any swing of the foot; one of all feet at once is
a drop-out, unless it is no longer than the flight of every stride.
"""

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, concatenated, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import SILENCE_NS, Stamped, TimeSource
from dogbot_logtool.dataclass import dataclass

MISSED_INTERVALS: Final = 2.5
"""A silence of more than so many intervals is a swing."""
LONGEST_SWING_S: Final = 3.0
"""Longer silences are left as they are."""
_SPACING_NS: Final = 40_000_000
"""Samples without contact are told this far apart; more than 50 ms would be a gap."""


_LONG_INTERVALS: Final = 6.0
"""Silences longer than so many intervals are swings nearly always, not lost messages."""
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
class SilentFeet:
    """How the feet that are silent in swing are to be understood."""

    interval_ns: Mapping[int, int]
    """ns between messages in contact, by foot."""
    swing_ns: Mapping[int, int] = field(default_factory=dict)
    """ns of silence from which a foot swings, where its usual swing is known."""
    dropout_ns: int | None = None
    """ns of silence of all feet that no flight lasts; None: not known."""
    stance_ns: Mapping[int, int] = field(default_factory=dict)
    """ns, the usual stance of a foot, where it and the usual swing are known."""
    clock: TimeSource = TimeSource.LOG
    """Clock of the silences: header stamps where messages are logged in bursts."""

    def swing_from_ns(self, foot: int) -> int:
        """Return the silence, ns, that is a swing and no lost message."""
        return max(self.cut_swing_from_ns(foot), self.swing_ns.get(foot, 0))

    def cut_swing_from_ns(self, foot: int) -> int:
        """Return the same, ns, for a silence that the log's start or end cuts."""
        return round(MISSED_INTERVALS * self.interval_ns[foot])

    def may_swing(self, foot: int, since: Ints, last_swing: Ints) -> Flags:
        """(n,) tell whether a foot may be in swing, by its last swing that was certain.

        The swing is not over yet, as when the foot hits something in it; or the stance is.

        Args:
            foot: its index.
            since: (n,) ns, when it fell silent.
            last_swing: (n, 2) ns, when its last certain swing began and ended; negative: unknown.
        """
        stance = self.stance_ns.get(foot)
        if stance is None:
            return np.zeros(len(since), np.bool_)
        swing = self.swing_ns[foot] / _PART_OF_SWING
        begun, stands = since - last_swing[:, 0], since - last_swing[:, 1]
        over = (stands >= _PART_OF_STANCE * stance) & (stands <= stance + swing)
        may: Flags = (last_swing[:, 0] >= 0) & ((begun < swing) | over)
        return may


def learn_silences(
    samples: Samples, interval_ns: Mapping[int, int], clock: TimeSource = TimeSource.LOG
) -> SilentFeet:
    """Learn how long swings and flights usually are.

    Args:
        samples: of stretches of a log, in the order of log time.
        interval_ns: ns between messages in contact, by foot.
        clock: of the silences.
    """
    all_times = clock.of(samples)
    longest = LONGEST_SWING_S * 1e9
    swing_ns: dict[int, int] = {}
    stance_ns: dict[int, int] = {}
    strides = []
    for foot, interval in interval_ns.items():
        time = all_times[samples.foot == foot]
        steps = np.diff(time)
        long = steps[(steps > _LONG_INTERVALS * interval) & (steps <= longest)]
        if len(long) >= _FEWEST_SILENCES:
            swing_ns[foot] = round(_PART_OF_SWING * float(median_of(long)))
            strides.append(len(long))
            stance_ns[foot] = _usual_stance_ns(time, swing_ns[foot])
    if not strides or len(strides) < len(interval_ns):
        return SilentFeet(interval_ns, swing_ns, stance_ns=stance_ns, clock=clock)
    rows = np.isin(samples.foot, list(interval_ns))
    times: Ints = np.sort(all_times[rows])
    together = times[1:] - times[:-1]
    shortest = max(_LONG_INTERVALS * max(interval_ns.values()), SILENCE_NS)
    flights = together[(together > shortest) & (together <= longest)]
    usual = len(flights) >= _PART_OF_STRIDES * float(median_of(strides))
    dropout = _LONGER_FLIGHT * float(median_of(flights)) if usual else shortest
    return SilentFeet(interval_ns, swing_ns, round(max(dropout, shortest)), stance_ns, clock)


def _usual_stance_ns(time: Ints, swing_from_ns: int) -> int:
    """Return the median time between two swings, ns.

    Args:
        time: (n,) ns, of a foot's messages.
        swing_from_ns: ns of silence that are a swing.
    """
    ends = np.flatnonzero(np.diff(time) > swing_from_ns)
    return round(float(median_of(time[ends[1:]] - time[ends[:-1] + 1])))


def with_swings(
    feet: Sequence[Samples], silent: SilentFeet, log_start: int | None, log_end: int | None
) -> tuple[Samples, ...]:
    """Insert samples without contact into the silences of feet that are silent in swing.

    The first sample without contact stands one interval after the last contact, and the last one
    interval before the next, where an always-speaking sensor would have said so. Both clocks are
    interpolated.

    Args:
        feet: samples of each foot, in the order of the log.
        silent: the feet that are silent in swing; the others stay as they are.
        log_start: ns, log time from which silence counts; None: from the first contact.
        log_end: ns, log time up to which it counts; None: up to the last contact.

    Returns:
        the samples and the inserted ones of each foot, in order.
    """
    dropouts = _dropouts(feet, silent)
    return tuple(
        _swinging(foot, samples, silent, dropouts, (log_start, log_end))
        if foot in silent.interval_ns and len(samples.log_time)
        else samples
        for foot, samples in enumerate(feet)
    )


def _dropouts(feet: Sequence[Samples], silent: SilentFeet) -> Ints:
    """(d, 2) ns: the last message of any foot before each drop-out of all, and the next."""
    if silent.dropout_ns is None:
        return np.empty((0, 2), np.int64)
    times = np.sort(np.concatenate([silent.clock.of(samples) for samples in feet]))
    long = np.flatnonzero(np.diff(times) > silent.dropout_ns)
    return np.stack([times[long], times[long + 1]], axis=1)


def _swinging(
    foot: int,
    samples: Samples,
    silent: SilentFeet,
    dropouts: Ints,
    limits: tuple[int | None, int | None],
) -> Samples:
    """Insert the swings of a foot, of which there are n samples."""
    interval, (log_start, log_end) = silent.interval_ns[foot], limits
    before = _at_start(samples, silent, log_start, interval)
    log_time = np.concatenate([before[:1], samples.log_time])
    stamp = np.concatenate([before[1:], samples.stamp])
    time = silent.clock.of(_Times(log_time, stamp))
    step = np.diff(time)
    known = ~_within(dropouts, time[:-1], time[1:])
    lasts_from = np.full(len(step), silent.swing_from_ns(foot))
    if foot in silent.stance_ns:
        # What comes before the foot's first message is no certain swing.
        swings = _certain_swings(np.maximum(time, time[1]), foot, silent)[:-1]
        long = round(_LONG_INTERVALS * interval)
        lasts_from[silent.may_swing(foot, time[:-1], swings)] = long
    # The log's ends may cut a swing.
    lasts_from[0] = silent.cut_swing_from_ns(foot)
    if log_end is not None:
        # No message comes on any clock but the log's.
        last = log_end + interval - log_time[-1]
        log_time, stamp = (np.append(each, each[-1] + last) for each in (log_time, stamp))
        step, lasts_from = np.append(step, last), np.append(lasts_from, lasts_from[0])
        known = np.append(known, not (dropouts[:, 0] >= time[-1]).any())
    silence, *times = _swings(_Times(log_time, stamp), step, interval, lasts_from, known)
    if not len(silence):
        return samples
    # A filling comes before the sample that ends its silence.
    keys = np.concatenate([2 * np.arange(len(samples.log_time)), 2 * silence - 1])
    whole = concatenated([samples, _free(foot, *times)])
    return whole.pick(np.argsort(keys, kind="stable"))


def _certain_swings(time: Ints, foot: int, silent: SilentFeet) -> Ints:
    """(n, 2) ns, the last certain swing up to each of n messages; negative: none."""
    step = np.diff(time, prepend=time[0])
    certain = (step > silent.swing_from_ns(foot)) & (step <= LONGEST_SWING_S * 1e9)
    row = np.maximum.accumulate(np.where(certain, np.arange(len(step)), -1))
    spans = np.stack([time[row - 1], time[row]], axis=1)
    swings: Ints = np.where(row[:, None] >= 0, spans, -1)
    return swings


def _within(dropouts: Ints, start: Ints, end: Ints) -> Flags:
    """(n,) whether all feet drop out within some silences of one foot."""
    since = np.searchsorted(dropouts[:, 0], start)
    within: Flags = np.searchsorted(dropouts[:, 1], end, side="right") > since
    return within


def _at_start(samples: Samples, silent: SilentFeet, log_start: int | None, interval: int) -> Ints:
    """Place a contact before the log's start, so that the foot swings from there on.

    Where messages come in bursts it is not known when the log starts on the clock of their stamps.

    Returns:
        (2,) ns, its log time and stamp; those of the first sample where it is not placed.
    """
    log_time, stamp = int(samples.log_time[0]), int(samples.stamp[0])
    if log_start is not None and silent.clock is not TimeSource.HEADER:
        time = log_start - interval
        placed = stamp - (log_time - time)
        # A stamp of 0 or less would say that there are none.
        if placed > -interval and stamp > 0:
            return np.array([time, placed])
    return np.array([log_time, stamp])


@dataclass(frozen=True, slots=True)
class _Times:
    """When a foot sent messages."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""


def _swings(
    times: Stamped, step: Ints, interval: int, lasts_from: Ints, known: Flags
) -> tuple[Ints, Ints, Ints]:
    """Fill the silences between n + 1 messages that are known to be swings.

    Args:
        times: of the messages.
        step: (n,) ns, the silences on their clock.
        interval: ns between messages in contact.
        lasts_from: (n,) ns of silence that are a swing.
        known: (n,) whether a silence can be one.

    Returns:
        (m,) which silence each filling is in, (m,) its log time, ns, (m,) its stamp, ns.
    """
    log_step, stamp_step = np.diff(times.log_time), np.diff(times.stamp)
    swing = known & (step > lasts_from) & (step <= LONGEST_SWING_S * 1e9)
    swing &= (stamp_step >= 0) & (stamp_step <= 2.0 * LONGEST_SWING_S * 1e9)
    spacing = max(interval, _SPACING_NS)
    fillings = np.where(swing, 1 - (2 * interval - step) // spacing, 0)
    silence = np.repeat(np.arange(len(step)), fillings)
    number = np.arange(len(silence)) - np.repeat(np.cumsum(fillings) - fillings, fillings)
    since = np.minimum(interval + number * spacing, step[silence] - interval)
    share: Floats = since / np.maximum(step[silence], 1)
    log_time, stamp = (
        column[silence] + np.round(share * steps[silence]).astype(np.int64)
        for column, steps in ((times.log_time, log_step), (times.stamp, stamp_step))
    )
    return silence, log_time, stamp


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
