"""Settings that decided the metrics."""

from dogbot_logtool.core.metrics import FootSettings, Settings
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Chosen:
    """What was chosen before a log was measured."""

    robot: str
    """Name of the robot's file."""
    robot_guessed: bool
    """Whether it was guessed from the topics."""
    contact_planned: bool
    """Whether contacts are what was planned, not what was measured."""


def settings_metrics(stats: Stats, chosen: Chosen) -> Settings:
    """Return what decided the metrics of a log."""
    settings, loads = stats.settings, stats.loads
    offset = settings.com_offset_m
    return Settings(
        robot=chosen.robot,
        robot_guessed=chosen.robot_guessed,
        clock=settings.clock.value,
        mass_kg=settings.mass_kg,
        body_weight_n=loads.weight_n,
        weight_source=None if loads.weight_source is None else loads.weight_source.value,
        forward_axis=settings.forward_axis,
        wrench_frame=settings.wrench_frame.value,
        reference_foot=stats.feet[stats.reference].name if stats.feet else None,
        com_offset_m=None if offset is None else tuple(offset),
        base_from="pose" if len(stats.base_history.time) else None,
        contact_from=_contact_from(stats, chosen),
        feet={foot.name: _foot(stats, row) for row, foot in enumerate(stats.feet)},
    )


def _contact_from(stats: Stats, chosen: Chosen) -> str | None:
    if all(foot.record.start is None for foot in stats.feet):
        return None
    return "plan" if chosen.contact_planned else "sensor"


def _foot(stats: Stats, row: int) -> FootSettings:
    foot, sensor = stats.feet[row], stats.settings.sensor(row)
    position = foot.leg_position
    return FootSettings(
        topic=foot.topic or None,
        leg_position=None if position is None else tuple(position),
        contact_on_n=sensor.rule.on_n,
        contact_off_n=sensor.rule.off_n,
        debounce_s=sensor.rule.debounce_s,
        offset_from=sensor.level.origin,
    )
