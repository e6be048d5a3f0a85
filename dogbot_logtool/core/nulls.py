"""Why metrics are null: the finding that voids one, or what the log lacks."""

from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Final

import numpy as np

from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import vertical_is_known
from dogbot_logtool.core.metrics import NEEDS, WalkMetrics
from dogbot_logtool.core.records import Field, KeyPath, values
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding

Lacks = Mapping[str, bool]
"""Whether each of `NEEDS` is missing."""


def _lacking(walk: Walk) -> dict[KeyPath, Lacks]:
    """Return what is missing, by the path of what it is missing for; ``()`` is the log."""
    log = _log(walk)
    lacks: dict[KeyPath, Lacks] = {(): log}
    for row, foot in enumerate(walk.feet):
        own = log | _foot(walk, row)
        lacks |= {("feet", foot.name): own, ("quality", "feet", foot.name): own}
    tracks = walk.legs.joints if walk.legs else {}
    for name, joint in walk.legs.metrics.joints.items() if walk.legs else ():
        lacks["legs", "joints", name] = log | {
            "efforts": not tracks[name].has_effort,
            "limits": not tracks[name].has_limits,
            "strides": joint.position_over_stride is None,
        }
    for each in walk.corrected.topics:
        lacks["quality", "topics", each.topic] = {"stamps": each.zero_stamps is None}
    return lacks


def _log(walk: Walk) -> dict[str, bool]:
    feet, legs, stability = walk.feet, walk.legs, walk.stability
    touching = [foot.record for foot in feet if len(foot.record.in_contact)]
    undefined = None if stability is None else stability.undefined_fraction
    joints = [] if legs is None else [legs.joints[name] for name in legs.metrics.joints]
    return {
        "feet": not feet,
        "two feet": len(feet) != 2,
        "four feet": len(feet) != 4,
        "three feet": len(feet) < 3 or undefined == 1.0,
        "leg positions": any(foot.leg_position is None for foot in feet),
        "all feet": walk.support is None,
        "strides": walk.main is None or not walk.main.strides,
        "phases": walk.main is not None
        and any(phase.mean is None for phase in walk.main.gait.phase.values()),
        "base": walk.base is None,
        "points": not any(_has_points(foot) for foot in feet),
        "foot frame": legs is None or not any(leg.frame for leg in legs.feet),
        "force": not all(foot.record.has_force for foot in feet),
        "vertical force": not all(map(vertical_is_known, touching)),
        "weight": walk.settings.mass_kg is None,
        "joints": not joints,
        "efforts": not any(each.has_effort for each in joints),
        "limits": not any(each.has_limits for each in joints),
        "commands": walk.command_track is None and walk.base is not None,
        "imu": not walk.settings.imu_topic,
    }


def _foot(walk: Walk, row: int) -> dict[str, bool]:
    foot, legs = walk.feet[row], walk.legs
    rolls_unknown = walk.settings.foot_rolling_m is None and foot.slip_from != "foot_frame"
    return {
        "contact": foot.record.contact_fraction() is None,
        "strides": not len(foot.strides.stance),
        "points": not _has_points(foot),
        "places": walk.base is None and not np.isfinite(foot.length_m).any(),
        "straight": foot.length_from == "base" and not np.isfinite(foot.length_m).any(),
        "foot frame": legs is None or not legs.feet[row].frame,
        "leg rate": legs is not None and legs.feet[row].is_slow,
        "rolling": rolls_unknown,
        "force": not foot.record.has_force,
        "vertical force": not vertical_is_known(foot.record),
        "weight": walk.loads.weight_n is None,
        "normals": not np.isfinite(foot.stances.figures.friction_use).any(),
        "plan": not walk.planned or walk.planned[row] is None,
    }


def _has_points(foot: FootSteps) -> bool:
    return len(foot.record.track.contact_points[0]) > 0


DOES_NOT_APPLY: Final = "does not apply"
WHOLE_ONLY: Final = "measured over the whole log only"
_SEGMENTS: Final = ("gait", "segments")
_NOT_OF_SEGMENTS: Final = ("planned", "height_over_stride_m")
"""Metrics of a foot that are measured over the whole log only."""


def null_because(metrics: WalkMetrics, walk: Walk, findings: Sequence[Finding]) -> dict[str, str]:
    """Return why each metric is null that is, by its path.

    Args:
        metrics: of a walk.
        walk: that they are made of.
        findings: what makes metrics doubtful.
    """
    lacking, reasons = _lacking(walk), dict[str, str]()
    nulls = [
        (path, field) for path, value, field in values(metrics) if value is None and field.of.needs
    ]
    for path, field in sorted(nulls, key=lambda each: each[0][:2] == _SEGMENTS):
        below, name = path, ".".join(path)
        lacks = next(lacking[path[:size]] for size in (3, 2, 0) if path[:size] in lacking)
        if path[:2] == _SEGMENTS:
            # Of what the whole log lacks, it has the reason.
            below = path[len(_SEGMENTS) + 1 :]
            if ".".join(below) in reasons:
                continue
            segment = metrics.gait.segments[int(path[len(_SEGMENTS)])]
            own = segment.feet[below[1]] if below[0] == "feet" else segment.gait
            lacks = {"strides": not own.strides}
        is_whole = below != path and below[-1] in _NOT_OF_SEGMENTS
        reasons[name] = WHOLE_ONLY if is_whole else _reason(below, field, lacks, findings)
    return reasons


def _reason(path: KeyPath, field: Field, lacks: Lacks, findings: Sequence[Finding]) -> str:
    """Return what voids a metric, what the log lacks for it, or what is found of it."""
    name = ".".join(path)
    for each in findings:
        if any(fnmatchcase(name, pattern) for pattern in each.voids):
            return each.code
    for need in field.of.needs:
        if lacks.get(need):
            return NEEDS[need]
    for each in findings:
        if each.where and name.startswith(each.where):
            return each.code
    return DOES_NOT_APPLY
