"""Metrics of joints and their work."""

from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core.arrays import aggregate, median_of
from dogbot_logtool.core.load.load_figures import symmetry_index_percent
from dogbot_logtool.core.metrics import Joint, Legs
from dogbot_logtool.core.records import Curve, Number, Shape, unknown

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joint_cycles import JointCurve
    from dogbot_logtool.core.legs.leg_figures import LegFigures, LegJoint


def legs_metrics(legs: "LegFigures | None") -> Legs:
    """Return the metrics of all joints over the whole log."""
    if legs is None:
        return unknown(Legs)
    return Legs(
        absolute_work_j=aggregate(legs.work.absolute_j),
        positive_work_j=aggregate(legs.work.positive_j),
        mechanical_cost_of_transport=legs.cost_of_transport,
        joints={joint.history.name: _joint(joint) for joint in legs.joints},
        asymmetry_percent={
            name: index
            for name, (_, left, right) in legs.pairs.items()
            if (index := symmetry_index_percent(_usual_range(left), _usual_range(right)))
            is not None
        },
    )


def _joint(joint: "LegJoint") -> Joint:
    history = joint.history
    effort = history.has_effort
    return Joint(
        foot=joint.foot or None,
        range_of_motion=joint.range_of_motion,
        peak_speed=history.peak_speed,
        peak_effort=history.peak_effort if effort else None,
        rms_effort=(
            float(np.sqrt(history.squared_effort / history.effort_s))
            if effort and history.effort_s > 0.0
            else None
        ),
        absolute_work_j=history.absolute_work_j if effort and joint.values_known else None,
        near_limit_fraction=_near_limit(joint),
        position_over_stride=_curve(joint.curve),
    )


def _near_limit(joint: "LegJoint") -> Number:
    history = joint.history
    if not history.has_limits or history.known_s <= 0.0:
        return None
    return min(history.near_limit_s / history.known_s, 1.0)


def _curve(curve: "JointCurve | None") -> Shape:
    if curve is None:
        return None
    parts = (curve.percent, curve.lower, curve.median, curve.upper)
    return Curve(*(tuple(each.tolist()) for each in parts))


def _usual_range(joint: "LegJoint") -> Number:
    """Return the median range of motion in a stride, rad or m."""
    if joint.curve is None:
        return None
    known = joint.curve.ranges[np.isfinite(joint.curve.ranges)]
    return float(median_of(known)) if len(known) else None
