"""Robots' files: those that come along are sound, and every key is read."""

from pathlib import Path

import pytest

from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.robot.robot import (
    AXES,
    Robot,
    known_robots,
    load_robot,
    parse_robot,
    robot_toml,
)

FOOT = '[feet.left]\ntopic = "/left"\n'


def test_known_robots_are_sorted_and_there() -> None:
    assert known_robots() == tuple(sorted(known_robots()))
    assert {"dogbot", "generic"} <= set(known_robots())


@pytest.mark.parametrize("name", known_robots())
def test_known_robots_load_under_their_own_name(name: str) -> None:
    robot = load_robot(name)

    assert robot.name == name
    assert robot.description
    assert robot.forward_axis in AXES
    # Which of them may fit a log is seen before any is parsed.
    assert all(topic in robot_toml(name) for topic in robot.topics)


@pytest.mark.parametrize("name", known_robots())
def test_a_known_robots_file_can_be_copied_and_loaded(name: str, tmp_path: Path) -> None:
    copy = tmp_path / "copy.toml"
    copy.write_text(robot_toml(name), encoding="utf-8")

    assert load_robot(str(copy)) == load_robot(name)


def test_dogbot_is_as_it_was_measured() -> None:
    robot = load_robot("dogbot")

    assert robot.mass_kg == 21.261
    assert robot.forward_axis == "+y"
    assert robot.odometry_topic == "/dogbot/odom"
    assert (robot.world_frame, robot.base_frame) == ("world", "base_link")
    assert [foot.name for foot in robot.feet] == [
        "front_left",
        "front_right",
        "back_left",
        "back_right",
    ]
    assert [foot.topic for foot in robot.feet] == [
        f"/dogbot/{foot.name}_contactsensor_state" for foot in robot.feet
    ]
    assert [foot.leg_position for foot in robot.feet] == [
        ("front", "left"),
        ("front", "right"),
        ("back", "left"),
        ("back", "right"),
    ]


def test_the_generic_robot_assumes_nothing() -> None:
    robot = load_robot("generic")

    assert robot.feet == ()
    assert robot.topics == frozenset()
    assert (robot.mass_kg, robot.odometry_topic, robot.base_frame) == (None, None, None)


def test_topics_are_those_of_the_odometry_and_of_the_feet() -> None:
    topics = load_robot("dogbot").topics

    assert "/dogbot/odom" in topics
    assert len(topics) == 5


def test_the_hexapod_s_legs_are_numbered_around_the_body() -> None:
    feet = {foot.name: foot.topic for foot in load_robot("hexapod").feet}
    assert feet["front_right"] == "/leg_1/foot_contact"
    assert feet["back_left"] == "/leg_4/foot_contact"
    assert feet["front_left"] == "/leg_6/foot_contact"


@pytest.mark.parametrize("name", ["unitree_a1", "unitree_go1", "unitree_go2"])
def test_unitree_s_order_is_right_before_left(name: str) -> None:
    robot = load_robot(name)
    assert {foot.name: foot.element for foot in robot.feet} == {
        "front_right": 0,
        "front_left": 1,
        "back_right": 2,
        "back_left": 3,
    }


# --- a robot of one's own -------------------------------------------------------------------------


def test_every_key_is_read() -> None:
    text = """
        name = "spider"
        description = "eight feet"
        mass_kg = 3
        forward_axis = "-x"
        com_offset_m = [0.02, 0, -0.01]
        foot_rolling_m = 0.002
        [topics]
        odometry = "/odom"
        [frames]
        world = "map"
        base = "trunk"
        [arrows]
        newtons_per_metre = 10
        shaft_diameter_m = 0.01
        [contact]
        on_n = 5
        on_counts = 30
        off_n = 2.5
        debounce_s = 0.01
        [feet.one]
        topic = "/one"
        collision = "*one*"
        place = ["middle", "centre"]
        [feet.two]
        topic = "/two"
        frame = "two_foot"
        contact_point_m = [0, 0.5, -0.25]
    """

    assert parse_robot(text, "mine.toml") == Robot(
        name="spider",
        description="eight feet",
        mass_kg=3.0,
        forward_axis="-x",
        com_offset_m=(0.02, 0.0, -0.01),
        foot_rolling_m=0.002,
        odometry_topic="/odom",
        world_frame="map",
        base_frame="trunk",
        feet=(
            Foot("one", "/one", "*one*", ("middle", "centre")),
            Foot("two", "/two", frame="two_foot", contact_point_m=(0.0, 0.5, -0.25)),
        ),
        newtons_per_metre=10.0,
        shaft_diameter_m=0.01,
        contact_on_n=5.0,
        contact_on_counts=30.0,
        contact_off_n=2.5,
        debounce_s=0.01,
    )


def test_an_empty_file_is_a_robot_with_the_files_name(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text("", encoding="utf-8")

    assert load_robot(str(file)) == Robot("mine")


def test_feet_stand_in_the_order_of_the_file() -> None:
    text = '[feet.z]\ntopic = "/z"\n[feet.a]\ntopic = "/a"\n[feet.m]\ntopic = "/m"\n'

    assert [foot.name for foot in parse_robot(text, "mine.toml").feet] == ["z", "a", "m"]


def test_a_given_mass_replaces_the_files() -> None:
    robot = load_robot("dogbot")

    assert robot.with_mass(30.0).mass_kg == 30.0
    assert robot.with_mass(None) is robot


def test_every_key_of_a_field_is_read() -> None:
    keys = 'field = "a[1].b"\nkind = "force"\nscale = 2\nunit = "kN"\nsign = "-"\naxis = "-z"\n'
    foot = parse_robot(f"{FOOT}{keys}threshold = 3\noffset = 4", "mine.toml").feet[0]
    assert foot.field == FootField("a[1].b", "force", 2.0, "kN", "-", "-z", 3.0)
    assert foot.offset == 4.0
