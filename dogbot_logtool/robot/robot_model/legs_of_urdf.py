"""The legs of a URDF: feet, which leg is which, forward axis, masses."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.frames.kinematics import Joint, Leg, Mass, leg_motion
from dogbot_logtool.core.leg_position import LegPosition, leg_names
from dogbot_logtool.core.rotations import multiply, rotate
from dogbot_logtool.core.settings import FORWARD_ANGLES
from dogbot_logtool.robot.names import leg_of, leg_position
from dogbot_logtool.robot.robot_model.urdf import RobotOfUrdf, joints_below
from dogbot_logtool.robot.words import Part, parts_of

_HIGHEST: Final = 0.4
"""Share of the depth of the lowest foot below the base that other feet may be higher."""
_SHORTEST: Final = 2
"""Joints of a leg at least; what hangs on one is a wheel, or turns a sensor."""
_ANKLED: Final = 4
"""Joints of a leg that may end at the last one: its foot is flat."""
_REACH: Final = 0.1
"""Share of the length of a leg with fewer joints that its foot is from the last one, at least."""
_SAME_LEG: Final = 0.5
"""Share of the joints of the shorter chain that two ends of one leg have in common."""
_MOST_LEGS: Final = 16


def find_legs(
    robot: RobotOfUrdf, posture: Mapping[str, float], forward_axis: str | None = None
) -> tuple[tuple[Leg, ...], str]:
    """Return the legs of a robot from front to back, and its forward axis.

    Args:
        robot: its description.
        posture: rad or m, usual positions of recorded joints; others are at rest.
        forward_axis: of the base; None: told by the names of the legs, else +x.

    Raises:
        ValueError: it has none that can be used; the sentence goes on from its description.
    """
    below = joints_below(robot.joints)
    ends = _ends(robot, below, posture)
    wheels = [end.leg.foot for end in ends if end.is_wheel]
    feet = _lowest([end for end in ends if not end.is_wheel])[:_MOST_LEGS]
    if not feet:
        what = f"legs that end in wheels, {', '.join(wheels)}, and " if wheels else ""
        raise ValueError(f"has {what}no two legs: chains of joints that end below the base")
    if unclear := [end.leg.foot for end in feet if end.is_joint]:
        text = f"does not say where the feet of {', '.join(unclear)} are: no link hangs there"
        raise ValueError(f"{text}, and they have no ball or cylinder")
    along = np.mean([end.place - end.hip for end in feet], axis=0)
    if np.hypot(along[0], along[1]) > abs(along[2]):
        raise ValueError(f"has a base, {robot.base}, whose z axis is not up: legs go sideways")
    places = np.array([end.place for end in feet])
    axis = forward_axis or _forward(places, [_position_in(end.leg) for end in feet])
    turn = FORWARD_ANGLES[axis]
    ahead = places[:, 0] * np.cos(turn) + places[:, 1] * np.sin(turn)
    aside = places[:, 1] * np.cos(turn) - places[:, 0] * np.sin(turn)
    names = leg_names(np.column_stack([ahead, aside, places[:, 2]]))
    legs = [
        end.leg._replace(
            name=name, position=leg_position(name), masses=_carried(robot, below, end.leg)
        )
        for name, end in zip(names, feet, strict=True)
    ]
    order = ("front", "middle", "back", "")
    legs.sort(key=lambda leg: (order.index((leg.position or ("",))[0]), leg.name))
    return tuple(legs), axis


def axis_by_names(robot: RobotOfUrdf, posture: Mapping[str, float]) -> str | None:
    """Return the forward axis with which all legs are where their names say; None: none is."""
    try:
        legs, axis = find_legs(robot, posture)
    except ValueError:
        return None
    return axis if all(_position_in(leg) == leg.position for leg in legs) else None


class _End(NamedTuple):
    """A chain of joints that no joint goes on from."""

    leg: Leg
    place: Floats
    """(3,) m, where it ends, in the base's frame; also `hip`, where its first joint is."""
    hip: Floats
    is_joint: bool
    """Whether it ends at its last joint, and is too short for a flat foot."""
    is_wheel: bool


def _paths(
    below: Mapping[str, list[Joint]], link: str, above: tuple[Joint, ...] = ()
) -> Iterator[tuple[Joint, ...]]:
    """Yield the joints down to each link."""
    yield above
    for joint in below.get(link, ()):
        yield from _paths(below, joint.child, (*above, joint))


