"""URDF: reading it safely; its base link, joints and links."""

from collections.abc import Mapping, Sequence
from math import hypot, isfinite
from typing import Final, NamedTuple, cast
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.frames.kinematics import Joint, Kind, Triple
from dogbot_logtool.core.frames.transforms import loops
from dogbot_logtool.core.legs.joints import JointLimits
from dogbot_logtool.core.rotations import from_roll_pitch_yaw, rotate

_KINDS: Final = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
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
    continuous: frozenset[str]
    """Joints that turn without an end."""

    @property
    def mass_kg(self) -> float | None:
        """The sum over all links; None where it has none."""
        return sum(link.mass_kg for link in self.links.values()) or None

    def link(self, name: str) -> Link:
        """Return a link, which a description need not have."""
        return self.links.get(name, Link())


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
    endless = (each.get("name", "") for each in elements if each.get("type") == "continuous")
    return RobotOfUrdf(
        base=_base(joints, links),
        joints=joints,
        limits={each.get("name", ""): own for each in elements if (own := _limits(each))},
        links=links,
        continuous=frozenset(endless),
    )


def _base(joints: Sequence[Joint], links: Mapping[str, Link]) -> str:
    """Return the base link: the root of most joints, past links without a mass before it."""
    below = joints_below(joints)
    children = {joint.child for joint in joints}
    roots = [link for link in below if link not in children]
    root = link = max(roots, key=lambda each: _count_below(below, each))
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


def _count_below(below: Mapping[str, list[Joint]], link: str) -> int:
    return sum(1 + _count_below(below, joint.child) for joint in below.get(link, ()))


def parse_urdf(text: str) -> ET.Element:
    """Parse a robot description.

    Raises:
        ValueError: a sentence without a subject: it is no XML with a root `robot`, or declares
            entities, which viewers might fetch.
    """
    if "\0" in text:
        raise ValueError("is a binary file, not the XML text of a URDF")
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
    name, kind = element.get("name", ""), _KINDS[element.get("type", "")]
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


def _limits(element: ET.Element) -> JointLimits | None:
    """Return the limits of a joint; None where it does not move.

    A continuous joint has none of its position; an effort or velocity of 0 says nothing.
    """
    names = ("lower", "upper", "effort", "velocity")
    lower, upper, effort, velocity = (_number(element, "limit", name) for name in names)
    if element.get("type") == "continuous" or lower >= upper:
        lower, upper = -np.inf, np.inf
    moves = element.get("type") != "fixed"
    return JointLimits(lower, upper, effort or np.inf, velocity or np.inf) if moves else None


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
