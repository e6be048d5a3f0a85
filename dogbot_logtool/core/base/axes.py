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
CLEARLY: Final = 2.0
"""Times by which one direction exceeds the other where the forward axis is clear."""


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
    places = usual_places(base, feet, positions)
    front, back = (
        [place for (end, _), place in places.items() if end == name] for name in ("front", "back")
    )
    return nearest_axis(np.mean(front, axis=0) - np.mean(back, axis=0)) if front and back else None


def usual_places(
    base: BaseHistory, feet: Sequence[FootHistory], positions: Sequence[LegPosition | None]
) -> dict[LegPosition, Floats]:
    """Return the mean of each foot's contact points, (2,) m along the body's x and y."""
    seen = [seen_from_base(foot, base)[1] for foot in feet]
    return {
        position: place.mean(axis=0)
        for place, position in zip(seen, positions, strict=True)
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
