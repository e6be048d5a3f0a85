"""URDF: reading it safely; its base link, joints, links and legs."""

from collections.abc import Iterator, Mapping, Sequence
from math import hypot, isfinite
from typing import Final, NamedTuple, cast
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.frames.kinematics import Joint, Kind, Leg, Mass, Triple, leg_motion
from dogbot_logtool.core.frames.transforms import loops
from dogbot_logtool.core.legs.joints import JointLimits
from dogbot_logtool.core.rotations import along_heading, from_roll_pitch_yaw, rotate
from dogbot_logtool.core.settings import FORWARD_ANGLES, LegPosition, leg_names
from dogbot_logtool.robot.names import leg_of, leg_order, leg_position
from dogbot_logtool.robot.words import Part, parts_of

_KINDS: Final = frozenset({"revolute", "continuous", "prismatic", "fixed"})
"""Joints with one position or none; planar and floating ones have more."""
_WORLDS: Final = frozenset({"world", "map", "odom"})
MOST_JOINTS: Final = 400
"""Joints of a robot, fixed ones too; no robot has more."""
ORIGIN: Final = (0.0, 0.0, 0.0)
_CENTRED: Final = 0.5
"""Share of its radius that a ball may be off its link's origin."""


class Link(NamedTuple):
    """A link of a robot description."""

    mass_kg: float = 0.0
    """0: none is given."""
    centre: Triple = ORIGIN
    """m, its centre of mass."""
    tip: Triple = ORIGIN
    """m, where it touches the ground: its farthest ball, or end of a cylinder."""
    radius_m: float = 0.0
    """Of the ball there; 0: there is none."""


class RobotOfUrdf(NamedTuple):
    """What a robot description tells of a robot."""

    base: str
    """Its base link."""
    joints: tuple[Joint, ...]
    """They make a tree of links."""
    limits: Mapping[str, JointLimits]
    links: Mapping[str, Link]
    """Those that it tells of."""

    @property
    def mass_kg(self) -> float | None:
        """The sum over all links; None where it has none."""
        return sum(link.mass_kg for link in self.links.values()) or None


def read_robot(urdf: str) -> RobotOfUrdf:
    """Read a robot description.

    Raises:
        ValueError: it is none, or has no joints.
    """
    root = parse_urdf(urdf)
    elements = [each for each in root.iterfind("joint") if each.get("type") in _KINDS]
    if not elements:
        raise ValueError("has no joints")
    if len(elements) > MOST_JOINTS:
        raise ValueError(f"has {len(elements)} joints, more than {MOST_JOINTS}")
    joints = tuple(_joint(each) for each in elements)
    edges = [(joint.parent, joint.child) for joint in joints]
    if loops(edges) or len({child for _, child in edges}) < len(edges):
        raise ValueError("has links in a circle, or with two parents")
    links = {each.get("name", "").lstrip("/"): _link(each) for each in root.iterfind("link")}
    return RobotOfUrdf(
        base=_base(joints, links),
        joints=joints,
        limits={each.get("name", ""): _limits(each) for each in elements},
        links=links,
    )


def _base(joints: Sequence[Joint], links: Mapping[str, Link]) -> str:
    """Return the base link: the root of most joints, past links without a mass before it."""
    below = joints_below(joints)
    children = {joint.child for joint in joints}
    roots = [link for link in below if link not in children]
    root = link = max(roots, key=lambda each: len([*_paths(below, each)]))
    stays = root.lower() not in _WORLDS
    while not (link in links and links[link].mass_kg) and len(below[link]) == 1:
        (joint,) = below[link]
        if joint.child not in below:
            return root
        stays &= joint.kind == "fixed" and not any(joint.translation)
        link = joint.child
    return root if stays else link


