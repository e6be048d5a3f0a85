"""Figures of each foot."""

from collections.abc import Callable, Sequence
from typing import Final

from dogbot_logtool.core.gait.cycle_curves import CycleCurve, ForceCurves
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.gait.planned import PlannedFoot
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Member,
    Scope,
    TableName,
    inside,
    points,
)
from dogbot_logtool.report.figures.foot_loads import FOOT_FORCES, FOOT_LOADING
from dogbot_logtool.report.figures.foot_source import FootSource
from dogbot_logtool.report.figures.planned import PLANNED

_STEPS, _PAGE_LOADS = TableName.STEPS, TableName.PAGE_LOADS
_NO_STANCE: Final = "no stance is seen from touchdown to lift-off"
_NO_STRIDE: Final = "no whole stride"

_SENSOR: Final[Sequence[Figure[FootStatistics]]] = (
    Figure("topic", Kind.TEXT, lambda foot: foot.topic, "topic of its contact sensor"),
    Figure(
        "place",
        Kind.TEXTS,
        lambda foot: None if foot.leg_position is None else list(foot.leg_position),
        "where the leg is: front, middle or back, then left, right or centre",
        null="the robot's file does not say",
    ),
    Figure("messages", Kind.COUNT, lambda foot: foot.record.messages, "messages of the sensor"),
    Figure(
        "sampling_interval_s",
        Kind.AMOUNT,
        lambda foot: foot.record.median_interval_s,
        "median interval of its samples: no time figure is finer",
        null="fewer than two usable messages",
    ),
    Figure(
        "not_finite",
        Kind.COUNT,
        lambda foot: foot.record.not_finite,
        "messages whose force is not finite; left out",
    ),
    Figure(
        "not_advancing",
        Kind.COUNT,
        lambda foot: foot.record.not_advancing,
        "messages that repeat a time or step back; left out",
    ),
)
_LEVEL: Final[Sequence[Figure[FootSource]]] = (
    Figure(
        "force_offset_n",
        Kind.NUMBERS,
        lambda source: None if source.level.reason else source.level.offset_n.tolist(),
        "what the unloaded sensor reads, x, y and z, taken off all forces",
        null="the log does not show it, and neither an option nor the robot's file says",
    ),
    Figure(
        "force_noise_n",
        Kind.AMOUNT,
        lambda source: source.level.noise_n,
        "standard deviation of the unloaded sensor's noisiest component",
        null="the log does not show the unloaded sensor",
    ),
    Figure(
        "force_drift_n_per_min",
        Kind.NUMBER,
        lambda source: source.level.drift_n_per_min,
        "drift of the unloaded level along the direction of the load",
        unit="N/min",
        null="the log does not show the unloaded sensor for long enough",
    ),
)
_CONTACT: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "contact_fraction",
        Kind.FRACTION,
        lambda foot: foot.contact_fraction,
        "time in contact / time in which contact is known",
        null="no usable messages; the sensor seems dead",
        columns=(Column(_STEPS, "contact", rank=10, percent=True),),
    ),
    Figure(
        "strides",
        Kind.COUNT,
        lambda foot: len(foot.strides.stance),
        "whole strides: touchdown to next touchdown, both seen",
        columns=(Column(_STEPS, "strides", rank=20),),
    ),
)
_DISCARDED: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "discarded_strides",
        Kind.COUNTS_BY_NAME,
        lambda foot: dict(foot.discarded),
        "stances that begin no whole stride, by reason: log_start, log_end, gap, standing, fall",
    ),
)
_CHATTER: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "filled_swings",
        Kind.COUNT,
        lambda foot: foot.record.filled_swings,
        "swings shorter than the debouncing time, counted as contact",
    ),
    Figure(
        "dropped_stances",
        Kind.COUNT,
        lambda foot: foot.record.dropped_stances,
        "contacts shorter than the debouncing time, counted as swing",
    ),
)
_TIMING: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "stance_s",
        Kind.AGGREGATE,
        lambda foot: foot.stance_s,
        "lift-off minus touchdown of whole stances",
        null=_NO_STANCE,
        columns=(Column(_STEPS, "stance s", 3, rank=30),),
    ),
    Figure(
        "swing_s",
        Kind.AGGREGATE,
        lambda foot: foot.swing_s,
        "next touchdown minus lift-off of whole strides",
        null=_NO_STRIDE,
        columns=(Column(_STEPS, "swing s", 3, rank=40),),
    ),
    Figure(
        "stride_period_s",
        Kind.AGGREGATE,
        lambda foot: foot.stride_period_s,
        "next touchdown minus touchdown",
        null=_NO_STRIDE,
    ),
    Figure(
        "stride_frequency_hz",
        Kind.NUMBER,
        lambda foot: foot.stride_frequency_hz,
        "whole strides / sum of their periods",
        null=_NO_STRIDE,
    ),
    Figure(
        "duty_factor",
        Kind.AGGREGATE,
        lambda foot: foot.duty_factor,
        "stance / stride period (Hildebrand 1965; Alexander 1984)",
        null=_NO_STRIDE,
        columns=(Column(_STEPS, "duty", 3, rank=50),),
    ),
    Figure(
        "stride_length_m",
        Kind.AGGREGATE,
        lambda foot: foot.stride_length_m,
        "horizontal distance of the base between touchdown and next touchdown",
        null=f"{_NO_STRIDE}; no odometry around the touchdowns",
        columns=(Column(_STEPS, "length m", 3, rank=80),),
    ),
)
_EVENTS: Final[Sequence[Figure[FootSource]]] = (
    Figure(
        "contact_without_odometry_s",
        Kind.AMOUNT,
        lambda source: source.stats.contact_without_pose_s[source.row],
        "time in contact further than 0.1 s from any pose of the base",
    ),
    Figure(
        "touchdown_s",
        Kind.NUMBERS,
        lambda source: source.stats.seconds(source.foot.touchdown),
        "times of the touchdowns that were seen, since the log's start",
    ),
    Figure(
        "liftoff_s",
        Kind.NUMBERS,
        lambda source: source.stats.seconds(source.foot.liftoff),
        "times of the lift-offs that were seen, since the log's start",
    ),
)

