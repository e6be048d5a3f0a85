"""Figures of each foot."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from dogbot_logtool.core.contact.sensor_level import SensorLevel
from dogbot_logtool.core.gait.foot_statistics import FootStatistics
from dogbot_logtool.core.gait.planned import PlannedFoot
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Member,
    Scope,
    TableName,
    inside,
    scaled,
)
from dogbot_logtool.report.figures.force_curves import FORCE_CURVES
from dogbot_logtool.report.figures.planned import PLANNED

_STEPS, _LOADS, _PAGE_LOADS = TableName.STEPS, TableName.LOADS, TableName.PAGE_LOADS
_NO_STANCE: Final = "no stance is seen from touchdown to lift-off"
_NO_STRIDE: Final = "no whole stride"
_NO_FORCE: Final = f"{_NO_STANCE}; the sensor gives no force"
_NO_VERTICAL: Final = f"{_NO_FORCE}; its wrenches are not known in the world frame"
_NO_SLIP: Final = f"{_NO_STANCE}; no contact points there; `settings.foot_rolling_m` is not known"
_NO_MASS: Final = "`forces.weight_n` is not known"


@dataclass(frozen=True, slots=True)
class FootSource:
    """What the figures of a foot are taken from."""

    stats: Stats
    """Of the whole log."""
    row: int
    """Of the foot in `stats.feet`."""
    foot: FootStatistics
    """The foot over the whole log, or in a segment of it."""

    @property
    def level(self) -> SensorLevel:
        """What its unloaded sensor reads."""
        return self.stats.settings.sensor(self.row).level

    @property
    def per_weight(self) -> float | None:
        """1/N: turns newtons into body weights; None where the weight is not known."""
        weight = self.stats.loads.weight_n
        return None if weight is None else 1.0 / weight


def foot_sources(stats: Stats) -> dict[str, FootSource]:
    """Return what each foot's figures are taken from, by its name."""
    return {foot.name: FootSource(stats, row, foot) for row, foot in enumerate(stats.feet)}