def joints_below(joints: Sequence[Joint]) -> dict[str, list[Joint]]:
    """Return the joints that hang on each link."""
    below: dict[str, list[Joint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    return below


def parse_urdf(text: str) -> ET.Element:
    """Parse a robot description.

    Raises:
        ValueError: a sentence without a subject: it is no XML with a root `robot`, or declares
            entities, which viewers might fetch.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ValueError("declares a document type or entities, which is refused")
    try:
        root = ET.fromstring(text)  # noqa: S314 - without entities
    except (ET.ParseError, ValueError) as error:
        raise ValueError(f"is no XML: {error}") from None
    if root.tag != "robot":
        raise ValueError(f"its root is {root.tag!r}, not 'robot', so it is no URDF")
    return root


def _joint(element: ET.Element) -> Joint:
    """Return a joint.

    Raises:
        ValueError: it has not two links, no axis, or a number that cannot be used.
    """
    name, kind = element.get("name", ""), element.get("type", "")
    parent, child = (_text(element, end, "link").lstrip("/") for end in ("parent", "child"))
    try:
        axis = _triple(element, "axis", "xyz", "1 0 0")
        turn = from_roll_pitch_yaw(np.array([_triple(element, "origin", "rpy")]))[0]
        length = hypot(*axis)
        if not (name and parent and child and (length or kind == "fixed")):
            raise ValueError("it lacks a name, a link or an axis")
        return Joint(
            name=name,
            parent=parent,
            child=child,
            kind=cast("Kind", kind),
            translation=_triple(element, "origin", "xyz"),
            rotation=tuple(turn.tolist()),
            axis=cast("Triple", tuple(part / (length or 1.0) for part in axis)),
            source=_text(element, "mimic", "joint"),
            multiplier=_number(element, "mimic", "multiplier", "1"),
            offset=_number(element, "mimic", "offset"),
        )
    except ValueError as error:
        raise ValueError(f"has a joint that cannot be used, {name}: {error}") from None


def _limits(element: ET.Element) -> JointLimits:
    """Return the limits of a joint; infinite where they are no numbers.

    A continuous joint has none of its position; an effort or velocity of 0 says nothing.
    """
    names = ("lower", "upper", "effort", "velocity")
    try:
        lower, upper, effort, velocity = (_number(element, "limit", name) for name in names)
    except ValueError:
        return JointLimits()
    if element.get("type") == "continuous" or lower >= upper:
        lower, upper = -np.inf, np.inf
    return JointLimits(lower, upper, effort or np.inf, velocity or np.inf)


def _link(element: ET.Element) -> Link:
    """Return a link."""
    mass, centre = 0.0, ORIGIN
    balls: list[tuple[Triple, float]] = []
    ends: list[Triple] = []
    for part in element:
        if part.tag not in {"inertial", "collision", "visual"}:
            continue
        place = _triple(part, "origin", "xyz")
        if part.tag == "inertial":
            mass, centre = max(_number(part, "mass", "value"), 0.0), place
        elif radius := _number(part, "geometry/sphere", "radius"):
            balls.append((place, radius))
        elif length := _number(part, "geometry/cylinder", "length"):
            turn = from_roll_pitch_yaw(np.array([_triple(part, "origin", "rpy")]))
            half = rotate(turn, np.array([[0.0, 0.0, length / 2.0]]))[0]
            both = np.array(place) + half, np.array(place) - half
            ends += [cast("Triple", tuple(each.tolist())) for each in both]
    if not balls:
        return Link(mass, centre, max(ends, key=lambda end: hypot(*end), default=ORIGIN))
    middle, radius = max(balls, key=lambda ball: (hypot(*ball[0]), ball[1]))
    return Link(mass, centre, ORIGIN if hypot(*middle) < _CENTRED * radius else middle, radius)


def _text(element: ET.Element, path: str, attribute: str, default: str = "") -> str:
    """Return an attribute of an element below another one."""
    found = element.find(path)
    return default if found is None else found.get(attribute, default)


def _number(element: ET.Element, path: str, attribute: str, default: str = "0") -> float:
    """Return a finite number of a description.

    Raises:
        ValueError: it is none.
    """
    return _finite(_text(element, path, attribute, default))


def _triple(element: ET.Element, path: str, attribute: str, default: str = "0 0 0") -> Triple:
    """Return three finite numbers of a description.

    Raises:
        ValueError: they are others.
    """
    x, y, z = map(_finite, _text(element, path, attribute, default).split())
    return x, y, z


def _finite(text: str) -> float:
    if not isfinite(number := float(text)):
        raise ValueError(f"{text!r} is not finite")
    return number


# --- its legs: feet, which leg is which, forward axis, masses ---

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


def legs_of_robot(
    robot: RobotOfUrdf, posture: Mapping[str, float], forward_axis: str | None = None
) -> tuple[tuple[Leg, ...], str]:
    """Return the legs of a robot from front to back, and its forward axis.

    Args:
        robot: its description.
        posture: rad or m, usual positions of recorded joints; others are at rest.
        forward_axis: of the base; None: told by the names of the legs, else +x.

    Raises:
        ValueError: a sentence: it has none that can be used.
    """
    below = joints_below(robot.joints)
    ends = _ends(robot, below, posture)
    wheels = [end.leg.foot for end in ends if end.is_wheel]
    feet = _lowest([end for end in ends if not end.is_wheel])[:_MOST_LEGS]
    if not feet:
        what = f"legs that end in wheels, {', '.join(wheels)}, and " if wheels else ""
        what = f"has {what}no two legs: chains of joints that end below the base"
        raise ValueError(f"the robot description {what}")
    if unclear := [end.leg.foot for end in feet if end.is_joint]:
        text = f"does not say where the feet of {', '.join(unclear)} are: no link hangs there"
        raise ValueError(f"the robot description {text}, and they have no ball or cylinder")
    along = np.mean([end.place - end.hip for end in feet], axis=0)
    if np.hypot(along[0], along[1]) > abs(along[2]):
        text = f"has a base, {robot.base}, whose z axis is not up: legs go sideways"
        raise ValueError(f"the robot description {text}")
    places = np.array([end.place for end in feet])
    axis = forward_axis or _forward(places, [_position_in(end.leg) for end in feet])
    names = leg_names(along_heading(places, FORWARD_ANGLES[axis]))
    legs = [
        end.leg._replace(
            name=name, position=leg_position(name), masses=_carried(robot, below, end.leg)
        )
        for name, end in zip(names, feet, strict=True)
    ]
    legs.sort(key=lambda leg: leg_order(leg.name, leg.position))
    return tuple(legs), axis


def axis_by_names(robot: RobotOfUrdf, posture: Mapping[str, float]) -> str | None:
    """Return the forward axis with which all legs are where their names say; None: none is."""
    try:
        legs, axis = legs_of_robot(robot, posture)
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
    of_joint: dict[str, list[tuple[Joint, ...]]] = {}
    inner: set[str] = set()
    for path in _paths(below, robot.base):
        moving = [joint.name for joint in path if joint.kind != "fixed"]
        inner.update(moving[:-1])
        if len(moving) >= _SHORTEST:
            of_joint.setdefault(moving[-1], []).append(path)
    several = [
        [_end(robot, path, posture) for path in paths]
        for name, paths in of_joint.items()
        if name not in inner
    ]
    return [min(ends, key=lambda end: (end.is_joint, end.place[2])) for ends in several]


def _end(robot: RobotOfUrdf, path: tuple[Joint, ...], posture: Mapping[str, float]) -> _End:
    """Return where a chain of joints ends, if its last link is the foot."""
    link = robot.links.get(path[-1].child, Link())
    leg = Leg(path, point=link.tip, radius_m=link.radius_m)
    motion = leg_motion(leg, np.array([[posture.get(name, 0.0) for name in leg.measured]]))
    moving = [row for row, joint in enumerate(path) if joint.kind != "fixed"]
    place, origins = motion.foot[0], motion.origins[0]
    length = sum(np.linalg.norm(np.diff(origins[moving[0] :], axis=0), axis=1))
    # A joint that slides takes the foot away from those that turn.
    turning = [row for row in moving if path[row].kind != "prismatic"] or moving
    reach = float(np.linalg.norm(place - origins[turning[-1]]))
    at_joint = reach <= _REACH * (length + reach)
    turns = at_joint and path[moving[-1]].kind == "continuous"
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
    about = places - places.mean(axis=0)

    def fit(axis: str) -> float:
        forth, aside, _ = along_heading(about, FORWARD_ANGLES[axis]).T
        return float(ahead @ np.sign(forth) + left @ np.sign(aside))

    return max(FORWARD_ANGLES, key=lambda axis: (round(fit(axis), 6), axis == "+x"))


def _carried(robot: RobotOfUrdf, below: Mapping[str, list[Joint]], leg: Leg) -> tuple[Mass, ...]:
    """Return the mass that each joint of a leg carries; what hangs on its link does not move."""
    own, masses = {joint.child for joint in leg.joints}, []
    hanging = {link: [each for each in on if each.child not in own] for link, on in below.items()}
    first = next(row for row, joint in enumerate(leg.joints) if joint.kind != "fixed")
    for row, joint in enumerate(leg.joints[first:], first):
        total, moment = 0.0, np.zeros(3)
        for path in _paths(hanging, joint.child):
            link = robot.links.get(path[-1].child if path else joint.child, Link())
            centre = leg_motion(Leg(path, point=link.centre), np.zeros((1, len(path)))).foot[0]
            total, moment = total + link.mass_kg, moment + link.mass_kg * centre
        if total:
            x, y, z = (moment / total).tolist()
            masses.append(Mass(row, total, (x, y, z)))
    return tuple(masses)
