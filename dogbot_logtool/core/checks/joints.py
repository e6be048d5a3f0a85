"""Reasons to doubt joint states: their numbers contradict themselves, or the forces on the feet.

While a foot stands, the motors of its leg give what the ground's force takes: the sum of their work
is minus the force times the way of the foot in the base's frame (virtual work of a leg without
mass; a leg's inertia blurs it, but does not turn it round). Where no forces tell, only the sum over
all joints can be judged: over whole strides motors lift and speed up the robot and make up for
losses, which are never negative.
"""

from collections import Counter
from collections.abc import Container, Iterator, Sequence
from itertools import permutations, product
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of
from dogbot_logtool.core.base.foot_path import FootPath
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.checks.feet import direction_is_doubtful
from dogbot_logtool.core.contact.stances import FootTrack
from dogbot_logtool.core.gait.feet import FootSteps, stride_curve
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.legs.joints import JointTrack, LegFigures, joint_work
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate
from dogbot_logtool.core.settings import GRAVITY_MPS2
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
WIDEST: Final = 6.28
"""rad, range that half of a robot's leg joints do not exceed: of degrees any step does."""
WEAKEST: Final = 1e-3
"""m: a largest effort of a leg below this much of the weight times a metre is in another unit. Also
`STRONGEST`, above which it is."""
STRONGEST: Final = 10.0

CONTRADICTS: Final = 0.75
"""Cosine of work given and taken up to which efforts as recorded are doubted, if with other signs
it reaches `AGREES`. A quadruped in a physics engine has 0.9 to 1 with the right signs."""
AGREES: Final = 0.9
_MATTERS: Final = 0.1
"""By so much a joint's sign changes that cosine, if it is to be named."""
_SECTIONS: Final = 5
"""Sections of a stance in which work is compared."""
_FEWEST_STANCES: Final = 3
_MOST_JOINTS: Final = 10
"""Joints of a leg: all combinations of their signs are tried."""
_FEWEST_STRIDES: Final = 4
SURELY_LOST: Final = 0.1
"""Share of the absolute work by which its sum must fall short of the work that lifts and speeds up
the robot. Errors of joint states, such as a filter's delay of the velocity, are smaller."""


def contradiction(
    moving: Sequence[JointTrack], of_legs: Container[str], weight_n: float | None
) -> str:
    """Say which numbers cannot be rad, rad/s and N m; empty if all can.

    Args:
        moving: joints that move, at least one with an effort.
        of_legs: names of those of legs.
        weight_n: N, of the robot; None: not known.
    """
    if odd := _odd_velocities(moving):
        return odd
    ranges = [joint.range for joint in moving if joint.name in of_legs]
    usual = float(median_of(ranges)) if ranges else 0.0
    if usual > WIDEST:
        return f"half of the legs' joints move by {usual:.3g} rad and more"
    strongest = max(joint.metrics.peak_effort or 0.0 for joint in moving)
    if weight_n is None or WEAKEST <= strongest / weight_n <= STRONGEST:
        return ""
    return (
        f"the largest effort is {strongest:.3g}, which is no torque in N m on a robot of "
        f"{weight_n:.3g} N"
    )


def _odd_velocities(moving: Sequence[JointTrack]) -> str:
    """Say whose velocities are not those of their positions."""
    squared = np.array([joint.reported_squared for joint in moving])
    moved = np.array([joint.reported_moved for joint in moving])
    # Velocities that have nothing to do with the positions are infinitely too large.
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios, total = squared / moved, squared.sum() / moved.sum()
    judged = (squared > 0.0) & (squared > _MOVES_MUCH * squared.sum())
    odd = np.flatnonzero(judged & ~_fits(ratios, OF_A_JOINT_AGREE))
    if not len(odd) and (not judged.any() or _fits(total, VELOCITIES_AGREE)):
        return ""
    if 0 < len(odd) < judged.sum():
        named = ", ".join(f"{moving[row].name} ({ratios[row]:.3g} times)" for row in odd.tolist())
        return f"velocities of some joints are not those of their positions: {named}"
    return f"velocities of joint states are {total:.3g} times those of their positions"


