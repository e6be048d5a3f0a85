"""Figures of the legs: swings of the feet, joints, work."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dogbot_logtool.core.gait.cycle_curves import CycleCurve
from dogbot_logtool.core.geometry.aggregates import aggregate
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.load.load_figures import symmetry_index_percent
from dogbot_logtool.report.figures.figure import Column, Figure, Kind, Scope, Shape, TableName
from dogbot_logtool.report.figures.foot_source import FootSource

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joint_cycles import JointCurve
    from dogbot_logtool.core.legs.joint_track import JointHistory
    from dogbot_logtool.core.legs.leg_figures import LegFigures, LegFoot, LegJoint

_LEGS, _JOINTS, _ROWS = TableName.LEGS, TableName.JOINTS, TableName.STRIDE_ROWS
_NO_PATH: Final = (
    "nothing tells of the foot's leg, or its frame is not at rest in stances (see findings)"
)
_NO_STRIDE: Final = "the foot makes no whole stride in which its leg is told without a silence"
_NO_SWING: Final = f"{_NO_PATH}; {_NO_STRIDE}"
_SLOW: Final = (
    "the leg or the foot's contact is told less often than 100 times a second; the swing is shorter"
)
_NO_WORK: Final = (
    "the efforts of joint states are empty, constantly zero or no torques; velocities contradict "
    "positions; clocks differ (see findings)"
)
_NO_EFFORT: Final = "no message tells an effort of the joint, or all tell zero"
_UNIT, _EFFORT_UNIT, _SPEED_UNIT = "rad or m", "N m or N", "rad/s or m/s"


def _swing(
    key: str, unit: str, of: "Callable[[LegFoot], Floats]", definition: str, column: Column
) -> "Figure[LegFoot]":
    """Return a figure of a foot's strides."""
    null = f"{_NO_SWING}; {_SLOW}" if "touchdown" in key else _NO_SWING
    null = f"{_NO_SWING}; the other foot's leg is not known" if "step" in key else null
    return Figure(
        key,
        Kind.AGGREGATE,
        unit,
        lambda leg: aggregate(of(leg)),
        definition,
        null,
        columns=(column,),
    )


_CLEARANCE: Final = (
    "highest point of a swing above the straight line between the foot's places in the middle of "
    "the stances before and after"
)
_DOWN: Final = (
    "downward velocity of the foot at the touchdown, one contact sample before it: slope there of "
    "the parabola that fits its places of the 30 ms before (at least four)"
)
_ALONG: Final = "horizontal speed of the foot, likewise"
_LENGTH: Final = "horizontal distance of the foot's places in the stances before and after a swing"
_STEP: Final = (
    "way from the footfall of the other foot of the pair to the own one, along the foot's swing"
)
_WIDTH: Final = "the same across it"

