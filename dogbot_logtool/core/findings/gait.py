"""Findings about gait, support and stability."""

from collections.abc import Iterator

from dogbot_logtool.core.findings.contradictions import why_feet_and_base_are_apart
from dogbot_logtool.core.gait.gait import CONSISTENT, IRREGULAR
from dogbot_logtool.core.gait.gait_classes import BIPED, HEXAPOD, QUADRUPED, TOLERANCE
from dogbot_logtool.core.leg_position import legs_in_order
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def gait_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing or doubtful in the figures of the gait."""
    main, where = stats.main, "gait.class"
    reference = stats.feet[stats.reference].name if stats.feet else ""
    if stats.support is None:
        text = "there is no time in which the state of every foot is known"
        if stats.feet_clocks_are_apart:
            text = "the clocks of the feet's topics differ: it is not known which are down at once"
        yield Finding("N_NO_SUPPORT", text, "gait.support")
    if main is None:
        text = "no foot makes a whole stride, and not all feet stand: the gait is not known"
        if stats.feet_clocks_are_apart:
            text = "the clocks of the feet's topics differ: the gait is not known"
        yield Finding("N_NO_GAIT", text, where)
        return
    yield from _against_plan(stats)
    order = legs_in_order([foot.leg_position for foot in stats.feet]) or range(len(stats.feet))
    if stats.reference != order[0]:
        first = stats.feet[order[0]].name
        text = f"{first} has no strides: phases are measured against {reference}"
        yield Finding("N_REFERENCE_FOOT", text, "gait.phase")
    yield from _without_steps(stats)
    if main.gait.name is None and not (main.moves_without_steps or main.is_lifted):
        yield Finding("N_CLASS_UNKNOWN", _why_no_class(stats), where)
    elif main.gait.name == IRREGULAR:
        yield Finding("N_IRREGULAR", _why_irregular(stats), where)
    classes = {segment.gait.name for segment in stats.segments}
    if len(classes) > 1:
        text = (
            f"the log holds {len(stats.segments)} segments of different gaits; the class is that "
            "of the longest"
        )
        yield Finding("N_SEVERAL_GAITS", text, "gait.segments")


def _against_plan(stats: Stats) -> Iterator[Finding]:
    """Say how the feet follow their plan."""
    for foot, plan in zip(stats.feet, stats.planned, strict=False):
        if plan is None or not plan.touchdowns:
            continue
        text = (
            f"{foot.name} against {plan.topic}: of {plan.touchdowns} planned touchdowns "
            f"{plan.early} early, {plan.late} late, {plan.missed} missed, and {plan.unplanned} "
            "unplanned ones"
        )
        if plan.delay is not None:
            when = "late" if plan.delay.median >= 0.0 else "early"
            text += f"; {1e3 * abs(plan.delay.median):.0f} ms {when} in the median"
        yield Finding("N_AGAINST_PLAN", text, f"feet.{foot.name}.planned")


def _without_steps(stats: Stats) -> Iterator[Finding]:
    moving = [segment for segment in stats.segments if segment.moves_without_steps]
    if moving:
        seconds = sum(segment.end - segment.start for segment in moving) / 1e9
        start = (moving[0].start - stats.origin) / 1e9
        text = (
            f"the robot moves without steps for {seconds:.1f} s, first at {start:.2f} s: no foot's "
            "contact or load comes and goes, and the base goes somewhere. It rolls on wheels, or "
            "the contacts are wrong (a force sensor that does not read zero in the air)"
        )
        yield Finding("W_MOVES_WITHOUT_STEPS", text, "gait.class")
    lifted = [segment for segment in stats.segments if segment.is_lifted]
    if lifted:
        seconds = sum(segment.end - segment.start for segment in lifted) / 1e9
        start = (lifted[0].start - stats.origin) / 1e9
        text = (
            f"no foot is loaded for {seconds:.1f} s in all, first at {start:.2f} s: the robot is "
            "held in the air, carried, or lies on its body; that is no part of its gait"
        )
        yield Finding("N_CARRIED", text, "gait.segments")


def _why_no_class(stats: Stats) -> str:
    if len(stats.feet) not in {BIPED, QUADRUPED, HEXAPOD}:
        return f"only gaits of two, four or six feet have names; this robot has {len(stats.feet)}"
    if legs_in_order([foot.leg_position for foot in stats.feet]) is None:
        return (
            "a gait's name needs to know which foot is front or back, left or right: names such as "
            "--foot front_left=TOPIC say so, or `place` in a robot's file"
        )
    main = stats.main
    missing = [
        foot.name
        for row, foot in enumerate(stats.feet)
        if main is not None and main.phases[row] is None
    ]
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


def stability_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing in the figures of stability."""
    if stats.stability is None:
        text = (
            why_feet_and_base_are_apart(stats)
            or "there is no time in which the base and the state of every foot are known"
        )
        yield Finding("N_NO_STABILITY", text, "stability")
    elif stats.stability.undefined_fraction is None:
        text = "no foot that is down tells where it stands: no support polygon"
        yield Finding("N_NO_MARGIN", text, "stability.static_margin_m")
    elif stats.stability.static_margin_m is None:
        text = "there are never three feet with a contact point down at once: no static margin"
        yield Finding("N_NO_MARGIN", text, "stability.static_margin_m")
    if stats.stability is not None and stats.stability.pressure_forward_m is None:
        text = "vertical forces are not known: no centre of pressure"
        yield Finding("N_NO_CENTRE_OF_PRESSURE", text, "stability.centre_of_pressure_forward_m")
