"""Everything that is measured on one foot, from the columns of its samples."""

from collections.abc import Iterator
from dataclasses import field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, norms
from dogbot_logtool.core.contact.contact_detection import (
    StanceRows,
    backdated,
    find_stances,
    schmitt,
)
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.contact.curves import CurveDetail, LoadCurves, load_curves
from dogbot_logtool.core.contact.stance_curves import AXES, PARTS, mean_forces
from dogbot_logtool.core.contact.stance_samples import FootSignal, stance_samples
from dogbot_logtool.core.contact.stances import (
    LONGEST_STANCE_S,
    Cut,
    StanceFigures,
    Stances,
    reduce_stances,
)
from dogbot_logtool.core.contact.track import FootTrack, foot_track
from dogbot_logtool.core.corrections.clock import TimeSource, advancing
from dogbot_logtool.core.quality.quality import steady_gap_ns
from dogbot_logtool.dataclass import dataclass

_SAME: Final = 1e-6
"""Difference of two forces, as a share of them, that is none: they have 24 bits."""
_TOUCH_N: Final = 1.0
"""Stands for the force of a contact whose force is not known; no figure shows it."""
_PORTION_ROWS: Final = 65_536
"""Samples of stances that are worked on at once, to spare memory."""


@dataclass(frozen=True, slots=True)
class FootHistory:
    """All that is kept of one foot's samples."""

    messages: int
    not_finite: int
    """Messages whose force is not finite; left out."""
    not_advancing: int
    """Messages that repeat a time or step back; left out."""
    loaded: int
    """Samples in contact."""
    repeated: int
    """Samples in contact whose force equals, to the bit, the one before."""
    start: int | None
    """ns, first usable sample; None without any. Also `end`, the last one."""
    end: int | None
    median_interval_s: float | None
    gaps: Ints
    """(g, 2) ns, silences that end what is known: last sample before, first one after."""
    known: Ints
    """(k, 2) ns, the time about which this foot's sensor says something."""
    stances: Stances
    stance_forces: Floats
    """(stances, 3, PARTS) N, mean force along the world's axes in each part of each stance; NaN
    where its direction is not known, and in stances too long to be a step's."""
    in_contact: Ints
    """(c, 2) ns, the time that is known to be in contact."""
    filled_swings: int
    dropped_stances: int
    track: FootTrack
    has_force: bool = True
    """Whether forces are known at all, not only contact."""
    curves: LoadCurves | None = None
    """Load over time; None unless asked for, and where forces are not known."""
    stopped: Ints = field(default_factory=timespans.no_spans)
    """(s, 2) ns, gaps in which the sensor speaks, but has stopped to feel the foot."""
    row: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    """(n,) the sample of the recording that each sample of `track` is."""
    log_time: Ints = field(default_factory=lambda: np.empty(0, np.int64))
    """(n,) ns, when those were recorded."""
    down: Flags = field(default_factory=lambda: np.empty(0, np.bool_))
    """(n,) whether each of them is in a stance."""

    def contact_fraction(self, within: Ints | None = None) -> float | None:
        """Return time in contact over time known; None where nothing is known.

        Args:
            within: (w, 2) ns, a part of the log; None: all of it.
        """
        limits = () if within is None else (within,)
        known = timespans.total(timespans.intersect([self.known, *limits]))
        down = timespans.total(timespans.intersect([self.in_contact, *limits]))
        return down / known if known else None

    def without_force(self) -> "FootHistory":
        """Return what is left where the sensor tells contact, but no force."""
        nothing = StanceFigures(*(np.full_like(each, np.nan) for each in self.stances.figures))
        return replace(
            self,
            has_force=False,
            stances=replace(self.stances, figures=nothing),
            stance_forces=np.full_like(self.stance_forces, np.nan),
            curves=None,
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
            stances=replace(stances, cut=cut, liftoff=liftoff).pick(kept),
            stance_forces=self.stance_forces[kept],
            in_contact=timespans.subtract(self.in_contact, spans),
            stopped=spans,
        )

    def load_curves(self, detail: CurveDetail) -> LoadCurves | None:
        """Return the load over time for drawing; None where forces are not known."""
        if not self.has_force:
            return None
        track = self.track
        return load_curves(track.time, track.force, track.vertical_force, detail)

    @property
    def vertical_known(self) -> Ints:
        """(v, 2) ns, the known time in which the vertical force is known too."""
        return timespans.subtract(self.known, self.track.vertical_unknown)


