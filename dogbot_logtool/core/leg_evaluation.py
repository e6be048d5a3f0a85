"""From joint states and transforms to all that is known of the legs.

The path of a foot in the base's frame comes from transforms, or from joints with their robot
description, at a low rate. A swing is a foot's way in the world, above the line between its
footfalls.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, aggregate, median_of
from dogbot_logtool.core.base.ground import Footfalls, FootPath, footfalls, known_path
from dogbot_logtool.core.base.witness import by_legs
from dogbot_logtool.core.clock import SLOWEST_S, first_at_each_tick, too_far_apart
from dogbot_logtool.core.frames.transforms import FrameTrack, lookup
from dogbot_logtool.core.gait.feet import CYCLE, FootSteps, cycle_curve
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.joints import (
    JointTrack,
    LegChain,
    LegFigures,
    LegFoot,
    LegSettings,
    joint_curve,
    joint_tracks,
    link_tracks,
    summed_work,
)
from dogbot_logtool.core.loads import slip_m, symmetry_index_percent
from dogbot_logtool.core.metrics import Joint, Legs
from dogbot_logtool.core.records import Shape
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.core.walk import Walk

RESTING_M: Final = 0.02
"""m that a foot's frame may move in the middle of a stance, or `RESTING_SHARE` of its swing."""
RESTING_SHARE: Final = 0.15
IDLE: Final = 0.02
"""rad or m: joints of no leg that move by less are left out."""
UNTOLD: Final = "neither transforms nor joint states tell where the foot is"
UNPLACED: Final = "where the base is among the feet is not known"
SHORTEST_PATH_M: Final = 0.1
"""m: work is not set against a shorter way."""


def with_legs(walk: Walk, settings: LegSettings) -> Walk:
    """Add what is known of the legs, and slips by the feet's frames where those are known.

    Args:
        walk: all other figures.
        settings: sources of the legs.
    """
    joints = joint_tracks(walk.recording.joints, walk.settings.clock, settings)
    chained = {frame for chain in settings.chains if chain for frame in chain.frames}
    links = link_tracks(settings.joints, joints)
    frames = walk.frames.tracks(chained) | links
    paths = [foot_path(chain, frames) for chain in settings.chains]
    clocks = walk.corrected.joint_clocks
    apart = too_far_apart(clocks, walk.period_s) & {table.topic for table in walk.recording.joints}
    unplaced = walk.base_clock_is_apart or walk.loses_track or not len(walk.poses.time)
    unplaced |= bool(apart and settings.joints)
    why = UNPLACED if unplaced else ""
    legs = [_leg(walk, row, path, why) for row, path in enumerate(paths)]
    feet = tuple(_with_leg(walk, settings, row, legs, joints.values()) for row in range(len(legs)))
    strides = walk.feet[walk.reference].strides if walk.feet else None
    working = [each for each in joints.values() if each.moves and each.has_effort]
    work = np.empty((2, 0)) if strides is None else summed_work(working, strides)
    found, ranges = _joints(walk, joints)
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
    return replace(walk, legs=figures, feet=feet, witness=witness)


def _leg(walk: Walk, row: int, path: FootPath | None, unplaced: str) -> LegFoot:
    """Return the leg of a foot, and where that stands, and its swings, if its frame rests then.

    Args:
        walk: all other figures.
        row: of the foot.
        path: of the foot in the base's frame; None: not known.
        unplaced: why paths cannot be placed in the world; empty: they can.
    """
    foot, reason = walk.feet[row], unplaced if path else UNTOLD
    leg = LegFoot(foot.name, reason, path, {})
    if path is None or reason:
        return leg
    world = path.in_world(walk.poses)
    stood = footfalls(world, foot.stances)
    travel = aggregate(stood.travel_m[foot.stances.whole])
    if travel is None:
        return leg._replace(reason="no whole stance in which its leg is told")
    interval_s = foot.record.median_interval_s or np.inf
    found, height = swings(world, stood, foot.strides, interval_s)
    length = aggregate(found["swing_length_m"])
    if travel.median > max(RESTING_M, RESTING_SHARE * (length.median if length else 0.0)):
        reason = (
            f"its frame moves by {travel.median * 1e3:.0f} mm in the middle of a stance: it is not "
            "the foot's, the odometry drifts, or the foot slips"
        )
        return leg._replace(reason=reason, moves=True)
    slow = is_slow(world, interval_s)
    return leg._replace(stood=stood, swings=found, height=height, is_slow=slow)


