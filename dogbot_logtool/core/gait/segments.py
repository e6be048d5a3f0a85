"""When does the gait change? The time line, cut where class or stride period changes lastingly."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from dogbot_logtool.core.gait.gait import STAND, UNKNOWN_GAIT, GaitClass, classify
from dogbot_logtool.core.gait.gait_classes import TOLERANCE, class_distances
from dogbot_logtool.core.gait.phases import phases_by_stride, phases_in
from dogbot_logtool.core.gait.standing import Standing
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.gait.support_pattern import Support
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.aggregates import CircularMean, circular_mean
from dogbot_logtool.core.geometry.arrays import Floats, Ints
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
    walked = Strides(*(getattr(strides, name)[steps] for name in Strides.__dataclass_fields__))
    found = [
        _segment(gait, _spans_of(walked, parts))
        for parts in _runs(_distances_by_stride(gait, walked), walked, apart)
    ]
    count = len(gait.feet)
    found += [_stand(int(start), int(end), count) for start, end in gait.standing.still]
    found += [_without_steps(span, count) for span in gait.standing.moving]
    found += [_lifted(span, count) for span in gait.standing.lifted]
    return tuple(sorted(found, key=lambda segment: segment.start))


def transition_strides(segments: Sequence[Segment], strides: Strides) -> int:
    """Return the number of reference strides that belong to no segment."""
    return len(strides.stance) - sum(segment.strides for segment in segments)


def _distances_by_stride(gait: GaitInput, walked: Strides) -> Floats:
    """(n, classes) distance of every stride from each class; (n, 0) where they have no names."""
    count = len(walked.touchdown)
    if gait.order is None or count == 0:
        return np.empty((count, 0))
    phases = [phases_by_stride(walked, gait.feet[foot].touchdown) for foot in gait.order]
    distances = class_distances(np.stack(phases, axis=1), walked.duty_factor)
    return np.stack(list(distances.values()), axis=1)


_NONE: Final = -1
"""No class: irregular, or unknown."""


class _StrideKinds:
    """The class and the period of each stride."""

    def __init__(self, distances: Floats, walked: Strides) -> None:
        self._distances = np.where(np.isnan(distances), np.inf, distances)
        self._period = walked.period_s.tolist()
        self.named = distances.shape[1] > 0
        count = len(self._period)
        self.label = [_NONE] * count
        if self.named and count:
            fits = self._distances.min(axis=1) <= TOLERANCE
            self.label = np.where(fits, self._distances.argmin(axis=1), _NONE).tolist()

    def agree(self, one: int, other: int) -> bool:
        """Tell whether two strides are of one kind."""
        shorter, longer = sorted((self._period[one], self._period[other]))
        similar = longer - shorter <= PERIOD_CHANGE * shorter
        return similar and self.label[one] == self.label[other]

    def goes_on(self, label: int, before: Sequence[int], stride: int) -> bool:
        """Tell whether a stride goes on with a run of a class; `before` are strides of it."""
        typical = _median([self._period[each] for each in before])
        if abs(self._period[stride] - typical) > PERIOD_CHANGE * typical:
            return False
        if self.label[stride] == label:
            return True
        if label == _NONE:
            return False
        limit = DRIFT if self.label[stride] == _NONE else BORDER
        return float(self._distances[stride, label]) <= limit

    def similar_runs(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        """Tell whether two runs are of one gait, with something in between."""
        first = _median(self._period[one[0] : one[1]])
        then = _median(self._period[other[0] : other[1]])
        same = self.label[one[0]] == self.label[other[0]]
        return same and abs(first - then) <= PERIOD_CHANGE * first

    def is_brief(self, one: tuple[int, int], other: tuple[int, int]) -> bool:
        """Tell whether two runs are of one gait, with too little in between for another one."""
        usual = _median(self._period[one[0] : one[1]])
        between = sum(self._period[one[1] : other[0]])
        return self.similar_runs(one, other) and between < LASTING * (1.0 - PERIOD_CHANGE) * usual


_RECENT: Final = 9
"""Strides that a stride's period is compared with."""