def _fits(ratio: Floats, factor: float) -> Flags:
    fits: Flags = (ratio >= 1.0 / factor) & (ratio <= factor)
    return fits


LegSigns = tuple[tuple[str, ...], float]
"""Joints with which the efforts of a leg would do the work of the ground's force, if theirs had the
other sign; and the size of that work, with those signs, over that of the force."""


def leg_signs(
    foot: FootSteps, path: FootPath, base: BaseHistory, joints: Sequence[JointTrack]
) -> LegSigns | None:
    """Compare the work of a leg's motors with that of the force at its foot.

    Args:
        foot: its forces and stances.
        path: of the foot in the base's frame.
        base: poses without jumps.
        joints: of the leg, those that move, all with efforts.

    Returns:
        None where too little is known.
    """
    stances = foot.stances
    known = np.isfinite(stances.figures.mean_vertical_force_n)
    rows = np.flatnonzero(stances.whole & known)
    if not 0 < len(joints) <= _MOST_JOINTS or not len(rows):
        return None
    duration = (stances.liftoff - stances.touchdown)[rows, None]
    shares = np.linspace(0.0, 1.0, _SECTIONS + 1)
    edges = stances.touchdown[rows, None] + np.rint(duration * shares).astype(np.int64)
    begin, end = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    absorbed = _absorbed(foot.record.track, edges, path, base)
    works = [joint_work(joint, begin, end) for joint in joints]
    given = np.stack([2.0 * positive - absolute for positive, absolute in works], axis=1)
    known = np.isfinite(absorbed) & np.isfinite(given).all(axis=1)
    if known.sum() < _FEWEST_STANCES * _SECTIONS:
        return None
    return _judged(given[known], absorbed[known], [joint.name for joint in joints])