def _with_leg(
    walk: Walk,
    settings: LegSettings,
    row: int,
    legs: Sequence[LegFoot],
    joints: Iterable[JointTrack],
) -> FootSteps:
    """Return a foot with what its leg tells: swings, steps, work; slips, and lengths by its frame.

    Args:
        walk: all other figures.
        settings: sources of the legs.
        row: of the foot.
        legs: of all feet.
        joints: of all legs.
    """
    foot, leg, chain = walk.feet[row], legs[row], settings.chains[row]
    own = [each for each in joints if each.foot == row and (each.works or not each.moves)]
    work = summed_work(own, foot.strides)
    done = dict(zip(("positive_work_j", "absolute_work_j"), work, strict=True))
    of_strides = {**foot.of_strides, **leg.swings, **_steps(walk, row, legs), **done}
    if leg.stood is None or chain is None:
        return foot._replace(of_strides=of_strides)
    if foot.length_from == "base" and np.isfinite(leg.swings["swing_length_m"]).any():
        of_strides["stride_length_m"] = leg.swings["swing_length_m"]
        foot = foot._replace(length_from="foot_frame")
    # The middle of a ball rolls with it: less the rolling, if that is known.
    rolling = 0.0 if any(chain.point) else walk.settings.foot_rolling_m
    if rolling is not None:
        slips = {
            "slip_m": slip_m(leg.stood.slip_m, rolling),
            "slip_largest_m": slip_m(leg.stood.largest_slip_m, rolling),
        }
        foot = foot._replace(of_stances={**foot.of_stances, **slips}, slip_from="foot_frame")
    return foot._replace(of_strides=of_strides)


def _steps(walk: Walk, row: int, legs: Sequence[LegFoot]) -> dict[str, Floats]:
    """Return the steps that a foot's swings end with, where both feet of its pair are known.

    Returns:
        (strides,) m each, from the other foot's footfall along the foot's own swing, and across it.
    """
    others = [other for other in range(len(legs)) if other != row and walk.paired(row, other)]
    own = legs[row].stood
    other = legs[others[0]].stood if len(others) == 1 else None
    if own is None or other is None:
        return {}
    strides = walk.feet[row].strides
    before, after = own.position[strides.stance], own.position[strides.stance + 1]
    last = np.searchsorted(walk.feet[others[0]].stances.touchdown, strides.end) - 1
    there = np.where((last >= 0)[:, None], other.position[last], np.nan)
    swing, step = (after - before)[:, :2], (after - there)[:, :2]
    length = np.hypot(*swing.T)
    length[~(length >= SHORTEST_STEP_M)] = np.nan
    across = np.abs(step[:, 0] * swing[:, 1] - step[:, 1] * swing[:, 0])
    along = (step * swing).sum(axis=1)
    return {"step_length_m": along / length, "step_width_m": across / length}


def _joints(
    walk: Walk, joints: Mapping[str, JointTrack]
) -> tuple[dict[str, Joint], dict[str, float]]:
    """Return the metrics of joints of legs and of others that move, and their usual ranges."""
    found: dict[str, Joint] = {}
    ranges: dict[str, float] = {}
    for name, joint in joints.items():
        if joint.foot is None and joint.range < IDLE:
            continue
        found[name] = joint.metrics
        if joint.foot is not None:
            foot = walk.feet[joint.foot]
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


TRANSFORM_RATE_HZ: Final = 200.0


def foot_path(chain: LegChain | None, frames: Mapping[str, FrameTrack]) -> FootPath | None:
    """Return the path of a foot in the base's frame; None where too little is known.

    Args:
        chain: of the foot.
        frames: by transforms and joints.
    """
    own = [frames.get(frame) for frame in chain.frames] if chain else []
    moving = [track for track in own if track and not track.static]
    if chain is None or None in own or not moving:
        return None
    last = moving[0]
    rows = first_at_each_tick(last.time, TRANSFORM_RATE_HZ)
    time, log_time = last.time[rows], last.log_time[rows]
    poses = lookup(frames, chain.frames[0], chain.base, time, log_time)
    position = poses.translation + rotate(poses.rotation, np.array([chain.point]))
    position[~poses.known] = np.nan
    return known_path(time, position.astype(np.float32)) if poses.known.any() else None


