"""A URDF as a robot's file: base link, legs and feet, which leg is which, forward axis, mass."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.frames.kinematics import Joint, Leg, Mass, Triple, leg_motion, link_poses
from dogbot_logtool.core.leg_position import LegPosition, leg_names
from dogbot_logtool.core.legs.joints import JointLimits
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.robot.robot_model.urdf import (
    finite,
    parse_urdf,
    triple_of,
    urdf_joints,
    urdf_limits,
)
from dogbot_logtool.robot.words import ENDS, LETTERS, SIDES, Part, words_of

_WORLDS: Final = frozenset({"world", "map", "odom"})
_HIGHEST: Final = 0.4
"""Share of the depth of the lowest foot below the base that other feet may be higher."""
_SHORTEST: Final = 2
"""Joints of a leg at least; what hangs on one is a wheel, or turns a sensor."""
_SAME_LEG: Final = 0.5
"""Share of the joints of the shorter chain that two ends of one leg have in common."""
_CENTRED: Final = 0.5
"""Share of its radius that a ball may be off its link's origin."""
MOST_JOINTS: Final = 400
"""Joints of a robot, fixed ones too; no robot has more."""
_MOST_LEGS: Final = 16
_ARMS: Final = frozenset(
    {"arm", "elbow", "finger", "fingers", "gripper", "hand", "head", "neck", "palm", "shoulder"}
    | {"thumb", "wrist"}
)
_SENSORS: Final = frozenset(["camera", "force", "ft", "imu", "motor", "rotor", "screw", "sensor"])
_SOLES: Final = frozenset({"sole", "soles", "footsole"})


@dataclass(frozen=True, slots=True)
class RobotOfUrdf:
    """What a robot description tells of a robot."""

    base: str
    """Its base link."""
    joints: tuple[Joint, ...]
    """All that make a tree of links."""
    left_out: int
    """How many make none."""
    limits: Mapping[str, JointLimits]
    links: Mapping[str, tuple[float, Triple]]
    """kg, and centre of mass in the link's frame, m, of links with a mass."""
    radii: Mapping[str, float]
    """m, of links that are balls."""

    @property
    def mass_kg(self) -> float | None:
        """The sum over all links; None where it has none."""
        return sum(mass for mass, _ in self.links.values()) or None


@dataclass(frozen=True, slots=True)
class NamedLeg:
    """A leg and which it is."""

    name: str
    """``front_left`` ..., or a number."""
    position: LegPosition | None
    leg: Leg


def read_robot(urdf: str) -> RobotOfUrdf:
    """Read a robot description.

    Raises:
        ValueError: it is none, or has no joints.
    """
    root = parse_urdf(urdf)
    joints, left_out = urdf_joints(root)
    if not joints:
        raise ValueError("has no joints that make a tree of links")
    if len(joints) > MOST_JOINTS:
        raise ValueError(f"has {len(joints)} joints, more than {MOST_JOINTS}")
    links = dict(_masses(root))
    return RobotOfUrdf(
        base=_base(joints, links),
        joints=joints,
        left_out=left_out,
        limits=urdf_limits(root),
        links=links,
        radii=dict(_balls(root)),
    )


def _masses(root: ET.Element) -> Iterator[tuple[str, tuple[float, Triple]]]:
    for link in root.findall("link"):
        inertial = link.find("inertial")
        mass = None if inertial is None else inertial.find("mass")
        try:
            kilograms = 0.0 if mass is None else finite(mass.get("value", "0"))
            centre = (0.0, 0.0, 0.0) if inertial is None else triple_of(inertial, "origin", "xyz")
        except ValueError:
            continue
        if kilograms > 0.0:
            yield link.get("name", "").lstrip("/"), (kilograms, centre)


def _balls(root: ET.Element) -> Iterator[tuple[str, float]]:
    """Yield the radii of links that are balls, about around their origins."""
    for link in root.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            ball = shape.find("geometry/sphere")
            try:
                away = np.linalg.norm(triple_of(shape, "origin", "xyz"))
                radius = 0.0 if ball is None else finite(ball.get("radius", "0"))
                if away < _CENTRED * radius:
                    yield link.get("name", "").lstrip("/"), radius
            except ValueError:
                continue


def _base(joints: Sequence[Joint], links: Mapping[str, object]) -> str:
    """Return the base link: the root of most joints, past links without a mass before it."""
    below = _below(joints)
    children = {joint.child for joint in joints}
    roots = [link for link in below if link not in children]
    root = link = max(roots, key=lambda each: sum(1 for _ in _descendants(below, each)))
    stays = root.lower() not in _WORLDS
    while link not in links and len(below.get(link, ())) == 1:
        (joint,) = below[link]
        stays &= joint.kind == "fixed" and not any((*joint.translation, *joint.rotation[:3]))
        if joint.child not in below:
            return root
        link = joint.child
    return root if stays else link