def foot_history(
    samples: Samples,
    rule: ContactRule,
    clock: TimeSource,
    *,
    force_in_world: bool,
    has_force: bool = True,
    breaks: Ints | None = None,
) -> FootHistory:
    """Measure one foot.

    Args:
        samples: of this foot, in the order of the log.
        rule: thresholds of contact.
        clock: on which is measured.
        force_in_world: whether the wrenches are in the world frame.
        has_force: whether forces are known at all, not only contact.
        breaks: (b, 2) ns, spans that nothing is measured across, as if they were gaps.
    """
    messages = len(samples.foot)
    if not has_force:
        rule = replace(rule, on_n=_TOUCH_N, off_n=0.0, backdates=False, unusable="")
        samples = replace(samples, force=_touches(samples.in_contact))
    if rule.unusable:
        samples = no_samples()
    signal, row, not_finite, not_advancing = _signal(samples, clock, force_in_world=force_in_world)
    time, force = signal.time, signal.force
    contact = _contact_states(signal, rule)
    loaded, repeated = int(contact.sum()), _repeats(force, contact)
    if rule.backdates:
        contact = backdated(contact, time, force, rule.off_n)
    rows = find_stances(time, contact, rule)
    figures, stance_forces = _stance_values(signal, rows, rule.on_n)

    median, longest = _intervals(time)
    gaps = _gaps(time, longest, breaks)
    known = timespans.subtract(np.stack([time[:1], time[-1:]], axis=1), gaps)
    stances = _stances(time, contact, rows, figures, gaps)
    contacts = np.stack([stances.touchdown, stances.liftoff], axis=1)
    history = FootHistory(
        messages=messages,
        not_finite=not_finite,
        not_advancing=not_advancing,
        loaded=loaded,
        repeated=repeated if has_force else 0,
        start=int(time[0]) if len(time) else None,
        end=int(time[-1]) if len(time) else None,
        median_interval_s=median,
        gaps=gaps,
        known=known,
        stances=stances,
        stance_forces=stance_forces,
        in_contact=timespans.intersect([contacts, known]),
        filled_swings=rows.filled_swings,
        dropped_stances=rows.dropped_stances,
        track=foot_track(
            time,
            force,
            signal.vertical,
            signal.samples.force[:, :2],
            signal.samples.position,
            longest,
        ),
        row=row,
        log_time=signal.samples.log_time,
        down=_down(contact, rows),
    )
    return history if has_force else history.without_force()


def _touches(in_contact: Flags) -> Floats:
    """(n, 3) N, what stands for the forces of contacts that are told without one."""
    return np.outer(np.where(in_contact, _TOUCH_N, 0.0), [0.0, 0.0, 1.0])


def _signal(
    samples: Samples, clock: TimeSource, *, force_in_world: bool
) -> tuple[FootSignal, Ints, int, int]:
    """Choose the samples that can be used.

    Returns:
        those with a finite force and a time later than all before, and their rows; how many have
        no such force, and how many of the others no such time.
    """
    time, force = clock.of(samples), norms(samples.force.astype(np.float64, copy=False))
    finite = np.isfinite(force)
    usable = finite & (time != 0) if clock is TimeSource.HEADER else finite.copy()
    usable[usable] = advancing(time[usable])
    row = np.flatnonzero(usable)
    counts = int((~finite).sum()), int((finite & ~usable).sum())
    if not usable.all():
        samples, time, force = samples.pick(usable), time[usable], force[usable]
    known = samples.in_world | force_in_world | (force == 0.0)
    vertical = np.where(known, samples.force[:, 2].astype(np.float64), np.nan)
    return FootSignal(samples, time, force, vertical), row, *counts


