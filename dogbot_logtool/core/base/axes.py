"""Which way is forward, and which side is left."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.ground import seen_from_base
from dogbot_logtool.core.base.motion import BaseTrack
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.leg_position import LegPosition
from dogbot_logtool.core.metrics import Base
from dogbot_logtool.core.settings import WalkSettings

STRAIGHT: Final = 0.9
"""Net way over path of a base that goes straight."""
SIDES_APART_M: Final = 0.02
"""m by which a left foot must be to the right of the right one for that to be said."""
CLEARLY: Final = 2.0
"""Times by which one direction exceeds the other where the forward axis is clear."""
WALKED_M: Final = 0.5
"""m, way to a side from which its direction means something."""


def with_forward_axis(
    settings: WalkSettings, track: BaseTrack, motion: Base | None, *, in_one_world: bool
) -> WalkSettings:
    """Let the fore and hind feet's contact points correct a guessed forward axis.

    Args:
        settings: with the forward axis of the robot.
        track: the poses of its base.
        motion: of the base along that axis; None: not known.
        in_one_world: whether base and contact points are, so that these tell of the body.
    """
    if not settings.forward_axis_is_assumed:
        return settings
    positions = [foot.leg_position for foot in settings.feet]
    tells = in_one_world and (motion is None or has_heading(motion))
    measured = axis_by_legs(track.history, track.feet, positions) if tells else None
    if measured is None:
        return settings
    if measured == settings.forward_axis:
        return replace(settings, forward_axis_is_assumed=False)
    because = "the fore feet are on that side of the hind feet"
    reason = f"{settings.forward_axis} of the guessed robot is not forward here: {because}"
    return replace(settings, forward_axis=measured, forward_axis_reason=reason)


def has_heading(motion: Base) -> bool:
    """Tell whether the heading turns with the way: one that never turns beside a bend is none."""
    net, path = motion.net_displacement_m or 0.0, motion.path_length_m or 0.0
    return bool(motion.yaw_rate_radps) or net >= STRAIGHT * path


def displacements_m(motion: Base | None) -> tuple[float, float]:
    """Return how far the base goes ahead and to the left, m; zeros where that is not known."""
    if motion is None or not has_heading(motion):
        return 0.0, 0.0
    speeds = motion.forward_speed_mps or 0.0, motion.lateral_speed_mps or 0.0
    seconds = motion.duration_s or 0.0
    return speeds[0] * seconds, speeds[1] * seconds


def axis_by_legs(
    base: BaseHistory, feet: Sequence[FootHistory], positions: Sequence[LegPosition | None]
) -> str | None:
    """Return the body's axis that points from the hind feet to the fore feet.

    Args:
        base: poses.
        feet: histories of all feet.
        positions: of each foot on the body.

    Returns:
        ``+x`` and so on; None where contact points and positions do not tell.
    """
    places = _usual_places(base, feet, positions)
    ends = [
        [place for (end, _), (_, place) in places.items() if end == name]
        for name in ("front", "back")
    ]
    if not all(ends):
        return None
    front, back = (np.mean(each, axis=0) for each in ends)
    return nearest_axis(front - back)


def swapped_pairs(
    base: BaseHistory,
    feet: Sequence[FootHistory],
    positions: Sequence[LegPosition | None],
    forward_rad: float,
) -> tuple[tuple[tuple[int, int], ...], int]:
    """Return the pairs of which the left foot touches to the right of the right one.

    Args:
        base: poses.
        feet: histories of all feet.
        positions: of each foot on the body.
        forward_rad: from the body's x axis to the axis that points forward.

    Returns:
        left and right foot of those pairs, and how many pairs contact points tell of.
    """
    places = _usual_places(base, feet, positions)
    left_axis = np.array([-np.sin(forward_rad), np.cos(forward_rad)])
    pairs = [
        (row, places[end, "right"][0], float((usual - places[end, "right"][1]) @ left_axis))
        for (end, side), (row, usual) in places.items()
        if side == "left" and (end, "right") in places
    ]
    swapped = tuple((left, right) for left, right, apart in pairs if apart < -SIDES_APART_M)
    return swapped, len(pairs)


def _usual_places(
    base: BaseHistory, feet: Sequence[FootHistory], positions: Sequence[LegPosition | None]
) -> dict[LegPosition, tuple[int, Floats]]:
    """Return each foot and its contact points' mean, (2,) m along the body's x and y."""
    seen = [seen_from_base(foot, base)[1] for foot in feet]
    return {
        position: (row, place.mean(axis=0))
        for row, (place, position) in enumerate(zip(seen, positions, strict=True))
        if position is not None and len(place)
    }


def nearest_axis(direction: Floats) -> str | None:
    """Return the axis that a (2,) direction in the body clearly follows; None: it does not."""
    x, y = direction.tolist()
    if max(abs(x), abs(y)) <= CLEARLY * min(abs(x), abs(y)):
        return None
    if abs(x) > abs(y):
        return "+x" if x > 0.0 else "-x"
    return "+y" if y > 0.0 else "-y"