def _below(joints: Sequence[Joint]) -> dict[str, list[Joint]]:
    below: dict[str, list[Joint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    return below


def _descendants(below: Mapping[str, list[Joint]], link: str) -> Iterator[Joint]:
    for joint in below.get(link, ()):
        yield joint
        yield from _descendants(below, joint.child)


def find_legs(robot: RobotOfUrdf, posture: Mapping[str, float]) -> tuple[tuple[NamedLeg, ...], str]:
    """Return the legs of a robot, and the axis that points forward.

    Args:
        robot: its description.
        posture: rad or m, usual positions of recorded joints; others are at rest.
    """
    ends = _lowest(list(_ends(robot, posture)))
    legs = [replace(leg, masses=_carried(robot, leg)) for leg, _ in ends[:_MOST_LEGS]]
    places = np.array([place for _, place in ends[:_MOST_LEGS]]).reshape(-1, 3)
    by_name = [_position_in(leg) for leg in legs]
    axis = _forward(places, by_name)
    turn = FORWARD_ANGLES[axis]
    ahead = places[:, 0] * np.cos(turn) + places[:, 1] * np.sin(turn)
    aside = places[:, 1] * np.cos(turn) - places[:, 0] * np.sin(turn)
    names = leg_names(np.column_stack([ahead, aside, places[:, 2]]))
    found = (NamedLeg(name, _position(name), leg) for name, leg in zip(names, legs, strict=True))
    order = {"front": 0, "middle": 1, "back": 2}
    return tuple(
        sorted(found, key=lambda each: (order.get((each.position or ("",))[0], 3), each.name))
    ), axis


def _position(name: str) -> LegPosition | None:
    """Return the position that `leg_names` gives; a biped's legs have sides only."""
    end, _, side = name.rpartition("_")
    if side not in SIDES.values():
        return None
    return end or "middle", side


def _ends(robot: RobotOfUrdf, posture: Mapping[str, float]) -> Iterator[tuple[Leg, Floats]]:
    """Yield chains of joints that no joint goes on from, and where they end."""
    below = _below(robot.joints)

    def walk(link: str, chain: tuple[Joint, ...]) -> Iterator[tuple[Joint, ...]]:
        moving = [each for each in below.get(link, ()) if _moves_on(below, each)]
        for joint in moving:
            yield from walk(joint.child, (*chain, joint))
        if not moving and sum(joint.kind != "fixed" for joint in chain) >= _SHORTEST:
            yield chain

    for chain in walk(robot.base, ()):
        tips = [chain, *(chain + tail for tail in _fixed_tails(below, chain[-1].child))]
        legs = [Leg(tip, radius_m=robot.radii.get(tip[-1].child, 0.0)) for tip in tips]
        placed = [(leg, _place(robot, leg, posture)) for leg in legs]
        yield min(placed, key=lambda each: (_rank(each[0].foot), each[1][2]))


def _moves_on(below: Mapping[str, list[Joint]], joint: Joint) -> bool:
    """Tell whether a joint, or one below it, moves."""
    return joint.kind != "fixed" or any(j.kind != "fixed" for j in _descendants(below, joint.child))


def _fixed_tails(below: Mapping[str, list[Joint]], link: str) -> Iterator[tuple[Joint, ...]]:
    for joint in below.get(link, ()):
        yield (joint,)
        yield from ((joint, *tail) for tail in _fixed_tails(below, joint.child))


def _rank(link: str) -> int:
    """Return how surely a link is named as what touches the ground, low first."""
    words = words_of(link)
    if any(word.text in _SENSORS for word in words):
        return 3
    if any(word.text in _SOLES for word in words):
        return 0
    return 1 if any(word.part is Part.FOOT for word in words) else 2


def _place(robot: RobotOfUrdf, leg: Leg, posture: Mapping[str, float]) -> Floats:
    """(3,) m, where a leg ends."""
    usual = [posture.get(name, _at_rest(robot.limits.get(name))) for name in leg.measured]
    return np.asarray(leg_motion(leg, np.array([usual])).foot[0])


def _at_rest(limits: JointLimits | None) -> float:
    if limits is None or limits.lower <= 0.0 <= limits.upper:
        return 0.0
    return (limits.lower + limits.upper) / 2.0


def _lowest(ends: Sequence[tuple[Leg, Floats]]) -> list[tuple[Leg, Floats]]:
    """Return the ends of legs: the lowest, of which none is called an arm or a wheel."""
    named = [each for each in ends if not _is_no_leg(each[0])]
    found: list[tuple[Leg, Floats]] = []
    for leg, place in sorted(named, key=lambda each: (each[1][2], each[0].foot)):
        if not any(_is_same_leg(leg, other) for other, _ in found):
            found.append((leg, place))
    if not found or found[0][1][2] >= 0.0:
        return []
    depth = -found[0][1][2]
    kept = {leg.foot for leg, place in found if place[2] <= -(1.0 - _HIGHEST) * depth}
    return [each for each in found if each[0].foot in kept] if len(kept) > 1 else []


def _is_no_leg(leg: Leg) -> bool:
    """Tell whether names say that a chain is an arm, or ends in a wheel or a tool."""
    last = [leg.foot, [joint.name for joint in leg.joints if joint.kind != "fixed"][-1]]
    parts = {word.part for name in last for word in words_of(name)}
    if Part.NOT_A_FOOT in parts and not parts & {Part.FOOT, Part.LEG}:
        return True
    names = [name for joint in leg.joints for name in (joint.name, joint.child)]
    words = [word for name in names for word in words_of(name)]
    of_legs = {Part.FOOT, Part.LEG, Part.UPPER_LEG}
    return any(w.text in _ARMS for w in words) and not any(w.part in of_legs for w in words)


def _is_same_leg(leg: Leg, other: Leg) -> bool:
    own, others = set(leg.measured), set(other.measured)
    return len(own & others) > _SAME_LEG * min(len(own), len(others))


def _position_in(leg: Leg) -> LegPosition | None:
    """Return which leg the names of its links and joints tell; None: they do not."""
    for name in (leg.foot, *(joint.name for joint in reversed(leg.joints))):
        position = leg_of(name)
        if position[1]:
            return position
    return None


def leg_of(name: str) -> LegPosition:
    """Return the end and the side of the robot that a name tells; empty where it does not."""
    end = side = ""
    for word in words_of(name):
        if word.text in LETTERS:
            return LETTERS[word.text]
        end, side = ENDS.get(word.text, end), SIDES.get(word.text, side)
    return end, side


def _forward(places: Floats, named: Sequence[LegPosition | None]) -> str:
    """Return the axis along which places are as the names of legs say; +x where these do not."""
    ends = {"front": 1.0, "back": -1.0}
    ahead = np.array([ends.get((each or ("", ""))[0], 0.0) for each in named])
    left = np.array(
        [{"left": 1.0, "right": -1.0}.get((each or ("", ""))[1], 0.0) for each in named]
    )
    about = places - places.mean(axis=0) if len(places) else places

    def fit(axis: str) -> float:
        cos, sin = np.cos(FORWARD_ANGLES[axis]), np.sin(FORWARD_ANGLES[axis])
        along, aside = about[:, 0] * cos + about[:, 1] * sin, about[:, 1] * cos - about[:, 0] * sin
        return float(ahead @ np.sign(along) + left @ np.sign(aside))

    return max(FORWARD_ANGLES, key=lambda axis: (round(fit(axis), 6), axis == "+x"))


def _carried(robot: RobotOfUrdf, leg: Leg) -> tuple[Mass, ...]:
    """Return the masses that each joint of a leg carries; what hangs on them does not move."""
    below, own = _below(robot.joints), {joint.child for joint in leg.joints}
    masses = []
    first = next(row for row, joint in enumerate(leg.joints) if joint.kind != "fixed")
    for row, joint in enumerate(leg.joints):
        if row < first:
            continue
        origin = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])
        for link, place, turn in _hanging(below, joint.child, *origin, own):
            if link in robot.links:
                mass, centre = robot.links[link]
                at = place + rotate(turn[None], np.array([centre]))[0]
                masses.append(Mass(row, mass, tuple(at.tolist())))
    return _joined(masses)


