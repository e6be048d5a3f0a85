"""Whether the numbers of joint states can be what they should: rad, rad/s and N m."""

from collections.abc import Container, Sequence
from typing import Final

from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.legs.joint_track import JointHistory

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


def contradiction(
    moving: Sequence[JointHistory], of_legs: Container[str], weight_n: float | None
) -> str:
    """Say which numbers contradict each other, a leg or the weight; empty if none do.

    Args:
        moving: joints that move.
        of_legs: names of those of legs.
        weight_n: N, of the robot; None: not known.
    """
    return _velocities(moving) or _positions(moving, of_legs) or _efforts(moving, weight_n)


def _velocities(moving: Sequence[JointHistory]) -> str:
    """Say whose velocities are not those of their positions."""
    told = [joint for joint in moving if joint.velocity_told]
    squared = sum(joint.told_squared for joint in told)
    judged = [joint for joint in told if joint.told_squared > _MOVES_MUCH * squared]
    odd = [joint for joint in judged if not _fits(_ratio([joint]), OF_A_JOINT_AGREE)]
    if not odd and (not judged or _fits(_ratio(told), VELOCITIES_AGREE)):
        return ""
    if 0 < len(odd) < len(judged):
        ratios = ", ".join(f"{joint.name} ({_ratio([joint]):.3g} times)" for joint in odd)
        return f"velocities of some joints are not those of their positions: {ratios}"
    return f"velocities of joint states are {_ratio(told):.3g} times those of their positions"


def _ratio(joints: Sequence[JointHistory]) -> float:
    """Return the slope of velocities told over those of positions; infinite where unrelated."""
    squared = sum(joint.told_squared for joint in joints)
    moved = sum(joint.told_moved for joint in joints)
    return squared / moved if moved != 0.0 else float("inf")


def _fits(ratio: float, factor: float) -> bool:
    return 1.0 / factor <= ratio <= factor


def _positions(moving: Sequence[JointHistory], of_legs: Container[str]) -> str:
    """Say why the positions of legs are no angles in rad."""
    ranges = [joint.highest - joint.lowest for joint in moving if joint.name in of_legs]
    usual = float(median_of(ranges)) if ranges else 0.0
    return f"half of the legs' joints move by {usual:.3g} rad and more" if usual > WIDEST else ""


def _efforts(moving: Sequence[JointHistory], weight_n: float | None) -> str:
    """Say why the efforts are no torques in N m."""
    strongest = max(joint.peak_effort for joint in moving if joint.has_effort)
    if weight_n is None or WEAKEST <= strongest / weight_n <= STRONGEST:
        return ""
    return (
        f"the largest effort is {strongest:.3g}, which is no torque in N m on a robot of "
        f"{weight_n:.3g} N"
    )
