"""Checks of steps and gait, of the forces on the feet, of the weight, and of the legs."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.gait.classes import CONSISTENT, IRREGULAR, TOLERANCE
from dogbot_logtool.core.gait.feet import net_push
from dogbot_logtool.core.loads import LARGEST_FOOT_M, REFUTED, WEIGHT_TOLERANCE, is_stuck
from dogbot_logtool.core.settings import GRAVITY_MPS2, legs_in_order
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found


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
    for foot in walk.feet:
        touches = foot.record.start is None or len(foot.stances.touchdown) > 0
        if not touches and not foot.is_dead:
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
        if far and walk.settings.foot_rolling_m is None and foot.slip_from == "points":
            where, metres = f"feet.{foot.name}.contact_travel_m", np.nanmax(reach)
            yield found("SLIPS", where=where, foot=foot.name, metres=metres, stances=far)


WHOLE_TOLERANCE: Final = 0.05
"""By how much the ratio may miss a whole number of summed physics steps, relative to it."""
MOST_STEPS: Final = 100
"""Physics steps that one message may hold."""
NOT_VERTICAL: Final = 0.1
"""Ratio below which the force is hardly along the world's z."""
MOST_PUSH: Final = 0.05
"""Share of the weight that feet may push a robot on, over whole stances, that does not speed up."""
_RATIO: Final = "forces.vertical_impulse_over_weight"


def no_force(walk: Walk) -> Iterator[Finding]:
    """Yield feet whose sensors tell contact only."""
    if walk.settings.contact_from:
        return
    for foot in walk.feet:
        touches = len(foot.stances.touchdown) > 0
        if touches and not foot.record.has_force and not is_stuck(foot.record, walk.records):
            yield found("NO_FORCE", where=f"feet.{foot.name}.peak_force_n", foot=foot.name)


def mass_unknown(walk: Walk) -> Iterator[Finding]:
    """Yield what stands for the weight of a robot whose mass is not given."""
    if walk.settings.mass_kg is not None:
        return
    weight_n = walk.loads.weight_n
    say = "plain" if weight_n is None else "estimated"
    yield found("MASS_UNKNOWN", where=_RATIO, say=say, weight=weight_n)


def impulse_is_not_weight(walk: Walk) -> Iterator[Finding]:
    """Yield that the feet's forces do not add up to the weight, and what that refutes."""
    loads = walk.loads
    ratio, magnitude = loads.vertical_impulse_over_weight, loads.magnitude_over_weight
    tolerance = REFUTED if walk.settings.contact_from else WEIGHT_TOLERANCE
    missing = walk.settings.lacks_feet and (ratio or 0.0) < 1.0
    if magnitude is not None and "shares" in loads.refuted:
        say, odd = "magnitude", magnitude
    elif ratio is None and (loads.mean_vertical_n or 0.0) < 0.0:
        say, odd = "downwards", 0.0
    elif ratio is not None and not missing and abs(ratio - 1.0) > tolerance:
        say, odd = "plain", ratio
    else:
        return
    words: Words = {"loads": loads, "ratio": odd, "cause": _likely_cause(walk, odd)}
    yield found("IMPULSE_IS_NOT_WEIGHT", *loads.refuted, where=_RATIO, say=say, **words)


def forces_lean(walk: Walk) -> Iterator[Finding]:
    """Yield that forces may be in the frames of legs, or do not add up to nothing on the ground."""
    if _may_lean(walk):
        yield found("DIRECTION_UNKNOWN", where="feet", loads=walk.loads)
    if push := _refuted_push(walk):
        way = "on" if push > 0.0 else "back"
        yield found("DIRECTION_UNKNOWN", where="feet", say="push", way=way, share=abs(push))


def direction_is_doubtful(walk: Walk) -> bool:
    """Tell whether the feet's forces are refuted, or their direction is."""
    refuted = {"direction", "vertical", "units"}.intersection(walk.loads.refuted)
    return bool(refuted) or _may_lean(walk) or _refuted_push(walk) is not None


def _may_lean(walk: Walk) -> bool:
    return walk.settings.wrench_frame_is_inferred and walk.loads.may_be_tilted


def _refuted_push(walk: Walk) -> float | None:
    """Return the share of the weight that the feet push on; None: no more than motion explains."""
    push, base = net_push(walk.feet), walk.base
    if push is None or base is None or not base.duration_s:
        return None
    if "direction" in walk.loads.refuted or _may_lean(walk):
        return None
    speeds = abs(base.forward_speed_mps or 0.0) / (GRAVITY_MPS2 * base.duration_s)
    return push if abs(push) > MOST_PUSH + 2.0 * speeds else None


def _likely_cause(walk: Walk, ratio: float) -> str:
    """Return the most likely reason why the feet's vertical impulse misses the weight."""
    mass_kg = walk.settings.mass_kg or 0.0
    silent = [foot.name for foot in walk.feet if foot.is_dead or foot.record.start is None]
    steps = round(ratio)
    if ratio < NOT_VERTICAL:
        return "the wrenches seem to be in a link's frame, or the sensors in other units"
    if silent and ratio < 1.0:
        return f"the load on {' and '.join(silent)} is missing"
    if 2 <= steps <= MOST_STEPS and abs(ratio - steps) <= WHOLE_TOLERANCE * steps:
        return f"{steps} physics steps seem to be added up in each message, or the mass is wrong"
    origin = "assumed for the guessed robot" if walk.settings.mass_is_assumed else "given"
    return f"the feet carry {ratio * mass_kg:.3g} kg, and the mass {origin} is {mass_kg:.4g} kg"


def foot_frames(walk: Walk) -> Iterator[Finding]:
    """Yield frames that move while their feet stand, and what tells no touchdown velocities."""
    legs = walk.legs.feet if walk.legs else ()
    for leg in legs:
        if leg.moves:
            where = f"legs.feet.{leg.name}.clearance_m"
            yield found("FOOT_FRAME", where=where, feet=(leg.name,), why=leg.reason)
    if slow := [leg.name for leg in legs if leg.is_slow]:
        names = ", ".join(slow)
        yield found("SAMPLED_SLOWLY", "touchdown", where="legs.feet", feet=slow, names=names)


def joint_clocks(walk: Walk) -> Iterator[Finding]:
    """Yield joint states on another clock than the feet."""
    for topic, clock in walk.legs.clocks_apart.items() if walk.legs else ():
        yield found("CLOCK_OFFSET", "joints", topic=topic, milliseconds=1e3 * clock.most_s)


def joint_work(walk: Walk) -> Iterator[Finding]:
    """Yield why the work of joints is not known, or its signs are wrong."""
    if walk.legs is None or walk.legs.clocks_apart:
        return
    # Loaded for logs of which joints are known.
    from dogbot_logtool.core.checks.joints import work_doubts  # noqa: PLC0415

    yield from work_doubts(walk, walk.legs)
