"""Reasons to doubt joint states: their numbers contradict themselves, or the forces on the feet.

While a foot stands, the motors of its leg give what the ground's force takes: the sum of their work
is minus the force times the way of the foot in the base's frame (virtual work of a leg without
mass; a leg's inertia blurs it, but does not turn it round). Where no forces tell, only the sum over
all joints can be judged: over whole strides motors lift the robot and make up for
losses, which are never negative.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import permutations
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, median_of
from dogbot_logtool.core.base.ground import FootPath
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.checks.feet import direction_is_doubtful
from dogbot_logtool.core.gait.feet import FootSteps, stride_curve
from dogbot_logtool.core.legs.joints import JointTrack, LegFigures, joint_work
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found

FEWEST_STATES: Final = 16
"""States of a joint in a stride; with fewer its work may be off by a tenth."""
OTHER_UNIT: Final = 3.0
"""Work of legs over that of the ground's forces: a larger factor, or one over it, is of units."""
_MOST_NAMED: Final = 6
_WORK: Final = "legs.absolute_work_j"
VELOCITIES_AGREE: Final = 1.25
"""By such a factor may the velocities that messages tell differ from those of the positions."""
OF_A_JOINT_AGREE: Final = 2.0
"""The same of a single joint, whose velocity may be noisy."""
_MOVES_MUCH: Final = 0.02
"""Share of the sum of squared velocities: joints with less are not judged alone."""
_LEAST_RANGE: Final = 0.01
"""rad or m: positions of a joint that moves less, in a stand, tell no velocity."""
WIDEST: Final = 6.28
"""rad, range that half of a robot's leg joints do not exceed: of degrees any step does."""
WEAKEST: Final = 1e-3
"""m: a largest effort of a leg below this much of the weight times a metre is in another unit. Also
`STRONGEST`, above which it is."""
STRONGEST: Final = 10.0

CONTRADICTS: Final = 0.75
"""Cosine of work given and taken up to which efforts as recorded are doubted, if with other signs
it reaches `AGREES`. With right signs, a quadruped in a physics engine has 0.9 to 1."""
AGREES: Final = 0.9
_MATTERS: Final = 0.3
"""Share of the work taken that a joint does, if it is to be named."""
_SECTIONS: Final = 5
"""Sections of a stance in which work is compared."""
_FEWEST_STANCES: Final = 3
_FEWEST_STRIDES: Final = 6
SURELY_LOST: Final = 0.1
"""Share of the absolute work by which its sum must fall short of the work that lifts the robot.
Errors of joint states, such as a filter's delay of the velocity, are smaller."""


def work_doubts(walk: Walk, legs: LegFigures) -> Iterator[Finding]:
    """Yield why the work of joints is not known: the first reason of those that there are."""
    if missing := _missing(walk, legs):
        yield found("JOINT_VALUES", "missing", where=_WORK, why=missing)
        return
    if slow := _too_slow(walk, legs):
        yield found("SAMPLED_SLOWLY", "work", where=_WORK, why=slow)
        return
    signs = _signs(walk, legs)
    odd = _odd_velocities(legs.moving)
    case = "velocities" if odd else "efforts"
    if odd := odd or _odd_efforts(walk, legs) or _other_unit(walk, signs):
        yield found("JOINT_VALUES", case, where=_WORK, why=odd)
        return
    yield from _effort_signs(walk, legs, signs)


