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
from dogbot_logtool.core.checks import base, beside, clock, feet, poses, sensors
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.loads import vertical_is_known
from dogbot_logtool.core.metrics import NEEDS, WalkMetrics
from dogbot_logtool.core.metrics import Check as Question
from dogbot_logtool.core.records import Field, KeyPath, values
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Severity

Check = Callable[[Walk], Iterator[Finding]]
MODULES: Final = (clock, base, poses, sensors, feet, beside)
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
    for name, lack, obstacle in _questions(walk):
        against = next((each.text for each in doubts if name in each.fails), "")
        answers = ("failed", against), ("does not apply", lack), ("not made", obstacle)
        outcome, reason = next((each for each in answers if each[1]), ("passed", None))
        made.append(Question(name, outcome, reason))
    return tuple(made)


def _questions(walk: Walk) -> Sequence[tuple[str, str, str]]:
    """Return each question, what the log lacks for it, and why else it cannot be answered."""
    records = walk.records
    forced = [row for row, each in enumerate(records) if each.has_force]
    assumed = (walk.settings.feet[row].level.reason for row in forced)
    odd_legs = (leg.reason for leg in walk.legs.feet) if walk.legs else ()
    seen = any(each.start is not None for each in records)
    posed = len(walk.base_history.time)
    pointed = any(len(each.track.contact_points[0]) for each in records)
    no_feet = "" if seen else "the log has no usable messages of feet"
    no_poses = "" if posed else "the log has no usable poses"
    no_points = "" if pointed else "the sensors report no contact points"
    no_forces = "" if forced else "the sensors report no forces"
    no_worlds = "" if walk.worlds else "two feet are not seen to touch near poses for a second each"
    compared, mass = walk.loads.vertical_impulse_over_weight is not None, walk.settings.mass_kg
    lacking = "the vertical load of all feet" if mass else "the mass"
    no_weight = "" if compared else f"{lacking} is not known"
    no_legs = "" if walk.legs else "nothing tells of the legs"
    no_stamps, one_clock, few_stamps = _clocks(walk)
    return (
        ("every foot's sensor works", no_feet, ""),
        ("what sensors read without load is known", no_forces, next(filter(None, assumed), "")),
        ("the base's poses are sound", no_poses, ""),
        ("header stamps are sound", no_stamps, ""),
        ("all topics have one clock", one_clock, few_stamps),
        ("no topic is silent for long", "", ""),
        ("contacts are where the base is", no_poses or no_points, no_worlds),
        ("the base moves as the feet step", no_feet or no_poses, ""),
        ("the feet carry the weight", no_forces, no_weight),
        ("nothing contradicts the accelerometer", *_accelerometer(walk, no_poses)),
        ("the legs move as the feet step", no_legs, next(filter(None, odd_legs), "")),
    )


def _clocks(walk: Walk) -> tuple[str, str, str]:
    """Say that there are no stamps, no two clocks, or too few stamps to compare clocks."""
    topics = {foot.topic for foot in walk.feet if foot.record.start is not None}
    if len(walk.base_history.time):
        topics.add(walk.settings.odometry_topic)
    used = [topic for topic in walk.corrected.topics if topic.topic in topics]
    bare = ", ".join(topic.topic for topic in used if topic.zero_stamps is None)
    apart = ", ".join(sorted(topics - {each.topic for each in walk.corrected.clocks}))
    no_stamps = f"messages of {bare} have no header stamps" if bare else ""
    one_clock = no_stamps
    if len(topics) < 2:
        one_clock = "there is only one topic"
    elif used and all(topic.clock_offset_s == 0.0 for topic in used):
        one_clock = "log times are the header stamps"
    few_stamps = f"too little time with header stamps in common: {apart}" if apart else ""
    return no_stamps, one_clock, few_stamps


def _accelerometer(walk: Walk, no_poses: str) -> tuple[str, str]:
    if not walk.settings.imu_topic:
        return "the log has no accelerometer of the base", ""
    if walk.imu is None:
        return no_poses, "accelerometer and poses are not known together for 2 s"
    undecided = walk.imu.reading in {"nothing", "unclear"}
    return no_poses, "it does not follow the base's attitude" if undecided else ""


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
