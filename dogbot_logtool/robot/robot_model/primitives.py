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

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.rotations import roll_pitch_yaw
from dogbot_logtool.core.scene.feet import colour_parts, foot_colour
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.robot_model.skeleton import RobotShape, Skeleton, body_size_m

_AXES: Final = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0)}
_ORIGIN: Final = (0.0, 0.0, 0.0)
_FEWEST_HIPS: Final = 3
"""Assumed hips that span a body."""
_SHORTEST_LIMB_M: Final = 0.01
_THICKNESS: Final = 0.045
"""Radius of a limb over the length of a leg."""
_THINNEST_M, _THICKEST_M = 0.005, 0.04
_COLOURS: Final = {"body": "#b8bec6", "limb": "#5c6470", "nose": "#2f3640"}


def primitive_urdf(described: Robot, frames: Skeleton, shape: RobotShape) -> str:
    """Return the URDF of a body, limbs between joints, feet in their colours, and a nose.

    Args:
        described: its name, and its mass, which gives the body's size where the legs do not.
        frames: below its base.
        shape: which axis points forward, and where legs without frames are assumed to begin.
    """
    robot = ET.Element("robot", name=described.name)
    materials = {foot: f"foot {described.feet[foot].name}" for foot in frames.legs}
    colours = _COLOURS | {name: foot_colour(foot) for foot, name in materials.items()}
    for material, colour in colours.items():
        element = ET.SubElement(robot, "material", name=material)
        ET.SubElement(element, "color", rgba=_text([*colour_parts(colour), 1.0]))
    links = {
        frame: ET.SubElement(robot, "link", name=frame) for frame in (frames.base, *frames.frames)
    }
    centre, size = _body(described, frames, shape)
    _add_visual(links[frames.base], "body", "box", centre, size=size)
    forward = np.array(_AXES[shape.forward_axis])
    depth, across = 0.15 * size.max(), 0.4 * size[:2][forward[:2] == 0].item()
    nose = np.where(forward != 0, depth, across)
    nose[2] = 0.6 * size.min()
    middle = centre + forward * (size + depth) / 2.0
    _add_visual(links[frames.base], "nose", "box", middle, size=nose)
    radius = _limb_radius(frames)
    hips = {leg[-1] for leg in frames.legs.values()}
    for frame in (each for each in frames.limbs if each not in hips):
        track = frames.frames[frame]
        _add_limb(links[track.parent], track.translation[0], radius)
        _add_visual(links[frame], "limb", "sphere", radius=[radius])
    for foot, (frame, *_) in frames.legs.items():
        point = frames.soles[foot]
        _add_limb(links[frame], point, radius)
        _add_visual(links[frame], materials[foot], "sphere", point, radius=[1.6 * radius])
    for child, track in frames.frames.items():
        kind = "fixed" if track.static else "floating"
        joint = ET.SubElement(robot, "joint", name=f"{track.parent} to {child}", type=kind)
        angles = roll_pitch_yaw(track.rotation[:1])[0]
        ET.SubElement(joint, "origin", xyz=_text(track.translation[0]), rpy=_text(angles))
        ET.SubElement(joint, "parent", link=track.parent)
        ET.SubElement(joint, "child", link=child)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode") + "\n"


def _body(robot: Robot, frames: Skeleton, shape: RobotShape) -> tuple[Floats, Floats]:
    """Return centre and size, m, of the box between the hips; of the mass's size without hips.

    The latter stands on the base's origin where the robot is a biped.
    """
    hips = [frames.frames[leg[-1]].translation[0] for leg in frames.legs.values()]
    if not hips and len(shape.hips) >= _FEWEST_HIPS:
        hips = [np.array(hip) for hip in shape.hips.values()]
    if not hips:
        length, width, height = body_size_m(robot.mass_kg)
        upright = len(robot.feet) == 2
        length, height = (height, length) if upright else (length, height)
        length, width = (length, width) if _AXES[shape.forward_axis][0] else (width, length)
        centre = np.array([0.0, 0.0, 0.5 * height if upright else 0.0])
        return centre, np.array([length, width, height])
    low, high = np.min(hips, axis=0), np.max(hips, axis=0)
    longest = max(float((high - low)[:2].max()), 0.1)
    size = np.maximum(high - low, 0.4 * longest)
    size[2] = 0.25 * longest
    return (low + high) / 2.0, size


def _limb_radius(frames: Skeleton) -> float:
    """Return the radius of limbs, m, by the length of the longest leg."""
    lengths = [
        sum(hypot(*frames.frames[frame].translation[0]) for frame in leg[:-1])
        + hypot(*frames.soles[foot])
        for foot, leg in frames.legs.items()
    ]
    return min(max(_THICKNESS * max(lengths, default=0.5), _THINNEST_M), _THICKEST_M)


def _add_limb(link: ET.Element, end: Sequence[float] | Floats, radius: float) -> None:
    """Add a cylinder from a link's origin to a point, where it is long enough to be seen."""
    length = hypot(*end)
    if length >= _SHORTEST_LIMB_M:
        x, y, z = end
        turn = (0.0, acos(min(max(z / length, -1.0), 1.0)), atan2(y, x))
        middle = (x / 2.0, y / 2.0, z / 2.0)
        _add_visual(link, "limb", "cylinder", middle, turn, radius=[radius], length=[length])


def _add_visual(
    link: ET.Element,
    material: str,
    shape: str,
    centre: Sequence[float] | Floats = _ORIGIN,
    turn: Sequence[float] = _ORIGIN,
    **sizes: Sequence[float] | Floats,
) -> None:
    visual = ET.SubElement(link, "visual")
    ET.SubElement(visual, "origin", xyz=_text(centre), rpy=_text(turn))
    geometry = {name: _text(numbers) for name, numbers in sizes.items()}
    ET.SubElement(ET.SubElement(visual, "geometry"), shape, geometry)
    ET.SubElement(visual, "material", name=material)


def _text(numbers: Sequence[float] | Floats) -> str:
    """Return numbers, rounded to micrometres, as a URDF has them; -0 is 0."""
    return " ".join(f"{round(float(number), 6) + 0.0:.6g}" for number in numbers)
