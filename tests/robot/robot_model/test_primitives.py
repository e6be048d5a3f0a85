"""The URDF of primitives: every frame is a link, limbs end where the next joint is."""

from xml.etree import ElementTree as ET

import pytest

from dogbot_logtool.robot.robot_model.primitives import primitive_urdf
from dogbot_logtool.robot.robot_model.skeleton import Skeleton

NOTHING = Skeleton("base", {}, ())


def tree(frames: Skeleton, axis: str = "+x", mass: float | None = None) -> ET.Element:
    return ET.fromstring(primitive_urdf("robot & <co>", frames, axis, mass))  # noqa: S314


def link(robot: ET.Element, name: str) -> ET.Element:
    (found,) = [each for each in robot.findall("link") if each.get("name") == name]
    return found


@pytest.mark.parametrize(
    ("axis", "x", "y"), [("+x", 1, 0), ("-x", -1, 0), ("+y", 0, 1), ("-y", 0, -1)]
)
def test_the_nose_is_at_the_front(axis: str, x: int, y: int) -> None:
    body, nose = link(tree(NOTHING, axis, 12.0), "base").findall("visual")
    place = [float(number) for number in nose.find("origin").get("xyz").split()]  # type: ignore[union-attr]
    size = [float(number) for number in body.find("geometry/box").get("size").split()]  # type: ignore[union-attr]
    reach = place[0] * x + place[1] * y
    assert reach > max(size) / 2.0
    assert place[0] * y == place[1] * x == place[2] == 0.0
    # A body is longest along its forward axis.
    assert size[0 if x else 1] == max(size)


def test_a_biped_s_body_stands_on_its_base() -> None:
    for upright in (False, True):
        robot = ET.fromstring(primitive_urdf("r", NOTHING, "+x", 60.0, upright=upright))  # noqa: S314
        body = link(robot, "base").findall("visual")[0]
        box, origin = body.find("geometry/box"), body.find("origin")
        assert box is not None
        assert origin is not None
        length, _, height = (float(side) for side in box.attrib["size"].split())
        assert (height > length) == upright
        lowest = float(origin.attrib["xyz"].split()[2]) - height / 2.0
        assert lowest == pytest.approx(0.0 if upright else -height / 2.0, abs=1e-6)
