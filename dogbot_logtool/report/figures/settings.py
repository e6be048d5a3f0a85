"""Figures of what decided the figures: clock, mass, frames, thresholds."""

from collections.abc import Callable, Sequence
from typing import Final

from dogbot_logtool.core.contact.contact_rule import FootSensor
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.figures.figure import Column, Figure, Kind, TableName
from dogbot_logtool.report.figures.loads import WRENCH_FRAMES

CLOCKS: Final = ("header", "log")
_LOG_ROWS: Final = TableName.LOG_ROWS


def _of_all(stats: Stats, of: Callable[[FootSensor], float]) -> float | None:
    """Return what holds of all feet's sensors; None where they differ."""
    settings = stats.settings
    values = {of(settings.sensor(row)) for row in range(len(settings.feet))}
    return values.pop() if len(values) == 1 else None


def sensors_by_foot(stats: Stats) -> dict[str, FootSensor]:
    """Return each foot's sensor by the foot's name."""
    settings = stats.settings
    return {foot.name: settings.sensor(row) for row, foot in enumerate(settings.feet)}


_ORIGINS: Final = ("option", "robot", "estimated", "default")
SENSOR: Final[Sequence[Figure[FootSensor]]] = (
    Figure(
        "contact_on_n",
        Kind.AMOUNT,
        lambda sensor: sensor.rule.on_n,
        "|F| above the unloaded level from which the foot is in contact",
    ),
    Figure(
        "contact_off_n",
        Kind.AMOUNT,
        lambda sensor: sensor.rule.off_n,
        "|F| above the unloaded level below which contact ends",
    ),
    Figure(
        "debounce_s",
        Kind.AMOUNT,
        lambda sensor: sensor.rule.debounce_s,
        "if not set, max(20 ms, 1.5 sampling intervals): shorter swings are filled, then shorter "
        "stances dropped; if not set, swings below 1/16 of the foot's usual one are filled, too",
    ),
    Figure(
        "thresholds_from",
        Kind.TEXT,
        lambda sensor: sensor.rule.origin,
        "where the thresholds come from",
        choices=_ORIGINS,
    ),
    Figure(
        "offset_from",
        Kind.TEXT,
        lambda sensor: sensor.level.origin,
        "where the unloaded level comes from",
        choices=_ORIGINS,
    ),
    Figure(
        "zero_in_swing",
        Kind.FLAG,
        lambda sensor: sensor.level.zero_in_swing,
        "whether it reads exactly zero in swing",
    ),
)
SETTINGS: Final[Sequence[Figure[Stats]]] = (
    Figure(
        "time_source",
        Kind.TEXT,
        lambda stats: str(stats.settings.clock),
        "clock of all figures: header stamps or log time",
        choices=CLOCKS,
    ),
    Figure(
        "time_source_forced",
        Kind.FLAG,
        lambda stats: (
            stats.settings.time_source is not None and not stats.settings.time_source_reason
        ),
        "whether an option chose it",
    ),
    Figure(
        "time_origin_ns",
        Kind.INTEGER,
        lambda stats: stats.origin,
        "earliest time of any used message on that clock: the log's start, from which times are "
        "counted",
        unit="ns",
    ),
    Figure(
        "mass_kg",
        Kind.NUMBER,
        lambda stats: stats.settings.mass_kg,
        "mass m of the robot",
        null="neither an option nor the robot's file says",
        columns=(Column(_LOG_ROWS, "mass_kg", rank=80),),
    ),
    Figure(
        "body_weight_n",
        Kind.NUMBER,
        lambda stats: stats.settings.body_weight_n,
        "m g, g = 9.81 m/s^2",
        null="the mass is not known",
    ),
    Figure(
        "forward_axis",
        Kind.TEXT,
        lambda stats: stats.settings.forward_axis,
        "axis of the body that points forward",
        choices=("+x", "-x", "+y", "-y"),
    ),
    Figure(
        "wrench_frame",
        Kind.TEXT,
        lambda stats: str(stats.settings.wrench_frame),
        "frame in which wrenches were recorded",
        choices=WRENCH_FRAMES,
    ),
    Figure(
        "contact_on_n",
        Kind.NUMBER,
        lambda stats: _of_all(stats, lambda sensor: sensor.rule.on_n),
        "|F| from which a foot is in contact",
        null="it differs from foot to foot: see `sensors`",
    ),
    Figure(
        "contact_off_n",
        Kind.NUMBER,
        lambda stats: _of_all(stats, lambda sensor: sensor.rule.off_n),
        "|F| below which contact ends; 0: where the sensor reports none",
        null="it differs from foot to foot: see `sensors`",
    ),
    Figure(
        "contact_on_counts",
        Kind.NUMBER,
        lambda stats: stats.settings.contact_on_counts,
        "counts above a foot's offset from which a raw sensor without a scale is in contact",
        null="the robot's file does not say",
    ),
    Figure(
        "debounce_s",
        Kind.NUMBER,
        lambda stats: _of_all(stats, lambda sensor: sensor.rule.debounce_s),
        "shorter swings are filled, then shorter stances dropped",
        null="it differs from foot to foot: see `sensors`",
    ),
    Figure(
        "com_offset_m",
        Kind.NUMBERS,
        lambda stats: None if (at := stats.settings.com_offset_m) is None else list(at),
        "centre of mass from the base's frame, in its axes",
        null="the robot's file does not say: it is taken to be at the base",
    ),
    Figure(
        "foot_rolling_m",
        Kind.NUMBER,
        lambda stats: stats.settings.foot_rolling_m,
        "travel of the contact point of a foot that rolls without slipping",
        null="the robot's file does not say",
    ),
    Figure(
        "reference_foot",
        Kind.TEXT,
        lambda stats: stats.feet[stats.reference].name if stats.feet else None,
        "foot that phases are measured against: the first that has strides",
        null="the robot has no feet",
    ),
    Figure(
        "odometry_topic",
        Kind.TEXT,
        lambda stats: stats.settings.odometry_topic or None,
        "topic of the poses of the base",
        null="there is none",
    ),
    Figure(
        "loading_rate_method",
        Kind.TEXT,
        lambda _: "slope from 20 % to 80 % of the rise to the first peak",
        "how loading rates are measured",
    ),
)
"""Settings behind the figures."""
