"""When does the gait change? The time line, cut where class or stride period changes lastingly."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise, zip_longest
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Ints,
    circular_mean,
    median_of,
    picked,
    rows_by_group,
)
from dogbot_logtool.core.gait.classes import (
    STAND,
    TOLERANCE,
    class_distances,
    classify,
    phases_by_stride,
    phases_in,
)
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.gait.strides import Standing, Strides, Support, support
from dogbot_logtool.core.metrics import Gait, Phase, SupportSet
from dogbot_logtool.core.records import Number, unknown
from dogbot_logtool.core.settings import legs_in_order

LASTING: Final = 2
"""Strides in a row that must agree before the gait counts as another one."""
PERIOD_CHANGE: Final = 0.2
"""Share by which the stride period must change to count as a change."""
DRIFT: Final = 2.0 * TOLERANCE
"""A stride stays with its segment's class up to this distance: a limp does not cut the line."""
BORDER: Final = 1.2 * TOLERANCE
"""So does one that another class fits better, up to this distance: a walk at the border of two
classes is of one."""
LONGEST_TRANSITION: Final = 4
"""Strides; more of them between two gaits are a segment of their own, however irregular."""
_NONE: Final = -1
"""No class: irregular, or unknown."""


class Segment(NamedTuple):
    """A part of the log with one gait, or without steps."""

    start: int
    """Ns. Also `end`."""
    end: int
    gait: Gait
    """Without steps and without a name where the robot moves all the same, or is held in the air:
    no gait is claimed."""

    @property
    def span(self) -> Ints:
        """(1, 2) ns."""
        return np.array([[self.start, self.end]])

    @property
    def strides(self) -> int:
        """Reference strides in it."""
        return self.gait.strides or 0


def reference_foot(feet: Sequence[FootSteps]) -> int:
    """Return the foot that phases are measured against: left fore, or the first with strides."""
    order = legs_in_order([foot.leg_position for foot in feet]) or range(len(feet))
    return next((row for row in order if len(feet[row].strides.stance)), 0)


def find_segments(
    feet: Sequence[FootSteps], standing: Standing, *, contacts_known: bool
) -> tuple[Segment, ...]:
    """Cut the time line into segments of one gait each.

    A reference stride carries the class that its phases and duty factor are nearest to. The line
    is cut where at least `LASTING` strides in a row carry another class, or periods that differ
    by more than `PERIOD_CHANGE`, and where the robot stands. A single odd stride does not cut.
    The strides of a transition belong to neither of its neighbours.

    Args:
        feet: steps of all feet.
        standing: spans that are no part of a stride.
        contacts_known: whether the contacts of all feet are known, on one clock.

    Returns:
        segments in order of time, stands among them.
    """
    strides, apart = feet[reference_foot(feet)].strides, standing.without_steps
    walked = picked(strides, ~timespans.touches(apart, strides.touchdown, strides.end))
    stood = np.searchsorted(apart[:, 0], walked.touchdown)
    fits, label = _labels(feet, walked)
    none = replace(no_gait(feet), strides=0)
    stand = replace(none, name=STAND, confidence=1.0, nearest_name=STAND, class_distance=0.0)
    parts = [(span, stand) for span in standing.still]
    parts += [(span, none) for span in (*standing.moving, *standing.lifted)]
    for _, rows in rows_by_group(stood):
        own = picked(walked, rows)
        for begin, end in _runs(fits[rows], label[rows], own.end - own.touchdown):
            span = np.array([own.touchdown[begin], own.end[end - 1]])
            parts.append((span, _gait_of(feet, span[None])))
    found, records = [], [foot.record for foot in feet]
    for span, gait in parts:
        known = support(records, span[None]) if contacts_known else None
        start, end = span.tolist()
        found.append(Segment(start, end, _named(with_support(gait, known, feet), feet)))
    return tuple(sorted(found, key=lambda segment: segment.start))


def no_gait(feet: Sequence[FootSteps]) -> Gait:
    """Return a gait of which nothing is known."""
    return replace(unknown(Gait), phase={foot.name: unknown(Phase) for foot in feet})


def with_support(gait: Gait, known: Support | None, feet: Sequence[FootSteps]) -> Gait:
    """Return a gait with the support in its time, where that is known."""
    if known is None:
        return gait
    return replace(
        gait,
        flight_fraction=known.feet_down[0],
        double_support_fraction=known.feet_down[2] if len(feet) == 2 else None,
        support={str(number): share for number, share in enumerate(known.feet_down)},
        support_sets=tuple(
            SupportSet(tuple(feet[row].name for row in rows), share) for rows, share in known.sets
        ),
    )


def main_segment(segments: Sequence[Segment]) -> Segment | None:
    """Return the longest segment; its class is the log's. None without segments."""
    return max(segments, key=lambda segment: segment.end - segment.start, default=None)


