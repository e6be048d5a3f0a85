"""From joint states and transforms to all that is known of the legs."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, aggregate
from dogbot_logtool.core.base.foot_path import Footfalls, FootPath, footfalls
from dogbot_logtool.core.corrections.clock import ClockDifference, too_far_apart
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.gait.strides import typical_period_s
from dogbot_logtool.core.legs.joints import JointTable, JointTrack, joint_tracks
from dogbot_logtool.core.legs.legs import LegFigures, LegFoot, joint_curve, summed_work
from dogbot_logtool.core.legs.paths import LegSettings, foot_path, link_tracks
from dogbot_logtool.core.legs.swings import (
    STEPS,
    SWINGS,
    is_slow,
    steps,
    swings,
)
from dogbot_logtool.core.loads import slip_m, symmetry_index_percent
from dogbot_logtool.core.metrics import Joint, Legs
from dogbot_logtool.core.walk import Walk

RESTING_M: Final = 0.02
"""m that a foot's frame may move in the middle of a stance, or `RESTING_SHARE` of its swing."""
RESTING_SHARE: Final = 0.15
IDLE: Final = 0.02
"""rad or m: joints of no leg that move by less are left out."""
SHORTEST_WAY_M: Final = 0.1
"""m: work is not set against a shorter way."""


def with_legs(
    walk: Walk,
    tables: Sequence[JointTable],
    settings: LegSettings,
    clocks: Sequence[ClockDifference],
) -> Walk:
    """Add what is known of the legs, and slips by the feet's frames where those are known.

    Args:
        walk: all other figures.
        tables: joint states, one table a topic, the best first.
        settings: sources of the legs.
        clocks: how far topics' clocks are from that of the feet, those of joint states among them.
    """
    joints = joint_tracks(tables, walk.settings.clock, settings.limits)
    links = link_tracks(settings.joints, joints)
    chained = {frame for chain in settings.chains if chain for frame in chain.frames}
    frames = walk.frames.tracks(chained) | links
    paths = [foot_path(chain, frames) for chain in settings.chains]
    if not joints and not any(path is not None for path in paths):
        return walk
    period = typical_period_s([foot.stances for foot in walk.feet])
    apart = too_far_apart(clocks, period) & set(settings.joint_topics)
    feet = _feet(walk, settings, joints, paths, joints_apart=bool(apart))
    strides = walk.feet[walk.reference].strides if walk.feet else None
    working = [each for each in joints.values() if each.moves and each.has_effort]
    work = np.empty((2, 0))
    if strides is not None:
        work = summed_work(working, strides.touchdown, strides.end)
    found, ranges = _joints(walk, settings, joints)
    legs = LegFigures(
        settings=settings,
        feet=feet,
        joints=joints,
        links=links,
        work=work,
        metrics=Legs(
            absolute_work_j=aggregate(work[1]),
            positive_work_j=aggregate(work[0]),
            mechanical_cost_of_transport=_cost(walk, work[1]),
            joints=found,
            asymmetry_percent=_asymmetry(settings, ranges),
        ),
        clocks_apart={each.topic: each for each in clocks if each.topic in apart},
    )
    pairs = zip(walk.feet, feet, strict=True)
    with_places = tuple(_with_lengths(_with_slips(*each), each[1]) for each in pairs)
    return replace(walk, legs=legs, feet=with_places)


def _with_lengths(foot: FootSteps, leg: LegFoot) -> FootSteps:
    """Return a foot with the lengths by its frame, where its sensor tells none of its own."""
    if foot.length_from != "base" or leg.reason:
        return foot
    length = leg.strides["swing_length_m"]
    known = bool(np.isfinite(length).any())
    return replace(foot, length_m=length, length_from="foot_frame") if known else foot


def _feet(
    walk: Walk,
    settings: LegSettings,
    joints: Mapping[str, JointTrack],
    paths: Sequence[FootPath | None],
    *,
    joints_apart: bool,
) -> tuple[LegFoot, ...]:
    """Return the leg of each foot."""
    base = walk.poses
    legs, stood = [], []
    for row, foot in enumerate(walk.feet):
        chain, path = settings.chains[row], paths[row]
        reason = settings.reasons[row]
        if chain is not None and path is None:
            reason = "too little of its leg is told"
        elif path is not None and walk.base_clock_is_apart:
            reason = "the clocks of odometry and feet differ"
        elif path is not None and walk.loses_way:
            reason = "the odometry drifts among the contact points"
        elif path is not None and joints_apart and settings.joints:
            reason = "the clock of the joint states differs from that of the feet"
        elif path is not None and not len(base.time):
            reason = "the log has no usable poses"
        own = [each for name, each in joints.items() if settings.foot_of_joint.get(name) == row]
        leg = LegFoot(
            name=foot.name,
            frame=chain.frames[0] if chain else "",
            reason=reason,
            moves=False,
            path=path,
            slips=None,
            strides=_leg_work(foot, own),
            height=None,
            is_slow=False,
        )
        falls = None
        if path is not None and not reason:
            leg, falls = _swinging(leg, foot, path.in_world(base))
        if falls is not None and chain is not None:
            rolling = None if chain.touches else walk.settings.foot_rolling_m
            slips = falls.slip_m, falls.largest_slip_m
            if rolling is not None:
                slips = slip_m(slips[0], rolling), slip_m(slips[1], rolling)
            # The middle of a ball rolls with it: less the rolling, if that is known.
            leg = replace(leg, slips=slips if chain.touches or rolling is not None else None)
        legs.append(leg)
        stood.append(falls)
    return tuple(
        replace(leg, strides={**leg.strides, **_steps(walk, row, stood)})
        for row, leg in enumerate(legs)
    )