def _contact_states(signal: FootSignal, rule: ContactRule) -> Flags:
    """(n,) tell which samples are in contact, by the messages' flags or by the force."""
    return signal.samples.in_contact if rule.by_flag else schmitt(signal.force, rule)


def _down(contact: Flags, rows: StanceRows) -> Flags:
    """(n,) tell which samples are in a stance; the last one is where the log ends in one."""
    change = np.zeros(len(contact) + 1, np.int8)
    change[rows.touchdown] += 1
    change[rows.liftoff] -= 1
    down = np.cumsum(change[:-1], dtype=np.int8) > 0
    down[-1:] |= contact[-1:]
    return down


def _repeats(force: Floats, contact: Flags) -> int:
    """Count the samples in contact whose force, (n,) N, is that of the one before."""
    # Turned into the world, a constant force differs in its last digits.
    equal = np.abs(np.diff(force)) <= _SAME * force[1:]
    return int((equal & contact[1:] & contact[:-1]).sum())


def _intervals(time: Ints) -> tuple[float | None, float]:
    """Return the median interval between samples, s, and the longest one, ns, that is no gap."""
    steps = np.diff(time)
    median = float(median_of(steps)) / 1e9 if len(steps) else None
    return median, steady_gap_ns(steps)


def _gaps(time: Ints, longest_interval_ns: float, breaks: Ints | None) -> Ints:
    """(g, 2) ns, intervals that are too long, and spans that nothing is measured across."""
    last = np.flatnonzero(np.diff(time) > longest_interval_ns)
    gaps = np.stack([time[last], time[last + 1]], axis=1)
    if breaks is None or not len(breaks):
        return gaps
    return timespans.merge(np.concatenate([gaps, breaks]))


def _stance_values(signal: FootSignal, rows: StanceRows, on_n: float) -> tuple[Floats, Floats]:
    """Reduce stances that are short enough to be a step's; the others are NaN.

    Returns:
        (figures, k) in the order of `StanceFigures`, and (k, AXES, PARTS) N, see `mean_forces`.
    """
    count = len(rows.touchdown)
    figures = np.full((len(StanceFigures._fields), count), np.nan)
    forces = np.full((count, AXES * PARTS), np.nan)
    duration = signal.time[rows.liftoff] - signal.time[rows.touchdown]
    steps = np.flatnonzero((duration > 0) & (duration <= LONGEST_STANCE_S * 1e9))
    for part in _portions(steps, (rows.liftoff - rows.touchdown)[steps]):
        samples = stance_samples(signal, rows.touchdown[part], rows.liftoff[part], on_n)
        figures[:, part] = np.stack(reduce_stances(samples))
        forces[part] = mean_forces(samples)
    return figures, forces.reshape(-1, AXES, PARTS)


def _portions(stances: Ints, samples: Ints) -> Iterator[Ints]:
    """Yield some stances in portions of so many samples, (k,), that memory is spared."""
    portion = np.cumsum(samples) // _PORTION_ROWS
    edges = np.flatnonzero(np.diff(portion)) + 1
    return (part for part in np.split(stances, edges) if len(part))


def _stances(time: Ints, contact: Flags, rows: StanceRows, figures: Floats, gaps: Ints) -> Stances:
    """Say of each stance what cuts it."""
    touchdown, liftoff = time[rows.touchdown], time[rows.liftoff]
    cut = np.full(len(touchdown), Cut.WHOLE, np.int8)
    cut[timespans.touches(gaps, touchdown, liftoff)] = Cut.GAP
    if contact[-1:].any():
        cut[-1:] = Cut.LOG_END
    cut[rows.touchdown == 0] = Cut.LOG_START
    return Stances(touchdown, liftoff, cut, StanceFigures(*figures))