def gait_changes(segments: Sequence[Segment], feet: Sequence[FootSteps]) -> list[tuple[int, Gait]]:
    """Return each gait and the time, ns, from which on it is; unknown where a segment ends."""
    changes = []
    for segment, after in zip_longest(segments, segments[1:]):
        changes.append((segment.start, segment.gait))
        if after is None or after.start > segment.end:
            changes.append((segment.end, no_gait(feet)))
    return changes


_Run = tuple[int, int]
"""First stride, and stride after the last."""


def _labels(feet: Sequence[FootSteps], walked: Strides) -> tuple[Ints, Ints]:
    """Return the class of each stride by itself, and as it goes on from the strides before it.

    (n,) each; `_NONE`: it fits none. One class for all where gaits of so many feet have no names.
    """
    order = legs_in_order([foot.leg_position for foot in feet]) or ()
    if not order or not len(walked.end):
        nameless = np.zeros(len(walked.end), np.int64)
        return nameless, nameless
    phases = [phases_by_stride(walked, feet[foot].touchdown) for foot in order]
    classes = class_distances(np.stack(phases, axis=1), walked.duty_factor)
    distance = np.nan_to_num(np.stack(list(classes.values()), axis=1), nan=np.inf)
    fits = np.where(distance.min(axis=1) <= TOLERANCE, distance.argmin(axis=1), _NONE)
    label = fits.copy()
    for row in range(1, len(label)):
        before = label[row - 1]
        limit = DRIFT if label[row] == _NONE else BORDER
        if before != _NONE and distance[row, before] <= limit:
            label[row] = before
    return fits, label


def _runs(fits: Ints, label: Ints, period: Ints) -> list[_Run]:
    """Return the strides of each gait; too few of another kind between them belong to it.

    Args:
        fits: (n,) classes of strides by themselves.
        label: (n,) classes as they go on.
        period: (n,) ns.
    """
    shorter, longer = np.minimum(period[1:], period[:-1]), np.maximum(period[1:], period[:-1])
    cut = (label[1:] != label[:-1]) | (longer > (1.0 + PERIOD_CHANGE) * shorter)
    found: list[_Run] = []
    for begin, border in pairwise([0, *(np.flatnonzero(cut) + 1).tolist(), len(label)]):
        # What only drifts from the class at the end of a run is no part of it.
        own = np.flatnonzero(fits[begin:border] == label[begin])
        end = begin + int(own.max(initial=-1)) + 1
        if end - begin < LASTING:
            continue
        first, last = found[-1] if found else (begin, begin)
        alike = found and _alike(label, period, (first, last), (begin, end))
        if alike and begin - last < LASTING:
            found[-1] = (first, end)
        else:
            found.append((begin, end))
    # What is too long for a transition is a run, too, however irregular.
    found = [run for run in found if label[run[0]] != _NONE or run[1] - run[0] > LONGEST_TRANSITION]
    edges = [0, *(edge for run in found for edge in run), len(label)]
    rest = zip(edges[::2], edges[1::2], strict=True)
    fewest = LONGEST_TRANSITION + 1 if found else 1
    return [*found, *(run for run in rest if run[1] - run[0] >= fewest)]


def _alike(label: Ints, period: Ints, one: _Run, other: _Run) -> bool:
    """Tell whether two runs are of one gait."""
    usual, then = (float(median_of(period[slice(*run)])) for run in (one, other))
    return bool(label[one[0]] == label[other[0]]) and abs(usual - then) <= PERIOD_CHANGE * usual


def _gait_of(feet: Sequence[FootSteps], spans: Ints) -> Gait:
    """Describe how the feet step in some spans, (n, 2) ns."""
    within = [foot.strides.within(spans) for foot in feet]
    reference, hind = within[reference_foot(feet)], None
    for foot, strides in zip(feet, within, strict=True):
        if foot.leg_position == ("back", "left") and len(foot.strides.stance):
            hind = strides
    duty = [float(each.duty_factor.mean()) for each in within if len(each.stance)]
    phases = {}
    for foot in feet:
        mean, consistency = _phase(foot, reference)
        phases[foot.name] = Phase(mean, consistency, left_hind=_phase(foot, hind)[0])
    return replace(
        unknown(Gait),
        duty_factor=float(np.mean(duty)) if duty else None,
        stride_frequency_hz=reference.frequency_hz,
        strides=len(reference.stance),
        phase=phases,
    )


def _phase(foot: FootSteps, strides: Strides | None) -> tuple[Number, Number]:
    """Return mean and consistency of a foot's phase in some strides."""
    mean = None if strides is None else circular_mean(phases_in(strides, foot.touchdown))
    return mean or (None, None)


def _named(gait: Gait, feet: Sequence[FootSteps]) -> Gait:
    """Name a gait by the phases of its feet, where all of these are known."""
    phases = [*gait.phase.values()]
    ordered = [phases[row] for row in legs_in_order([foot.leg_position for foot in feet]) or ()]
    means = [each.mean for each in ordered if each.mean is not None]
    consistency = [each.consistency for each in ordered if each.consistency is not None]
    known = means and len(means) == len(feet)
    return classify(gait, means, consistency) if known else gait
