"""URDFs as robots' files: joints, base links, legs among arms and wheels, masses."""

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path

import pytest

from dogbot_logtool.core.frames.kinematics import Joint as JointOf
from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.description import own_description, read_urdf
from dogbot_logtool.robot.urdf import legs_of_robot, read_robot
from tests.oracles.mcap_channels import SentChannel, write_channels

Joint = tuple[str, str, str, str, str]
"""Type, parent, child, place and axis."""


def urdf(joints: Sequence[Joint], masses: Sequence[str] = (), names: str = "{}_joint") -> str:
    links = {link for _, parent, child, _, _ in joints for link in (parent, child)}
    mass = '<inertial><origin xyz="0 0 -0.1"/><mass value="2"/></inertial>'
    text = [f'<link name="{link}">{mass if link in masses else ""}</link>' for link in links]
    text += [
        f'<joint name="{names.format(child)}" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="{place}"/><axis xyz="{axis}"/></joint>'
        for kind, parent, child, place, axis in joints
    ]
    return f'<robot name="r">{"".join(text)}</robot>'


def leg(base: str, name: str, x: float, y: float) -> list[Joint]:
    return [
        ("revolute", base, f"{name}_hip", f"{x} {y} 0", "1 0 0"),
        ("revolute", f"{name}_hip", f"{name}_thigh", "0 0 0", "0 1 0"),
        ("revolute", f"{name}_thigh", f"{name}_calf", "0 0 -0.2", "0 1 0"),
        ("fixed", f"{name}_calf", f"{name}_imu", "0 0 -0.1", "1 0 0"),
        ("fixed", f"{name}_calf", f"{name}_foot", "0 0 -0.2", "1 0 0"),
    ]


def quadruped(base: str, corners: str = "FL FR RL RR") -> list[Joint]:
    places = ((0.3, 0.1), (0.3, -0.1), (-0.3, 0.1), (-0.3, -0.1))
    named = zip(corners.split(), places, strict=True)
    return [joint for name, place in named for joint in leg(base, name, *place)]


ARM: tuple[Joint, ...] = (
    ("revolute", "trunk", "shoulder", "0.3 0 0.1", "0 0 1"),
    ("revolute", "shoulder", "elbow", "0 0 -0.6", "0 1 0"),
    ("prismatic", "elbow", "gripper", "0 0 -0.1", "0 1 0"),
)
NAMES = ["front_left", "front_right", "back_left", "back_right"]


def with_wheels(name: str) -> str:
    wheels: list[Joint] = [
        ("continuous", f"{leg}_calf", name.format(leg), "0 0 -0.3", "0 1 0")
        for leg in ("FL", "FR", "RL", "RR")
    ]
    return urdf([*quadruped("trunk"), *wheels])


def below_a_world(kind: str) -> str:
    joints: list[Joint] = [(kind, "world", "virtual", "0 0 0", "0 0 1")]
    joints.append((kind, "virtual", "trunk", "0 0 1", "1 0 0"))
    return urdf([*joints, *quadruped("trunk")], ["trunk"])


def biped() -> str:
    """A biped with a waist, toes, and springs that hang beside them on the same leg."""
    joints: list[Joint] = [("revolute", "torso", "pelvis", "0 0 -0.3", "0 0 1")]
    for side, y in (("left", 0.1), ("right", -0.1)):
        joints += leg("pelvis", side, 0.0, y)
        joints.append(("revolute", f"{side}_foot", f"{side}_toe", "0.1 0 0", "0 1 0"))
        joints.append(("revolute", f"{side}_calf", f"{side}_rod", "0.05 0 -0.15", "0 1 0"))
    return urdf(joints, ["torso"])


def without_feet(shape: str) -> str:
    """A quadruped whose calves are the last links, with a shape."""
    text = urdf([joint for joint in quadruped("trunk") if joint[0] != "fixed"])
    for leg in ("FL", "FR", "RL", "RR"):
        calf = f'<link name="{leg}_calf">'
        text = text.replace(calf, f"{calf}<collision>{shape}</collision>")
    return text


BASE: Joint = ("fixed", "base", "trunk", "0 0 0", "1 0 0")
LYING = urdf(
    [
        (kind, parent, child, "{0} {2} {1}".format(*place.split()), axis)
        for kind, parent, child, place, axis in quadruped("trunk")
    ]
)
UPRIGHT = (
    '<joint name="r" type="fixed"><parent link="r"/><child link="trunk"/>'
    '<origin rpy="1.5707963 0 0"/></joint></robot>'
)
WALKERS = {
    "arm": (urdf([*quadruped("trunk"), *ARM], ["trunk"]), "trunk", "+x", 3),
    "fixed below a world": (below_a_world("fixed"), "trunk", "+x", 3),
    "floating below a world": (below_a_world("floating"), "trunk", "+x", 3),
    "moved below a world": (below_a_world("revolute"), "trunk", "+x", 3),
    "root that is the base": (urdf([BASE, *quadruped("trunk")], ["trunk"]), "base", "+x", 3),
    "turned": (urdf(quadruped("trunk", "RR RL FR FL")), "trunk", "-x", 3),
    "legs without names": (urdf(quadruped("trunk", "a b c d")), "trunk", "+x", 3),
    "lying below an upright root": (LYING.replace("</robot>", UPRIGHT), "r", "+x", 3),
    "biped": (biped(), "torso", "+x", 5),
}
"""Its base, its forward axis, and how many joints its legs have."""


