"""The size of a robot and which way it looks, for pictures of it."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import median_of
from dogbot_logtool.core.base.ground import nearest_axis
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.robot.probe import Probe
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.robot_model.primitives import body_size_m
from dogbot_logtool.robot.robot_model.skeleton import Point
from dogbot_logtool.robot.topics.selection import Selection

_INSIDE: Final = 0.75
"""Hips over feet: how much nearer to the middle of the body they are assumed to be."""


@dataclass(frozen=True, slots=True)
class RobotShape:
    """The known shape of the robot."""

    forward_axis: str
    """The body axis that points forward, ``+x`` ..."""
    hips: Mapping[int, Point]
    """m, base frame: where legs are assumed to begin, by foot."""
    height_m: float
    """Height of the base above the feet."""
    size_m: float
    """Length of the body, or its height above the feet if that is more."""


def robot_shape(selection: Selection, probe: Probe) -> RobotShape:
    """Return what the positions of standing feet, else the mass, tell of a robot's shape."""
    robot, stances = selection.robot, probe.stances
    length = body_size_m(robot.mass_kg)[0]
    height = length
    if stances:
        points = np.array(list(stances.values()))
        height = max(-float(median_of(points[:, 2])), 0.0) or length
        length = max(float(np.ptp(points[:, :2], axis=0).max()), 0.5 * length)
    hips = {foot: (_INSIDE * x, _INSIDE * y, 0.0) for foot, (x, y, _) in stances.items()}
    axis = _axis_by_feet(robot, stances) if selection.robot_is_guessed else None
    return RobotShape(axis or robot.forward_axis, hips, height, max(length, height))


def _axis_by_feet(robot: Robot, stances: Mapping[int, Point]) -> str | None:
    """Return the axis from hind to fore feet; None: their positions are not known."""
    ends: Sequence[list[Point]] = [
        [
            stances[number]
            for number, foot in enumerate(robot.feet)
            if number in stances and foot.leg_position is not None and foot.leg_position[0] == end
        ]
        for end in ("front", "back")
    ]
    if not all(ends):
        return None
    fore, hind = (np.mean(points, axis=0) for points in ends)
    return nearest_axis((fore - hind)[:2])
