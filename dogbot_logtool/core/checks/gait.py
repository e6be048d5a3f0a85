"""Checks of steps and of the gait."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.gait.classes import CONSISTENT, IRREGULAR, TOLERANCE
from dogbot_logtool.core.leg_position import legs_in_order
from dogbot_logtool.core.loads import LARGEST_FOOT_M
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found


def no_class(walk: Walk) -> Iterator[Finding]:
    """Yield why the gait has no name."""
    main, where = walk.main, "gait.class"
    if walk.settings.lacks_feet:
        return
    if main is None:
        say = "clocks" if walk.feet_clocks_are_apart else "no_strides"
        yield found("CLASS_UNKNOWN", where=where, say=say)
        return
    phases = main.gait.phase
    if main.gait.name is None and main.strides:
        missing = (name for name, phase in phases.items() if phase.mean is None)
        say, names = "phases", ", ".join(missing)
        if legs_in_order([foot.leg_position for foot in walk.feet]) is None:
            say = "positions"
        if len(phases) not in {2, 4, 6}:
            say = "number"
        yield found("CLASS_UNKNOWN", where=where, say=say, names=names, number=len(phases))
    elif main.gait.name == IRREGULAR:
        loose = [
            f"{name} (R = {phase.consistency:.2f})"
            for name, phase in phases.items()
            if phase.consistency is not None and phase.consistency <= CONSISTENT
        ]
        say = "flight" if (main.gait.class_distance or 0.0) <= TOLERANCE else "nearest"
        say, names = "loose" if loose else say, ", ".join(loose)
        yield found("CLASS_UNKNOWN", where=where, say=say, names=names, gait=main.gait)


def other_reference_foot(walk: Walk) -> Iterator[Finding]:
    """Yield that phases are measured against another foot than usual."""
    names = [foot.name for foot in walk.feet]
    order = legs_in_order([foot.leg_position for foot in walk.feet]) or range(len(names))
    if walk.main is not None and walk.reference != order[0]:
        usual, other = names[order[0]], names[walk.reference]
        yield found("CLASS_UNKNOWN", where="gait.phase", say="reference", foot=usual, other=other)


def moves_without_steps(walk: Walk) -> Iterator[Finding]:
    """Yield time in which the base moves and no foot steps.

    Of feet whose unloaded level is not known, the contacts are refuted.
    """
    if not len(walk.standing.moving):
        return
    unsure = [
        foot.name for row, foot in enumerate(walk.feet) if walk.settings.feet[row].level.reason
    ]
    cases = ("offset_unknown",) if unsure else ()
    seconds, first = _lasting(walk, walk.standing.moving)
    yield found(
        "MOVES_WITHOUT_STEPS", *cases, where="gait.class", feet=unsure, seconds=seconds, first=first
    )


def lifted(walk: Walk) -> Iterator[Finding]:
    """Yield feet that never touch and carry nothing, and time in which no foot is loaded."""
    for row, foot in enumerate(walk.feet):
        usable = foot.record.start is not None and not walk.settings.feet[row].rule.unusable
        if usable and not foot.is_dead and not len(foot.stances.touchdown):
            yield found("LIFTED", foot=foot.name)
    if len(walk.standing.lifted):
        seconds, first = _lasting(walk, walk.standing.lifted)
        yield found("LIFTED", where="gait.segments", say="robot", seconds=seconds, first=first)


def _lasting(walk: Walk, spans: Ints) -> tuple[float, float]:
    """Return how long spans last in all, and when the first begins, s."""
    return timespans.total(spans) / 1e9, int(spans[0, 0] - walk.origin) / 1e9


def several_gaits(walk: Walk) -> Iterator[Finding]:
    """Yield that there are several gaits."""
    if len({segment.gait.name for segment in walk.segments}) > 1:
        yield found("SEVERAL_GAITS", where="gait.segments", segments=len(walk.segments))


def against_plan(walk: Walk) -> Iterator[Finding]:
    """Yield how the feet follow their plan."""
    for foot, plan in zip(walk.feet, walk.planned, strict=False):
        if plan is not None and plan.touchdowns:
            delay, median = plan.metrics.delay_s, ""
            if delay is not None:
                when = "late" if delay.median >= 0.0 else "early"
                median = f"; {1e3 * abs(delay.median):.0f} ms {when} in the median"
            where = f"feet.{foot.name}.planned"
            yield found(
                "PLANNED", "followed", where=where, foot=foot.name, plan=plan, median=median
            )


def slips(walk: Walk) -> Iterator[Finding]:
    """Yield contact points that travel further in a stance than a foot is long."""
    for foot in walk.feet if walk.ground is None else ():
        reach = foot.stances.figures.contact_reach_m[foot.stances.whole]
        far = int((reach > LARGEST_FOOT_M).sum())
        if far and walk.settings.foot_rolling_m is None and foot.slip_from is None:
            where, metres = f"feet.{foot.name}.contact_travel_m", np.nanmax(reach)
            yield found("SLIPS", where=where, foot=foot.name, metres=metres, stances=far)
