"""When does the gait change? The time line, cut where class or stride period changes lastingly."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.gait.gait import (
    STAND,
    TOLERANCE,
    UNKNOWN_GAIT,
    GaitClass,
    class_distances,
    classify,
    phases_by_stride,
    phases_in,
)
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.aggregates import CircularMean, circular_mean
from dogbot_logtool.core.geometry.arrays import Floats, Ints

STAND_S: Final = 1.0
"""All feet down for longer, and for longer than a stride, is a stand."""
LASTING: Final = 2
"""Strides in a row that must agree before the gait counts as another one."""
PERIOD_CHANGE: Final = 0.2
"""Share by which the stride period must change to count as a change."""
DRIFT: Final = 2.0 * TOLERANCE
"""A stride stays with its segment's class up to this distance: a limp does not cut the line."""


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
    """Of each foot against the reference foot."""
    duty_factor: float | None
    """Mean of the feet's mean duty factors."""
    stride_frequency_hz: float | None
    """Of the reference foot."""

    @property
    def spans(self) -> Ints:
        """(1, 2) ns."""
        return np.array([[self.start, self.end]], np.int64)


@dataclass(frozen=True, slots=True)
class FootEvents:
    """What segments are made of, for one foot."""

    strides: Strides
    touchdown: Ints
    """(n,) ns, touchdowns that were seen, in whole strides or not."""


def stands(all_down: Ints, typical_period_s: float | None) -> Ints:
    """Choose the spans in which the robot stands rather than walks.

    Args:
        all_down: (n, 2) ns, all feet in contact.
        typical_period_s: s, median stride period; None without strides.
    """
    longest_step = max(STAND_S, typical_period_s or 0.0)
    chosen: Ints = all_down[all_down[:, 1] - all_down[:, 0] >= longest_step * 1e9]
    return chosen


def find_segments(
    feet: Sequence[FootEvents],
    reference: int,
    corners: tuple[int, int, int, int] | None,
    standing: Ints,
) -> tuple[Segment, ...]:
    """Cut the time line into segments of one gait each.

    A reference stride carries the class that its phases are nearest to. The line is cut where at
    least `LASTING` strides in a row carry another class, or periods that differ by more than
    `PERIOD_CHANGE`, and where the robot stands. A single odd stride does not cut.

    Args:
        feet: every foot's strides and touchdowns.
        reference: the foot that phases are measured against.
        corners: which foot is front left, front right, back left, back right; None leaves the
            class unknown.
        standing: (s, 2) ns, spans in which the robot stands.

    Returns:
        segments in order of time, stands among them.
    """
    strides = feet[reference].strides
    moving = ~timespans.touches(standing, strides.touchdown, strides.end)
    walked = Strides(*(getattr(strides, name)[moving] for name in Strides.__dataclass_fields__))
    found = [
        _segment(feet, reference, corners, int(walked.touchdown[first]), int(walked.end[last - 1]))
        for first, last in _runs(_nearest_by_stride(feet, walked, corners), walked, standing)
    ]
    found += [_stand(int(start), int(end), len(feet)) for start, end in standing]
    return tuple(sorted(found, key=lambda segment: segment.start))


def _nearest_by_stride(
    feet: Sequence[FootEvents], walked: Strides, corners: tuple[int, int, int, int] | None
) -> Floats:
    """(n, classes) distance of every stride from each class; NaN where unknown."""
    if corners is None:
        return np.full((len(walked.touchdown), 1), np.nan)
    phases = [phases_by_stride(walked, feet[foot].touchdown) for foot in corners]
    return np.stack(list(class_distances(np.stack(phases, axis=1)).values()), axis=1)


_NONE: Final = -1
"""No class: irregular, or unknown."""


def _runs(distances: Floats, walked: Strides, standing: Ints) -> list[tuple[int, int]]:
    """First stride, and stride after the last, of each run of one gait."""
    count = len(walked.touchdown)
    period = walked.period_s.tolist()
    known = np.where(np.isnan(distances), np.inf, distances)
    nearest = np.where(known.min(axis=1) <= TOLERANCE, known.argmin(axis=1), _NONE).tolist()
    stood = np.searchsorted(standing[:, 0], walked.touchdown).tolist()

    runs: list[tuple[int, int]] = []
    first, label, odd = 0, _NONE, 0
    for stride in range(count):
        if stride == first:
            label, odd = nearest[stride], 0
            continue
        if stood[stride] != stood[stride - 1]:
            runs.append((first, stride))
            first, label, odd = stride, nearest[stride], 0
            continue
        typical = _median(period[first : stride - odd][-_RECENT:])
        stays = _keeps(label, nearest[stride], known[stride], period[stride], typical)
        odd = 0 if stays else odd + 1
        if odd >= LASTING and _agree(stride, nearest, period):
            change = stride - odd + 1
            if change - first >= LASTING:
                runs.append((first, change))
                first = change
            label, odd = nearest[stride], 0
    if count:
        runs.append((first, count))
    return runs


_RECENT: Final = 9
"""Strides that a stride's period is compared with."""


def _median(values: Sequence[float]) -> float:
    """Return the median of a few values; numpy takes longer to begin than to end with them."""
    ordered = sorted(values)
    middle = len(ordered) // 2
    return (ordered[middle] + ordered[~middle]) / 2.0


def _keeps(label: int, nearest: int, distance: Floats, period: float, typical: float) -> bool:
    """Tell whether a stride goes on with the gait of its segment."""
    if abs(period - typical) > PERIOD_CHANGE * typical:
        return False
    if nearest == label:
        return True
    return label != _NONE and nearest == _NONE and float(distance[label]) <= DRIFT


def _agree(stride: int, nearest: list[int], period: list[float]) -> bool:
    """Tell whether a stride and the one before it are of one kind."""
    similar = abs(period[stride] - period[stride - 1]) <= PERIOD_CHANGE * period[stride]
    return nearest[stride] == nearest[stride - 1] and similar


def _segment(
    feet: Sequence[FootEvents],
    reference: int,
    corners: tuple[int, int, int, int] | None,
    start: int,
    end: int,
) -> Segment:
    """Describe the gait between two times."""
    spans = np.array([[start, end]], np.int64)
    strides = feet[reference].strides.within(spans)
    phases = tuple(circular_mean(phases_in(strides, foot.touchdown)) for foot in feet)
    duty = [
        float(inside.duty_factor.mean())
        for foot in feet
        if len((inside := foot.strides.within(spans)).stance)
    ]
    gait = UNKNOWN_GAIT
    known = [phases[foot] for foot in corners or ()]
    if known and all(known):
        gait = classify(
            [phase.mean for phase in known if phase],
            [phase.consistency for phase in known if phase],
        )
    return Segment(
        start,
        end,
        gait,
        len(strides.stance),
        phases,
        float(np.mean(duty)) if duty else None,
        strides.frequency_hz,
    )


def _stand(start: int, end: int, feet: int) -> Segment:
    gait = GaitClass(STAND, None, STAND, 0.0)
    return Segment(start, end, gait, 0, (None,) * feet, None, None)


def main_segment(segments: Sequence[Segment]) -> Segment | None:
    """Return the longest segment; its class is the log's. None without segments."""
    return max(segments, key=lambda segment: segment.end - segment.start, default=None)
