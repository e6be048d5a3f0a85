"""Figures of how a foot follows its plan."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.core.gait.planned import ON_TIME_S, PlannedFoot
from dogbot_logtool.report.figures.figure import Figure, Kind

PLANNED: Final[Sequence[Figure[PlannedFoot]]] = (
    Figure("topic", Kind.TEXT, lambda foot: foot.topic, "topic of the plan"),
    Figure(
        "touchdowns",
        Kind.COUNT,
        lambda foot: foot.touchdowns,
        "planned touchdowns in the time that is known of plan and measurement",
    ),
    Figure(
        "touchdown_delay_s",
        Kind.AGGREGATE,
        lambda foot: foot.delay,
        "measured minus planned touchdown, of those that are nearest to each other and nearer than "
        "half the way to the planned touchdowns beside; positive: late",
        null="no touchdown has a match",
    ),
    Figure(
        "early",
        Kind.COUNT,
        lambda foot: foot.early,
        "matched touchdowns that are early by more than `tolerance_s`",
    ),
    Figure(
        "late",
        Kind.COUNT,
        lambda foot: foot.late,
        "matched touchdowns that are late by more than `tolerance_s`",
    ),
    Figure(
        "missed", Kind.COUNT, lambda foot: foot.missed, "planned touchdowns without a measured one"
    ),
    Figure(
        "unplanned",
        Kind.COUNT,
        lambda foot: foot.unplanned,
        "measured touchdowns without a planned one",
    ),
    Figure(
        "tolerance_s",
        Kind.AMOUNT,
        lambda foot: foot.tolerance_s,
        f"by how much a touchdown on time is off at most: {ON_TIME_S:g} s, and a sample of either",
    ),
    Figure(
        "contact_agreement",
        Kind.FRACTION,
        lambda foot: foot.agreement,
        "share of the time in which plan and measurement agree on contact",
        null="plan and measurement have no time in common",
    ),
)
