"""When does the gait change? The time line, cut where class or stride period changes lastingly."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import CircularMean, Ints, circular_mean, median_of, picked
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.classes import (
    STAND,
    TOLERANCE,
    UNKNOWN_GAIT,
    GaitClass,
    class_distances,
    classify,
    phases_by_stride,
    phases_in,
)
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.gait.strides import (
    Strides,
    cut_by_fall,
    cut_by_standing,
    no_strides,
    strides_of,
)
from dogbot_logtool.core.gait.support import Standing, Support, steps_apart
from dogbot_logtool.core.leg_position import legs_in_order
from dogbot_logtool.dataclass import dataclass

LASTING: Final = 2
"""Strides in a row that must agree before the gait counts as another one."""
PERIOD_CHANGE: Final = 0.2
"""Share by which the stride period must change to count as a change."""
DRIFT: Final = 2.0 * TOLERANCE
"""A stride stays with its segment's class up to this distance: a limp does not cut the line."""
BORDER: Final = 0.5 * TOLERANCE
"""So does one that another class fits better, up to this distance."""
LONGEST_TRANSITION: Final = 4
"""Strides; more of them between two gaits are a segment of their own, however irregular."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of the log with one gait."""

    start: int
    """ns. Also `end`."""
    end: int
    gait: GaitClass
    strides: int
    """Reference strides in it."""
    phases: tuple[CircularMean | None, ...]
    """Phase of each foot against the reference foot."""
    hind_phases: tuple[CircularMean | None, ...] | None = None
    """The same against the left hind foot; None where that is not known or has no strides."""
    duty_factor: float | None = None
    """Mean of the feet's mean duty factors."""
    stride_frequency_hz: float | None = None
    """Hz, of the reference foot."""
    flight_fraction: float | None = None
    """Share of the time without a foot in contact."""
    moves_without_steps: bool = False
    """All feet are down and the base moves: no gait is claimed."""
    is_lifted: bool = False
    """No foot is down for longer than a leap takes: held in the air, or lying on its body."""
    interruptions: tuple[tuple[int, int], ...] = ()
    """ns, from and to: strides of another kind, too few to be a gait; not part of it."""

    @property
    def duty_below_half(self) -> bool | None:
        """Whether the duty factor is below one half; None where it is not known."""
        return None if self.duty_factor is None else self.duty_factor < 0.5

    @property
    def spans(self) -> Ints:
        """(n, 2) ns, without its interruptions."""
        edges = [self.start, *(edge for span in self.interruptions for edge in span), self.end]
        return np.array(edges, np.int64).reshape(-1, 2)


@dataclass(frozen=True, slots=True)
class FootEvents:
    """The strides of one foot that segments are made of."""

    strides: Strides
    touchdown: Ints
    """(n,) ns, touchdowns that were seen, in whole strides or not."""


@dataclass(frozen=True, slots=True)
class GaitInput:
    """The strides that the gait is made of."""

    feet: tuple[FootEvents, ...]
    reference: int
    """The foot that phases are measured against: left fore, or the first one with strides."""
    hind_reference: int | None
    """Left hind, that papers often use; None: not known, or without strides."""
    order: tuple[int, ...] | None
    """The feet as `class_distances` wants them; None leaves the class unknown."""
    standing: Standing
    support: Support | None
    """None: it is never known of all feet at once whether they are down."""


def find_segments(gait: GaitInput) -> tuple[Segment, ...]:
    """Cut the time line into segments of one gait each.

    A reference stride carries the class that its phases and duty factor are nearest to. The line
    is cut where at least `LASTING` strides in a row carry another class, or periods that differ
    by more than `PERIOD_CHANGE`, and where the robot stands. A single odd stride does not cut.
    The strides of a transition belong to neither of its neighbours.

    Returns:
        segments in order of time, stands among them.
    """
    strides = gait.feet[gait.reference].strides
    apart = gait.standing.without_steps
    steps = ~timespans.touches(apart, strides.touchdown, strides.end)
    walked = picked(strides, steps)
    stood = np.searchsorted(apart[:, 0], walked.touchdown)
    runs = _runs(_kinds(gait, walked), stood)
    found = [_segment(gait, _spans_of(walked, parts)) for parts in runs]
    nothing = (None,) * len(gait.feet)
    stand = GaitClass(STAND, None, STAND, 0.0)
    still, moving, lifted = (spans.tolist() for spans in gait.standing)
    found += [Segment(start, end, stand, 0, nothing) for start, end in still]
    found += [
        Segment(start, end, UNKNOWN_GAIT, 0, nothing, moves_without_steps=True)
        for start, end in moving
    ]
    found += [
        Segment(start, end, UNKNOWN_GAIT, 0, nothing, is_lifted=True) for start, end in lifted
    ]
    return tuple(sorted(found, key=lambda segment: segment.start))


