"""When is a foot on the ground, and what is measured of it, from the columns of its samples.

Contact is a Schmitt trigger on |F|: on from one threshold, off below a lower one, or as soon as
the sensor itself says that nothing touches (a message without states). Unless a lower threshold
is set, only the sensor's word ends a contact: a walking foot may carry next to nothing for a
tenth of a second and yet stay where it is, and bumpers are silent in swing. Then swings
shorter than the debounce time are filled, and after that stances shorter than it are dropped (a
foot that brushes the ground). Stances are joined that a foot bounces between at touchdown, again
and again. Two thresholds and minimum durations are practice in biomechanics (Kinetics Toolkit,
`detect_cycles`) and in state estimation for legged robots (pronto's stance estimator).
"""

from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Ints,
    flagged_runs,
    latched,
    median_of,
    percentiles_of,
    rows_of_runs,
)
from dogbot_logtool.core.clock import SILENCE_NS, TimeSource
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.contact.sensor import Origin
from dogbot_logtool.core.contact.stances import (
    Cut,
    FootTrack,
    StanceFigures,
    Stances,
    foot_track,
    lone_spikes,
    stance_figures,
)

ANY_FORCE_N: Final = 1e-9
"""Threshold where no force was ever seen, so that nothing tells what a load is."""
DEBOUNCE_S: Final = 0.020


class ContactRule(NamedTuple):
    """The thresholds of contact."""

    on_n: float
    """N: |F| from which a foot is in contact."""
    off_n: float
    """N: |F| below which contact ends; it always ends at 0. 0: only there."""
    debounce_s: float
    """s: shorter swings are filled, then shorter stances dropped."""
    brief_s: float | None = None
    """s: so are shorter swings, and those in which the foot bounces; None: they are not."""
    origin: Origin = "default"
    """The origin of the thresholds."""
    by_flag: bool = False
    """Whether the message's own contact flag decides, whatever the force."""
    unusable: str = ""
    """Why the sensor cannot tell contact; empty: it can."""


class Thresholds(NamedTuple):
    """The settings of contact by a user or the robot's file; None: not given."""

    on_n: float | None = None
    off_n: float | None = None
    debounce_s: float | None = None
    origin: Origin = "option"


