"""A log's plan of its feet, measured like the feet themselves and compared with them."""

from dataclasses import replace
from typing import TYPE_CHECKING

from dogbot_logtool.core.gait.planned import follow_plan
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.finding import note
from dogbot_logtool.robot import Foot

if TYPE_CHECKING:
    from dogbot_logtool.core.statistics import Stats
    from dogbot_logtool.pipeline.options import StatsOptions
    from dogbot_logtool.results import Measurement


def options_of_plan(options: "StatsOptions", feet: tuple[Foot, ...]) -> "StatsOptions":
    """Return the options that measure a plan of the feet instead of their sensors."""
    topics = replace(
        options.topics, foot_topics=None, offsets_n=None, takes_offsets=False, feet=feet
    )
    return replace(options, topics=topics, curves=None)


def with_plan(measured: "Measurement", planned: "Stats") -> "Measurement":
    """Add how the feet follow their plan.

    Args:
        measured: of the feet by their sensors.
        planned: of the planned ones.
    """
    stats = measured.stats
    clocks = [each.settings.time_source or TimeSource.HEADER for each in (stats, planned)]
    plan = {foot.name: foot for foot in planned.feet}
    topics = sorted({foot.topic for foot in planned.feet})
    if clocks[0] is not clocks[1]:
        text = f"{topics[0]} is a plan on another clock than the feet: they are not compared"
        facts = replace(
            measured.facts, findings=[*measured.facts.findings, note("PLAN_NOT_COMPARED", text)]
        )
        return replace(measured, facts=facts)
    found = tuple(
        follow_plan(foot, plan[foot.name]) if foot.name in plan else None for foot in stats.feet
    )
    return replace(measured, stats=replace(stats, planned=found))
