"""All checks of a walk: functions that yield findings, each naming the metrics that it voids.

A metric is null for the finding that voids it, or for what the log lacks.

A check is a generator in one of these modules that takes what was measured, and nothing else. It
changes nothing; what its findings void is set to null afterwards, in one place (`records.void`).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from inspect import isgeneratorfunction
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.checks import base, feet, recorded, sensors
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import vertical_is_known
from dogbot_logtool.core.metrics import NEEDS, WalkMetrics
from dogbot_logtool.core.metrics import Check as Question
from dogbot_logtool.core.records import Field, KeyPath, values
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Severity

Check = Callable[[Walk], Iterator[Finding]]
MODULES: Final = (base, sensors, feet, recorded)
CHECKS: Final[tuple[Check, ...]] = tuple(
    each
    for module in MODULES
    for name, each in vars(module).items()
    if isgeneratorfunction(each) and each.__module__ == module.__name__
    if not name.startswith("_") and [*each.__annotations__] == ["walk", "return"]
)
"""In order of the subjects; findings are sorted by consequence."""


def findings_of(walk: Walk) -> list[Finding]:
    """Make all checks, and return what they find."""
    return [finding for check in CHECKS for finding in check(walk)]


def consequence(finding: Finding) -> tuple[int, float]:
    """Return the key that sorts findings: what makes most metrics doubtful comes first."""
    return finding.severity, float("inf") if finding.rank is None else finding.rank


def questions_of(walk: Walk, findings: Iterable[Finding]) -> tuple[Question, ...]:
    """Return the questions about a recording before it is trusted, with their answers.

    A question fails by a finding (``fails`` in ``findings.toml``), does not apply where the log
    holds no data of its kind, and is not made where it holds too little.

    Args:
        walk: all that is measured.
        findings: about that, and about the log.
    """
    doubts = [each for each in findings if each.severity is not Severity.NOTE]
    made = []
    for name, applies, obstacle in _questions(walk):
        against = next((each.text for each in doubts if name in each.fails), "")
        outcomes = {"failed": against, "does not apply": not applies, "not made": obstacle}
        outcome = next((word for word, holds in outcomes.items() if holds), "passed")
        made.append(Question(name, outcome, {"failed": against, "not made": obstacle}.get(outcome)))
    return tuple(made)


def _questions(walk: Walk) -> Sequence[tuple[str, bool, str]]:
    """Return each question, whether the log holds data of its kind, and why it is not answered."""
    records, legs, imu = walk.records, walk.legs, walk.imu
    forced = [row for row, each in enumerate(records) if each.has_force]
    assumed = (walk.settings.feet[row].level.reason for row in forced)
    odd_legs = (leg.reason for leg in legs.feet) if legs else ()
    seen = any(each.start is not None for each in records)
    posed = len(walk.base_history.time) > 0
    pointed = any(len(each.track.contact_points[0]) for each in records)
    no_worlds = "" if walk.worlds else "two feet are not seen to touch near poses for a second each"
    lacking = "the vertical load of all feet" if walk.settings.mass_kg else "the mass"
    weighed = walk.loads.vertical_impulse_over_weight is not None
    odd_imu = "accelerometer and poses are not known together for 2 s"
    if imu is not None:
        undecided = imu.reading in {"nothing", "unclear"}
        odd_imu = "it does not follow the base's attitude" if undecided else ""
    has_stamps, has_clocks, few_stamps = _clocks(walk)
    return (
        ("every foot's sensor works", seen, ""),
        ("what sensors read without load is known", bool(forced), next(filter(None, assumed), "")),
        ("the base's poses are sound", posed, ""),
        ("header stamps are sound", has_stamps, ""),
        ("all topics have one clock", has_clocks, few_stamps),
        ("no topic is silent for long", True, ""),
        ("contacts are where the base is", posed and pointed, no_worlds),
        ("the base moves as the feet step", seen and posed, ""),
        ("the feet carry the weight", bool(forced), "" if weighed else f"{lacking} is not known"),
        ("nothing contradicts the accelerometer", posed and bool(walk.settings.imu_topic), odd_imu),
        ("the legs move as the feet step", legs is not None, next(filter(None, odd_legs), "")),
    )


def _clocks(walk: Walk) -> tuple[bool, bool, str]:
    """Tell whether there are stamps, whether two clocks, and why these are not compared."""
    topics = {foot.topic for foot in walk.feet if foot.record.start is not None}
    if len(walk.base_history.time):
        topics.add(walk.settings.odometry_topic)
    used = [topic for topic in walk.corrected.topics if topic.topic in topics]
    has_stamps = all(topic.zero_stamps is not None for topic in used)
    # Log times that are the header stamps are no second clock.
    apart = not used or any(topic.clock_offset_s != 0.0 for topic in used)
    missing = ", ".join(sorted(topics - {each.topic for each in walk.corrected.clocks}))
    few_stamps = f"too little time with header stamps in common: {missing}" if missing else ""
    return has_stamps, has_stamps and len(topics) > 1 and apart, few_stamps


_METRICS: Final[Mapping[str, Sequence[str]]] = {
    "length_m": ("feet.{foot}.stride_length_m",),
    "absolute_work_j": ("legs.absolute_work_j",),
    "positive_work_j": ("feet.{foot}.positive_work_j", "legs.absolute_work_j"),
}
"""Metrics that void columns of tables, where these are not the foot's of the same name."""


