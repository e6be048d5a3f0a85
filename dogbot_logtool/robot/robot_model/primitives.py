"""A URDF of boxes, cylinders and spheres: a robot to look at where the log has no model.

Its links are the log's own frames, so that the log's transforms move it; the origins of its joints
are their first recorded poses, so that it stands before the first transform. Joints are floating:
how they move is not known.
"""

from collections.abc import Sequence
from math import acos, atan2, hypot
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np

from dogbot_logtool.core.known_frames import Point
from dogbot_logtool.core.rotations import roll_pitch_yaw
from dogbot_logtool.core.scene.foot_style import colour_parts
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.robot_model.skeleton import RobotShape, Skeleton, body_size_m

_AXES: Final = {"+x": (1, 0), "-x": (-1, 0), "+y": (0, 1), "-y": (0, -1)}
_FEWEST_HIPS: Final = 3
"""Assumed hips that span a body."""
_SHORTEST_LIMB_M: Final = 0.01
_THICKNESS: Final = 0.045
"""Radius of a limb over the length of a leg."""
_THINNEST_M, _THICKEST_M = 0.005, 0.04
_BODY: Final = "#b8bec6"
_LIMB: Final = "#5c6470"
_NOSE: Final = "#2f3640"


def primitive_urdf(described: Robot, frames: Skeleton, shape: RobotShape) -> str:
    """Return the URDF of a body, limbs between joints, feet in their colours, and a nose.

    Args:
        described: its name, and its mass, which gives the body's size where the legs do not.
        frames: below its base.
        shape: which axis points forward, and where legs without frames are assumed to begin.
    """
    robot = ET.Element("robot", name=described.name)
    colours = {"body": _BODY, "limb": _LIMB, "nose": _NOSE}
    colours |= {f"foot {foot.name}": foot.colour for foot in frames.feet}
    for material, colour in colours.items():
        element = ET.SubElement(robot, "material", name=material)
        ET.SubElement(element, "color", rgba=_text([*colour_parts(colour), 1.0]))
    links = {
        frame: ET.SubElement(robot, "link", name=frame) for frame in (frames.base, *frames.frames)
    }
    centre, size = _body(described, frames, shape)
    _add_visual(links[frames.base], "body", centre, "box", size=_text(size))
    _add_nose(links[frames.base], centre, size, shape.forward_axis)
    radius = _limb_radius(frames)
    for frame, pose in frames.limbs:
        _add_limb(links[pose.parent], pose.translation, radius)
        _add_visual(links[frame], "limb", (0.0, 0.0, 0.0), "sphere", radius=_text([radius]))
    for foot in frames.feet:
        _add_limb(links[foot.frame], foot.point, radius)
        material = f"foot {foot.name}"
        _add_visual(links[foot.frame], material, foot.point, "sphere", radius=_text([1.6 * radius]))
    for child, pose in frames.frames.items():
        kind = "fixed" if pose.static else "floating"
        joint = ET.SubElement(robot, "joint", name=f"{pose.parent} to {child}", type=kind)
        angles = roll_pitch_yaw(np.array([pose.rotation]))[0].tolist()
        ET.SubElement(joint, "origin", xyz=_text(pose.translation), rpy=_text(angles))
        ET.SubElement(joint, "parent", link=pose.parent)
        ET.SubElement(joint, "child", link=child)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _body(robot: Robot, frames: Skeleton, shape: RobotShape) -> tuple[Point, Point]:
    """Return centre and size, m, of the box between the hips; of the mass's size without hips.

    The latter stands on the base's origin where the robot is a biped.
    """
    hips = [frames.frames[leg[-1]].translation for leg in frames.legs]
    if not hips and len(shape.hips) >= _FEWEST_HIPS:
        hips = list(shape.hips.values())
    if not hips:
        length, width, height = body_size_m(robot.mass_kg)
        upright = len(robot.feet) == 2
        length, height = (height, length) if upright else (length, height)
        along_x = _AXES[shape.forward_axis][0] != 0
        centre = (0.0, 0.0, 0.5 * height if upright else 0.0)
        return centre, (*((length, width) if along_x else (width, length)), height)
    low, high = np.min(hips, axis=0), np.max(hips, axis=0)
    longest = max(float((high - low)[:2].max()), 0.1)
    x, y = (max(float(side), 0.4 * longest) for side in (high - low)[:2])
    cx, cy, cz = ((low + high) / 2.0).tolist()
    return (cx, cy, cz), (x, y, 0.25 * longest)


def _limb_radius(frames: Skeleton) -> float:
    """Return the radius of limbs, m, by the length of the longest leg."""
    lengths = [
        sum(hypot(*frames.frames[frame].translation) for frame in leg[:-1]) + hypot(*foot.point)
        for foot, leg in zip(frames.feet, frames.legs, strict=False)
    ]
    return min(max(_THICKNESS * max(lengths, default=0.5), _THINNEST_M), _THICKEST_M)


def _add_nose(link: ET.Element, centre: Point, size: Point, forward_axis: str) -> None:
    """Add a small box at the front of the body."""
    x, y = _AXES[forward_axis]
    depth = 0.15 * max(size)
    reach_x, reach_y = (size[0] + depth) / 2.0, (size[1] + depth) / 2.0
    middle = (centre[0] + x * reach_x, centre[1] + y * reach_y, centre[2])
    across = 0.4 * (size[1] if x else size[0])
    high = 0.6 * min(size)
    nose = (depth, across, high) if x else (across, depth, high)
    _add_visual(link, "nose", middle, "box", size=_text(nose))


def _add_limb(link: ET.Element, end: Point, radius: float) -> None:
    """Add a cylinder from a link's origin to a point, where it is long enough to be seen."""
    length = hypot(*end)
    if length < _SHORTEST_LIMB_M:
        return
    x, y, z = end
    turn = (0.0, acos(min(max(z / length, -1.0), 1.0)), atan2(y, x))
    sizes = {"radius": _text([radius]), "length": _text([length])}
    _add_visual(link, "limb", (x / 2.0, y / 2.0, z / 2.0), "cylinder", turn, **sizes)


def _add_visual(
    link: ET.Element,
    material: str,
    centre: Sequence[float],
    shape: str,
    turn: Sequence[float] = (0.0, 0.0, 0.0),
    **sizes: str,
) -> None:
    visual = ET.SubElement(link, "visual")
    ET.SubElement(visual, "origin", xyz=_text(centre), rpy=_text(turn))
    ET.SubElement(ET.SubElement(visual, "geometry"), shape, sizes)
    ET.SubElement(visual, "material", name=material)


def _text(numbers: Sequence[float]) -> str:
    """Return numbers, rounded to micrometres, as a URDF has them; -0 is 0."""
    return " ".join(f"{round(number, 6) + 0.0:.6g}" for number in numbers)