_SAME: Final = 1e-6
"""Difference of two forces, as a share of them, that is none: they have 24 bits."""
_STUCK: Final = 0.99
"""Share of neighbouring loaded samples that are equal in a sensor that is stuck."""
_STUCK_SAMPLES: Final = 40
_TOUCH_N: Final = 1.0
"""Stands for the force of a contact whose force is not known; no figure shows it."""
FEWEST_STANCES: Final = 4
SCUFF_DURATION: Final = 0.1
"""Share of the usual stance below which a touch may be a scuff."""
SCUFF_LOAD: Final = 1.0 / 3.0
"""The same of its mean load."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class FootHistory:
    """All that is kept of one foot's samples."""

    messages: int
    not_finite: int
    """Messages whose force is not finite; left out."""
    not_advancing: int
    """Messages that repeat a time or step back; left out."""
    is_constant: bool
    """Whether the force never varies while the foot is loaded."""
    start: int | None
    """ns, first usable sample; None without any. Also `end`, the last one."""
    end: int | None
    median_interval_s: float | None
    gaps: Ints
    """(g, 2) ns, silences that end what is known: last sample before, first one after."""
    known: Ints
    """(k, 2) ns, the time about which this foot's sensor says something."""
    stances: Stances
    in_contact: Ints
    """(c, 2) ns, the time that is known to be in contact."""
    filled_swings: int
    dropped_stances: int
    track: FootTrack
    has_force: bool = True
    """Whether forces are known at all, not only contact."""
    stopped: Ints = field(default_factory=timespans.no_spans)
    """(s, 2) ns, gaps in which the sensor speaks, but has stopped to feel the foot."""
    down: Flags = field(default_factory=lambda: np.empty(0, np.bool_))
    """(n,) whether each sample of `track` is in a stance."""
    scuffs: Ints = field(default_factory=timespans.no_spans)
    """(u, 2) ns, short and light touches in swings; no stances."""
    spikes: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    """(s,) samples of `track` that are faults of the sensor; left out of the stances' figures."""

    def contact_fraction(self, within: Ints = timespans.ALWAYS) -> float | None:
        """Return time in contact over time known; None where nothing is known.

        Args:
            within: (w, 2) ns, a part of the log.
        """
        known = timespans.total(timespans.intersect([self.known, within]))
        down = timespans.total(timespans.intersect([self.in_contact, within]))
        return down / known if known else None

    def without_force(self) -> "FootHistory":
        """Return what is left where the sensor tells contact, but no force."""
        nothing = StanceFigures(*(np.full_like(each, np.nan) for each in self.stances.figures))
        return replace(
            self,
            has_force=False,
            stances=self.stances._replace(figures=nothing),
            spikes=self.spikes[:0],
        )

    def stopped_in(self, spans: Ints) -> "FootHistory":
        """Return what is left where the sensor has stopped in some spans, (s, 2) ns.

        Each begins with a touchdown, or the log, and ends with a touchdown, or the log.
        """
        stances, gaps = self.stances, timespans.merge(np.concatenate([self.gaps, spans]))
        begins = np.isin(stances.touchdown, spans[:, 0])
        kept = begins | ~timespans.covers(spans, stances.touchdown)
        cut, liftoff = stances.cut.copy(), stances.liftoff.copy()
        touched = timespans.touches(spans, stances.touchdown, stances.liftoff)
        cut[touched & (cut != Cut.LOG_START)] = Cut.GAP
        liftoff[begins] = spans[np.isin(spans[:, 0], stances.touchdown), 1]
        return replace(
            self,
            gaps=gaps,
            known=timespans.subtract(self.known, spans),
            stances=stances._replace(cut=cut, liftoff=liftoff).pick(kept),
            in_contact=timespans.subtract(self.in_contact, spans),
            stopped=spans,
        )

    @property
    def vertical_known(self) -> Ints:
        """(v, 2) ns, the known time in which the vertical force is known too."""
        return timespans.subtract(self.known, self.track.vertical_unknown)