_UNKNOWN: Final = (
    "no whole stance or stride; wrenches are not known in the world frame; forward forces also "
    "without odometry"
)


def cycle_figures(unit: str) -> Sequence[Figure[CycleCurve]]:
    """Return the figures of a quantity over strides."""
    return (
        Figure("n", Kind.COUNT, lambda curve: curve.number, "number of strides"),
        points("percent", lambda curve: curve.percent, "of the stride", "%"),
        points("median", lambda curve: curve.median, "median over strides", unit),
        points("lower_quartile", lambda curve: curve.lower, "a quarter lies below", unit),
        points("upper_quartile", lambda curve: curve.upper, "a quarter lies above", unit),
    )


_CURVE: Final = cycle_figures("N")


def _curve(key: str, of: Callable[[ForceCurves], CycleCurve | None], definition: str) -> Scope:
    return Scope(key, _CURVE, of, definition, null=_UNKNOWN)


def _curves_of(foot: FootStatistics) -> ForceCurves:
    return foot.force_curves


FORCE_CURVES: Final = Scope(
    "force_curves",
    (
        _curve(
            "vertical_over_stride_n",
            lambda curves: curves.vertical_over_stride,
            "vertical force over whole strides: mean of each of 25 equal parts of a stance, 0 in "
            "swing",
        ),
        _curve(
            "forward_over_stride_n",
            lambda curves: curves.forward_over_stride,
            "force along the base's forward axis at mid-stance, likewise",
        ),
    ),
    _curves_of,
    "usual forces over the gait cycle",
)
"""Figures of a `FootStatistics`."""


def _of_foot(source: FootSource) -> FootStatistics:
    return source.foot


def _plan_of(source: FootSource) -> PlannedFoot | None:
    return source.stats.planned[source.row] if source.stats.planned else None


FOOT_OF_SEGMENT: Final[Sequence[Member]] = (
    *inside(_CONTACT, _of_foot),
    *inside(_TIMING, _of_foot),
    *FOOT_FORCES,
    *inside(FOOT_LOADING, _of_foot),
)
"""Figures of a `FootSource` that mean something of any part of the log."""
FOOT: Final[Sequence[Member]] = (
    *inside(_SENSOR, _of_foot),
    *_LEVEL,
    *inside(_CONTACT, _of_foot),
    *inside(_DISCARDED, _of_foot),
    Scope("chatter", _CHATTER, _of_foot, "contacts and swings that debouncing removed"),
    *inside(_TIMING, _of_foot),
    *FOOT_FORCES,
    *inside(FOOT_LOADING, _of_foot),
    *inside((FORCE_CURVES,), _of_foot),
    *_EVENTS,
    Scope(
        "planned",
        PLANNED,
        _plan_of,
        "how the foot follows its plan",
        null="the log has no plan of the foot beside its measurement, or on another clock",
    ),
)
"""Figures of a `FootSource` of the whole log."""
