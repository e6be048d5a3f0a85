"""Forces of the ground on the feet, by the torques of the legs' motors.

Motors of a leg carry its own links and push the ground: ``tau = sum(m Jc^T (c'' + s)) - J^T f``,
with m the links' masses at c, s what an accelerometer on the base reads, and f the ground's force
on the foot (Featherstone 2008); solved for f.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, flagged_runs, latched, median_of
from dogbot_logtool.core.estimated.ground import Ground, slopes
from dogbot_logtool.core.frames.kinematics import LegMotion

LOADED: Final = 0.4
"""Share of the weight a foot, were it spread evenly, from which a foot is loaded."""
UNLOADED: Final = 0.2
"""The same, below which it is not any more."""
BOUNCE: Final = 0.35
"""Share of the usual time without rest below which a foot without load bounces, or less than
`LONGEST_BOUNCE_S`."""
LONGEST_BOUNCE_S: Final = 0.08
RESTED: Final = 0.2
"""Share of a foot's time under load in which it rests, at least."""
FORCE_ONLY: Final = 1e-6
"""How little forces are damped in a least-squares fit, and how much `MOMENT` moments at a foot."""
MOMENT: Final = 1e-2
CARRY: Final = (0.75, 1.33)
"""Mean vertical force of all feet over the weight within which efforts are torques in N m."""
WRONG_SIGN: Final = "efforts have the wrong sign"
TOO_MUCH: Final = "by the efforts, feet carry"


def ground_forces(
    seconds: Floats,
    legs: Sequence[LegMotion],
    points: Floats,
    efforts: Sequence[Floats],
    felt: Floats,
) -> Floats:
    """Return the ground's force on each foot by the torques of its leg.

    Args:
        seconds: (n,) s.
        legs: of each foot.
        points: (n, f, 3) m, where feet touch the ground, along the base's axes.
        efforts: (n, k) N m or N of each leg's joints.
        felt: (n, 3) m/s^2, what an accelerometer on the base reads: gravity, upwards.

    Returns:
        (n, f, 3) N along the base's axes.
    """
    forces = [
        _force(seconds, leg, points[:, foot], efforts[foot], felt) for foot, leg in enumerate(legs)
    ]
    return np.stack(forces, axis=1)


def _force(seconds: Floats, leg: LegMotion, point: Floats, effort: Floats, felt: Floats) -> Floats:
    """(n, 3) N, the force on a foot; moments too where joints tell, which are damped."""
    carried = np.zeros_like(effort)
    for number, mass in enumerate(leg.leg.masses):
        centre = leg.centres[:, number]
        moved, _ = leg.jacobian(centre, mass.joint + 1)
        pull = mass.mass_kg * (slopes(seconds, slopes(seconds, centre)) + felt)
        carried += np.einsum("nik,ni->nk", moved, pull)
    moved, turned = leg.jacobian(point)
    both = np.concatenate([moved, turned], axis=1)
    damped = np.diag([FORCE_ONLY] * 3 + [MOMENT] * 3)
    square = both @ both.transpose(0, 2, 1) + damped
    asked = np.einsum("nik,nk->ni", both, carried - effort)
    return np.asarray(np.linalg.solve(square, asked[:, :, None])[:, :3, 0])


def loaded_feet(seconds: Floats, vertical: Floats, weight_n: float, ground: Ground) -> Flags:
    """(n, f) which feet carry a load, and rest meanwhile, but for touchdown and lift-off.

    Args:
        seconds: (n,) s.
        vertical: (n, f) N, of the ground on each foot.
        weight_n: N, of the robot.
        ground: what the motion of the feet tells.
    """
    share = weight_n / vertical.shape[1]
    on, off = vertical >= LOADED * share, vertical < UNLOADED * share
    loaded = latched(on & ~ground.fast, off | ground.fast)
    for foot in range(vertical.shape[1]):
        resting = ground.resting[:, foot]
        # A foot that bounces at touchdown, while it is there already.
        swings = _lasting_s(seconds, flagged_runs(~resting))
        usual = float(median_of(swings)) if len(swings) else 0.0
        aloft = flagged_runs(~loaded[:, foot])
        short = _lasting_s(seconds, aloft) < min(BOUNCE * usual, LONGEST_BOUNCE_S)
        for first, behind in aloft[short].tolist():
            loaded[first:behind, foot] = True
        for first, behind in flagged_runs(loaded[:, foot]).tolist():
            if resting[first:behind].mean() < RESTED:
                loaded[first:behind, foot] = False
    return loaded


def _lasting_s(seconds: Floats, runs: Ints) -> Floats:
    """(k,) s from the first row of each run to its last."""
    return np.asarray(seconds[runs[:, 1] - 1] - seconds[runs[:, 0]])


def effort_fault(vertical: Floats, weight_n: float | None) -> str:
    """Say why efforts are no torques in N m; empty if they are.

    Args:
        vertical: (n, f) N, forces that follow from them.
        weight_n: N, of the robot; None: not known.
    """
    if weight_n is None:
        return "the mass is not known, so that efforts cannot be checked against the weight"
    ratio = float(vertical.sum(axis=1).mean()) / weight_n
    if CARRY[0] <= ratio <= CARRY[1]:
        return ""
    if -CARRY[1] <= ratio <= -CARRY[0]:
        return f"{WRONG_SIGN}: by them, the feet pull at the ground"
    return f"{TOO_MUCH} {ratio:.3g} times the weight: they are no torques in N m"