_SENSOR: Final[Sequence[Figure[FootStatistics]]] = (
    Figure("topic", Kind.TEXT, "", lambda foot: foot.topic, "topic of its contact sensor"),
    Figure(
        "place",
        Kind.TEXTS,
        "",
        lambda foot: None if foot.place is None else list(foot.place),
        "where the leg is: front, middle or back, then left, right or centre",
        null="the robot's file does not say",
    ),
    Figure("messages", Kind.COUNT, "", lambda foot: foot.record.messages, "messages of the sensor"),
    Figure(
        "sampling_interval_s",
        Kind.AMOUNT,
        "s",
        lambda foot: foot.record.median_interval_s,
        "median interval of its samples: no time figure is finer",
        null="fewer than two usable messages",
    ),
    Figure(
        "not_finite",
        Kind.COUNT,
        "",
        lambda foot: foot.record.not_finite,
        "messages whose force is not finite; left out",
    ),
    Figure(
        "not_advancing",
        Kind.COUNT,
        "",
        lambda foot: foot.record.not_advancing,
        "messages that repeat a time or step back; left out",
    ),
)
_LEVEL: Final[Sequence[Figure[FootSource]]] = (
    Figure(
        "force_offset_n",
        Kind.NUMBERS,
        "N",
        lambda source: None if source.level.reason else source.level.offset_n.tolist(),
        "what the unloaded sensor reads, x, y and z, taken off all forces",
        null="the log does not show it, and neither an option nor the robot's file says",
    ),
    Figure(
        "force_noise_n",
        Kind.AMOUNT,
        "N",
        lambda source: source.level.noise_n,
        "standard deviation of the unloaded sensor's noisiest component",
        null="the log does not show the unloaded sensor",
    ),
    Figure(
        "force_drift_n_per_min",
        Kind.NUMBER,
        "N/min",
        lambda source: source.level.drift_n_per_min,
        "drift of the unloaded level along the direction of the load",
        null="the log does not show the unloaded sensor for long enough",
    ),
)
_CONTACT: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "contact_fraction",
        Kind.FRACTION,
        "",
        lambda foot: foot.contact_fraction,
        "time in contact / time in which contact is known",
        null="no usable messages; the sensor seems dead",
        columns=(Column(_STEPS, "contact", rank=10, percent=True),),
    ),
    Figure(
        "strides",
        Kind.COUNT,
        "",
        lambda foot: len(foot.strides.stance),
        "whole strides: touchdown to next touchdown, both seen",
        columns=(Column(_STEPS, "strides", rank=20),),
    ),
)
_DISCARDED: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "discarded_strides",
        Kind.COUNTS_BY_NAME,
        "",
        lambda foot: dict(foot.discarded),
        "stances that begin no whole stride, by reason: log_start, log_end, gap, standing, fall",
    ),
)
_CHATTER: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "filled_swings",
        Kind.COUNT,
        "",
        lambda foot: foot.record.filled_swings,
        "swings shorter than the debouncing time, counted as contact",
    ),
    Figure(
        "dropped_stances",
        Kind.COUNT,
        "",
        lambda foot: foot.record.dropped_stances,
        "contacts shorter than the debouncing time, counted as swing",
    ),
)
_TIMING: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "stance_s",
        Kind.AGGREGATE,
        "s",
        lambda foot: foot.stance_s,
        "lift-off minus touchdown of whole stances",
        null=_NO_STANCE,
        columns=(Column(_STEPS, "stance s", 3, rank=30),),
    ),
    Figure(
        "swing_s",
        Kind.AGGREGATE,
        "s",
        lambda foot: foot.swing_s,
        "next touchdown minus lift-off of whole strides",
        null=_NO_STRIDE,
        columns=(Column(_STEPS, "swing s", 3, rank=40),),
    ),
    Figure(
        "stride_period_s",
        Kind.AGGREGATE,
        "s",
        lambda foot: foot.stride_period_s,
        "next touchdown minus touchdown",
        null=_NO_STRIDE,
    ),
    Figure(
        "stride_frequency_hz",
        Kind.NUMBER,
        "1/s",
        lambda foot: foot.stride_frequency_hz,
        "whole strides / sum of their periods",
        null=_NO_STRIDE,
    ),
    Figure(
        "duty_factor",
        Kind.AGGREGATE,
        "",
        lambda foot: foot.duty_factor,
        "stance / stride period (Hildebrand 1965; Alexander 1984)",
        null=_NO_STRIDE,
        columns=(Column(_STEPS, "duty", 3, rank=50),),
    ),
    Figure(
        "stride_length_m",
        Kind.AGGREGATE,
        "m",
        lambda foot: foot.stride_length_m,
        "horizontal distance of the base between touchdown and next touchdown",
        null=f"{_NO_STRIDE}; no odometry around the touchdowns",
        columns=(Column(_STEPS, "length m", 3, rank=80),),
    ),
)
_FORCES: Final[Sequence[Figure[FootSource]]] = (
    Figure(
        "peak_force_n",
        Kind.AGGREGATE,
        "N",
        lambda source: source.foot.peak_force_n,
        "highest force |F| of a stance, lone spikes left out",
        null=f"{_NO_FORCE}; the sensor is cut off at a limit",
        columns=(
            Column(_LOADS, "peak |F|", 1, rank=20),
            Column(_PAGE_LOADS, "highest N", 1, rank=20, statistic="max"),
            Column(_PAGE_LOADS, "peak N", 1, rank=30),
        ),
    ),
    Figure(
        "peak_force_bw",
        Kind.AGGREGATE,
        "body weights",
        lambda source: scaled(source.foot.peak_force_n, source.per_weight),
        "`peak_force_n` / `forces.weight_n`",
        null=f"{_NO_FORCE}; {_NO_MASS}",
        columns=(
            Column(_LOADS, "peak |F|", 2, rank=20),
            Column(_PAGE_LOADS, "peak BW", 2, rank=40),
        ),
    ),
    Figure(
        "mean_force_n",
        Kind.AGGREGATE,
        "N",
        lambda source: source.foot.mean_force_n,
        "mean of |F| over the samples of a stance",
        null=_NO_FORCE,
        columns=(
            Column(_LOADS, "mean |F|", 1, rank=30),
            Column(_PAGE_LOADS, "mean N", 1, rank=50),
        ),
    ),
    Figure(
        "mean_force_bw",
        Kind.AGGREGATE,
        "body weights",
        lambda source: scaled(source.foot.mean_force_n, source.per_weight),
        "`mean_force_n` / `forces.weight_n`",
        null=f"{_NO_FORCE}; {_NO_MASS}",
        columns=(Column(_LOADS, "mean |F|", 2, rank=30),),
    ),
    Figure(
        "peak_vertical_force_n",
        Kind.AGGREGATE,
        "N",
        lambda source: source.foot.peak_vertical_force_n,
        "highest vertical force of a stance, upwards in the world, lone spikes left out",
        null=_NO_VERTICAL,
        columns=(
            Column(_LOADS, "peak Fz", 1, rank=40),
            Column(_PAGE_LOADS, "peak Fz N", 1, rank=60),
        ),
    ),
    Figure(
        "peak_vertical_force_bw",
        Kind.AGGREGATE,
        "body weights",
        lambda source: scaled(source.foot.peak_vertical_force_n, source.per_weight),
        "`peak_vertical_force_n` / `forces.weight_n`",
        null=f"{_NO_VERTICAL}; {_NO_MASS}",
        columns=(Column(_LOADS, "peak Fz", 2, rank=40),),
    ),
    Figure(
        "mean_vertical_force_n",
        Kind.AGGREGATE,
        "N",
        lambda source: source.foot.mean_vertical_force_n,
        "mean vertical force over the samples of a stance",
        null=_NO_VERTICAL,
    ),
    Figure(
        "mean_vertical_force_bw",
        Kind.AGGREGATE,
        "body weights",
        lambda source: scaled(source.foot.mean_vertical_force_n, source.per_weight),
        "`mean_vertical_force_n` / `forces.weight_n`",
        null=f"{_NO_VERTICAL}; {_NO_MASS}",
    ),
)
_LOADING: Final[Sequence[Figure[FootStatistics]]] = (
    Figure(
        "vertical_impulse_ns",
        Kind.NUMBER,
        "N s",
        lambda foot: foot.vertical_impulse_ns,
        "integral of the vertical force over all time known (trapezoid), gaps left out",
        null="nothing is known of the foot; the sensor gives no force, or seems dead; its wrenches "
        "are not known in the world frame",
    ),
    Figure(
        "spikes",
        Kind.COUNT,
        "",
        lambda foot: foot.spikes,
        "samples of whole stances, not their first ones, at least twice as high as their "
        "neighbours and the rest of the stance, unless a fifth of the stances have one at the same "
        "phase (an impact); left out of the peaks",
    ),
    Figure(
        "braking_impulse_ns",
        Kind.AGGREGATE,
        "N s",
        lambda foot: foot.braking_impulse_ns,
        "size of the impulse of a stance against the base's forward axis at mid-stance",
        null=f"{_NO_VERTICAL}; no odometry around the stances; the feet's vertical impulse misses "
        "the weight by more than 5 % (an assumed one: 20 %); forces lean, and neither transforms "
        "nor the weight tell that they are in the world frame",
    ),
    Figure(
        "propulsive_impulse_ns",
        Kind.AGGREGATE,
        "N s",
        lambda foot: foot.propulsive_impulse_ns,
        "impulse of a stance along the base's forward axis at mid-stance",
        null=f"{_NO_VERTICAL}; no odometry around the stances; the feet's vertical impulse misses "
        "the weight by more than 5 % (an assumed one: 20 %); forces lean, and neither transforms "
        "nor the weight tell that they are in the world frame",
    ),
    Figure(
        "loading_rate_nps",
        Kind.AGGREGATE,
        "N/s",
        lambda foot: foot.loading_rate_nps,
        "slope of |F| from 20 % to 80 % of the rise to the first peak of a stance",
        null=f"{_NO_FORCE}; the rise takes less than one sampling interval",
        columns=(Column(_PAGE_LOADS, "rate N/s", 0, rank=80),),
    ),
    Figure(
        "impact_ratio",
        Kind.AGGREGATE,
        "",
        lambda foot: foot.impact_ratio,
        "highest |F| in the first 50 ms of a stance / median of |F| over the stance",
        null=_NO_FORCE,
        columns=(
            Column(_LOADS, "impact", 2, rank=50),
            Column(_PAGE_LOADS, "impact", 2, rank=70),
        ),
    ),
    Figure(
        "contact_travel_m",
        Kind.AGGREGATE,
        "m",
        lambda foot: foot.contact_travel_m,
        "horizontal distance of the contact points at 10 % and 90 % of a stance",
        null=f"{_NO_STANCE}; no contact points there",
        columns=(Column(_LOADS, "travel", 1, rank=70, scale=1e3),),
    ),
    Figure(
        "slip_m",
        Kind.AGGREGATE,
        "m",
        lambda foot: foot.slip_distance_m,
        "by how much `contact_travel_m` exceeds `settings.foot_rolling_m`, at least 0",
        null=_NO_SLIP,
        columns=(
            Column(_LOADS, "slip", 1, rank=80, scale=1e3),
            Column(_PAGE_LOADS, "slip mm", 1, rank=100, scale=1e3),
        ),
    ),
    Figure(
        "slip_largest_m",
        Kind.AGGREGATE,
        "m",
        lambda foot: foot.largest_slip_m,
        "the same of the contact point's largest horizontal distance from where it is at 10 % of a "
        "stance, up to 90 %",
        null=_NO_SLIP,
    ),
    Figure(
        "friction_use",
        Kind.AGGREGATE,
        "",
        lambda foot: foot.friction_use,
        "tangential / normal force, 95th percentile over a stance",
        null=f"{_NO_VERTICAL}; no contact normals",
        columns=(
            Column(_LOADS, "friction", 2, rank=60),
            Column(_PAGE_LOADS, "friction", 2, rank=90),
        ),
    ),
)
_EVENTS: Final[Sequence[Figure[FootSource]]] = (
    Figure(
        "contact_without_odometry_s",
        Kind.AMOUNT,
        "s",
        lambda source: source.stats.contact_without_pose_s[source.row],
        "time in contact further than 0.1 s from any pose of the base",
    ),
    Figure(
        "touchdown_s",
        Kind.NUMBERS,
        "s",
        lambda source: source.stats.seconds(source.foot.touchdown),
        "times of the touchdowns that were seen, since the log's start",
    ),
    Figure(
        "liftoff_s",
        Kind.NUMBERS,
        "s",
        lambda source: source.stats.seconds(source.foot.liftoff),
        "times of the lift-offs that were seen, since the log's start",
    ),
)


def _of_foot(source: FootSource) -> FootStatistics:
    return source.foot


def _plan_of(source: FootSource) -> PlannedFoot | None:
    return source.stats.planned[source.row] if source.stats.planned else None


FOOT_OF_SEGMENT: Final[Sequence[Member]] = (
    *inside(_CONTACT, _of_foot),
    *inside(_TIMING, _of_foot),
    *_FORCES,
    *inside(_LOADING, _of_foot),
)
"""Figures of a `FootSource` that mean something of any part of the log."""
FOOT: Final[Sequence[Member]] = (
    *inside(_SENSOR, _of_foot),
    *_LEVEL,
    *inside(_CONTACT, _of_foot),
    *inside(_DISCARDED, _of_foot),
    Scope("chatter", _CHATTER, _of_foot, "contacts and swings that debouncing removed"),
    *inside(_TIMING, _of_foot),
    *_FORCES,
    *inside(_LOADING, _of_foot),
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
