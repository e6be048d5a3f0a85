"""Figures of joints: range, speed, effort, work, motion over the gait cycle, left and right."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dogbot_logtool.core.geometry.aggregates import aggregate
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.load.load_figures import symmetry_index_percent
from dogbot_logtool.report.figures.figure import Column, Figure, Kind, Scope, TableName, points

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joint_cycles import JointCurve
    from dogbot_logtool.core.legs.leg_figures import LegJoint

_JOINTS: Final = TableName.JOINTS
NO_STRIDE: Final = "the foot makes no whole stride in which its leg is told without a silence"
NO_WORK: Final = (
    "the efforts of joint states are empty, constant or no torques; positions are no angles in "
    "rad; velocities contradict positions; joint states come too rarely; clocks differ (see "
    "findings)"
)
NO_SIGN: Final = "the log contradicts the sign of an effort (see findings)"
_NO_EFFORT: Final = (
    "no message tells an effort of the joint, or all tell zero, or the same while it moves"
)
_NO_VALUES: Final = "joint states contradict each other or the ground's forces (see findings)"
_UNIT, _EFFORT_UNIT, _SPEED_UNIT = "rad or m", "N m or N", "rad/s or m/s"
_SPREAD: Final = "standard deviation over strides (divisor n)"
_CURVE: "Final[Sequence[Figure[JointCurve]]]" = (
    Figure("n", Kind.COUNT, lambda curve: curve.number, "number of strides"),
    points("percent", lambda curve: curve.percent, "of the stride", "%"),
    points("position", lambda curve: curve.median, "mean over strides", _UNIT),
)


def _rms(joint: "LegJoint") -> float | None:
    history = joint.history
    if not history.has_effort or history.effort_s <= 0.0:
        return None
    return float(np.sqrt(history.squared_effort / history.effort_s))


def _effort(joint: "LegJoint") -> float | None:
    return joint.history.peak_effort if joint.history.has_effort else None


def _near_limit(joint: "LegJoint") -> float | None:
    history = joint.history
    if not history.has_limits or history.known_s <= 0.0:
        return None
    return min(history.near_limit_s / history.known_s, 1.0)


def _absolute_work(joint: "LegJoint") -> float | None:
    known = joint.history.has_effort and joint.values_known
    return joint.history.absolute_work_j if known else None


JOINT: "Final[Sequence[Figure[LegJoint] | Scope]]" = (
    Figure(
        "foot",
        Kind.TEXT,
        lambda joint: joint.foot or None,
        "foot that it moves: by the robot description, else by names",
        null="it is of no leg, or nothing tells of which",
    ),
    Figure(
        "range_of_motion",
        Kind.AMOUNT,
        lambda joint: joint.range_of_motion,
        "of its position in the log",
        unit=_UNIT,
        columns=(Column(_JOINTS, "range", 3),),
    ),
    Figure(
        "peak_speed",
        Kind.AMOUNT,
        lambda joint: joint.history.peak_speed,
        "highest speed, as messages tell it, or by the differences of positions where all tell "
        "zero or none",
        unit=_SPEED_UNIT,
        columns=(Column(_JOINTS, "peak speed", 2),),
    ),
    Figure(
        "peak_effort",
        Kind.AMOUNT,
        _effort,
        "largest magnitude of its effort, as recorded",
        unit=_EFFORT_UNIT,
        null=_NO_EFFORT,
        columns=(Column(_JOINTS, "peak N m", 2),),
    ),
    Figure(
        "rms_effort",
        Kind.AMOUNT,
        _rms,
        "square root of the mean squared effort over all time known (trapezoid)",
        unit=_EFFORT_UNIT,
        null=_NO_EFFORT,
        columns=(Column(_JOINTS, "RMS N m", 2),),
    ),
    Figure(
        "absolute_work_j",
        Kind.AMOUNT,
        _absolute_work,
        "absolute work in the whole log: integral of the magnitude of effort times velocity "
        "(trapezoid), or mean effort times the way between states where no velocity is told; "
        "silences above 0.1 s left out",
        null=f"{_NO_EFFORT}; {_NO_VALUES}",
        columns=(Column(_JOINTS, "|work| J", 2),),
    ),
    Figure(
        "near_limit_fraction",
        Kind.FRACTION,
        _near_limit,
        "share of the time within 2 % of the range from an end, or above 95 % of the effort or "
        "speed that the robot description allows",
        null="the log has no robot description with limits of this joint",
        columns=(Column(_JOINTS, "near limit", percent=True),),
    ),
    Scope(
        "over_stride",
        _CURVE,
        lambda joint: joint.curve,
        "its usual motion over the strides of its foot",
        null=f"nothing tells which foot it moves; clocks differ; {NO_STRIDE}",
    ),
)

_Pair = tuple[Any, "LegJoint", "LegJoint"]


def _index(of: "Callable[[LegJoint], float | None]") -> Callable[[_Pair], float | None]:
    def index(pair: _Pair) -> float | None:
        _, left, right = pair
        return symmetry_index_percent(of(left), of(right))

    return index


def _median(values: Floats) -> float | None:
    found = aggregate(values)
    return None if found is None else found.median


_NO_INDEX: Final = "not known of both joints; both are 0"
ASYMMETRY: "Final[Sequence[Figure[_Pair]]]" = (
    Figure("left", Kind.TEXT, lambda pair: pair[1].history.name, "joint on the left"),
    Figure("right", Kind.TEXT, lambda pair: pair[2].history.name, "joint on the right"),
    Figure(
        "range_of_motion",
        Kind.NUMBER,
        _index(lambda joint: None if joint.curve is None else _median(joint.curve.ranges)),
        "symmetry index of the median range of motion in a stride: 100 (right - left) / their mean "
        "(Robinson, Herzog, Nigg 1987)",
        unit="%",
        null=_NO_INDEX,
    ),
    Figure(
        "rms_effort",
        Kind.NUMBER,
        _index(_rms),
        "the same of `rms_effort`",
        unit="%",
        null=_NO_INDEX,
    ),
    Figure(
        "absolute_work",
        Kind.NUMBER,
        _index(lambda joint: _median(joint.work.absolute_j)),
        "the same of the median absolute work in a stride",
        unit="%",
        null=_NO_INDEX,
    ),
)
