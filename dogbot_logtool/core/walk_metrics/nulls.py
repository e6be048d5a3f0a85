"""Why metrics are null: the finding that voids one, or what the log lacks."""

from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import Final

from dogbot_logtool.core.metrics import NEEDS, Segment, WalkMetrics
from dogbot_logtool.core.records import Field, KeyPath, values
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.core.walk_metrics.lacks import Lacking, Lacks
from dogbot_logtool.finding import Finding

DOES_NOT_APPLY: Final = "does not apply"
WHOLE_ONLY: Final = "measured over the whole log only"
_SEGMENTS: Final = ("gait", "segments")
_NOT_OF_SEGMENTS: Final = ("planned", "height_over_stride_m")
"""Metrics of a foot that are measured over the whole log only."""


def null_because(walk: WalkMetrics, stats: Stats, findings: Sequence[Finding]) -> dict[str, str]:
    """Return why each metric is null that is, by its path.

    Args:
        walk: its metrics.
        stats: what they are made of.
        findings: what makes metrics doubtful.
    """
    lacking, reasons, of_segments = Lacking(stats), {}, []
    for path, value, field in values(walk):
        if value is not None or not field.of.needs:
            continue
        if path[:2] == _SEGMENTS:
            of_segments.append((path, field))
        else:
            reasons[".".join(path)] = _reason(path, field, lacking.at(path), findings)
    for path, field in of_segments:
        below = path[len(_SEGMENTS) + 1 :]
        if ".".join(below) not in reasons:
            segment = walk.gait.segments[int(path[len(_SEGMENTS)])]
            reasons[".".join(path)] = _of_segment(segment, below, field, findings)
    return reasons


def _reason(path: KeyPath, field: Field, lacks: Lacks, findings: Sequence[Finding]) -> str:
    """Return what voids a metric, what the log lacks for it, or what is found of it."""
    name = ".".join(path)
    for each in findings:
        if any(fnmatchcase(name, pattern) for pattern in each.voids):
            return each.code
    for need in field.of.needs:
        if need in lacks:
            return NEEDS[need]
    for each in findings:
        if each.where and name.startswith(each.where):
            return each.code
    return DOES_NOT_APPLY


def _of_segment(segment: Segment, below: KeyPath, field: Field, findings: Sequence[Finding]) -> str:
    """Return why a metric is null in a segment only."""
    if below[-1] in _NOT_OF_SEGMENTS:
        return WHOLE_ONLY
    own = segment.feet[below[1]] if below[0] == "feet" else segment.gait
    lacks = Lacks() if own.strides else Lacks({"strides"})
    return _reason(below, field, lacks, findings)