_HEIGHT: Final[Sequence[Figure[CycleCurve]]] = (
    Figure("n", Kind.COUNT, "", lambda curve: curve.number, "number of strides"),
    Figure("percent", Kind.NUMBERS, "%", lambda curve: curve.percent.tolist(), "of the stride"),
    Figure("median", Kind.NUMBERS, "m", lambda curve: curve.median.tolist(), "median"),
    Figure(
        "lower_quartile", Kind.NUMBERS, "m", lambda curve: curve.lower.tolist(), "a quarter below"
    ),
    Figure(
        "upper_quartile", Kind.NUMBERS, "m", lambda curve: curve.upper.tolist(), "a quarter above"
    ),
)
_FOOT: "Final[Sequence[Figure[LegFoot] | Scope]]" = (
    Figure(
        "frame",
        Kind.TEXT,
        "",
        lambda leg: leg.frame or None,
        "frame that is followed",
        null="nothing connects a frame of the foot with the base",
    ),
    Figure(
        "point",
        Kind.TEXT,
        "",
        lambda leg: ("contact_point" if leg.touches else "origin") if leg.frame else None,
        "point of that frame: where contacts or the robot's file say that the foot touches the "
        "ground, or the frame's origin (the middle of a ball rolls with it)",
        null="nothing connects a frame of the foot with the base",
        choices=("contact_point", "origin"),
    ),
    Figure(
        "frame_travel_m",
        Kind.AGGREGATE,
        "m",
        lambda leg: leg.travel_m,
        "distance of the point from itself at 20 % and at 80 % of a stance: near 0 where the frame "
        "is the foot's and the odometry does not drift",
        null="nothing tells of the foot's leg in a whole stance",
        columns=(Column(_LEGS, "at rest", 1, scale=1e3, rank=110),),
    ),
    _swing(
        "clearance_m",
        "m",
        lambda leg: leg.swings.clearance_m,
        _CLEARANCE,
        Column(_LEGS, "clearance", 1, scale=1e3),
    ),
    _swing(
        "swing_length_m",
        "m",
        lambda leg: leg.swings.length_m,
        _LENGTH,
        Column(_LEGS, "swing m", 3),
    ),
    _swing("step_length_m", "m", lambda leg: leg.steps.length_m, _STEP, Column(_LEGS, "step m", 3)),
    _swing("step_width_m", "m", lambda leg: leg.steps.width_m, _WIDTH, Column(_LEGS, "width m", 3)),
    _swing(
        "touchdown_down_mps",
        "m/s",
        lambda leg: leg.swings.touchdown_down_mps,
        _DOWN,
        Column(_LEGS, "down m/s", 3),
    ),
    _swing(
        "touchdown_along_mps",
        "m/s",
        lambda leg: leg.swings.touchdown_along_mps,
        _ALONG,
        Column(_LEGS, "along m/s", 3),
    ),
    Figure(
        "positive_work_j",
        Kind.AGGREGATE,
        "J",
        lambda leg: aggregate(leg.work.positive_j),
        "positive work of the leg's joints in a stride of the foot",
        null=f"no joint is known to be of this leg; {_NO_WORK}; {_NO_STRIDE}",
        columns=(Column(_LEGS, "work+ J", 2),),
    ),
    Figure(
        "absolute_work_j",
        Kind.AGGREGATE,
        "J",
        lambda leg: aggregate(leg.work.absolute_j),
        "absolute work of the leg's joints in a stride of the foot",
        null=f"no joint is known to be of this leg; {_NO_WORK}; {_NO_STRIDE}",
        columns=(Column(_LEGS, "|work| J", 2),),
    ),
    Scope(
        "height_over_stride_m",
        _HEIGHT,
        lambda leg: leg.swings.height,
        "height of the foot above the line of its clearance, from touchdown to touchdown",
        null=_NO_SWING,
    ),
)
_CURVE: "Final[Sequence[Figure[JointCurve]]]" = (
    Figure("n", Kind.COUNT, "", lambda curve: curve.number, "number of strides"),
    Figure("percent", Kind.NUMBERS, "%", lambda curve: curve.percent.tolist(), "of the stride"),
    Figure(
        "position", Kind.NUMBERS, _UNIT, lambda curve: curve.position.tolist(), "mean over strides"
    ),
    Figure(
        "position_sd",
        Kind.NUMBERS,
        _UNIT,
        lambda curve: curve.position_sd.tolist(),
        "standard deviation over strides (divisor n)",
    ),
    Figure(
        "effort",
        Kind.NUMBERS,
        _EFFORT_UNIT,
        lambda curve: None if curve.effort is None else curve.effort.tolist(),
        "mean over strides",
        null=_NO_EFFORT,
    ),
    Figure(
        "effort_sd",
        Kind.NUMBERS,
        _EFFORT_UNIT,
        lambda curve: None if curve.effort_sd is None else curve.effort_sd.tolist(),
        "standard deviation over strides (divisor n)",
        null=_NO_EFFORT,
    ),
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


def _done(of: "Callable[[JointHistory], float]") -> "Callable[[LegJoint], float | None]":
    return lambda joint: of(joint.history) if joint.history.has_effort else None


JOINT: "Final[Sequence[Figure[LegJoint] | Scope]]" = (
    Figure(
        "foot",
        Kind.TEXT,
        "",
        lambda joint: joint.foot or None,
        "foot that it moves: by the robot description, else by names",
        null="it is of no leg, or nothing tells of which",
    ),
    Figure("topic", Kind.TEXT, "", lambda joint: joint.history.topic, "of its states"),
    Figure(
        "messages", Kind.COUNT, "", lambda joint: joint.history.messages, "that tell its position"
    ),
    Figure(
        "lowest_position",
        Kind.NUMBER,
        _UNIT,
        lambda joint: joint.history.lowest,
        "in the log",
        columns=(Column(_JOINTS, "lowest", 3),),
    ),
    Figure(
        "highest_position",
        Kind.NUMBER,
        _UNIT,
        lambda joint: joint.history.highest,
        "in the log",
        columns=(Column(_JOINTS, "highest", 3),),
    ),
    Figure(
        "range_of_motion",
        Kind.AMOUNT,
        _UNIT,
        lambda joint: joint.range_of_motion,
        "`highest_position` - `lowest_position`",
        columns=(Column(_JOINTS, "range", 3),),
    ),
    Figure(
        "stride_range_of_motion",
        Kind.AGGREGATE,
        _UNIT,
        lambda joint: None if joint.curve is None else aggregate(joint.curve.ranges),
        "range of its position in a stride of its foot",
        null=f"nothing tells which foot it moves; {_NO_STRIDE}",
        columns=(Column(_JOINTS, "range/stride", 3),),
    ),
    Figure(
        "peak_speed",
        Kind.AMOUNT,
        _SPEED_UNIT,
        lambda joint: joint.history.peak_speed,
        "highest speed, as messages tell it or by the differences of positions: see "
        "`velocity_source`",
        columns=(Column(_JOINTS, "peak speed", 2),),
    ),
    Figure(
        "velocity_source",
        Kind.TEXT,
        "",
        lambda joint: "messages" if joint.history.velocity_told else "differences",
        "whether messages tell velocities that are not all zero, or positions are differenced",
        choices=("messages", "differences"),
    ),
    Figure(
        "peak_effort",
        Kind.AMOUNT,
        _EFFORT_UNIT,
        _effort,
        "largest magnitude of its effort, as recorded",
        null=_NO_EFFORT,
        columns=(Column(_JOINTS, "peak N m", 2),),
    ),
    Figure(
        "rms_effort",
        Kind.AMOUNT,
        _EFFORT_UNIT,
        _rms,
        "square root of the mean squared effort over all time known (trapezoid)",
        null=_NO_EFFORT,
        columns=(Column(_JOINTS, "RMS N m", 2),),
    ),
    Figure(
        "positive_work_j",
        Kind.AMOUNT,
        "J",
        _done(lambda history: history.positive_work_j),
        "positive work in the whole log: integral of effort times velocity where that is positive "
        "(trapezoid), or mean effort times the way between states where no velocity is told; "
        "silences above 0.1 s left out",
        null=_NO_EFFORT,
    ),
    Figure(
        "absolute_work_j",
        Kind.AMOUNT,
        "J",
        _done(lambda history: history.absolute_work_j),
        "the same of the magnitude of the power",
        null=_NO_EFFORT,
    ),
    Figure(
        "stride_positive_work_j",
        Kind.AGGREGATE,
        "J",
        lambda joint: aggregate(joint.work.positive_j),
        "positive work in a stride of its foot, or of the reference foot",
        null=f"{_NO_EFFORT}; {_NO_WORK}; {_NO_STRIDE}",
        columns=(Column(_JOINTS, "work+ J", 2),),
    ),
    Figure(
        "stride_absolute_work_j",
        Kind.AGGREGATE,
        "J",
        lambda joint: aggregate(joint.work.absolute_j),
        "absolute work in the same",
        null=f"{_NO_EFFORT}; {_NO_WORK}; {_NO_STRIDE}",
        columns=(Column(_JOINTS, "|work| J", 2),),
    ),
    Figure(
        "near_limit_fraction",
        Kind.FRACTION,
        "",
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
        null=f"nothing tells which foot it moves; clocks differ; {_NO_STRIDE}",
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
_ASYMMETRY: "Final[Sequence[Figure[_Pair]]]" = (
    Figure("left", Kind.TEXT, "", lambda pair: pair[1].history.name, "joint on the left"),
    Figure("right", Kind.TEXT, "", lambda pair: pair[2].history.name, "joint on the right"),
    Figure(
        "range_of_motion",
        Kind.NUMBER,
        "%",
        _index(lambda joint: None if joint.curve is None else _median(joint.curve.ranges)),
        "symmetry index of the median `stride_range_of_motion`: 100 (right - left) / their mean "
        "(Robinson, Herzog, Nigg 1987)",
        null=_NO_INDEX,
    ),
    Figure(
        "rms_effort", Kind.NUMBER, "%", _index(_rms), "the same of `rms_effort`", null=_NO_INDEX
    ),
    Figure(
        "absolute_work",
        Kind.NUMBER,
        "%",
        _index(lambda joint: _median(joint.work.absolute_j)),
        "the same of the median `stride_absolute_work_j`",
        null=_NO_INDEX,
    ),
)


def _kinematics(legs: "LegFigures") -> str | None:
    if not any(chain is not None for chain in legs.settings.chains):
        return None
    return "joint_states" if legs.settings.by_joints else "transforms"


LEGS: "Final[Sequence[Figure[LegFigures] | Scope]]" = (
    Figure(
        "kinematics",
        Kind.TEXT,
        "",
        _kinematics,
        "what places the feet: joint states with the log's robot description, or its transforms",
        null="nothing connects the feet with the base",
        choices=("joint_states", "transforms"),
    ),
    Figure(
        "positive_work_j",
        Kind.AGGREGATE,
        "J",
        lambda legs: aggregate(legs.work.positive_j),
        "positive work of all joints that tell an effort, in a stride of the reference foot",
        null=f"{_NO_WORK}; {_NO_STRIDE}",
    ),
    Figure(
        "absolute_work_j",
        Kind.AGGREGATE,
        "J",
        lambda legs: aggregate(legs.work.absolute_j),
        "absolute work of them in the same",
        null=f"{_NO_WORK}; {_NO_STRIDE}",
    ),
    Figure(
        "mechanical_cost_of_transport",
        Kind.AMOUNT,
        "",
        lambda legs: legs.cost_of_transport,
        "absolute mechanical work of the joints / (m g d), summed over strides of the reference "
        "foot; d: their length. It is no electrical cost: no losses of motors and electronics",
        null=f"{_NO_WORK}; {_NO_STRIDE}; the mass or the odometry is not known; the way is below "
        "0.1 m",
        columns=(Column(TableName.LOG_ROWS, "mechanical_cost_of_transport", rank=70),),
    ),
    Figure(
        "idle_joints",
        Kind.COUNT,
        "",
        lambda legs: legs.idle,
        "joints of no leg that move by less than 0.02 rad or m; they are not listed",
    ),
    Scope(
        "feet",
        _FOOT,
        lambda legs: {leg.name: leg for leg in legs.feet},
        "swings of each foot, and work of its leg",
        shape=Shape.BY_NAME,
    ),
    Scope(
        "joints",
        JOINT,
        lambda legs: {joint.history.name: joint for joint in legs.joints},
        "each joint",
        shape=Shape.BY_NAME,
    ),
    Scope(
        "asymmetry_percent",
        _ASYMMETRY,
        lambda legs: legs.pairs,
        "right against left of joints whose names differ in the side only, by pair",
        shape=Shape.BY_NAME,
    ),
)
"""Of a `LegFigures`."""


def _of_strides(of: "Callable[[LegFoot], Floats]") -> Callable[[FootSource], Floats]:
    def column(source: FootSource) -> Floats:
        legs = source.stats.legs
        unknown = np.full(len(source.foot.strides.stance), np.nan)
        found = unknown if legs is None else of(legs.feet[source.row])
        # One NaN for all: tables are compared to the bit.
        return np.where(np.isnan(found), np.nan, found)

    return column


def _stride(
    key: str, unit: str, of: "Callable[[LegFoot], Floats]", definition: str, null: str
) -> Figure[FootSource]:
    columns = (Column(_ROWS, key),)
    return Figure(key, Kind.COLUMN, unit, _of_strides(of), definition, null, columns=columns)


LEG_STRIDES: Final[Sequence[Figure[FootSource]]] = (
    _stride("clearance_m", "m", lambda leg: leg.swings.clearance_m, _CLEARANCE, _NO_SWING),
    _stride("swing_length_m", "m", lambda leg: leg.swings.length_m, _LENGTH, _NO_SWING),
    _stride("step_length_m", "m", lambda leg: leg.steps.length_m, _STEP, _NO_SWING),
    _stride("step_width_m", "m", lambda leg: leg.steps.width_m, _WIDTH, _NO_SWING),
    _stride(
        "touchdown_down_mps",
        "m/s",
        lambda leg: leg.swings.touchdown_down_mps,
        f"{_DOWN} that ends the stride",
        f"{_NO_SWING}; {_SLOW}",
    ),
    _stride(
        "touchdown_along_mps",
        "m/s",
        lambda leg: leg.swings.touchdown_along_mps,
        _ALONG,
        f"{_NO_SWING}; {_SLOW}",
    ),
    _stride(
        "positive_work_j",
        "J",
        lambda leg: leg.work.positive_j,
        "positive work of the leg's joints in the stride",
        _NO_WORK,
    ),
    _stride(
        "absolute_work_j",
        "J",
        lambda leg: leg.work.absolute_j,
        "absolute work of the leg's joints in the stride",
        _NO_WORK,
    ),
)
"""Figures of the strides of a `FootSource`, like `STRIDES`."""