def _absorbed(track: FootTrack, edges: Ints, path: FootPath, base: BaseHistory) -> Floats:
    """(stances * sections,) J, that the ground's force takes; NaN where not known.

    Args:
        track: forces of the foot.
        edges: (stances, sections + 1) ns.
        path: of the foot in the base's frame.
        base: poses.
    """
    begin, end = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    displacement = np.diff(path.at(edges), axis=1).reshape(-1, 3)
    displacement = rotate(
        from_roll_pitch_yaw(base.angles_at(begin + (end - begin) // 2)), displacement
    )
    force = track.mean_force(begin, end)
    return np.where(path.unbroken(begin, end), -(force * displacement).sum(axis=1), np.nan)


def _judged(given: Floats, absorbed: Floats, names: Sequence[str]) -> LegSigns | None:
    """Compare work as recorded, and with other signs of efforts, with what is taken.

    Args:
        given: (n, joints) J.
        absorbed: (n,) J.
        names: of the joints.
    """
    turned = np.array(list(product((1.0, -1.0), repeat=len(names))))
    likeness = _cosines(given, absorbed, turned)
    agree = bool(likeness[0] > CONTRADICTS)
    best = 0 if agree else int(likeness.argmax())
    if not agree and likeness[best] < AGREES:
        return None
    back = turned[best] * (1.0 - 2.0 * np.eye(len(names)))
    without = likeness[best] - _cosines(given, absorbed, back)
    odd = (turned[best] < 0.0) & (without >= _MATTERS)
    if not agree and not odd.any():
        return None
    scale = float(np.linalg.norm(given @ turned[best]) / np.linalg.norm(absorbed))
    return tuple(np.array(names)[odd].tolist()), scale


def _cosines(given: Floats, absorbed: Floats, signs: Floats) -> Floats:
    """(k,) cosine of what is taken and the sum over joints; signs: (k, joints) of their efforts."""
    squares = ((signs @ (given.T @ given)) * signs).sum(axis=1) * (absorbed @ absorbed)
    lengths = np.sqrt(np.maximum(squares, 0.0))
    return np.asarray(signs @ (given.T @ absorbed) / np.where(lengths > 0.0, lengths, np.inf))


def shortfall(work: Floats, strides: Strides, base: BaseHistory, weight_n: float) -> float | None:
    """Return by how much the motors' work falls short of what the robot gains, J a stride.

    Args:
        work: (2, strides) J, positive and absolute, of all joints.
        strides: of a foot.
        base: poses without jumps.
        weight_n: N, of the robot.

    Returns:
        None where it does not clearly, or too little is known: losses are at least zero.
    """
    half = (strides.end - strides.touchdown) // 2
    before, after = (_head_m(base, time, half) for time in (strides.touchdown, strides.end))
    positive, absolute = work
    short = weight_n * (after - before) - (2.0 * positive - absolute)
    known = np.isfinite(short)
    short, absolute = short[known], absolute[known]
    if len(short) < _FEWEST_STRIDES:
        return None
    surely = float(short.mean() - 2.0 * short.std(ddof=1) / np.sqrt(len(short)))
    is_short = surely > 0.0 and short.sum() > SURELY_LOST * absolute.sum()
    return float(short.mean()) if is_short else None


def _head_m(base: BaseHistory, time: Ints, half: Ints) -> Floats:
    """(n,) m, the base's energy over its weight: its height, and that of its mean speed.

    Args:
        base: poses without jumps.
        time: (n,) ns.
        half: (n,) ns, of what the speed is a mean over.
    """
    displacement = base.position_at(time + half) - base.position_at(time - half)
    squared = (displacement * displacement).sum(axis=1) / (2.0 * half / 1e9) ** 2
    head: Floats = base.position_at(time)[:, 2] + squared / (2.0 * GRAVITY_MPS2)
    return head


def work_doubts(walk: Walk, legs: LegFigures) -> Iterator[Finding]:
    """Yield why the work of joints is not known: the first reason of those that there are."""
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
        return "the joint states' efforts are empty, zero or constant"
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
    period = walk.period_s
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
        moving = [joint for joint in legs.joints_of(row) if joint.works]
        signs = leg_signs(foot, leg.path, walk.poses, moving)
        if signs is not None:
            judged[leg.name] = signs
    return judged


def _other_unit(walk: Walk, judged: dict[str, LegSigns]) -> str:
    """Say that the work of legs is of another size than that of the forces on their feet."""
    over_weight = walk.loads.vertical_impulse_over_weight
    newtons = over_weight is None or 0.5 < over_weight < 2.0
    scale = median_of([scale for _, scale in judged.values()]) if judged else 1.0
    if not newtons or 1.0 / OTHER_UNIT <= scale <= OTHER_UNIT:
        return ""
    return f"the work of joints is {scale:.3g} times that of the forces on the feet"


def _effort_signs(
    walk: Walk, legs: LegFigures, judged: dict[str, LegSigns], *, judges_all: bool
) -> Iterator[Finding]:
    """Yield efforts of the wrong sign: of legs, or else by energy of all joints together."""
    odd = {foot: names for foot, (names, _) in judged.items() if names}
    sound = judged.keys() - odd.keys()
    where, feet = "legs.positive_work_j", [foot.name for foot in walk.feet]
    if odd:
        feet = [name for name in feet if name not in sound]
        names = _named([name for each in odd.values() for name in each])
        yield found("EFFORT_SIGN", where=where, feet=feet, names=names)
        return
    weight, astray = walk.loads.weight_n, walk.base_clock_is_apart or walk.loses_track
    # Legs alone do not tell whether the base climbs.
    astray |= walk.settings.base_from_legs
    if weight is None or astray or not judges_all or len(judged) == len(legs.feet):
        return
    strides = walk.feet[walk.reference].strides
    short = shortfall(legs.work, strides, walk.poses, weight)
    if short is not None:
        yield found("EFFORT_SIGN", where=where, say="energy", feet=feet, short=short)