@pytest.mark.parametrize("name", WALKERS)
def test_walkers(name: str) -> None:
    text, base, forward, joints = WALKERS[name]
    robot = read_robot(text)
    legs, axis = legs_of_robot(robot, {})
    assert (robot.base, axis) == (base, forward)
    assert [each.name for each in legs] == (["left", "right"] if name == "biped" else NAMES)
    assert {len(each.measured) for each in legs} == {joints}


NO_LEGS = {
    with_wheels("{}_wheel"): "wheels, FL_wheel, ",
    with_wheels("{}_4"): "wheels, FL_4, ",
    without_feet(""): "where the feet of FL_calf, FR_calf",
    LYING: "z axis is not up",
}


@pytest.mark.parametrize("text", NO_LEGS, ids=NO_LEGS.values())
def test_what_is_no_leg_is_named(text: str) -> None:
    with pytest.raises(ValueError, match=NO_LEGS[text]):
        legs_of_robot(read_robot(text), {})


def test_masses_of_legs() -> None:
    """The foot's mass is the calf's, too: nothing moves between them."""
    robot = read_robot(urdf(quadruped("trunk"), ["trunk", "FL_calf", "FL_foot"]))
    (first, *_), _ = legs_of_robot(robot, {})
    assert (robot.mass_kg, first.foot) == (6.0, "FL_foot")
    assert [(mass.joint, mass.mass_kg) for mass in first.masses] == [(2, 2.0), (3, 2.0)]


@pytest.mark.parametrize(
    ("z", "shape", "radius"),
    [(-0.2, 'sphere radius="0.02"', 0.02), (-0.1, 'cylinder length="0.2" radius="0.01"', 0.0)],
)
def test_a_foot_without_a_link_is_where_the_last_link_ends(
    z: float, shape: str, radius: float
) -> None:
    text = without_feet(f'<origin xyz="0 0 {z}"/><geometry><{shape}/></geometry>')
    (first, *_), _ = legs_of_robot(read_robot(text), {})
    assert (first.foot, first.radius_m) == ("FL_calf", radius)
    assert first.point == pytest.approx((0.0, 0.0, -0.2))


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
</robot>"""


def test_joints_that_are_understood() -> None:
    hip, wheel, finger, sole = read_robot(URDF).joints
    assert hip.rotation == pytest.approx((0.0, 0.0, 0.5**0.5, 0.5**0.5))
    upright = hip._replace(rotation=wheel.rotation)
    place, axis = (0.1, 0.2, 0.3), (0.0, 1.0, 0.0)
    assert upright == JointOf("hip", "base", "leg", "revolute", place, axis=axis)
    assert wheel == JointOf("wheel", "leg", "tyre", "continuous")
    free = finger._replace(source="", multiplier=1.0, offset=0.0)
    assert free == JointOf("finger", "leg", "tip", "prismatic")
    assert finger == free._replace(source="hip", multiplier=-1.0, offset=0.5)
    assert sole == JointOf("sole", "leg", "foot", "fixed")


LEG = '<parent link="leg"/><child link="x"/>'
FAULTY = {
    '<joint name="j" type="fixed"><parent link="leg"/></joint>': "j: it lacks a name, a link",
    f'<joint name="j" type="revolute">{LEG}<axis xyz="0 0 0"/></joint>': "j: it lacks .*an axis",
    f'<joint name="j" type="fixed">{LEG}<origin xyz="1 two 3"/></joint>': "j: could not convert",
    f'<joint name="j" type="fixed">{LEG}<origin xyz="1 2"/></joint>': "j: not enough values",
    f'<joint name="j" type="fixed">{LEG}<origin rpy="nan 0 0"/></joint>': "j: 'nan' is not finite",
    '<link name="foot"><inertial><mass value="x"/></inertial></link>': "could not convert",
    '<joint name="j" type="fixed"><parent link="b"/><child link="a"/></joint>'
    '<joint name="k" type="fixed"><parent link="a"/><child link="b"/></joint>': "in a circle",
    '<joint name="j" type="fixed"><parent link="leg"/><child link="foot"/></joint>': "two parents",
    '<joint name="j" type="fixed"/>' * 401: "more than 400",
}


@pytest.mark.parametrize("faulty", FAULTY, ids=FAULTY.values())
def test_a_description_with_a_fault_says_why_it_is_not_used(faulty: str) -> None:
    with pytest.raises(ValueError, match=FAULTY[faulty]):
        read_robot(URDF.replace("</robot>", f"{faulty}</robot>"))


# Files and topics of descriptions


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"no xml", "is no XML"),
        (b"<robot", "is no XML"),
        (b"<sdf/>", "'robot'"),
        (b"\xff\xfe<robot/>", "UTF-8"),
        (b"\x7fELF\x02\x01\x01\0\0", "is no XML"),
        (
            b'<!DOCTYPE robot [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot>&a;</robot>',
            "entities",
        ),
        (b"<robot/>" + b" " * (17 << 20), "larger"),
    ],
)
def test_what_is_no_urdf_is_refused(content: bytes, why: str, tmp_path: Path) -> None:
    file = tmp_path / "x.urdf"
    file.write_bytes(content)
    with pytest.raises(CallError, match=why):
        read_urdf(file)


def test_a_description_that_cannot_be_decoded_is_none(tmp_path: Path) -> None:
    message = 1, b'{"data": "<robot/>"}'
    sent = SentChannel("/robot_description", "std_msgs/String", "json", messages=[message])
    with closing(open_log(write_channels(tmp_path / "log.mcap", [sent]))) as log:
        assert own_description(log) is None
