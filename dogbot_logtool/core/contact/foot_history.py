"""Everything that is measured on one foot while its samples stream past."""

from dataclasses import field, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contact_detection import (
    DecidedStances,
    FootSignal,
    StanceFinder,
    foot_signal,
)
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.curves import CurveDetail, LoadCurveRecorder, LoadCurves
from dogbot_logtool.core.contact.stance_curves import AXES, PARTS
from dogbot_logtool.core.contact.stances import (
    Cut,
    StanceFigures,
    Stances,
)
from dogbot_logtool.core.contact.track import FootTrack, TrackRecorder
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.aggregates import IntervalHistogram
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, norms
from dogbot_logtool.core.geometry.blocks import BLOCK_ROWS, Blocks, GrowingTable
from dogbot_logtool.core.geometry.clock import TimeSource, absolute_time, advancing
from dogbot_logtool.core.quality.quality import steady_rhythm
from dogbot_logtool.dataclass import dataclass

_SAME: Final = 1e-9
"""Difference of two forces, as a share of them, that is none."""
_TOUCH_N: Final = 1.0
"""Stands for the force of a contact whose force is not known; no figure shows it."""


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

    @property
    def vertical_known(self) -> Ints:
        """(v, 2) ns, the known time in which the vertical force is known too."""
        return timespans.subtract(self.known, self.track.vertical_unknown)


class FootRecorder:
    """Makes a `FootHistory` of the samples of one foot, fed batch by batch.

    The record is the same to the bit however the samples are split into batches.
    """

    def __init__(
        self,
        rule: ContactRule,
        clock: TimeSource,
        *,
        force_in_world: bool,
        has_force: bool = True,
        curves: CurveDetail | None = None,
        block_rows: int = BLOCK_ROWS,
    ) -> None:
        self._has_force = has_force
        self._curves = LoadCurveRecorder(curves) if curves and has_force else None
        if not has_force:
            rule = replace(rule, on_n=_TOUCH_N, off_n=0.0, backdates=False, unusable="")
        self._rule = rule
        self._clock = clock
        self._force_in_world = force_in_world
        self._blocks: Blocks[Samples] = Blocks(block_rows)
        self._intervals = IntervalHistogram()
        self._finder = StanceFinder(rule)
        self._track = TrackRecorder()
        self._stances = GrowingTable(2 + len(StanceFigures._fields))
        self._stance_forces = GrowingTable(AXES * PARTS)
        self._start: int | None = None
        self._end: int | None = None
        self._messages = self._not_finite = self._not_advancing = 0
        self._loaded = self._repeated = 0

    def add(self, samples: Samples) -> None:
        """Take in samples of this foot, in the order of the log."""
        for block in self._blocks.add(samples):
            self._add_block(block)

    def finish(self, breaks: Ints | None = None) -> FootHistory:
        """End the log.

        Args:
            breaks: (b, 2) ns, spans that nothing is measured across, as if they were gaps.
        """
        for block in self._blocks.rest():
            self._add_block(block)
        self._found(self._finder.finish())
        median = self._intervals.percentile(50.0)
        longest = steady_rhythm(self._intervals).gap_ns
        silences = self._track.silences()
        gaps = silences[silences[:, 1] - silences[:, 0] > longest]
        if breaks is not None and len(breaks):
            gaps = timespans.merge(np.concatenate([gaps, breaks]))
        known = self._known(gaps)
        stances = self._all_stances(gaps)
        contacts = np.stack([stances.touchdown, stances.liftoff], axis=1)
        history = FootHistory(
            messages=self._messages,
            not_finite=self._not_finite,
            not_advancing=self._not_advancing,
            loaded=self._loaded,
            repeated=self._repeated if self._has_force else 0,
            start=self._start,
            end=self._end,
            median_interval_s=None if median is None else median / 1e9,
            gaps=gaps,
            known=known,
            stances=stances,
            stance_forces=self._stance_forces.stacked().reshape(-1, AXES, PARTS),
            in_contact=timespans.intersect([contacts, known]),
            filled_swings=self._finder.filled_swings,
            dropped_stances=self._finder.dropped_stances,
            track=self._track.finish(longest),
            curves=self._curves.finish() if self._curves else None,
        )
        return history if self._has_force else history.without_force()

    def _add_block(self, samples: Samples) -> None:
        if self._rule.unusable:
            self._messages += len(samples.foot)
            return
        if not self._has_force:
            touch = np.where(samples.in_contact, _TOUCH_N, 0.0)
            samples = replace(samples, force=touch[:, None] * np.array([0.0, 0.0, 1.0]))
        time, force = self._clock.of(samples), norms(samples.force)
        finite = np.isfinite(force)
        usable = self._usable(time, finite)
        self._messages += len(time)
        self._not_finite += int((~finite).sum())
        self._not_advancing += int((finite & ~usable).sum())
        if not usable.all():
            samples, time, force = samples.pick(usable), time[usable], force[usable]
        if len(time) == 0:
            return

        previous = self._finder.last
        signal = foot_signal(
            samples,
            time,
            force,
            self._rule,
            force_in_world=self._force_in_world,
            previous=previous,
        )
        if self._start is None:
            self._start = int(time[0])
        self._end = int(time[-1])
        self._count_repeats(signal, previous)
        self._intervals.add(np.diff(time, prepend=time[:1] if previous is None else previous.time))
        self._track.add(time, signal.force, signal.vertical, signal.point)
        if self._curves is not None:
            self._curves.add(time, signal.force, signal.vertical)
        self._found(self._finder.add(signal))

    def _usable(self, time: Ints, finite: Flags) -> Flags:
        """Tell which samples have a finite force and a time later than all before."""
        if self._clock is TimeSource.HEADER:
            finite = finite & (time != 0)
        usable = np.zeros(len(time), np.bool_)
        usable[finite] = advancing(time[finite], self._end)
        return usable

    def _count_repeats(self, signal: FootSignal, previous: FootSignal | None) -> None:
        force, contact = signal.force, signal.contact
        # Turned into the world, a constant force differs in its last digits.
        equal = np.abs(np.diff(force)) <= _SAME * force[1:]
        equal = equal & contact[1:] & contact[:-1]
        self._loaded += int(contact.sum())
        self._repeated += int(equal.sum())
        if previous is not None and previous.contact[0] and contact[0]:
            self._repeated += int(abs(previous.force[0] - force[0]) <= _SAME * force[0])

    def _found(self, stances: DecidedStances) -> None:
        if self._start is not None:
            since = (time - self._start for time in (stances.touchdown, stances.liftoff))
            self._stances.append(np.column_stack([*since, stances.figures]))
            self._stance_forces.append(stances.forces)

    def _known(self, gaps: Ints) -> Ints:
        """Return the time from the first to the last usable sample, without the gaps."""
        if self._start is None or self._end is None:
            return timespans.no_spans()
        return timespans.subtract(np.array([[self._start, self._end]], np.int64), gaps)

    def _all_stances(self, gaps: Ints) -> Stances:
        """Stack the stances and say of each what cuts it."""
        rows = self._stances.stacked()
        start = self._start or 0
        touchdown = absolute_time(rows[:, 0], start)
        liftoff = absolute_time(rows[:, 1], start)
        cut = np.full(len(touchdown), Cut.WHOLE)
        cut[timespans.touches(gaps, touchdown, liftoff)] = Cut.GAP
        last = self._finder.last
        if last is not None and last.contact[0]:
            cut[-1:] = Cut.LOG_END
        cut[touchdown == start] = Cut.LOG_START
        return Stances(touchdown, liftoff, cut.astype(np.int8), StanceFigures(*rows[:, 2:].T))