def foot_history(
    samples: Samples,
    rule: ContactRule,
    clock: TimeSource,
    breaks: Ints,
    *,
    force_in_world: bool,
    has_force: bool,
) -> FootHistory:
    """Measure one foot.

    Args:
        samples: of this foot, in the order of the log.
        rule: thresholds of contact.
        clock: on which is measured.
        breaks: (b, 2) ns, spans that nothing is measured across, as if they were gaps.
        force_in_world: whether the wrenches are in the world frame.
        has_force: whether forces are known at all, not only contact.
    """
    messages = len(samples.foot)
    if not has_force:
        rule = rule._replace(on_n=_TOUCH_N, off_n=0.0, unusable="")
        touches = np.outer(np.where(samples.in_contact, _TOUCH_N, 0.0), [0.0, 0.0, 1.0])
        samples = replace(samples, force=touches)
    if rule.unusable:
        samples = no_samples()
    used = len(samples.foot)
    track, samples, not_finite = foot_track(samples, clock, force_in_world=force_in_world)
    time, force = track.time, track.force
    is_low = (force < rule.off_n) | (force == 0.0)
    contact = samples.in_contact if rule.by_flag else latched(force >= rule.on_n, is_low)
    # Turned into the world, a constant force differs in its last digits.
    equal = np.abs(np.diff(force)) <= _SAME * force[1:]
    loaded = equal[contact[1:] & contact[:-1]]
    enough = has_force and len(loaded) >= _STUCK_SAMPLES
    if not rule.by_flag:
        contact = backdated(contact, time, is_low)
    shortest = rule.debounce_s, rule.brief_s or 0.0
    starts, ends, filled, dropped = find_stances(time, contact, *shortest)
    is_scuff = _scuffs(track, starts, ends)
    scuffs = np.stack([time[starts[is_scuff]], time[ends[is_scuff]]], axis=1)
    starts, ends = starts[~is_scuff], ends[~is_scuff]
    if rule.brief_s is not None:
        stances = len(starts)
        starts, ends = joined_bounces(time, starts, ends)
        filled += stances - len(starts)

    gaps = timespans.merge(np.concatenate([track.gaps, breaks]))
    known = timespans.subtract(np.stack([time[:1], time[-1:]], axis=1), gaps)

    steps, touchdown, liftoff = np.diff(time), time[starts], time[ends]
    cut = np.full(len(starts), Cut.WHOLE, np.int8)
    cut[timespans.touches(gaps, touchdown, liftoff)] = Cut.GAP
    if contact[-1:].any():
        cut[-1:] = Cut.LOG_END
    cut[starts == 0] = Cut.LOG_START
    spikes = lone_spikes(track, starts, ends)
    calm = track.without(spikes) if len(spikes) else track
    figures = stance_figures(samples, calm, starts, ends, rule.on_n)
    history = FootHistory(
        messages=messages,
        not_finite=not_finite,
        not_advancing=used - not_finite - len(time),
        is_constant=bool(enough and loaded.mean() >= _STUCK),
        start=int(time[0]) if len(time) else None,
        end=int(time[-1]) if len(time) else None,
        median_interval_s=float(median_of(steps)) / 1e9 if len(steps) else None,
        gaps=gaps,
        known=known,
        stances=Stances(touchdown, liftoff, cut, figures),
        in_contact=timespans.intersect([np.stack([touchdown, liftoff], axis=1), known]),
        filled_swings=filled,
        dropped_stances=dropped,
        track=track,
        down=rows_in_stances(starts, ends, contact),
        scuffs=scuffs,
        spikes=spikes,
    )
    return history if has_force else history.without_force()


def _scuffs(track: FootTrack, starts: Ints, ends: Ints) -> Flags:
    """(k,) which touches are scuffs: far shorter and lighter than the usual stance, in a swing.

    Usual is what half of the time on the ground is spent in.
    """
    if len(starts) < FEWEST_STANCES:
        return np.zeros(len(starts), np.bool_)
    duration = track.time[ends] - track.time[starts]
    ordered = np.sort(duration)
    usual = ordered[np.searchsorted(np.cumsum(ordered), duration.sum() / 2)]
    impulse = track.force_impulse.total[:, 0]
    mean = (impulse[ends] - impulse[starts]) / np.maximum(duration / 1e9, 1e-9)
    load = float(median_of(mean[duration >= usual]))
    scuff = (duration < SCUFF_DURATION * usual) & (mean < SCUFF_LOAD * load)
    swing = np.append(track.time[starts[1:]] - track.time[ends[:-1]], 0)
    scuff &= (swing > duration) & (np.concatenate([[0], swing[:-1]]) > duration)
    return np.asarray(scuff)


BOUNCE: Final = 0.2
"""Share of a foot's usual swing below which a swing is a bounce, if it is shorter than
`LONGEST_BOUNCE_S`."""
LONGEST_BOUNCE_S: Final = 0.08
FEWEST_BOUNCES: Final = 3
"""Bounces of a foot in a log, at least."""
LONGEST_RISE_S: Final = 0.1
"""s: a touchdown is dated back by no more."""


def silent_before(time: Ints) -> Flags:
    """(n,) tell whether nothing is known just before: the first sample, or one after a silence.

    Args:
        time: (n,) ns, strictly increasing.
    """
    silent: Flags = np.diff(time, prepend=time[:1]) > SILENCE_NS
    silent[:1] = True
    return silent


