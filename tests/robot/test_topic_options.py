"""Options about topics: what they choose, and what is said of those that do not fit."""

from pathlib import Path

import pytest

from dogbot_logtool.errors import CallError
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.robot.annotated import open_recorded
from dogbot_logtool.robot.selection import Selection, select_topics
from tests.oracles.foot_logs import CONTACTS, write_log

LEGS = ("front_left", "front_right", "back_left", "back_right")
DOGBOT = {f"/dogbot/{leg}_contactsensor_state": CONTACTS for leg in LEGS}
SPARE = {f"/spare/{number}": CONTACTS for number in range(4)}
FRONT_RIGHT = "/dogbot/front_right_contactsensor_state"


def selected(path: Path, options: RobotOptions, **topics: str) -> Selection:
    log = open_recorded(write_log(path, topics or DOGBOT | SPARE, odometry=["/dogbot/odom", "/x"]))
    try:
        return select_topics(log, options)
    finally:
        log.close()


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "log.mcap"


def test_options_choose(path: Path) -> None:
    options = RobotOptions(
        robot="generic",
        odom_topic="/x",
        foot={"paw": "/spare/0", "hind_left": "/spare/1"},
        mass=12.5,
    )
    found = selected(path, options)
    assert found.base_name == "/x"
    assert {foot.name: foot.topic for foot in found.robot.feet} == options.foot
    assert [foot.leg_position for foot in found.robot.feet] == [None, ("back", "left")]
    assert found.robot.mass_kg == 12.5


def test_a_foot_of_the_robot_gets_another_topic(path: Path) -> None:
    found = selected(path, RobotOptions(robot="dogbot", foot={"back_left": "/spare/0"}))
    (foot,) = [foot for foot in found.robot.feet if foot.name == "back_left"]
    assert (foot.topic, foot.collision) == ("/spare/0", "*back_left_foot*")


@pytest.mark.parametrize("topics", [list(DOGBOT), list(SPARE)], ids=["its own", "others"])
def test_all_feet_of_a_guessed_robot_can_be_named_anew(path: Path, topics: list[str]) -> None:
    given = {f"paw_{number}": topic for number, topic in enumerate(topics)}
    recorded = dict.fromkeys(topics, CONTACTS)
    found = selected(path, RobotOptions(foot=given), **recorded)
    assert found.robot.name == "dogbot"
    assert {foot.name: foot.topic for foot in found.robot.feet} == given


def test_a_robot_of_which_the_log_has_nothing(path: Path) -> None:
    found = selected(path, RobotOptions(robot="anymal"), **SPARE)
    assert "ROBOT_GUESSED" in {each.code for each in found.findings}
    named = selected(path, RobotOptions(robot="anymal", odom_topic="/x"), **SPARE)
    assert "ROBOT_GUESSED" not in {each.code for each in named.findings}


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (RobotOptions(odom_topic="dogbot/odom"), "did you mean /dogbot/odom?"),
        (RobotOptions(odom_topic="/dogbt/odom"), "did you mean /dogbot/odom?"),
        (RobotOptions(foot={"back_left": "/dogbot/back_left"}), "did you mean /dogbot/"),
        (RobotOptions(odom_topic="/none"), "no topic /none"),
        (RobotOptions(odom_topic="/spare/0"), "is of type gazebo_msgs/ContactsState"),
        (RobotOptions(foot={"a": "/none"}), "--foot"),
        (RobotOptions(foot={"a": "/x"}), "is of type nav_msgs/Odometry"),
        (RobotOptions(robot="unicorn"), "dogbot, generic"),
        (RobotOptions(robot="unicorn.toml"), "no such file"),
        (RobotOptions(foot={"nose": "/spare/0"}), "has no such foot; it has front_left"),
        (RobotOptions(robot="dogbot", foot={"nose": "/spare/0"}), "has no such foot"),
        (
            RobotOptions(robot="generic", foot={"a": "/spare/0", "b": "/spare/0"}),
            r"topic of a, b; .*ContactsState is about one foot",
        ),
        (RobotOptions(foot={"front_left": FRONT_RIGHT}), "topic of front_left, front_right"),
    ],
)
def test_options_that_do_not_fit(path: Path, options: RobotOptions, said: str) -> None:
    with pytest.raises(CallError, match=said):
        selected(path, options)