def _leg_work(foot: FootSteps, joints: Sequence[JointTrack]) -> dict[str, Floats]:
    """Return the work of a leg in the strides of its foot, with NaN for what else is of strides."""
    unknown = np.full(len(foot.strides.stance), np.nan)
    found = dict.fromkeys((*SWINGS, *STEPS, "positive_work_j", "absolute_work_j"), unknown)
    if all(joint.has_effort or not joint.moves for joint in joints):
        work = summed_work(joints, foot.strides.touchdown, foot.strides.end)
        found["positive_work_j"], found["absolute_work_j"] = work
    return found


def _swinging(leg: LegFoot, foot: FootSteps, path: FootPath) -> tuple[LegFoot, Footfalls | None]:
    """Add the swings of a foot by its path in the world, if it is at rest in stances."""
    stood = footfalls(path, foot.stances)
    travel = aggregate(stood.travel_m[foot.stances.whole])
    if travel is None:
        return replace(leg, reason="no whole stance in which its leg is told"), None
    interval_s = foot.record.median_interval_s or np.inf
    found, height = swings(path, stood, foot.strides, interval_s)
    length = aggregate(found["swing_length_m"])
    if travel.median > max(RESTING_M, RESTING_SHARE * (length.median if length else 0.0)):
        reason = (
            f"its frame moves by {travel.median * 1e3:.0f} mm in the middle of a stance: it is not "
            "the foot's, the odometry drifts, or the foot slips"
        )
        return replace(leg, reason=reason, moves=True), None
    slow = is_slow(path, interval_s)
    leg = replace(leg, strides={**leg.strides, **found}, height=height, is_slow=slow)
    return leg, stood


def _steps(walk: Walk, row: int, stood: Sequence[Footfalls | None]) -> dict[str, Floats]:
    """Return the steps of a foot against the other of its pair, where both are known."""
    others = [
        number for number in range(len(walk.feet)) if number != row and walk.paired(row, number)
    ]
    own = stood[row]
    other = stood[others[0]] if len(others) == 1 else None
    if own is None or other is None:
        return {}
    return steps(walk.feet[row].strides, own, other, walk.feet[others[0]].stances.touchdown)


def _joints(
    walk: Walk, settings: LegSettings, joints: Mapping[str, JointTrack]
) -> tuple[dict[str, Joint], dict[str, float]]:
    """Return the metrics of joints of legs and of others that move, and their usual ranges."""
    found: dict[str, Joint] = {}
    ranges: dict[str, float] = {}
    for name, joint in joints.items():
        number = settings.foot_of_joint.get(name)
        if number is None and joint.range < IDLE:
            continue
        found[name] = joint.metrics
        if number is not None:
            foot = walk.feet[number]
            curve = joint_curve(joint, foot.strides)
            ranges |= {} if curve is None else {name: curve[1]}
            position = None if curve is None else curve[0]
            found[name] = replace(joint.metrics, foot=foot.name, position_over_stride=position)
    return found, ranges


def _asymmetry(settings: LegSettings, ranges: Mapping[str, float]) -> dict[str, float]:
    """Compare the usual ranges of joints that are alike, right against left."""
    indices = {
        pair.name: symmetry_index_percent(ranges.get(pair.left), ranges.get(pair.right))
        for pair in settings.pairs
    }
    return {name: index for name, index in indices.items() if index is not None}


def _cost(walk: Walk, absolute_j: Floats) -> float | None:
    """Return absolute work / (weight x way), over the reference foot's strides that have both."""
    weight = walk.loads.weight_n
    if weight is None or not walk.feet:
        return None
    way = walk.feet[walk.reference].base_way_m
    known = np.isfinite(absolute_j) & np.isfinite(way)
    total = float(way[known].sum())
    return float(absolute_j[known].sum()) / (weight * total) if total >= SHORTEST_WAY_M else None


def _with_slips(foot: FootSteps, leg: LegFoot) -> FootSteps:
    """Return a foot with the slips of its frame, where these are known."""
    slips = leg.slips
    if slips is None:
        return foot
    return replace(foot, slip_m=slips[0], slip_largest_m=slips[1], slip_from="foot_frame")
