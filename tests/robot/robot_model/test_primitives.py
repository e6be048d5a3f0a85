"""The URDF of primitives: every frame is a link, limbs end where the next joint is."""

from math import cos, sin
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from dogbot_logtool.core.soles import FramePose, Point
from dogbot_logtool.robot.robot_model.primitives import primitive_urdf
from dogbot_logtool.robot.robot_model.skeleton import (
    ModelFoot,
    Skeleton,
    skeleton,
)

UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def pose(parent: str, *translation: float, static: bool = False) -> FramePose:
    x, y, z = translation
    return FramePose(parent, (x, y, z), UPRIGHT, static)


POSES = {
    "base": pose("world", 0, 0, 1),
    "hip": pose("base", 0.2, 0.1, 0.0),
    "knee": pose("hip", 0.1, 0.2, -0.2),
    "other_hip": pose("base", -0.2, -0.1, 0.0),
    "imu": pose("base", 0.0, 0.3, 0.0, static=True),
    "loop_a": pose("loop_b", 0, 0, 0),
    "loop_b": pose("loop_a", 0, 0, 0),
}
FEET = (ModelFoot("left", "knee", (0.0, 0.0, -0.3), "#0072b2"),)


def tree(frames: Skeleton, axis: str = "+x", mass: float | None = None) -> ET.Element:
    return ET.fromstring(primitive_urdf("robot & <co>", frames, axis, mass))  # noqa: S314


def ends(visual: ET.Element) -> tuple[np.ndarray, np.ndarray]:
    """The ends of a cylinder, by the definition of roll, pitch and yaw."""
    cylinder, origin = visual.find("geometry/cylinder"), visual.find("origin")
    assert cylinder is not None
    assert origin is not None
    middle = np.array([float(x) for x in origin.attrib["xyz"].split()])
    roll, pitch, yaw = (float(x) for x in origin.attrib["rpy"].split())
    assert roll == 0.0
    axis = np.array([sin(pitch) * cos(yaw), sin(pitch) * sin(yaw), cos(pitch)])
    half = float(cylinder.attrib["length"]) / 2.0 * axis
    return middle - half, middle + half


def link(robot: ET.Element, name: str) -> ET.Element:
    (found,) = [each for each in robot.findall("link") if each.get("name") == name]
    return found


def test_links_are_the_frames_below_the_base() -> None:
    robot = tree(skeleton("base", POSES, set(), FEET))
    assert robot.get("name") == "robot & <co>"
    names = [each.get("name") for each in robot.findall("link")]
    assert sorted(filter(None, names)) == ["base", "hip", "imu", "knee", "other_hip"]
    pairs = {
        (joint.find("parent").get("link"), joint.find("child").get("link"))  # type: ignore[union-attr]
        for joint in robot.findall("joint")
    }
    assert pairs == {("base", "hip"), ("hip", "knee"), ("base", "other_hip"), ("base", "imu")}
    kinds = {joint.get("name"): joint.get("type") for joint in robot.findall("joint")}
    assert kinds["base to imu"] == "fixed"
    assert kinds["hip to knee"] == "floating"


@pytest.mark.parametrize(
    "end", [(0.1, 0.2, -0.2), (0.0, 0.0, -0.3), (0.0, 0.0, 0.3), (-0.1, 0.0, 0.0), (0.1, -0.4, 0.2)]
)
def test_limbs_end_at_the_next_joint(end: Point) -> None:
    poses = POSES | {"knee": pose("hip", *end)}
    robot = tree(skeleton("base", poses, set(), FEET))
    (limb,) = link(robot, "hip").findall("visual")
    start, found = ends(limb)
    np.testing.assert_allclose(start, 0.0, atol=1e-5)
    np.testing.assert_allclose(found, end, atol=1e-5)


def test_a_shin_ends_at_the_contact_point_in_a_coloured_foot() -> None:
    robot = tree(skeleton("base", POSES, set(), FEET))
    joint, shin, ball = link(robot, "knee").findall("visual")
    assert joint.find("origin").get("xyz") == "0 0 0"  # type: ignore[union-attr]
    np.testing.assert_allclose(ends(shin)[1], [0.0, 0.0, -0.3], atol=1e-5)
    assert ball.find("geometry/sphere") is not None
    material = ball.find("material")
    assert material is not None
    assert material.get("name") == "foot left"
    colours = {
        each.get("name"): each.find("color").get("rgba")  # type: ignore[union-attr]
        for each in robot.findall("material")
    }
    assert colours["foot left"] == "0 0.447059 0.698039 1"


@pytest.mark.parametrize(
    ("axis", "x", "y"), [("+x", 1, 0), ("-x", -1, 0), ("+y", 0, 1), ("-y", 0, -1)]
)
def test_the_nose_is_at_the_front(axis: str, x: int, y: int) -> None:
    body, nose = link(tree(skeleton("base", {}, set(), ()), axis, 12.0), "base").findall("visual")
    place = [float(number) for number in nose.find("origin").get("xyz").split()]  # type: ignore[union-attr]
    size = [float(number) for number in body.find("geometry/box").get("size").split()]  # type: ignore[union-attr]
    reach = place[0] * x + place[1] * y
    assert reach > max(size) / 2.0
    assert place[0] * y == place[1] * x == place[2] == 0.0
    # A body is longest along its forward axis.
    assert size[0 if x else 1] == max(size)


def test_a_biped_s_body_stands_on_its_base() -> None:
    frames = skeleton("base", {}, frozenset(), ())
    for upright in (False, True):
        robot = ET.fromstring(primitive_urdf("r", frames, "+x", 60.0, upright=upright))  # noqa: S314
        body = link(robot, "base").findall("visual")[0]
        box, origin = body.find("geometry/box"), body.find("origin")
        assert box is not None
        assert origin is not None
        length, _, height = (float(side) for side in box.attrib["size"].split())
        assert (height > length) == upright
        lowest = float(origin.attrib["xyz"].split()[2]) - height / 2.0
        assert lowest == pytest.approx(0.0 if upright else -height / 2.0, abs=1e-6)


def test_frames_with_two_parents_are_left_out_with_those_below() -> None:
    frames = skeleton("base", POSES, {"hip"}, FEET)
    assert sorted(frames.frames) == ["imu", "other_hip"]
    assert frames.feet == ()
