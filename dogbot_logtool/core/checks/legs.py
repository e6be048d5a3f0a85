"""Checks of joints and of the feet's frames."""

from collections import Counter
from collections.abc import Iterator
from itertools import permutations
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.checks.loads import direction_is_doubtful
from dogbot_logtool.core.gait.feet import stride_curve
from dogbot_logtool.core.gait.strides import typical_period_s
from dogbot_logtool.core.legs.doubts import LegSigns, contradiction, leg_signs, shortfall
from dogbot_logtool.core.legs.joints import LegFigures
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found

FEWEST_STATES: Final = 16
"""States of a joint in a stride; with fewer its work may be off by a tenth."""
OTHER_UNIT: Final = 3.0
"""Work of legs over that of the ground's forces: a larger factor, or one over it, is of units."""
_MOST_NAMED: Final = 6
_WORK: Final = "legs.absolute_work_j"


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
    """Yield why the work of joints is not known: the first reason of those that there are."""
    legs = walk.legs
    if legs is None or legs.clocks_apart:
        return
    if missing := _no_work(legs) or _lacking(walk, legs):
        yield found("JOINT_VALUES", "missing", where=_WORK, why=missing)
        return
    if slow := _too_slow(walk, legs):
        yield found("SAMPLED_SLOWLY", "work", where=_WORK, why=slow)
        return
    signs = _signs(walk, legs)
    odd = contradiction(legs.moving, legs.settings.foot_of_joint, walk.loads.weight_n)
    if odd := odd or _other_unit(walk, signs):
        case = "velocities" if odd.startswith("velocities") else "efforts"
        yield found("JOINT_VALUES", case, where=_WORK, why=odd)
        return
    without = [joint.name for joint in legs.moving if not joint.has_effort]
    if without:
        yield found("JOINT_VALUES", "some_missing", where=_WORK, names=_named(without))
    yield from _effort_signs(walk, legs, signs, judges_all=not without)


def _named(names: list[str]) -> str:
    """Return some names, not too many."""
    more = len(names) - _MOST_NAMED
    return ", ".join(names[:_MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _no_work(legs: LegFigures) -> str:
    """Say which efforts are missing; empty if none are."""
    moving = legs.moving
    if not moving:
        return "no joint states tell of joints that move"
    if not any(joint.has_effort for joint in moving):
        peaks = [joint.peak_effort for joint in moving if np.isfinite(joint.peak_effort)]
        how = ("constant" if any(peaks) else "constantly zero") if peaks else "empty"
        return f"the joint states' efforts are {how}"
    of_legs = legs.settings.foot_of_joint
    lacking = [each.name for each in moving if each.name in of_legs and not each.has_effort]
    return f"joints of legs tell no effort: {', '.join(lacking)}" if lacking else ""


def _lacking(walk: Walk, legs: LegFigures) -> str:
    """Say which joints of legs are missing; empty if none are known to be."""
    if legs.settings.lacking:
        return f"joint states do not tell of {', '.join(legs.settings.lacking)}"
    count = Counter(legs.settings.foot_of_joint.get(name) for name in legs.joints)
    for row, other in permutations(range(len(walk.feet)), 2):
        if 0 < count[row] < count[other] and walk.paired(row, other):
            one, more = (f"{walk.feet[each].name} ({count[each]})" for each in (row, other))
            return f"joint states tell of fewer joints of {one} than of {more}"
    return ""


def _too_slow(walk: Walk, legs: LegFigures) -> str:
    """Say that joint states of legs come too rarely for work; empty if they do not."""
    period = typical_period_s([foot.stances for foot in walk.feet])
    of_legs = legs.settings.foot_of_joint
    own = [joint for joint in legs.moving if joint.name in of_legs] or legs.moving
    states = min(joint.rate_hz for joint in own) * period if period else FEWEST_STATES
    if period is None or states >= FEWEST_STATES:
        return ""
    return f"joint states come {states:.3g} times in a stride of {period:.2f} s"


def _signs(walk: Walk, legs: LegFigures) -> dict[str, LegSigns]:
    """Judge the efforts of each leg by the force on its foot, where both are known."""
    if not walk.feet or direction_is_doubtful(walk):
        return {}
    judged = {}
    for row, (foot, leg) in enumerate(zip(walk.feet, legs.feet, strict=True)):
        pushes = stride_curve(foot, foot.strides, forward=True)
        if leg.path is None or leg.reason or pushes is None:
            continue
        moving = [joint for joint in legs.joints_of(row) if joint.moves]
        signs = leg_signs(foot.record.track, foot.stances, leg.path, walk.poses, moving)
        if signs is not None:
            judged[leg.name] = signs
    return judged


def _other_unit(walk: Walk, judged: dict[str, LegSigns]) -> str:
    """Say that the work of legs is of another size than that of the forces on their feet."""
    over_weight = walk.loads.vertical_impulse_over_weight
    newtons = over_weight is None or 0.5 < over_weight < 2.0
    scale = median_of([signs.scale for signs in judged.values()]) if judged else 1.0
    if not newtons or 1.0 / OTHER_UNIT <= scale <= OTHER_UNIT:
        return ""
    return f"the work of joints is {scale:.3g} times that of the forces on the feet"


def _effort_signs(
    walk: Walk, legs: LegFigures, judged: dict[str, LegSigns], *, judges_all: bool
) -> Iterator[Finding]:
    """Yield efforts of the wrong sign: of legs, or else by energy of all joints together."""
    odd = {foot: signs.odd for foot, signs in judged.items() if not signs.agree}
    sound = judged.keys() - odd.keys()
    where, feet = "legs.positive_work_j", [foot.name for foot in walk.feet]
    if odd:
        feet = [name for name in feet if name not in sound]
        names = _named([name for each in odd.values() for name in each])
        yield found("EFFORT_SIGN", where=where, feet=feet, names=names)
        return
    weight, astray = walk.loads.weight_n, walk.base_clock_is_apart or walk.loses_track
    if weight is None or astray or not judges_all or len(judged) == len(legs.feet):
        return
    strides = walk.feet[walk.reference].strides
    short = shortfall(legs.work, strides, walk.poses, weight)
    if short is not None:
        yield found("EFFORT_SIGN", where=where, say="energy", feet=feet, short=short)