def _median(values: Sequence[float]) -> float:
    """Return the median of a few values; numpy takes longer to begin than to end with them."""
    ordered = sorted(values)
    middle = len(ordered) // 2
    return (ordered[middle] + ordered[~middle]) / 2.0


_Parts = tuple[tuple[int, int], ...]
"""First stride, and stride after the last, of each part of a run that others interrupt."""


def _runs(distances: Floats, walked: Strides, apart: Ints) -> list[_Parts]:
    """Return the runs of one gait each."""
    kinds = _StrideKinds(distances, walked)
    stood = np.searchsorted(apart[:, 0], walked.touchdown)
    edges = [0, *(np.flatnonzero(np.diff(stood)) + 1).tolist(), len(stood)]
    runs: list[_Parts] = []
    for first, last in pairwise(edges):
        if first < last:
            runs += _runs_between(kinds, first, last)
    return runs


def _runs_between(kinds: _StrideKinds, first: int, last: int) -> list[_Parts]:
    """Return the runs of strides `first` to `last` (exclusive), between which nothing stands."""
    settled: list[tuple[int, int]] = []
    stride = first
    while stride < last - 1:
        if not kinds.agree(stride, stride + 1):
            stride += 1
            continue
        run = (stride, _end_of_run(kinds, stride, last))
        if settled and kinds.similar_runs(settled[-1], run):
            run = (settled.pop()[0], run[1])
        settled.append(run)
        stride = run[1]
    if kinds.named:
        settled = [
            run
            for run in settled
            if kinds.label[run[0]] != _NONE or run[1] - run[0] > LONGEST_TRANSITION
        ]
    return _joined(kinds, _with_unsettled(settled, first, last))


def _joined(kinds: _StrideKinds, runs: Sequence[tuple[int, int]]) -> list[_Parts]:
    """Join runs of one gait around others that last less than `LASTING` strides of that gait.

    One touchdown too many splits a stride into two short ones, which agree with each other.
    """
    joined: list[_Parts] = []
    for run in runs:
        same = [row for row, before in enumerate(joined) if kinds.is_brief(before[-1], run)]
        parts = (*joined[same[0]], run) if same else (run,)
        joined[same[0] if same else len(joined) :] = [parts]
    return joined


def _end_of_run(kinds: _StrideKinds, first: int, last: int) -> int:
    """Return the stride after the last one of the run that begins at `first`.

    Strides that only drift from the run's class belong to it if others follow that do not.
    """
    label, members = kinds.label[first], [first]
    end = first + 1
    for stride in range(first + 1, last):
        if kinds.goes_on(label, members[-_RECENT:], stride):
            members.append(stride)
            end = stride + 1 if kinds.label[stride] == label else end
        elif stride - members[-1] >= LASTING:
            break
    return end


def _with_unsettled(
    settled: Sequence[tuple[int, int]], first: int, last: int
) -> list[tuple[int, int]]:
    """Add what is too long for a transition, or is all that there is."""
    if not settled:
        return [(first, last)]
    runs = list(settled)
    edges = [first, *(edge for run in settled for edge in run), last]
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        if end - start > LONGEST_TRANSITION:
            runs.append((start, end))
    return sorted(runs)


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


def _stand(start: int, end: int, feet: int) -> Segment:
    gait = GaitClass(STAND, None, STAND, 0.0)
    return Segment(start, end, gait, 0, (None,) * feet)


def _without_steps(span: Ints, feet: int) -> Segment:
    start, end = span.tolist()
    return Segment(start, end, UNKNOWN_GAIT, 0, (None,) * feet, moves_without_steps=True)


def _lifted(span: Ints, feet: int) -> Segment:
    start, end = span.tolist()
    return Segment(start, end, UNKNOWN_GAIT, 0, (None,) * feet, is_lifted=True)


def main_segment(segments: Sequence[Segment]) -> Segment | None:
    """Return the longest segment; its class is the log's. None without segments."""
    return max(segments, key=lambda segment: segment.end - segment.start, default=None)