def _hanging(
    below: Mapping[str, list[Joint]], link: str, place: Floats, turn: Floats, left_out: set[str]
) -> Iterator[tuple[str, Floats, Floats]]:
    """Yield a link and those that hang on it, but for some, and their places and rotations."""
    yield link, place, turn
    for joint in below.get(link, ()):
        if joint.child not in left_out:
            pose = link_poses([joint], np.zeros((1, 1)))
            there = place + rotate(turn[None], pose.translation[:, 0])[0]
            turned = _product(turn, pose.rotation[0, 0])
            yield from _hanging(below, joint.child, there, turned, left_out)


def _product(first: Floats, second: Floats) -> Floats:
    from dogbot_logtool.core.rotations import multiply  # noqa: PLC0415

    return np.asarray(multiply(first[None], second[None])[0])


def _joined(masses: Sequence[Mass]) -> tuple[Mass, ...]:
    """Return one mass a joint."""
    found = []
    for row in sorted({mass.joint for mass in masses}):
        own = [mass for mass in masses if mass.joint == row]
        total = sum(mass.mass_kg for mass in own)
        centre = sum(mass.mass_kg * np.array(mass.centre) for mass in own) / total
        found.append(Mass(row, total, tuple(np.asarray(centre).tolist())))
    return tuple(found)
