"""Metrics of each foot."""

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, aggregate
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.legs.leg_figures import LegFoot
from dogbot_logtool.core.metrics import Foot, Planned
from dogbot_logtool.core.records import Numbers, Shape, Spread
from dogbot_logtool.core.walk_metrics.span import Span
from dogbot_logtool.core.walk_metrics.values import curve_of, scaled, seconds

_SLIP_FROM: Final[Mapping[str, str]] = {"contact_points": "points", "foot_frame": "foot_frame"}
_SWINGS: Final[Mapping[str, Callable[[LegFoot], Floats]]] = {
    "step_length_m": lambda leg: leg.steps.length_m,
    "step_width_m": lambda leg: leg.steps.width_m,
    "clearance_m": lambda leg: leg.swings.clearance_m,
    "swing_length_m": lambda leg: leg.swings.length_m,
    "touchdown_down_mps": lambda leg: leg.swings.touchdown_down_mps,
    "touchdown_along_mps": lambda leg: leg.swings.touchdown_along_mps,
}
"""What tells each metric of swings, a value a stride."""


def feet_metrics(span: Span) -> dict[str, Foot]:
    """Return the metrics of each foot over a span, by its name."""
    return {foot.name: _foot(span, row, foot) for row, foot in enumerate(span.feet)}


def _foot(span: Span, row: int, foot: FootStatistics) -> Foot:
    weight = span.stats.loads.weight_n
    per_weight = None if weight is None else 1.0 / weight
    swings, height = _swings(span, row)
    curves = foot.force_curves
    return Foot(
        contact_fraction=foot.contact_fraction,
        strides=len(foot.strides.stance),
        stance_s=foot.stance_s,
        swing_s=foot.swing_s,
        stride_period_s=foot.stride_period_s,
        duty_factor=foot.duty_factor,
        stride_frequency_hz=foot.stride_frequency_hz,
        stride_length_m=foot.stride_length_m,
        stride_length_from=None if foot.stride_length_m is None else "base",
        **swings,
        height_over_stride_m=height,
        contact_travel_m=foot.contact_travel_m,
        slip_m=foot.slip_distance_m,
        slip_largest_m=foot.largest_slip_m,
        slip_from=_SLIP_FROM.get(foot.slip_source or ""),
        touchdown_s=_times(span, foot.touchdown),
        lift_off_s=_times(span, foot.liftoff),
        planned=_planned(span, row),
        peak_force_n=foot.peak_force_n,
        peak_force_bw=scaled(foot.peak_force_n, per_weight),
        mean_force_n=foot.mean_force_n,
        peak_vertical_force_n=foot.peak_vertical_force_n,
        peak_vertical_force_bw=scaled(foot.peak_vertical_force_n, per_weight),
        mean_vertical_force_n=foot.mean_vertical_force_n,
        vertical_impulse_ns=foot.vertical_impulse_ns,
        braking_impulse_ns=foot.braking_impulse_ns,
        propulsive_impulse_ns=foot.propulsive_impulse_ns,
        loading_rate_nps=foot.loading_rate_nps,
        impact_ratio=foot.impact_ratio,
        friction_use=foot.friction_use,
        vertical_over_stride_n=curve_of(curves.vertical_over_stride),
        forward_over_stride_n=curve_of(curves.forward_over_stride),
    )


def _times(span: Span, time: Ints) -> Numbers:
    """Return the times of a span as seconds since the log's start."""
    if not span.is_whole and span.segment is not None:
        time = time[timespans.covers(span.segment.spans, time)]
    return seconds(time, span.stats.origin)


def _swings(span: Span, row: int) -> tuple[dict[str, Spread], Shape]:
    """Return the metrics of a foot's swings and of the steps that they end with, and its height."""
    legs = span.stats.legs
    if legs is None:
        return dict.fromkeys(_SWINGS), None
    leg, strides = legs.feet[row], span.stats.feet[row].strides
    inside = np.ones(len(strides.stance), np.bool_)
    if not span.is_whole and span.segment is not None:
        inside = strides.rows_within(span.segment.spans)
    found = {key: aggregate(of(leg)[inside]) for key, of in _SWINGS.items()}
    return found, curve_of(leg.swings.height) if span.is_whole else None


def _planned(span: Span, row: int) -> Planned | None:
    """Return how a foot follows its plan over the whole log; None without one."""
    plan = span.stats.planned[row] if span.stats.planned and span.is_whole else None
    return None if plan is None else plan.metrics