def backdated(contact: Flags, time: Ints, is_low: Flags) -> Flags:
    """Date touchdowns back to where the force rose above the off threshold.

    A rise lasts `LONGEST_RISE_S` at most and does not reach over a silence.

    Args:
        contact: (n,) state of the Schmitt trigger.
        time: (n,) ns, strictly increasing.
        is_low: (n,) whether the force is below the off threshold.

    Returns:
        (n,) bool.
    """
    begins = np.flatnonzero(contact[1:] & ~contact[:-1]) + 1
    # The row after the last low one, or the last after a silence, up to each touchdown.
    rises = silent_before(time)
    rises[1:] |= is_low[:-1]
    edges = np.flatnonzero(rises)
    since = edges[np.searchsorted(edges, begins, side="right") - 1]
    earliest = np.searchsorted(time, time[begins] - round(LONGEST_RISE_S * 1e9))
    dated = contact.copy()
    dated[rows_of_runs(np.minimum(np.maximum(since, earliest), begins), begins)[0]] = True
    return dated


def joined_bounces(time: Ints, starts: Ints, ends: Ints) -> tuple[Ints, Ints]:
    """Join stances of a foot that bounces between them.

    Usual is what is as long as three quarters of all are, since a foot may bounce each time.

    Args:
        time: (n,) ns, strictly increasing.
        starts: (k,) the first row of each stance in contact.
        ends: (k,) the first row after it.

    Returns:
        the same of the stances that remain.
    """
    swings = (time[starts[1:]] - time[ends[:-1]]) / 1e9
    if not len(swings):
        return starts, ends
    longest_s = min(BOUNCE * float(percentiles_of(swings, 75.0)), LONGEST_BOUNCE_S)
    # Of a swing that begins with a silence it is not known that it is short.
    apart = (swings >= longest_s) | silent_before(time)[ends[:-1]]
    if (~apart).sum() < FEWEST_BOUNCES:
        return starts, ends
    return starts[np.append(True, apart)], ends[np.append(apart, True)]


def find_stances(
    time: Ints, contact: Flags, debounce_s: float, brief_s: float = 0.0
) -> tuple[Ints, Ints, int, int]:
    """Fill swings that are too short, then drop stances that are.

    Args:
        time: (n,) ns, strictly increasing.
        contact: (n,) state of the Schmitt trigger.
        debounce_s: s, below which swings and stances are too short.
        brief_s: s, below which swings are, too.

    Returns:
        (k,) the first row of each stance in contact, (k,) the first row after it that is not, or
        the last row where the log ends in the stance; how many swings were filled, how many
        stances dropped.
    """
    silent, fill_ns = silent_before(time), round(max(debounce_s, brief_s) * 1e9)
    begins, breaks = flagged_runs(contact).T
    runs = len(begins)
    # Of a swing that begins with a silence it is not known that it is short.
    parts = (time[begins[1:]] - time[breaks[:-1]] >= fill_ns) | silent[breaks[:-1]]
    starts = begins[np.append(True, parts)[:runs]]
    ends = breaks[np.append(parts, True)[:runs]]
    # Where the log ends in a stance, its last sample ends it.
    last = np.minimum(ends, len(time) - 1)
    # Swings that were filled do not count.
    total = np.concatenate([[0], np.cumsum(np.diff(time) * contact[:-1])])
    brief = (total[last] - total[starts] < round(debounce_s * 1e9)) & ~silent[starts]
    # A short one at the log's end may be part of a longer one.
    brief &= ends < len(time)
    return starts[~brief], last[~brief], runs - len(starts), int(brief.sum())


def rows_in_stances(starts: Ints, ends: Ints, contact: Flags) -> Flags:
    """(n,) whether rows are in stances; the last one is where the log ends in contact."""
    down = np.zeros(len(contact), np.bool_)
    down[rows_of_runs(starts, ends)[0]] = True
    down[-1:] |= contact[-1:]
    return down
