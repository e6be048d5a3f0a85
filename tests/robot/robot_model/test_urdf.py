"""Joints of robot descriptions, as the definition of URDF has them."""

import pytest

from dogbot_logtool.robot.robot_model.urdf import parse_urdf, urdf_joints

URDF = """<robot name="r">
  <joint name="hip" type="revolute">
    <origin xyz="0.1 0.2 0.3" rpy="0 0 1.5707963267948966"/>
    <parent link="base"/><child link="/leg"/><axis xyz="0 2 0"/>
  </joint>
  <joint name="wheel" type="continuous"><parent link="leg"/><child link="tyre"/></joint>
  <joint name="finger" type="prismatic">
    <parent link="leg"/><child link="tip"/><mimic joint="hip" multiplier="-1" offset="0.5"/>
  </joint>
  <joint name="sole" type="fixed"><parent link="leg"/><child link="foot"/></joint>
  <joint name="free" type="floating"><parent link="leg"/><child link="ball"/></joint>
  <joint name="no child" type="fixed"><parent link="leg"/></joint>
  <joint name="no axis" type="revolute">
    <parent link="leg"/><child link="x"/><axis xyz="0 0 0"/>
  </joint>
  <joint name="words" type="fixed">
    <origin xyz="1 two 3"/><parent link="leg"/><child link="y"/>
  </joint>
  <joint name="short" type="fixed"><origin xyz="1 2"/><parent link="leg"/><child link="z"/></joint>
  <joint name="nan" type="fixed">
    <origin rpy="nan 0 0"/><parent link="leg"/><child link="n"/>
  </joint>
</robot>"""


def test_joints_that_are_understood() -> None:
    (hip, wheel, finger, sole), left_out = urdf_joints(parse_urdf(URDF))
    assert left_out == 5
    assert (hip.name, hip.parent, hip.child, hip.kind) == ("hip", "base", "leg", "revolute")
    assert hip.translation == (0.1, 0.2, 0.3)
    assert hip.rotation == pytest.approx((0.0, 0.0, 0.5**0.5, 0.5**0.5))
    assert hip.axis == (0.0, 1.0, 0.0)
    assert (wheel.kind, wheel.axis) == ("revolute", (1.0, 0.0, 0.0))
    assert (finger.kind, finger.measured, finger.multiplier, finger.offset) == (
        "prismatic",
        "hip",
        -1.0,
        0.5,
    )
    assert (sole.kind, sole.rotation) == ("fixed", (0.0, 0.0, 0.0, 1.0))


def test_circles_and_second_parents_are_left_out() -> None:
    pairs = ["base a", "b a", "a b", "c d", "d c", "d e", "b f"]
    text = "".join(
        f'<joint name="{pair}" type="fixed"><parent link="{pair[:-2]}"/>'
        f'<child link="{pair[-1]}"/></joint>'
        for pair in pairs
    )
    joints, left_out = urdf_joints(parse_urdf(f"<robot>{text}</robot>"))
    assert [joint.name for joint in joints] == ["base a", "a b", "b f"]
    assert left_out == 4
