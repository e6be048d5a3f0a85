"""Checks of steps and of the gait."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core.checks.wording import counted
from dogbot_logtool.core.gait.classes import (
    BIPED,
    CONSISTENT,
    HEXAPOD,
    IRREGULAR,
    QUADRUPED,
    TOLERANCE,
)
from dogbot_logtool.core.leg_position import legs_in_order
from dogbot_logtool.core.loads import LARGEST_FOOT_M
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def no_class(stats: Stats) -> Iterator[Finding]:
    """Yield why the gait has no name."""
    main = stats.main
    if main is None:
        text = "no foot makes a whole stride, and not all feet stand: the gait is not known"
        if stats.feet_clocks_are_apart:
            text = "the clocks of the feet's topics differ: the gait is not known"
        yield Finding("CLASS_UNKNOWN", text, "gait.class")
    elif main.gait.name is None and not (main.moves_without_steps or main.is_lifted):
        yield Finding("CLASS_UNKNOWN", _why_no_class(stats), "gait.class")
    elif main.gait.name == IRREGULAR:
        yield Finding("CLASS_UNKNOWN", _why_irregular(stats), "gait.class")


def other_reference_foot(stats: Stats) -> Iterator[Finding]:
    """Yield that phases are measured against another foot than usual."""
    order = legs_in_order([foot.leg_position for foot in stats.feet]) or range(len(stats.feet))
    if stats.main is not None and stats.reference != order[0]:
        names = stats.feet[order[0]].name, stats.feet[stats.reference].name
        text = f"{names[0]} has no strides: phases are measured against {names[1]}"
        yield Finding("CLASS_UNKNOWN", text, "gait.phase")


def moves_without_steps(stats: Stats) -> Iterator[Finding]:
    """Yield time in which the base moves and no foot steps.

    Of feet whose unloaded level is not known, the contacts are refuted.
    """
    moving = [segment for segment in stats.segments if segment.moves_without_steps]
    if not moving:
        return
    seconds = sum(segment.end - segment.start for segment in moving) / 1e9
    start = (moving[0].start - stats.origin) / 1e9
    text = (
        f"the robot moves without steps for {seconds:.1f} s, first at {start:.2f} s: no foot's "
        "contact or load comes and goes, and the base goes somewhere. It rolls on wheels, or "
        "the contacts are wrong (a force sensor that does not read zero in the air)"
    )
    unsure = tuple(
        foot.name for row, foot in enumerate(stats.feet) if stats.settings.sensor(row).level.reason
    )
    cases = ("offset_unknown",) if unsure else ()
    yield Finding("MOVES_WITHOUT_STEPS", text, "gait.class", cases=cases, feet=unsure)


def lifted(stats: Stats) -> Iterator[Finding]:
    """Yield feet that never touch and carry nothing, and time in which no foot is loaded."""
    for row, foot in enumerate(stats.feet):
        told = foot.record.start is not None and not stats.settings.sensor(row).rule.unusable
        if told and not foot.is_dead and not len(foot.stances.touchdown):
            text = (
                f"{foot.name} never touches the ground, and the other feet carry the whole weight"
            )
            yield Finding("LIFTED", text, f"feet.{foot.name}")
    spans = [segment for segment in stats.segments if segment.is_lifted]
    if spans:
        seconds = sum(segment.end - segment.start for segment in spans) / 1e9
        start = (spans[0].start - stats.origin) / 1e9
        text = (
            f"no foot is loaded for {seconds:.1f} s in all, first at {start:.2f} s: the robot is "
            "held in the air, carried, or lies on its body; that is no part of its gait"
        )
        yield Finding("LIFTED", text, "gait.segments")


def several_gaits(stats: Stats) -> Iterator[Finding]:
    """Yield that there are several gaits."""
    if len({segment.gait.name for segment in stats.segments}) > 1:
        text = (
            f"the log holds {len(stats.segments)} segments of different gaits; the class is that "
            "of the longest"
        )
        yield Finding("SEVERAL_GAITS", text, "gait.segments")


def against_plan(stats: Stats) -> Iterator[Finding]:
    """Yield how the feet follow their plan."""
    for foot, plan in zip(stats.feet, stats.planned, strict=False):
        if plan is None or not plan.touchdowns:
            continue
        found, delay = plan.metrics, plan.metrics.delay_s
        text = (
            f"{foot.name} against {plan.topic}: of {plan.touchdowns} planned touchdowns "
            f"{plan.early} early, {plan.late} late, {found.missed} missed, and {found.unplanned} "
            "unplanned ones"
        )
        if delay is not None:
            when = "late" if delay.median >= 0.0 else "early"
            text += f"; {1e3 * abs(delay.median):.0f} ms {when} in the median"
        yield Finding("AGAINST_PLAN", text, f"feet.{foot.name}.planned")


def slips(stats: Stats) -> Iterator[Finding]:
    """Yield contact points that travel further in a stance than a foot is long."""
    for foot in stats.feet:
        if stats.settings.foot_rolling_m is not None or foot.slip_from is not None:
            continue
        reach = foot.stances.figures.contact_reach_m[foot.stances.whole]
        far = int((reach > LARGEST_FOOT_M).sum())
        if far:
            text = (
                f"the contact point of {foot.name} travels up to {np.nanmax(reach):.2f} m in "
                f"{counted(far, 'stance')}, further than a foot is long: it slips, or poses drift"
            )
            yield Finding("SLIPS", text, f"feet.{foot.name}.contact_travel_m")


def _why_no_class(stats: Stats) -> str:
    if len(stats.feet) not in {BIPED, QUADRUPED, HEXAPOD}:
        return f"only gaits of two, four or six feet have names; this robot has {len(stats.feet)}"
    if legs_in_order([foot.leg_position for foot in stats.feet]) is None:
        return (
            "a gait's name needs to know which foot is front or back, left or right: names such as "
            "--foot front_left=TOPIC say so, or `place` in a robot's file"
        )
    phases = stats.main.phases if stats.main else ()
    missing = [foot.name for foot, phase in zip(stats.feet, phases, strict=False) if phase is None]
    return f"{', '.join(missing)} has no touchdowns in the strides of the reference foot"


def _why_irregular(stats: Stats) -> str:
    main = stats.main
    loose = [
        f"{foot.name} (R = {phase.consistency:.2f})"
        for foot, phase in zip(stats.feet, main.phases if main else (), strict=False)
        if phase is not None and phase.consistency <= CONSISTENT
    ]
    if loose:
        return f"phases are not consistent: {', '.join(loose)}"
    gait = main.gait if main else None
    if gait is None or gait.distance is None:
        return "the phases fit no class"
    if gait.distance <= TOLERANCE:
        return f"its footfalls are those of an {gait.nearest}, but it has flight"
    return f"the phases fit no class; the nearest is {gait.nearest}, {gait.distance:.2f} cycles off"
