"""Which efforts have a sign or a size that the log contradicts, and what is not known for that.

Absolute work, and so the mechanical cost of transport, is the same with either sign.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.base.poses import BaseHistory, without_jumps
from dogbot_logtool.core.checks.loads import direction_is_doubtful
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.legs.effort_signs import LegSigns, leg_signs, shortfall
from dogbot_logtool.core.legs.foot_path import FootPath
from dogbot_logtool.core.legs.leg_figures import LegFigures, LegFoot, SignDoubt
from dogbot_logtool.core.legs.leg_history import LegHistory
from dogbot_logtool.core.statistics import Stats

OTHER_UNIT: Final = 3.0
"""Work of legs over that of the ground's forces: a larger factor, or one over it, is of units."""
_MOST_NAMED: Final = 6


def with_effort_doubts(stats: Stats, history: LegHistory, legs: LegFigures) -> LegFigures:
    """Check signs and size of efforts, and leave out what rests on those that are contradicted.

    Args:
        stats: all other figures.
        history: what was kept of the legs.
        legs: their figures.
    """
    if legs.work_unknown or not stats.feet:
        return legs
    base = without_jumps(stats.base_history, stats.jumps)
    named: dict[str, LegSigns] = {}
    # Forces whose direction is doubtful are no judges.
    rows = zip(stats.feet, legs.feet, history.paths, strict=True)
    for foot, leg, path in () if direction_is_doubtful(stats) else rows:
        if (signs := _leg(foot, leg, path, base, legs)) is not None:
            named[leg.name] = signs
    unit = _other_unit(stats, named)
    if unit:
        return legs.without_work(unit)
    doubts = _doubts_of_legs(named, legs)
    if not doubts and len(named) < len(legs.feet):
        doubts = _doubts_of_all(stats, legs, base)
    return _without(legs, tuple(doubts)) if doubts else legs


def _other_unit(stats: Stats, judged: Mapping[str, LegSigns]) -> str:
    """Say that the work of legs is of another size than that of the forces on their feet."""
    over_weight = stats.loads.vertical_impulse_over_weight
    newtons = over_weight is None or 0.5 < over_weight < 2.0
    scale = median_of([signs.scale for signs in judged.values()]) if judged else 1.0
    if not newtons or 1.0 / OTHER_UNIT <= scale <= OTHER_UNIT:
        return ""
    return f"the work of joints is {scale:.3g} times that of the forces on the feet"


def _leg(
    foot: FootSteps,
    leg: LegFoot,
    path: FootPath | None,
    base: BaseHistory,
    legs: LegFigures,
) -> LegSigns | None:
    """Judge the efforts of a leg by the force on its foot, where both are known."""
    told = foot.vertical_over_stride is not None and foot.forward_over_stride is not None
    if path is None or leg.footfalls is None or not told:
        return None
    own = [each.history for each in legs.joints if each.foot == leg.name]
    moving = [each for each in own if each.moves]
    return leg_signs(foot.record.stance_forces, foot.stances, path, base, moving)


def _doubts_of_legs(judged: Mapping[str, LegSigns], legs: LegFigures) -> list[SignDoubt]:
    """Say which legs contradict the forces on their feet; judged: legs by their foot."""
    odd = {foot: signs.odd for foot, signs in judged.items() if not signs.agree}
    if not odd:
        return []
    joints = [name for names in odd.values() for name in names]
    more = f" and {len(joints) - _MOST_NAMED} more" if len(joints) > _MOST_NAMED else ""
    text = (
        "motors do not do the work of the forces on the feet, but would with the other sign of "
        f"some efforts ({', '.join(joints[:_MOST_NAMED])}{more})"
    )
    sound = judged.keys() - odd.keys()
    names = frozenset(each.history.name for each in legs.joints if each.foot not in sound)
    return [SignDoubt(text, f"legs.feet.{next(iter(odd))}.positive_work_j", names)]


def _doubts_of_all(stats: Stats, legs: LegFigures, base: BaseHistory) -> list[SignDoubt]:
    """Judge the sum of all efforts by energy, where the base's height and all efforts are known."""
    weight = stats.loads.weight_n
    astray = stats.base_clock_is_apart or stats.loses_way
    if weight is None or astray or legs.without_effort:
        return []
    strides = stats.feet[stats.reference].strides
    short = shortfall(legs.work, strides, base, weight)
    if short is None:
        return []
    text = (
        f"the joints' work is {short:.3g} J a stride short of what lifts and speeds up the robot, "
        "before any losses: efforts have the wrong sign, or something else drives it (it is "
        "pushed, or goes down a slope that the poses do not tell)"
    )
    names = frozenset(joint.history.name for joint in legs.joints)
    return [SignDoubt(text, "legs.positive_work_j", names)]


def _without(legs: LegFigures, doubts: tuple[SignDoubt, ...]) -> LegFigures:
    """Return figures without those that rest on the signs of doubted efforts."""
    names = frozenset[str]().union(*(doubt.joints for doubt in doubts))
    doubted = {joint.foot for joint in legs.joints if joint.history.name in names}
    return replace(
        legs,
        work=legs.work.without_signs(),
        feet=tuple(
            replace(leg, work=leg.work.without_signs()) if leg.name in doubted else leg
            for leg in legs.feet
        ),
        joints=tuple(
            replace(joint, work=joint.work.without_signs())
            if joint.history.name in names
            else joint
            for joint in legs.joints
        ),
        sign_doubts=doubts,
    )