APPROACH_S: Final = 0.03
"""s before a touchdown that its velocity is taken from."""
FEWEST_ROWS: Final = 4
"""Rows of the path that its velocity is taken from."""
SHORTEST_STEP_M: Final = 0.05
"""m: a shorter swing does not tell the direction of walking."""


def swings(
    path: FootPath, stood: Footfalls, strides: Strides, contact_interval_s: float
) -> tuple[dict[str, Floats], Shape]:
    """Measure a foot's swings.

    Args:
        path: of the foot in the world.
        stood: its footfalls, by stance.
        strides: of the foot, whose stances have one after them.
        contact_interval_s: s between its contact samples: touchdowns may be so much earlier.

    Returns:
        (strides,) by the name of the metric, NaN where not known; and the height over the stride
        above the line between the footfalls before and after, m.
    """
    before, after = stood.position[strides.stance], stood.position[strides.stance + 1]
    known = path.unbroken(strides.touchdown, strides.end)
    known &= np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)

    def height_from(start: Ints) -> Floats:
        """(strides, points) m, above the line between the footfalls, from some times to the end."""
        time = start[:, None] + np.rint((strides.end - start)[:, None] * CYCLE).astype(np.int64)
        return _above_line(path.at(time), before[:, None], after[:, None])

    length = np.hypot(*(after - before)[:, :2].T)
    velocity = _approach(path, strides, contact_interval_s)
    values = {
        "clearance_m": np.where(known, height_from(strides.liftoff).max(axis=1), np.nan),
        "swing_length_m": np.where(known, length, np.nan),
        "touchdown_down_mps": -velocity[:, 2],
        "touchdown_along_mps": np.hypot(velocity[:, 0], velocity[:, 1]),
    }
    return values, cycle_curve(height_from(strides.touchdown)[known])


def is_slow(path: FootPath, contact_interval_s: float) -> bool:
    """Tell whether path or contacts are sampled too rarely for velocities at touchdown."""
    intervals = contact_interval_s, float(median_of(np.diff(path.time))) / 1e9
    return not all(each <= SLOWEST_S for each in intervals)


def _above_line(position: Floats, before: Floats, after: Floats) -> Floats:
    """Return how high points lie above the line between two footfalls; shapes broadcast, m."""
    since, displacement = position - before, after - before
    along, squared = ((each * displacement)[..., :2].sum(axis=-1) for each in (since, displacement))
    share = np.clip(along / np.maximum(squared, 1e-6), 0.0, 1.0)
    return np.asarray(since[..., 2] - share * displacement[..., 2])


def _approach(path: FootPath, strides: Strides, contact_interval_s: float) -> Floats:
    """(n, 3) m/s, velocity of the foot when it was last known to be in the air.

    It is the slope there of the parabola that fits the path's last rows, `APPROACH_S` of them but
    at least four. NaN where path or contacts are told too rarely, or the swing is shorter.
    """
    if is_slow(path, contact_interval_s):
        return np.full((len(strides.end), 3), np.nan)
    interval = float(median_of(np.diff(path.time)))
    rows = max(FEWEST_ROWS, round(APPROACH_S * 1e9 / interval))
    aloft = strides.end - round(contact_interval_s * 1e9)
    last = path.time[np.searchsorted(path.time, aloft, side="right") - 1]
    time = last[:, None] - np.rint(interval * np.arange(rows)).astype(np.int64)
    since_s = (time - aloft[:, None]) / 1e9
    slope = np.linalg.pinv(np.stack([since_s**0, since_s, since_s**2], axis=-1))[:, 1]
    velocity: Floats = np.einsum("nt,ntc->nc", slope, path.at(time))
    known = path.unbroken(time[:, -1], aloft) & (time[:, -1] >= strides.liftoff)
    velocity[~known] = np.nan
    return velocity