def _ends(
    robot: RobotOfUrdf, below: Mapping[str, list[Joint]], posture: Mapping[str, float]
) -> list[_End]:
    """Return where chains of joints end: at what hangs lowest on the last joint that moves."""
    of_joint: dict[str, list[_End]] = {}
    inner: set[str] = set()
    for path in _paths(below, robot.base):
        moving = [joint.name for joint in path if joint.kind != "fixed"]
        inner.update(moving[:-1])
        if len(moving) >= _SHORTEST:
            of_joint.setdefault(moving[-1], []).append(_end(robot, path, posture))
    return [
        min(ends, key=lambda end: (end.is_joint, end.place[2]))
        for name, ends in of_joint.items()
        if name not in inner
    ]


def _end(robot: RobotOfUrdf, path: tuple[Joint, ...], posture: Mapping[str, float]) -> _End:
    """Return where a chain of joints ends, if its last link is the foot."""
    link = robot.link(path[-1].child)
    leg = Leg(path, point=link.tip, radius_m=link.radius_m)
    motion = leg_motion(leg, np.array([[posture.get(name, 0.0) for name in leg.measured]]))
    moving = [row for row, joint in enumerate(path) if joint.kind != "fixed"]
    place, origins = motion.foot[0], motion.origins[0]
    length = sum(np.linalg.norm(np.diff(origins[moving[0] :], axis=0), axis=1))
    # A joint that slides takes the foot away from those that turn.
    turning = [row for row in moving if path[row].kind == "revolute"] or moving
    reach = float(np.linalg.norm(place - origins[turning[-1]]))
    at_joint = reach <= _REACH * (length + reach)
    turns = at_joint and path[moving[-1]].name in robot.continuous
    is_joint = at_joint and len(moving) < _ANKLED
    return _End(leg, place, origins[moving[0]], is_joint, turns or _is_wheel(leg))


def _lowest(ends: Sequence[_End]) -> list[_End]:
    """Return the lowest ends, one a leg; none where only one is below the base."""
    found: list[_End] = []
    for end in sorted(ends, key=lambda each: (each.place[2], each.leg.foot)):
        if not any(_is_same_leg(end.leg, other.leg) for other in found):
            found.append(end)
    depth = -found[0].place[2] if found else 0.0
    kept = [each for each in found if each.place[2] <= -(1.0 - _HIGHEST) * depth < 0.0]
    return kept if len(kept) > 1 else []


def _is_wheel(leg: Leg) -> bool:
    """Tell whether names say that a chain ends in a wheel or a tool."""
    moving = [joint.name for joint in leg.joints if joint.kind != "fixed"]
    parts = parts_of([leg.foot, moving[-1]])
    return Part.NOT_A_FOOT in parts and not parts & {Part.FOOT, Part.LEG}


def _is_same_leg(leg: Leg, other: Leg) -> bool:
    own, others = set(leg.measured), set(other.measured)
    return len(own & others) > _SAME_LEG * min(len(own), len(others))


def _position_in(leg: Leg) -> LegPosition:
    """Return which leg the names of its links and joints tell; empty where they do not."""
    positions = map(leg_of, (leg.foot, *(joint.name for joint in reversed(leg.joints))))
    return next((position for position in positions if position[1]), ("", ""))


def _forward(places: Floats, named: Sequence[LegPosition]) -> str:
    """Return the axis along which places are as the names of legs say; +x where these do not."""
    ahead = np.array([{"front": 1.0, "back": -1.0}.get(end, 0.0) for end, _ in named])
    left = np.array([{"left": 1.0, "right": -1.0}.get(side, 0.0) for _, side in named])
    x, y, _ = (places - places.mean(axis=0)).T

    def fit(axis: str) -> float:
        cos, sin = np.cos(FORWARD_ANGLES[axis]), np.sin(FORWARD_ANGLES[axis])
        return float(ahead @ np.sign(x * cos + y * sin) + left @ np.sign(y * cos - x * sin))

    return max(FORWARD_ANGLES, key=lambda axis: (round(fit(axis), 6), axis == "+x"))


def _carried(robot: RobotOfUrdf, below: Mapping[str, list[Joint]], leg: Leg) -> tuple[Mass, ...]:
    """Return the mass that each joint of a leg carries; what hangs on its link does not move."""
    own, masses = {joint.child for joint in leg.joints}, []
    first = next(row for row, joint in enumerate(leg.joints) if joint.kind != "fixed")
    for row, joint in enumerate(leg.joints[first:], first):
        hanging = [(joint.child, np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))]
        total, moment = 0.0, np.zeros(3)
        for link, place, turn in hanging:  # which grows
            mass = robot.link(link)
            total += mass.mass_kg
            moment += mass.mass_kg * (place + rotate(turn, np.array([mass.centre])))[0]
            for each in below.get(link, ()):
                if each.child not in own:
                    there = place + rotate(turn, np.array([each.translation]))
                    hanging.append((each.child, there, multiply(turn, np.array([each.rotation]))))
        if total:
            x, y, z = (moment / total).tolist()
            masses.append(Mass(row, total, (x, y, z)))
    return tuple(masses)
