"""Figures of the legs: swings of the feet, work; those of joints are beside (`joints.py`)."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from dogbot_logtool.core.geometry.aggregates import aggregate
from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.report.figures.feet import cycle_figures
from dogbot_logtool.report.figures.figure import Column, Figure, Kind, Scope, Shape, TableName
from dogbot_logtool.report.figures.foot_source import FootSource
from dogbot_logtool.report.figures.joints import ASYMMETRY, JOINT, NO_SIGN, NO_STRIDE, NO_WORK

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.leg_figures import LegFigures, LegFoot

_LEGS: Final = TableName.LEGS
_NO_PATH: Final = (
    "nothing tells of the foot's leg, or its frame is not at rest in stances (see findings)"
)
_NO_STEP: Final = f"{_NO_PATH}; the other foot's leg is not known"
_NO_VELOCITY: Final = (
    f"{_NO_PATH}; the leg or the foot's contact is told less often than 100 times a second; the "
    "swing is shorter"
)
_NO_LEG_WORK: Final = f"no joint is known to be of this leg; {NO_WORK}"


def _of_stride(
    key: str,
    of: "Callable[[LegFoot], Floats]",
    texts: tuple[str, str],
    column: Column,
) -> "tuple[Figure[LegFoot], Figure[FootSource]]":
    """Return a figure of a foot, aggregated over its strides, and the same of each stride.

    Args:
        key: of both.
        of: takes the values of all strides.
        texts: the definition, and when it is not known.
        column: shows the aggregate.
    """
    definition, null = texts
    aggregated: Figure[LegFoot] = Figure(
        key,
        Kind.AGGREGATE,
        lambda leg: aggregate(of(leg)),
        definition,
        f"{null}; {NO_STRIDE}",
        columns=(column,),
    )
    rows = Figure(
        key,
        Kind.COLUMN,
        _stride_values(of),
        definition,
        f"{null}; the leg is silent in the stride",
    )
    return aggregated, rows


def _stride_values(of: "Callable[[LegFoot], Floats]") -> Callable[[FootSource], Floats]:
    def column(source: FootSource) -> Floats:
        legs = source.stats.legs
        unknown = np.full(len(source.foot.strides.stance), np.nan)
        found = unknown if legs is None else of(legs.feet[source.row])
        # One NaN for all: tables are compared to the bit.
        return np.where(np.isnan(found), np.nan, found)

    return column


_CLEARANCE: Final = (
    "highest point of a swing above the straight line between the foot's places in the middle of "
    "the stances before and after"
)
_DOWN: Final = (
    "downward velocity of the foot one contact sample before the touchdown that ends the stride: "
    "slope there of the parabola that fits its places of the 30 ms before (at least four)"
)
_ALONG: Final = "horizontal speed of the foot, likewise"
_LENGTH: Final = "horizontal distance of the foot's places in the stances before and after a swing"
_STEP: Final = (
    "way from the footfall of the other foot of the pair to the own one, along the foot's swing"
)
_WIDTH: Final = "the same across it"

_OF_STRIDES: Final = (
    _of_stride(
        "clearance_m",
        lambda leg: leg.swings.clearance_m,
        (_CLEARANCE, _NO_PATH),
        Column(_LEGS, "clearance", 1, scale=1e3),
    ),
    _of_stride(
        "swing_length_m",
        lambda leg: leg.swings.length_m,
        (_LENGTH, _NO_PATH),
        Column(_LEGS, "swing m", 3),
    ),
    _of_stride(
        "step_length_m",
        lambda leg: leg.steps.length_m,
        (_STEP, _NO_STEP),
        Column(_LEGS, "step m", 3),
    ),
    _of_stride(
        "step_width_m",
        lambda leg: leg.steps.width_m,
        (_WIDTH, _NO_STEP),
        Column(_LEGS, "width m", 3),
    ),
    _of_stride(
        "touchdown_down_mps",
        lambda leg: leg.swings.touchdown_down_mps,
        (_DOWN, _NO_VELOCITY),
        Column(_LEGS, "down m/s", 3),
    ),
    _of_stride(
        "touchdown_along_mps",
        lambda leg: leg.swings.touchdown_along_mps,
        (_ALONG, _NO_VELOCITY),
        Column(_LEGS, "along m/s", 3),
    ),
    _of_stride(
        "positive_work_j",
        lambda leg: leg.work.positive_j,
        (
            "positive work of the leg's joints in a stride of the foot",
            f"{_NO_LEG_WORK}; {NO_SIGN}",
        ),
        Column(_LEGS, "work+ J", 2),
    ),
    _of_stride(
        "absolute_work_j",
        lambda leg: leg.work.absolute_j,
        ("absolute work of the leg's joints in a stride of the foot", _NO_LEG_WORK),
        Column(_LEGS, "|work| J", 2),
    ),
)

_HEIGHT: Final = cycle_figures("m")
_FOOT: "Final[Sequence[Figure[LegFoot] | Scope]]" = (
    Figure(
        "frame",
        Kind.TEXT,
        lambda leg: leg.frame or None,
        "frame that is followed",
        null="nothing connects a frame of the foot with the base",
    ),
    Figure(
        "point",
        Kind.TEXT,
        lambda leg: ("contact_point" if leg.touches else "origin") if leg.frame else None,
        "point of that frame: where contacts or the robot's file say that the foot touches the "
        "ground, or the frame's origin (the middle of a ball rolls with it)",
        null="nothing connects a frame of the foot with the base",
        choices=("contact_point", "origin"),
    ),
    Figure(
        "frame_travel_m",
        Kind.AGGREGATE,
        lambda leg: leg.travel_m,
        "distance of the point from itself at 20 % and at 80 % of a stance: near 0 where the frame "
        "is the foot's and the odometry does not drift",
        null="nothing tells of the foot's leg in a whole stance",
        columns=(Column(_LEGS, "at rest", 1, scale=1e3, rank=110),),
    ),
    *(aggregated for aggregated, _ in _OF_STRIDES),
    Scope(
        "height_over_stride_m",
        _HEIGHT,
        lambda leg: leg.swings.height,
        "height of the foot above the line of its clearance, from touchdown to touchdown",
        null=f"{_NO_PATH}; {NO_STRIDE}",
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
        _kinematics,
        "what places the feet: joint states with the log's robot description, or its transforms",
        null="nothing connects the feet with the base",
        choices=("joint_states", "transforms"),
    ),
    Figure(
        "positive_work_j",
        Kind.AGGREGATE,
        lambda legs: aggregate(legs.work.positive_j),
        "positive work of all joints that tell an effort, in a stride of the reference foot",
        null=f"{NO_WORK}; {NO_SIGN}; {NO_STRIDE}",
    ),
    Figure(
        "absolute_work_j",
        Kind.AGGREGATE,
        lambda legs: aggregate(legs.work.absolute_j),
        "absolute work of them in the same",
        null=f"{NO_WORK}; {NO_STRIDE}",
    ),
    Figure(
        "mechanical_cost_of_transport",
        Kind.AMOUNT,
        lambda legs: legs.cost_of_transport,
        "absolute mechanical work of the joints / (m g d), summed over strides of the reference "
        "foot; d: their length. It is no electrical cost: no losses of motors and electronics",
        null=f"{NO_WORK}; {NO_STRIDE}; the mass or the odometry is not known; the way is below "
        "0.1 m",
        columns=(Column(TableName.LOG_ROWS, "mechanical_cost_of_transport", rank=70),),
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
        ASYMMETRY,
        lambda legs: legs.pairs,
        "right against left of joints whose names differ in the side only, by pair",
        shape=Shape.BY_NAME,
    ),
)
"""Figures of a `LegFigures`."""


LEG_STRIDES: Final[Sequence[Figure[FootSource]]] = tuple(rows for _, rows in _OF_STRIDES)
"""Figures of the strides of a `FootSource`, like `STRIDES`."""
