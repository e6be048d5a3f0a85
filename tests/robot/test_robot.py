"""Robots' files: those that come along are sound, and every key is read."""

from pathlib import Path

import pytest

from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.robot.robot import Robot, known_robots, load_robot, parse_robot, robot_toml

FOOT = '[feet.left]\ntopic = "/left"\n'
EVERY_KEY = """
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
    [feet.two]
    topic = "/two"
    collision = "*two*"
    place = ["middle", "centre"]
    [feet.one]
    topic = "/one"
    frame = "one_foot"
    contact_point_m = [0, 0.5, -0.25]
    field = "a[1].b"
    kind = "force"
    scale = 2
    unit = "kN"
    sign = "-"
    axis = "-z"
    threshold = 3
    offset = 4
    [feet.three]
    topic = "/three"
    element = 1
    newtons_per_count = 0.5
    offset_n = [0, 0, -12]
    label = "paw"
"""


@pytest.mark.parametrize("name", known_robots())
def test_known_robots_load_under_their_own_name_and_can_be_copied(
    name: str, tmp_path: Path
) -> None:
    robot, copy = load_robot(name), tmp_path / "copy.toml"
    copy.write_text(robot_toml(name), encoding="utf-8")
    assert load_robot(str(copy)) == robot
    assert robot.name == name
    assert robot.description
    # Which of them may fit a log is seen before any is parsed.
    assert all(topic in robot_toml(name) for topic in robot.topics)


def test_the_generic_robot_assumes_nothing() -> None:
    robot = load_robot("generic")
    assert (robot.feet, robot.topics) == ((), frozenset())
    assert (robot.mass_kg, robot.odometry_topic, robot.base_frame) == (None, None, None)


@pytest.mark.parametrize("name", ["unitree_a1", "unitree_go1", "unitree_go2"])
def test_unitree_s_order_is_right_before_left(name: str) -> None:
    elements = {foot.name: foot.element for foot in load_robot(name).feet}
    assert elements == {"front_right": 0, "front_left": 1, "back_right": 2, "back_left": 3}


def test_every_key_is_read() -> None:
    assert parse_robot(EVERY_KEY, "mine.toml") == Robot(
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
            Foot("two", "/two", "*two*", ("middle", "centre")),
            Foot(
                "one",
                "/one",
                frame="one_foot",
                contact_point_m=(0.0, 0.5, -0.25),
                field=FootField("a[1].b", "force", 2.0, "kN", "-", "-z", 3.0),
                offset=4.0,
            ),
            Foot(
                "three",
                "/three",
                element=1,
                label="paw",
                offset_n=(0.0, 0.0, -12.0),
                newtons_per_count=0.5,
            ),
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
