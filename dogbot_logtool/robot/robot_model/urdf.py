"""URDF: reading it safely, and its joints."""

from collections.abc import Iterator
from math import isfinite
from typing import Final, cast
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.frames.kinematics import Joint, Kind, Triple
from dogbot_logtool.core.legs.joints import JointLimits
from dogbot_logtool.core.rotations import from_roll_pitch_yaw

_KINDS: Final = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
"""Joints with one position or none; planar and floating ones have more."""


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
    """Return the limits of the joints of a description that has them, by name.

    A continuous joint has none of its position; an effort or velocity of 0 says nothing.
    """
    found = {}
    for joint in root.findall("joint"):
        limit, name = joint.find("limit"), joint.get("name", "")
        if limit is None or joint.get("type") not in {"revolute", "continuous", "prismatic"}:
            continue
        turns = joint.get("type") == "continuous"
        try:
            ends = [
                np.inf if turns and end in {"lower", "upper"} else finite(limit.get(end, "0"))
                for end in ("lower", "upper", "effort", "velocity")
            ]
        except ValueError:
            continue
        lower, upper, effort, velocity = ends
        if turns or lower >= upper:
            lower, upper = -np.inf, np.inf
        found[name] = JointLimits(lower, upper, effort or np.inf, velocity or np.inf)
    return found


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