def transition_strides(segments: Sequence[Segment], strides: Strides) -> int:
    """Return the number of reference strides that belong to no segment."""
    return len(strides.stance) - sum(segment.strides for segment in segments)


_NONE: Final = -1
"""No class: irregular, or unknown."""
_Parts = tuple[tuple[int, int], ...]
"""First stride, and stride after the last, of each part of a run that others interrupt."""


@dataclass(frozen=True, slots=True)
class _Kinds:
    """The class and the period of n strides."""

    fits: Ints
    """(n,) the class that each fits best by itself; `_NONE`: it fits none."""
    label: Ints
    """(n,) its class, as it goes on from the strides before it."""
    period: Ints
    """(n,) ns."""
    named: bool
    """Whether gaits of so many feet have names."""

    def usual(self, run: tuple[int, int]) -> float:
        """Return the median period of a run, ns."""
        return float(median_of(self.period[run[0] : run[1]]))

    def alike(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        """Tell whether two runs are of one gait."""
        same = self.label[one[0]] == self.label[other[0]]
        usual = self.usual(one)
        return bool(same) and abs(usual - self.usual(other)) <= PERIOD_CHANGE * usual

    def is_brief(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        """Tell whether too little lies between two runs of one gait for another one."""
        between = float(self.period[one[1] : other[0]].sum())
        least = LASTING * (1.0 - PERIOD_CHANGE) * self.usual(one)
        return self.alike(one, other) and between < least


def _kinds(gait: GaitInput, walked: Strides) -> _Kinds:
    """Return the class and the period of each stride."""
    period = walked.end - walked.touchdown
    none = np.full(len(period), _NONE)
    phases = [phases_by_stride(walked, gait.feet[foot].touchdown) for foot in gait.order or ()]
    if not phases or not len(period):
        return _Kinds(none, none, period, named=False)
    classes = class_distances(np.stack(phases, axis=1), walked.duty_factor)
    if not classes:
        return _Kinds(none, none, period, named=False)
    distance = np.nan_to_num(np.stack(list(classes.values()), axis=1), nan=np.inf)
    fits = np.where(distance.min(axis=1) <= TOLERANCE, distance.argmin(axis=1), _NONE)
    label = fits.tolist()
    for row in range(1, len(label)):
        before = label[row - 1]
        limit = DRIFT if label[row] == _NONE else BORDER
        if before not in {_NONE, label[row]} and distance[row, before] <= limit:
            label[row] = before
    return _Kinds(fits, np.array(label), period, named=True)


def _runs(kinds: _Kinds, stood: Ints) -> list[_Parts]:
    """Return the runs of one gait each.

    Args:
        kinds: of n strides.
        stood: (n,) how often the robot has stood before each.
    """
    edges = [0, *(np.flatnonzero(np.diff(stood)) + 1).tolist(), len(stood)]
    runs: list[_Parts] = []
    for first, last in pairwise(edges):
        if first < last:
            settled = _settled(kinds, first, last)
            runs += _joined(kinds, _with_unsettled(settled, first, last))
    return runs


def _settled(kinds: _Kinds, first: int, last: int) -> list[tuple[int, int]]:
    """Return the runs of at least `LASTING` strides of one kind, first to last (exclusive)."""
    label, period = kinds.label[first:last], kinds.period[first:last]
    shorter, longer = np.minimum(period[1:], period[:-1]), np.maximum(period[1:], period[:-1])
    cut = (label[1:] != label[:-1]) | (longer > (1.0 + PERIOD_CHANGE) * shorter)
    settled: list[tuple[int, int]] = []
    for begin, end in pairwise([first, *(np.flatnonzero(cut) + first + 1).tolist(), last]):
        # What only drifts from the class at the end of a run is no part of it.
        own = np.flatnonzero(kinds.fits[begin:end] == kinds.label[begin])
        run = (begin, begin + int(own[-1]) + 1) if len(own) else (begin, begin)
        if run[1] - run[0] < LASTING:
            continue
        if settled and kinds.alike(settled[-1], run):
            run = (settled.pop()[0], run[1])
        settled.append(run)
    return [
        run
        for run in settled
        if not kinds.named or kinds.label[run[0]] != _NONE or run[1] - run[0] > LONGEST_TRANSITION
    ]


def _joined(kinds: _Kinds, runs: Sequence[tuple[int, int]]) -> list[_Parts]:
    """Join runs of one gait around others that last less than `LASTING` strides of that gait.

    One touchdown too many splits a stride into two short ones, which agree with each other.
    """
    joined: list[_Parts] = []
    for run in runs:
        same = [row for row, before in enumerate(joined) if kinds.is_brief(before[-1], run)]
        parts = (*joined[same[0]], run) if same else (run,)
        joined[same[0] if same else len(joined) :] = [parts]
    return joined


def _with_unsettled(
    settled: Sequence[tuple[int, int]], first: int, last: int
) -> list[tuple[int, int]]:
    """Add what is too long for a transition, or is all that there is."""
    if not settled:
        return [(first, last)]
    edges = [first, *(edge for run in settled for edge in run), last]
    rest = [
        (start, end)
        for start, end in zip(edges[::2], edges[1::2], strict=True)
        if end - start > LONGEST_TRANSITION
    ]
    return sorted([*settled, *rest])


def _spans_of(walked: Strides, parts: _Parts) -> Ints:
    """(n, 2) ns, the time of some parts of a run."""
    return np.array(
        [(walked.touchdown[first], walked.end[last - 1]) for first, last in parts], np.int64
    )


def _segment(gait: GaitInput, spans: Ints) -> Segment:
    """Describe the gait in some spans, (n, 2) ns."""
    feet = gait.feet
    strides = feet[gait.reference].strides.within(spans)
    phases = _phases(feet, gait.reference, spans)
    duty = [
        float(inside.duty_factor.mean())
        for foot in feet
        if len((inside := foot.strides.within(spans)).stance)
    ]
    duty_factor = float(np.mean(duty)) if duty else None
    flight = gait.support.flight_within(spans) if gait.support else None
    known = [phases[foot] for foot in gait.order or ()]
    named = UNKNOWN_GAIT
    if known and all(known):
        named = classify(
            [phase.mean for phase in known if phase],
            [phase.consistency for phase in known if phase],
            duty_factor,
            flight,
        )
    hind = gait.hind_reference
    return Segment(
        start=int(spans[0, 0]),
        end=int(spans[-1, 1]),
        gait=named,
        strides=len(strides.stance),
        phases=phases,
        hind_phases=_phases(feet, hind, spans) if hind is not None else None,
        duty_factor=duty_factor,
        stride_frequency_hz=strides.frequency_hz,
        flight_fraction=flight,
        interruptions=tuple(pairwise(spans.ravel().tolist()))[1::2],
    )


def _phases(
    feet: Sequence[FootEvents], reference: int, spans: Ints
) -> tuple[CircularMean | None, ...]:
    strides = feet[reference].strides.within(spans)
    return tuple(circular_mean(phases_in(strides, foot.touchdown)) for foot in feet)


def main_segment(segments: Sequence[Segment]) -> Segment | None:
    """Return the longest segment; its class is the log's. None without segments."""
    return max(segments, key=lambda segment: segment.end - segment.start, default=None)


def any_strides(records: Sequence[FootHistory], fallen: Ints, standing: Ints) -> Ints:
    """(s, 2) ns, the strides of the first foot that has any.

    Args:
        records: of all feet.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: (s, 2) ns, spans without steps, as far as they are known.
    """
    for record in records:
        stances = cut_by_fall(record.stances, fallen)
        stances = cut_by_standing(stances, steps_apart(standing, stances))
        strides, _ = strides_of(stances, record.gaps, fallen)
        if len(strides.stance):
            return strides.spans
    return timespans.no_spans()


def reference_strides(feet: Sequence[FootSteps]) -> Strides:
    """Return the whole strides of the first foot that has any."""
    return next((foot.strides for foot in feet if len(foot.strides.stance)), no_strides())


def gait_input(
    feet: Sequence[FootSteps], standing: Standing, supported: Support | None
) -> GaitInput:
    """Choose the feet that phases are measured against."""
    leg_positions = [foot.leg_position for foot in feet]
    order = legs_in_order(leg_positions)
    walking = [row for row in order or range(len(feet)) if len(feet[row].strides.stance)]
    hind = leg_positions.index(("back", "left")) if ("back", "left") in leg_positions else None
    return GaitInput(
        feet=tuple(FootEvents(foot.strides, foot.touchdown) for foot in feet),
        reference=walking[0] if walking else 0,
        hind_reference=hind if hind in walking else None,
        order=order,
        standing=standing,
        support=supported,
    )