def _named(names: list[str]) -> str:
    """Return some names, not too many."""
    more = len(names) - _MOST_NAMED
    return ", ".join(names[:_MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _missing(walk: Walk, legs: LegFigures) -> str:
    """Say which efforts or joints are missing; empty if none are known to be."""
    if not legs.moving:
        return "no joint states tell of joints that move"
    if not any(joint.has_effort for joint in legs.moving):
        return "the joint states' efforts are empty, zero or constant"
    if mute := [each.name for each in legs.moving if each.foot is not None and not each.has_effort]:
        return f"joints of legs tell no effort: {', '.join(mute)}"
    if legs.settings.lacking:
        return f"joint states do not tell of {', '.join(legs.settings.lacking)}"
    count = Counter(joint.foot for joint in legs.joints.values())
    for row, other in permutations(range(len(walk.feet)), 2):
        if 0 < count[row] < count[other] and walk.paired(row, other):
            one, more = (f"{walk.feet[each].name} ({count[each]})" for each in (row, other))
            return f"joint states tell of fewer joints of {one} than of {more}"
    return ""


def _too_slow(walk: Walk, legs: LegFigures) -> str:
    """Say that joint states of legs come too rarely for work; empty if they do not."""
    own = [joint for joint in legs.moving if joint.foot is not None] or legs.moving
    states = min(joint.rate_hz for joint in own) * (walk.period_s or np.inf)
    if states >= FEWEST_STATES:
        return ""
    return f"joint states come {states:.3g} times in a stride of {walk.period_s:.2f} s"


def _odd_velocities(moving: Sequence[JointTrack]) -> str:
    """Say that velocities are not those of their positions, and whose; empty if they are."""
    squared = np.array([joint.reported_squared for joint in moving])
    moved = np.array([joint.reported_moved for joint in moving])
    # Velocities that have nothing to do with the positions are infinitely too large.
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios, total = squared / moved, squared.sum() / moved.sum()
    judged = (squared > 0.0) & (squared > _MOVES_MUCH * squared.sum())
    judged &= np.array([joint.range for joint in moving]) > _LEAST_RANGE
    odd = np.flatnonzero(judged & ~_fits(ratios, OF_A_JOINT_AGREE)).tolist()
    if not odd and (not judged.any() or _fits(total, VELOCITIES_AGREE)):
        return ""
    whose = _named([f"{moving[row].name} ({ratios[row]:.3g} times)" for row in odd]) or "of most"
    return f"velocities of joints are {total:.3g} times those of their positions: {whose}"


def _fits(ratio: Floats, factor: float) -> Flags:
    fits: Flags = (ratio >= 1.0 / factor) & (ratio <= factor)
    return fits


def _odd_efforts(walk: Walk, legs: LegFigures) -> str:
    """Say which numbers of legs cannot be rad and N m; empty if all can."""
    weight_n = walk.loads.weight_n
    ranges = [joint.range for joint in legs.moving if joint.foot is not None]
    usual = float(median_of(ranges or [0.0]))
    if usual > WIDEST:
        return f"half of the legs' joints move by {usual:.3g} rad and more"
    strongest = max(joint.metrics.peak_effort or 0.0 for joint in legs.moving)
    if weight_n is None or WEAKEST <= strongest / weight_n <= STRONGEST:
        return ""
    what = f"no torque in N m on a robot of {weight_n:.3g} N"
    return f"the largest effort is {strongest:.3g}, which is {what}"


LegSigns = tuple[tuple[str, ...], float]
"""Joints with which the efforts of a leg would do the work of the ground's force, if theirs had the
other sign; and the size of that work over that of the force."""


def _signs(walk: Walk, legs: LegFigures) -> dict[str, LegSigns]:
    """Judge the efforts of each leg by the force on its foot, where both are known."""
    # Forces that were worked out from efforts agree with these, whatever their signs.
    if not walk.feet or direction_is_doubtful(walk) or walk.settings.contact_from:
        return {}
    judged = {}
    for row, (foot, leg) in enumerate(zip(walk.feet, legs.feet, strict=True)):
        joints = [joint for joint in legs.moving if joint.foot == row]
        pushes = stride_curve(foot, foot.strides, forward=True)
        if leg.path is None or leg.reason or pushes is None or not joints:
            continue
        signs = _leg_signs(foot, leg.path, walk.poses, joints)
        if signs is not None:
            judged[leg.name] = signs
    return judged


def _leg_signs(
    foot: FootSteps, path: FootPath, base: BaseHistory, joints: Sequence[JointTrack]
) -> LegSigns | None:
    """Compare the work of a leg's motors with that of the force at its foot, part by part.

    Args:
        foot: its forces and stances.
        path: of the foot in the base's frame.
        base: poses without jumps.
        joints: of the leg, those that move, all with efforts.

    Returns:
        None where too little is known, or no signs explain it.
    """
    stances = foot.stances
    rows = stances.whole & np.isfinite(stances.figures.mean_vertical_force_n)
    duration = (stances.liftoff - stances.touchdown)[rows, None]
    shares = np.linspace(0.0, 1.0, _SECTIONS + 1)
    edges = stances.touchdown[rows, None] + np.rint(duration * shares).astype(np.int64)
    begin, end = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    displacement = np.diff(path.at(edges), axis=1).reshape(-1, 3)
    turn = from_roll_pitch_yaw(base.angles_at(begin + (end - begin) // 2))
    force = foot.record.track.mean_force(begin, end)
    taken = -(force * rotate(turn, displacement)).sum(axis=1)
    works = [joint_work(joint, begin, end) for joint in joints]
    given = np.stack([2.0 * positive - absolute for positive, absolute in works], axis=1)
    known = path.unbroken(begin, end) & np.isfinite(taken) & np.isfinite(given).all(axis=1)
    if known.sum() < _FEWEST_STANCES * _SECTIONS:
        return None
    given, taken = given[known], taken[known]
    size = float(np.linalg.norm(taken))
    if _cosine(given.sum(axis=1), taken) > CONTRADICTS:
        return (), float(np.linalg.norm(given.sum(axis=1))) / size
    factors = np.linalg.lstsq(given, taken, rcond=None)[0]
    odd = (np.linalg.norm(given * factors, axis=0) > _MATTERS * size) & (factors < 0.0)
    turned = given @ np.where(odd, -1.0, 1.0)
    if not odd.any() or _cosine(turned, taken) < AGREES:
        return None
    names = tuple(joints[row].name for row in np.flatnonzero(odd).tolist())
    return names, float(np.linalg.norm(turned)) / size


def _cosine(one: Floats, other: Floats) -> float:
    """Return the cosine of the angle between two vectors; 0 of none."""
    sizes = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / sizes if sizes else 0.0


def _other_unit(walk: Walk, judged: dict[str, LegSigns]) -> str:
    """Say that the work of legs is of another size than that of the forces on their feet."""
    over_weight = walk.loads.vertical_impulse_over_weight
    newtons = over_weight is None or 0.5 < over_weight < 2.0
    scale = median_of([scale for _, scale in judged.values()]) if judged else 1.0
    if not newtons or 1.0 / OTHER_UNIT <= scale <= OTHER_UNIT:
        return ""
    return f"the work of joints is {scale:.3g} times that of the forces on the feet"


def _effort_signs(walk: Walk, legs: LegFigures, judged: dict[str, LegSigns]) -> Iterator[Finding]:
    """Yield efforts of the wrong sign: of legs, or else by energy of all joints together."""
    odd = {foot: names for foot, (names, _) in judged.items() if names}
    sound = judged.keys() - odd.keys()
    where, feet = "legs.positive_work_j", [foot.name for foot in walk.feet]
    if odd:
        feet = [name for name in feet if name not in sound]
        names = _named([name for each in odd.values() for name in each])
        yield found("EFFORT_SIGN", where=where, feet=feet, names=names)
    elif len(judged) < len(legs.feet) and (short := _shortfall(walk, legs)) is not None:
        yield found("EFFORT_SIGN", where=where, say="energy", feet=feet, short=short)


def _shortfall(walk: Walk, legs: LegFigures) -> float | None:
    """Return by how much the motors' work falls short of what lifts the robot, J a stride.

    Losses are at least zero. None where it does not clearly, or too little is known.
    """
    weight_n, astray = walk.loads.weight_n, walk.base_clock_is_apart or walk.loses_track
    # Legs alone do not tell whether the base climbs.
    if weight_n is None or astray or walk.settings.base_from_legs:
        return None
    strides, (positive, absolute) = walk.feet[walk.reference].strides, legs.work
    height = [walk.poses.position_at(each)[:, 2] for each in (strides.touchdown, strides.end)]
    short = weight_n * (height[1] - height[0]) - (2.0 * positive - absolute)
    known = np.isfinite(short)
    lost = float(short[known].sum()) > SURELY_LOST * float(absolute[known].sum())
    return float(short[known].mean()) if lost and known.sum() >= _FEWEST_STRIDES else None