def void_columns(
    columns: Mapping[str, Floats], foot: str, findings: Iterable[Finding]
) -> Mapping[str, Floats]:
    """Set to NaN what findings void of a foot's strides or stances.

    Args:
        columns: (n,) values by the column's name.
        foot: its name.
        findings: about the log.
    """
    patterns = {pattern for each in findings for pattern in each.voids}

    def is_void(column: str) -> bool:
        metrics = _METRICS.get(column, ("feet.{foot}." + column,))
        paths = [metric.replace("{foot}", foot) for metric in metrics]
        return any(fnmatchcase(path, pattern) for path in paths for pattern in patterns)

    return {
        name: np.full(len(values), np.nan) if is_void(name) else values
        for name, values in columns.items()
    }


Lacks = Mapping[str, bool]
"""Whether each of `NEEDS` is missing."""


def _lacking(walk: Walk) -> dict[KeyPath, Lacks]:
    """Return what is missing, by the path of what it is missing for; ``()`` is the log."""
    log = _log(walk)
    lacks: dict[KeyPath, Lacks] = {(): log}
    for row, foot in enumerate(walk.feet):
        own = log | _foot(walk, row)
        lacks |= {("feet", foot.name): own, ("quality", "feet", foot.name): own}
    for name, joint in walk.legs.metrics.joints.items() if walk.legs else ():
        lacks["legs", "joints", name] = log | {
            "efforts": joint.peak_effort is None,
            "limits": joint.near_limit_fraction is None,
            "strides": joint.position_over_stride is None,
        }
    for each in walk.corrected.topics:
        lacks["quality", "topics", each.topic] = {"stamps": each.zero_stamps is None}
    return lacks


def _log(walk: Walk) -> dict[str, bool]:
    feet, legs, stability = walk.feet, walk.legs, walk.stability
    touching = [foot.record for foot in feet if len(foot.record.in_contact)]
    undefined = None if stability is None else stability.undefined_fraction
    joints = [] if legs is None else legs.metrics.joints.values()
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
        "foot frame": legs is None or not any(leg.path for leg in legs.feet),
        "force": not all(foot.record.has_force for foot in feet),
        "vertical force": not all(map(vertical_is_known, touching)),
        "weight": walk.settings.mass_kg is None,
        "joints": not joints,
        "efforts": all(each.peak_effort is None for each in joints),
        "limits": all(each.near_limit_fraction is None for each in joints),
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
        "foot frame": legs is None or legs.feet[row].path is None,
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
_SEGMENTS: Final = ("gait", "segments")


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
        reasons[name] = _reason(below, field, lacks, findings)
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
