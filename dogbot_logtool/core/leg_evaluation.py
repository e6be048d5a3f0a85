"""From joint states and transforms to all that is known of the legs."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, aggregate
from dogbot_logtool.core.base.foot_path import Footfalls, FootPath, footfalls
from dogbot_logtool.core.base.witness import by_legs
from dogbot_logtool.core.corrections.clock import too_far_apart
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.legs.joints import (
    JointTrack,
    LegFigures,
    LegFoot,
    joint_curve,
    joint_tracks,
    summed_work,
)
from dogbot_logtool.core.legs.swings import (
    LegChain,
    LegSettings,
    foot_path,
    is_slow,
    link_tracks,
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
UNPLACED: Final = "where the base is among the feet is not known"
SHORTEST_PATH_M: Final = 0.1
"""m: work is not set against a shorter way."""


def with_legs(walk: Walk, settings: LegSettings) -> Walk:
    """Add what is known of the legs, and slips by the feet's frames where those are known.

    Args:
        walk: all other figures.
        settings: sources of the legs.
    """
    joints = joint_tracks(walk.recording.joints, walk.settings.clock, settings.limits)
    for name in {each.name for each in settings.joints if each.source} & joints.keys():
        joints[name] = joints[name]._replace(follows=True)
    chained = {frame for chain in settings.chains if chain for frame in chain.frames}
    links = link_tracks(settings.joints, joints)
    frames = walk.frames.tracks(chained) | links
    paths = [foot_path(chain, frames) for chain in settings.chains]
    if not joints and not any(path is not None for path in paths):
        return walk
    clocks = walk.corrected.joint_clocks
    apart = too_far_apart(clocks, walk.period_s) & set(settings.joint_topics)
    unplaced = walk.base_clock_is_apart or walk.loses_track or not len(walk.poses.time)
    unplaced |= bool(apart and settings.joints)
    legs, stood, feet = [], [], []
    for row, (foot, path) in enumerate(zip(walk.feet, paths, strict=True)):
        leg, falls, swung = _leg(walk, settings, row, path, UNPLACED if unplaced else "")
        own = [each for name, each in joints.items() if settings.foot_of_joint.get(name) == row]
        own = [each for each in own if each.works or not each.moves]
        work = summed_work(own, foot.strides.touchdown, foot.strides.end)
        of_leg = swung | dict(zip(("positive_work_j", "absolute_work_j"), work, strict=True))
        feet.append(_with_frame(walk, settings.chains[row], foot, of_leg, falls))
        legs.append(leg)
        stood.append(falls)
    strides = walk.feet[walk.reference].strides if walk.feet else None
    working = [each for each in joints.values() if each.moves and each.has_effort]
    work = np.empty((2, 0))
    if strides is not None:
        work = summed_work(working, strides.touchdown, strides.end)
    found, ranges = _joints(walk, settings, joints)
    figures = LegFigures(
        settings=settings,
        feet=tuple(legs),
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
    witness = walk.witness
    if witness is None and not walk.settings.base_from_legs:
        witness = by_legs(paths, walk.records, walk.corrected.base)
    feet = [
        foot._replace(of_strides={**foot.of_strides, **_steps(walk, row, stood)})
        for row, foot in enumerate(feet)
    ]
    return replace(walk, legs=figures, feet=tuple(feet), witness=witness)


def _leg(
    walk: Walk, settings: LegSettings, row: int, path: FootPath | None, unplaced: str
) -> tuple[LegFoot, Footfalls | None, dict[str, Floats]]:
    """Return the leg of a foot, and where that stands, and its swings, if its frame rests then.

    Args:
        walk: all other figures.
        settings: sources of the legs.
        row: of the foot.
        path: of the foot in the base's frame; None: not known.
        unplaced: why paths cannot be placed in the world; empty: they can.
    """
    foot, chain = walk.feet[row], settings.chains[row]
    too_little = "" if path else "too little of its leg is told"
    reason = settings.reasons[row] or too_little or unplaced
    leg = LegFoot(foot.name, chain.frames[0] if chain else "", reason, path)
    if path is None or leg.reason:
        return leg, None, {}
    world = path.in_world(walk.poses)
    stood = footfalls(world, foot.stances)
    travel = aggregate(stood.travel_m[foot.stances.whole])
    if travel is None:
        return leg._replace(reason="no whole stance in which its leg is told"), None, {}
    interval_s = foot.record.median_interval_s or np.inf
    found, height = swings(world, stood, foot.strides, interval_s)
    length = aggregate(found["swing_length_m"])
    if travel.median > max(RESTING_M, RESTING_SHARE * (length.median if length else 0.0)):
        reason = (
            f"its frame moves by {travel.median * 1e3:.0f} mm in the middle of a stance: it is not "
            "the foot's, the odometry drifts, or the foot slips"
        )
        return leg._replace(reason=reason, moves=True), None, {}
    slow = is_slow(world, interval_s)
    return leg._replace(height=height, is_slow=slow), stood, found


def _with_frame(
    walk: Walk,
    chain: LegChain | None,
    foot: FootSteps,
    of_leg: Mapping[str, Floats],
    stood: Footfalls | None,
) -> FootSteps:
    """Return a foot with what its leg tells: slips too, and lengths where its sensor has none."""
    foot = foot._replace(of_strides={**foot.of_strides, **of_leg})
    if stood is None or chain is None:
        return foot
    length = of_leg["swing_length_m"]
    if foot.length_from == "base" and np.isfinite(length).any():
        lengths = {**foot.of_strides, "stride_length_m": length}
        foot = foot._replace(of_strides=lengths, length_from="foot_frame")
    # The middle of a ball rolls with it: less the rolling, if that is known.
    rolling = 0.0 if chain.touches else walk.settings.foot_rolling_m
    if rolling is None:
        return foot
    slips = {
        "slip_m": slip_m(stood.slip_m, rolling),
        "slip_largest_m": slip_m(stood.largest_slip_m, rolling),
    }
    return foot._replace(of_stances={**foot.of_stances, **slips}, slip_from="foot_frame")


def _steps(walk: Walk, row: int, stood: Sequence[Footfalls | None]) -> dict[str, Floats]:
    """Return the steps of a foot against the other of its pair, where both are known."""
    others = [other for other in range(len(walk.feet)) if other != row and walk.paired(row, other)]
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
        name: symmetry_index_percent(ranges.get(left), ranges.get(right))
        for name, (left, right) in settings.pairs.items()
    }
    return {name: index for name, index in indices.items() if index is not None}


def _cost(walk: Walk, absolute_j: Floats) -> float | None:
    """Return absolute work / (weight x way), over the reference foot's strides that have both."""
    weight = walk.loads.weight_n
    if weight is None or not walk.feet:
        return None
    displacement = walk.feet[walk.reference].of_strides["base_displacement_m"]
    known = np.isfinite(absolute_j) & np.isfinite(displacement)
    total = float(displacement[known].sum())
    return float(absolute_j[known].sum()) / (weight * total) if total >= SHORTEST_PATH_M else None
