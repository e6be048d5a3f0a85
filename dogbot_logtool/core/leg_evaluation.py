"""The figures of the legs, worked out from what was kept of joints and of the feet's frames."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, aggregate
from dogbot_logtool.core.base.poses import BaseHistory, without_jumps
from dogbot_logtool.core.corrections.clock import ClockDifference, too_far_apart
from dogbot_logtool.core.effort_doubts import with_effort_doubts
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.gait.standing import typical_period_s
from dogbot_logtool.core.legs.foot_path import FootPath
from dogbot_logtool.core.legs.joint_cycles import (
    Work,
    joint_curve,
    joint_work,
    no_work,
    summed,
)
from dogbot_logtool.core.legs.joint_track import JointHistory
from dogbot_logtool.core.legs.joint_values import contradiction
from dogbot_logtool.core.legs.leg_figures import LegFigures, LegFoot, LegJoint
from dogbot_logtool.core.legs.leg_history import LegHistory
from dogbot_logtool.core.legs.settings import LegSettings
from dogbot_logtool.core.legs.swings import (
    RESTING_M,
    RESTING_SHARE,
    Steps,
    footfalls,
    no_swings,
    steps,
    swings,
    world_path,
)
from dogbot_logtool.core.load.slip import slip_m
from dogbot_logtool.core.statistics import Stats

IDLE: Final = 0.02
"""rad or m: joints of no leg that move by less are left out."""
FEWEST_STATES: Final = 16
"""States of a joint in a stride; with fewer its work may be off by a tenth."""
SHORTEST_WAY_M: Final = 0.1
"""m: work is not set against a shorter way."""


def with_legs(stats: Stats, history: LegHistory, clocks: Sequence[ClockDifference]) -> Stats:
    """Add the figures of the legs, and slips by the feet's frames where those are known.

    Args:
        stats: all other figures.
        history: what was kept of the legs.
        clocks: how far topics' clocks are from that of the feet, those of joint states among them.
    """
    if not history.joints and not any(path is not None for path in history.paths):
        return stats
    period = typical_period_s([foot.stances for foot in stats.feet])
    apart = too_far_apart(clocks, period) & set(history.settings.joint_topics)
    feet = _feet(stats, history, by_joints_apart=bool(apart))
    legs = _figures(
        stats, history, feet, {each.topic: each for each in clocks if each.topic in apart}
    )
    legs = with_effort_doubts(stats, history, legs)
    slipping = [_slip_of(stats, leg) for leg in legs.feet]
    if not any(falls is not None for falls in slipping):
        return replace(stats, legs=legs)
    return replace(stats, legs=legs, feet=_slips(stats.feet, slipping))


def _slip_of(stats: Stats, leg: LegFoot) -> tuple[Floats, Floats] | None:
    """(stances,) m each, net and largest slip by the foot's frame; None where it is not known.

    The middle of a ball rolls with it: less the rolling, if that is known.
    """
    if leg.footfalls is None:
        return None
    net, largest = leg.footfalls.slip_m, leg.footfalls.largest_slip_m
    if leg.touches:
        return net, largest
    rolling = stats.settings.foot_rolling_m
    return None if rolling is None else (slip_m(net, rolling), slip_m(largest, rolling))


def _slips(
    feet: Sequence[FootSteps], slipping: Sequence[tuple[Floats, Floats] | None]
) -> tuple[FootSteps, ...]:
    """Return feet with the slips of their frames."""
    return tuple(
        foot
        if falls is None
        else replace(
            foot,
            slip_m=falls[0],
            slip_largest_m=falls[1],
            slip_from="foot_frame",
        )
        for foot, falls in zip(feet, slipping, strict=True)
    )


def _feet(stats: Stats, history: LegHistory, *, by_joints_apart: bool) -> tuple[LegFoot, ...]:
    base = without_jumps(stats.base_history, stats.jumps)
    found = []
    for row, foot in enumerate(stats.feet):
        chain, path = history.settings.chains[row], history.paths[row]
        reason = history.settings.reasons[row]
        if chain is not None and path is None:
            reason = "too little of its leg is told"
        elif path is not None and stats.base_clock_is_apart:
            reason = "the clocks of odometry and feet differ"
        elif path is not None and stats.loses_way:
            reason = "the odometry drifts among the contact points"
        elif path is not None and by_joints_apart and chain is not None and chain.joints:
            reason = "the clock of the joint states differs from that of the feet"
        elif path is not None and not len(base.time):
            reason = "the log has no usable poses"
        found.append(_foot(foot, path, base, reason))
    return tuple(
        replace(leg, steps=_steps(stats, row, found))
        for row, leg in enumerate(_named(found, history))
    )


def _named(found: Sequence[LegFoot], history: LegHistory) -> list[LegFoot]:
    """Return legs with their frames."""
    return [
        leg if chain is None else replace(leg, frame=chain.frames[0], touches=chain.touches)
        for leg, chain in zip(found, history.settings.chains, strict=True)
    ]


def _foot(foot: FootSteps, path: FootPath | None, base: BaseHistory, reason: str) -> LegFoot:
    """Return the swings of a foot, if its frame is at rest in stances."""
    count = len(foot.strides.stance)
    unknown = np.full(count, np.nan)
    leg = LegFoot(
        name=foot.name,
        frame="",
        reason=reason,
        moves=False,
        touches=False,
        travel_m=None,
        footfalls=None,
        swings=no_swings(count),
        steps=Steps(unknown, unknown),
        work=no_work(count),
    )
    if path is None or reason:
        return leg
    world = world_path(path, base)
    stood = footfalls(world, foot.stances)
    travel = aggregate(stood.travel_m[foot.stances.whole])
    if travel is None:
        return replace(leg, reason="no whole stance in which its leg is told")
    found = swings(world, stood, foot.strides, foot.record.median_interval_s or np.inf)
    length = aggregate(found.length_m)
    allowed = max(RESTING_M, RESTING_SHARE * (length.median if length else 0.0))
    if travel.median > allowed:
        reason = (
            f"its frame moves by {travel.median * 1e3:.0f} mm in the middle of a stance: it is not "
            "the foot's, the odometry drifts, or the foot slips"
        )
        return replace(leg, travel_m=travel, reason=reason, moves=True)
    return replace(leg, travel_m=travel, footfalls=stood, swings=found)


def _steps(stats: Stats, row: int, legs: Sequence[LegFoot]) -> Steps:
    """Return the steps of a foot against the other of its pair, where both are known."""
    strides = stats.feet[row].strides
    unknown = np.full(len(strides.stance), np.nan)
    own = stats.feet[row].leg_position
    others = [
        number
        for number, foot in enumerate(stats.feet)
        if number != row
        and (len(stats.feet) == 2 or (foot.leg_position and own and foot.leg_position[0] == own[0]))
    ]
    stood = legs[row].footfalls
    other = legs[others[0]].footfalls if len(others) == 1 else None
    if stood is None or other is None or not len(strides.stance):
        return Steps(unknown, unknown)
    return steps(strides, stood, other, stats.feet[others[0]].stances)


def _figures(
    stats: Stats,
    history: LegHistory,
    feet: tuple[LegFoot, ...],
    clocks_apart: Mapping[str, ClockDifference],
) -> LegFigures:
    settings, joints = history.settings, history.joints
    moving = [each for each in joints if each.moves]
    slow = _too_slow(stats, settings, moving)
    missing = _work_unknown(history, clocks_apart) or _incomplete(stats, history) or slow
    weight = stats.loads.weight_n
    refuted = "" if missing else contradiction(moving, settings.foot_of_joint, weight)
    unknown = missing or refuted
    legs = []
    kept = [
        replace(
            _joint(stats, settings, joint, known=not unknown, timed=not clocks_apart),
            values_known=not refuted,
        )
        for joint in joints
        if joint.name in settings.foot_of_joint or joint.highest - joint.lowest >= IDLE
    ]
    for row, leg in enumerate(feet):
        count = len(stats.feet[row].strides.stance)
        own = [each.work for each in kept if each.foot == leg.name]
        legs.append(replace(leg, work=summed(own, count)))
    reference = stats.feet[stats.reference].strides if stats.feet else None
    count = 0 if reference is None else len(reference.stance)
    working = [each for each in moving if each.has_effort]
    work = no_work(count)
    if reference is not None and not unknown:
        work = summed(
            [joint_work(each, reference.touchdown, reference.end) for each in working], count
        )
    return LegFigures(
        settings=settings,
        feet=tuple(legs),
        joints=tuple(kept),
        work_unknown=unknown,
        work_refuted=bool(refuted),
        joints_slow=bool(slow) and missing == slow,
        without_effort=tuple(each.name for each in moving if not each.has_effort),
        work=work,
        cost_of_transport=_cost(stats, work),
        clocks_apart=clocks_apart,
    )


def _joint(
    stats: Stats, settings: LegSettings, joint: JointHistory, *, known: bool, timed: bool
) -> LegJoint:
    number = settings.foot_of_joint.get(joint.name)
    foot = stats.feet[stats.reference if number is None else number] if stats.feet else None
    strides = None if foot is None else foot.strides
    curve = joint_curve(joint, strides) if strides is not None and number is not None else None
    work = no_work(0 if strides is None else len(strides.stance))
    if strides is not None and known and (joint.has_effort or not joint.moves):
        work = joint_work(joint, strides.touchdown, strides.end)
    name = "" if number is None else stats.feet[number].name
    return LegJoint(joint, name, work, curve if timed else None)


def _incomplete(stats: Stats, history: LegHistory) -> str:
    """Say which joints of legs are missing; empty if none are known to be."""
    settings = history.settings
    if settings.untold:
        return f"joint states do not tell of {', '.join(settings.untold)}"
    count = Counter(settings.foot_of_joint.get(joint.name) for joint in history.joints)
    for row, foot in enumerate(stats.feet):
        for other, beside in enumerate(stats.feet):
            alike = len(stats.feet) == 2 or (foot.leg_position and _end(foot) == _end(beside))
            if alike and 0 < count[row] < count[other]:
                return (
                    f"joint states tell of fewer joints of {foot.name} ({count[row]}) than of "
                    f"{beside.name} ({count[other]})"
                )
    return ""


def _end(foot: FootSteps) -> str | None:
    return foot.leg_position[0] if foot.leg_position else None


def _too_slow(stats: Stats, settings: LegSettings, moving: Sequence[JointHistory]) -> str:
    """Say that joint states of legs come too rarely for work; empty if they do not."""
    period = typical_period_s([foot.stances for foot in stats.feet])
    own = [joint for joint in moving if joint.name in settings.foot_of_joint] or moving
    if period is None or not own:
        return ""
    rate = min(joint.messages / max(joint.known_s, 1e-9) for joint in own)
    if rate * period >= FEWEST_STATES:
        return ""
    return f"joint states come {rate * period:.3g} times in a stride of {period:.2f} s"


def _work_unknown(history: LegHistory, clocks_apart: Mapping[str, ClockDifference]) -> str:
    """Say what is missing for work to be known; empty if nothing is."""
    moving = [joint for joint in history.joints if joint.moves]
    if not moving:
        return "no joint states tell of joints that move"
    if not any(joint.has_effort for joint in moving):
        told = [joint for joint in moving if np.isfinite(joint.lowest_effort)]
        zero = all(joint.lowest_effort == 0.0 for joint in told)
        how = ("constantly zero" if zero else "constant") if told else "empty"
        return f"the joint states' efforts are {how}"
    of_legs = history.settings.foot_of_joint
    lacking = [each.name for each in moving if each.name in of_legs and not each.has_effort]
    if lacking:
        return f"joints of legs tell no effort: {', '.join(lacking)}"
    if clocks_apart:
        return f"the clock of {', '.join(sorted(clocks_apart))} differs from that of the feet"
    return ""


def _cost(stats: Stats, work: Work) -> float | None:
    """Return absolute work / (weight x way), over the reference foot's strides that have both."""
    weight = stats.loads.weight_n
    if weight is None or not stats.feet:
        return None
    way = stats.feet[stats.reference].length_m
    known = np.isfinite(work.absolute_j) & np.isfinite(way)
    total = float(way[known].sum())
    return (
        float(work.absolute_j[known].sum()) / (weight * total) if total >= SHORTEST_WAY_M else None
    )
