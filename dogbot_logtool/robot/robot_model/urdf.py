"""URDF: reading it safely; its base link, joints and links."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Final, cast
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.frames.kinematics import Joint, Kind, Triple
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


@dataclass(frozen=True, slots=True)
class Link:
    """A link of a robot description."""

    mass_kg: float
    """0: none is given."""
    centre: Triple
    """m, its centre of mass."""
    balls: tuple[tuple[Triple, float], ...]
    """m, middles and radii of the balls that it consists of."""
    ends: tuple[Triple, ...]
    """m, middles of the ends of its cylinders."""


NOTHING: Final = Link(0.0, (0.0, 0.0, 0.0), (), ())


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
    links: Mapping[str, Link]
    continuous: frozenset[str]
    """Joints that turn without an end."""

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
    joints, left_out = urdf_joints(root)
    if not joints:
        raise ValueError("has no joints that make a tree of links")
    if len(joints) > MOST_JOINTS:
        raise ValueError(f"has {len(joints)} joints, more than {MOST_JOINTS}")
    links = urdf_links(root)
    turning = (joint for joint in root.findall("joint") if joint.get("type") == "continuous")
    return RobotOfUrdf(
        base=_base(joints, links),
        joints=joints,
        left_out=left_out,
        limits=urdf_limits(root),
        links=links,
        continuous=frozenset(joint.get("name", "") for joint in turning),
    )


def _base(joints: Sequence[Joint], links: Mapping[str, Link]) -> str:
    """Return the base link: the root of most joints, past links without a mass before it."""
    below = joints_below(joints)
    children = {joint.child for joint in joints}
    roots = [link for link in below if link not in children]
    root = link = max(roots, key=lambda each: _count_below(below, each))
    stays = root.lower() not in _WORLDS
    while not links.get(link, NOTHING).mass_kg and len(below[link]) == 1:
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


def urdf_joints(root: ET.Element) -> tuple[tuple[Joint, ...], int]:
    """Return the joints that make a tree of links, and how many others are left out.

    Others lack a link, an axis or a finite number, hang in a circle, or give a link a second
    parent. Planar and floating joints are not counted.
    """
    elements = [each for each in root.findall("joint") if each.get("type") in _KINDS]
    joints: dict[str, Joint] = {}
    below: dict[str, list[str]] = {}
    for joint in (joint for element in elements for joint in _joint(element)):
        if joint.child not in joints:
            joints[joint.child] = joint
            below.setdefault(joint.parent, []).append(joint.child)
    reached = [link for link in below if link not in joints]
    for link in reached:  # which grows
        reached.extend(below.get(link, ()))
    in_tree = frozenset(reached)
    kept = tuple(joint for link, joint in joints.items() if link in in_tree)
    return kept, len(elements) - len(kept)


def said_of_left_out(count: int) -> str:
    """Say how many joints of a description are left out, and why."""
    return (
        f"joints left out of the robot description: {count} (a number that cannot be used, "
        "an axis of length 0, a missing link, a circle, or a second parent)"
    )


def urdf_limits(root: ET.Element) -> dict[str, JointLimits]:
    """Return the limits of a description's joints by name, where numbers tell them.

    A continuous joint has none of its position; an effort or velocity of 0 says nothing.
    """
    found = {}
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        told: Mapping[str, str] = {} if limit is None else limit.attrib
        try:
            ends = ("lower", "upper", "effort", "velocity")
            lower, upper, effort, velocity = (finite(told.get(end, "0")) for end in ends)
        except ValueError:
            continue
        if joint.get("type") == "continuous" or lower >= upper:
            lower, upper = -np.inf, np.inf
        if joint.get("type") in {"revolute", "continuous", "prismatic"}:
            limits = JointLimits(lower, upper, effort or np.inf, velocity or np.inf)
            found[joint.get("name", "")] = limits
    return found


def urdf_links(root: ET.Element) -> dict[str, Link]:
    """Return a description's links by name; parts with numbers that cannot be used are left out."""
    found = {}
    for link in root.findall("link"):
        mass, centre = 0.0, (0.0, 0.0, 0.0)
        balls: list[tuple[Triple, float]] = []
        ends: list[Triple] = []
        for part in (
            *link.findall("inertial"),
            *link.findall("collision"),
            *link.findall("visual"),
        ):
            try:
                place = triple_of(part, "origin", "xyz")
                if part.tag == "inertial":
                    mass, centre = _number(part.find("mass"), "value"), place
                elif radius := _number(part.find("geometry/sphere"), "radius"):
                    balls.append((place, radius))
                elif length := _number(part.find("geometry/cylinder"), "length"):
                    turn = from_roll_pitch_yaw(np.array([triple_of(part, "origin", "rpy")]))
                    half = rotate(turn, np.array([[0.0, 0.0, length / 2.0]]))[0]
                    both = np.array(place) + half, np.array(place) - half
                    ends += [cast("Triple", tuple(each.tolist())) for each in both]
            except ValueError:
                continue
        name = link.get("name", "").lstrip("/")
        found[name] = Link(max(mass, 0.0), centre, tuple(balls), tuple(ends))
    return found


def _number(element: ET.Element | None, attribute: str) -> float:
    """Return a number of an element; 0 where there is none."""
    return 0.0 if element is None else finite(element.get(attribute, "0"))


def _joint(element: ET.Element) -> Iterator[Joint]:
    """Yield a joint, if it is understood."""
    name, kind = element.get("name", ""), _KINDS.get(element.get("type", ""))
    parent, child = (
        "" if (link := element.find(end)) is None else link.get("link", "").lstrip("/")
        for end in ("parent", "child")
    )
    if not (name and kind and parent and child):
        return
    mimic = element.find("mimic")
    try:
        axis = triple_of(element, "axis", "xyz", (1.0, 0.0, 0.0))
        turn = from_roll_pitch_yaw(np.array([triple_of(element, "origin", "rpy")]))[0]
        length = float(np.linalg.norm(axis))
        if not length and kind != "fixed":
            return
        yield Joint(
            name=name,
            parent=parent,
            child=child,
            kind=cast("Kind", kind),
            translation=triple_of(element, "origin", "xyz"),
            rotation=tuple(turn.tolist()),
            axis=cast("Triple", tuple(part / (length or 1.0) for part in axis)),
            source="" if mimic is None else mimic.get("joint", ""),
            multiplier=1.0 if mimic is None else finite(mimic.get("multiplier", "1")),
            offset=0.0 if mimic is None else finite(mimic.get("offset", "0")),
        )
    except ValueError:
        return


def triple_of(
    element: ET.Element, tag: str, attribute: str, default: Triple = (0.0, 0.0, 0.0)
) -> Triple:
    """Return three numbers of a joint or a shape.

    Raises:
        ValueError: they are others.
    """
    found = element.find(tag)
    text = None if found is None else found.get(attribute)
    if text is None:
        return default
    x, y, z = (finite(word) for word in text.split())
    return x, y, z


def finite(text: str) -> float:
    """Return a number of a description.

    Raises:
        ValueError: it is none, or not finite.
    """
    number = float(text)
    if not isfinite(number):
        raise ValueError(f"{text!r} is not finite")
    return number
