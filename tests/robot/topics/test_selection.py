"""Which topics are used for what: by the robot's file, by options, by type and name."""

import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pytest
from mcap.writer import Writer as McapWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from dogbot_logtool.errors import CallError
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.topics.selection import Selection, select_topics

ODOMETRY, CONTACTS, TF = "nav_msgs/Odometry", "gazebo_msgs/ContactsState", "tf2_msgs/TFMessage"
WRENCH = "geometry_msgs/WrenchStamped"
DOGBOT_FEET = ("front_left", "front_right", "back_left", "back_right")
DOGBOT = {
    "/dogbot/odom": ODOMETRY,
    **{f"/dogbot/{foot}_contactsensor_state": CONTACTS for foot in DOGBOT_FEET},
}
STORE = get_typestore(Stores.ROS1_NOETIC)
STORE.register(
    get_types_from_msg(
        "string info\nstring collision1_name\nstring collision2_name\n"
        "geometry_msgs/Wrench[] wrenches\ngeometry_msgs/Wrench total_wrench\n"
        "geometry_msgs/Vector3[] contact_positions\ngeometry_msgs/Vector3[] contact_normals\n"
        "float64[] depths\n",
        "gazebo_msgs/msg/ContactState",
    )
)
STORE.register(
    get_types_from_msg(
        "Header header\ngazebo_msgs/ContactState[] states\n", "gazebo_msgs/msg/ContactsState"
    )
)
STORE.register(
    get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage")
)


def definition(type_name: str) -> bytes:
    text, _ = STORE.generate_msgdef(type_name.replace("/", "/msg/"))
    return text.encode()


Channel = tuple[str, str, bytes, str, int]
"""Topic, type, definition, encoding, number of messages."""


def write_log(path: Path, channels: Sequence[Channel]) -> Path:
    """Write an MCAP whose messages are empty: only channels matter here."""
    with path.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start(profile="ros1")
        for topic, type_name, text, encoding, count in channels:
            schema = writer.register_schema(type_name, "ros1msg", text) if type_name else 0
            channel = writer.register_channel(topic, encoding, schema)
            for number in range(count):
                writer.add_message(channel, number, b"", number)
        writer.finish()
    return path


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "log.mcap"


def channels(topics: Mapping[str, str], counts: Mapping[str, int] | None = None) -> list[Channel]:
    counts = counts or {}
    return [(t, kind, definition(kind), "ros1", counts.get(t, 0)) for t, kind in topics.items()]


@pytest.fixture
def opened(path: Path) -> Iterator["Opener"]:
    opener = Opener(path)
    yield opener
    for log in opener.logs:
        log.close()


class Opener:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.logs: list[Log] = []

    def __call__(self, found: Sequence[Channel]) -> Log:
        self.logs.append(open_log(write_log(self.path, found)))
        return self.logs[-1]


def feet(selection: Selection) -> dict[str, str]:
    return {foot.name: foot.topic for foot in selection.robot.feet}


def codes(selection: Selection) -> list[str]:
    return [finding.code for finding in selection.findings]


def test_the_known_robot_with_most_topics_is_guessed(opened: Opener) -> None:
    selection = select_topics(opened(channels(DOGBOT | {"/tf": TF})), MeasureOptions())
    assert selection.robot.name == "dogbot"
    assert [channel.topic for channel in selection.odometry] == ["/dogbot/odom"]
    assert tuple(feet(selection)) == DOGBOT_FEET
    assert [channel.topic for channel in selection.transforms] == ["/tf"]
    by_topic = {c.topic: selection.feet_of[c.id] for c in selection.contacts}
    told = [by_topic[f"/dogbot/{foot}_contactsensor_state"] for foot in DOGBOT_FEET]
    assert told == [(0,), (1,), (2,), (3,)]
    assert codes(selection) == ["ROBOT_GUESSED"]


def test_an_unknown_robot_s_topics_are_found(opened: Opener) -> None:
    topics = {
        "/spot/odometry": ODOMETRY,
        "/spot/contacts/LF": CONTACTS,
        "/spot/contacts/RF": CONTACTS,
        "/spot/contacts/LH": CONTACTS,
        "/spot/contacts/RH": CONTACTS,
    }
    selection = select_topics(opened(channels(topics)), MeasureOptions())
    assert selection.robot.name == "generic"
    assert feet(selection) == {
        "front_left": "/spot/contacts/LF",
        "front_right": "/spot/contacts/RF",
        "back_left": "/spot/contacts/LH",
        "back_right": "/spot/contacts/RH",
    }
    assert codes(selection) == ["ROBOT_GUESSED", "TOPICS_CHOSEN", "TOPICS_CHOSEN"]
    assert "--robot" in selection.findings[0].text


def test_feet_whose_names_do_not_tell_are_offered(opened: Opener) -> None:
    topics = {"/bumper 7": CONTACTS, "/a/left_front": CONTACTS, "/b/left_front": CONTACTS}
    selection = select_topics(opened(channels(topics)), MeasureOptions(mass=12.5))
    assert (selection.robot.feet, selection.contacts) == ((), ())
    assert {"NO_BASE", "FEET_UNSURE"} <= set(codes(selection))
    (finding,) = [f for f in selection.findings if f.code == "FEET_UNSURE"]
    words = shlex.split(finding.command)
    assert words[:5] == ["dogbot-logtool", "stats", str(opened.path), "--mass", "12.5"]
    assert words[5:] == [
        *("--foot", "a_left_front=/a/left_front"),
        *("--foot", "b_left_front=/b/left_front"),
        *("--foot", "bumper_7=/bumper 7"),
    ]
    assert finding.text.endswith(finding.command)


def test_sensors_that_are_not_named_like_feet_are_no_feet(opened: Opener) -> None:
    topics = {"/odom": ODOMETRY, "/rl_tool/drill/force": WRENCH, "/left_hand/ft": WRENCH}
    selection = select_topics(opened(channels(topics)), MeasureOptions())
    assert selection.robot.feet == ()
    (finding,) = [f for f in selection.findings if f.code == "NO_FEET"]
    assert "/left_hand/ft, /rl_tool/drill/force" in finding.text


def test_what_else_may_be_feet_is_told(opened: Opener) -> None:
    sides = [f"/{kind}{side}fsensor" for kind in ("", "off_") for side in "lr"]
    selection = select_topics(opened(channels(dict.fromkeys(sides, WRENCH))), MeasureOptions())
    assert feet(selection) == {"left": "/off_lfsensor", "right": "/off_rfsensor"}
    (finding,) = [f for f in selection.findings if f.code == "TOPICS_CHOSEN"]
    assert "--foot left=/lfsensor --foot right=/rfsensor" in finding.text


def test_feet_of_another_type_are_found(opened: Opener) -> None:
    topics = {"/trunk/bumper": CONTACTS, "/left_ankle_ft": WRENCH, "/right_ankle_ft": WRENCH}
    selection = select_topics(opened(channels(topics)), MeasureOptions())
    assert feet(selection) == {"left": "/left_ankle_ft", "right": "/right_ankle_ft"}


def test_the_odometry_that_is_heard_most_is_taken(opened: Opener) -> None:
    topics = {"/a/odom": ODOMETRY, "/b/odom": ODOMETRY, "/c/odom": ODOMETRY}
    log = opened(channels(topics, {"/a/odom": 3, "/b/odom": 9}))
    selection = select_topics(log, MeasureOptions())
    assert [channel.topic for channel in selection.odometry] == ["/b/odom"]
    (finding,) = [f for f in selection.findings if f.code == "TOPICS_CHOSEN"]
    assert finding.where == "/b/odom"
    assert "/a/odom" in finding.text
    assert "--odom-topic" in finding.text


def test_missing_feet_are_told_and_kept(opened: Opener) -> None:
    log = opened(channels({"/dogbot/back_left_contactsensor_state": CONTACTS}))
    selection = select_topics(log, MeasureOptions())
    assert selection.robot.name == "dogbot"
    assert len(selection.robot.feet) == 4
    missing = [f.where for f in selection.findings if f.code == "NO_MESSAGES"]
    assert len(missing) == 3
    assert set(selection.feet_of.values()) == {(2,)}


def test_options_choose(opened: Opener) -> None:
    topics = {"/x": ODOMETRY, "/dogbot/odom": ODOMETRY, "/y": CONTACTS, "/z": CONTACTS}
    options = MeasureOptions(
        robot="generic", odom_topic="/x", foot={"paw": "/y", "hind_left": "/z"}, mass=12.5
    )
    selection = select_topics(opened(channels(topics)), options)
    assert [channel.topic for channel in selection.odometry] == ["/x"]
    assert feet(selection) == {"paw": "/y", "hind_left": "/z"}
    assert [foot.leg_position for foot in selection.robot.feet] == [None, ("back", "left")]
    assert selection.robot.mass_kg == 12.5
    assert codes(selection) == []


def test_a_foot_of_the_robot_gets_another_topic(opened: Opener) -> None:
    topics = DOGBOT | {"/other": CONTACTS}
    options = MeasureOptions(robot="dogbot", foot={"back_left": "/other"})
    selection = select_topics(opened(channels(topics)), options)
    assert feet(selection)["back_left"] == "/other"
    (foot,) = [foot for foot in selection.robot.feet if foot.name == "back_left"]
    assert (foot.collision, foot.leg_position) == ("*back_left_foot*", ("back", "left"))


SPARE = {f"/spare/{number}": CONTACTS for number in range(4)}


def test_feet_take_each_other_s_topics(opened: Opener) -> None:
    left, right = (f"/dogbot/front_{side}_contactsensor_state" for side in ("left", "right"))
    options = MeasureOptions(foot={"front_left": right, "front_right": left})
    selection = select_topics(opened(channels(DOGBOT)), options)
    assert feet(selection)["front_left"] == right
    assert feet(selection)["front_right"] == left


@pytest.mark.parametrize("topics", [list(DOGBOT)[1:], list(SPARE)], ids=["its own", "others"])
def test_all_feet_of_a_guessed_robot_can_be_named_anew(
    opened: Opener, topics: Sequence[str]
) -> None:
    recorded = {"/dogbot/odom": ODOMETRY, **dict.fromkeys(topics, CONTACTS)}
    given = {f"paw_{number}": topic for number, topic in enumerate(topics)}
    selection = select_topics(opened(channels(recorded)), MeasureOptions(foot=given))
    assert selection.robot.name == "dogbot"
    assert feet(selection) == given


@pytest.mark.parametrize("robot", [None, "dogbot"])
def test_a_foot_that_the_robot_does_not_have(opened: Opener, robot: str | None) -> None:
    log = opened(channels(DOGBOT | SPARE))
    options = MeasureOptions(robot=robot, foot={"nose": "/spare/0"})
    with pytest.raises(CallError, match=r"dogbot.* no such foot; it has front_left, front_right"):
        select_topics(log, options)


def test_a_topic_for_two_feet(opened: Opener) -> None:
    log = opened(channels(DOGBOT | SPARE))
    same = MeasureOptions(robot="generic", foot={"a": "/spare/0", "b": "/spare/0"})
    with pytest.raises(CallError, match=r"topic of a, b; .*ContactsState is about one foot"):
        select_topics(log, same)
    other = f"/dogbot/{DOGBOT_FEET[1]}_contactsensor_state"
    with pytest.raises(CallError, match="topic of front_left, front_right"):
        select_topics(log, MeasureOptions(foot={"front_left": other}))


def test_a_robot_of_which_the_log_has_nothing(opened: Opener) -> None:
    topics = {"/odom": ODOMETRY, "/left_foot": CONTACTS, "/right_foot": CONTACTS}
    selection = select_topics(opened(channels(topics)), MeasureOptions(robot="dogbot"))
    assert feet(selection) == {"left": "/left_foot", "right": "/right_foot"}
    told = [each.text for each in selection.findings if each.code == "TOPICS_CHOSEN"]
    missing = "/odom, found by its type, since the robot's /dogbot/odom is missing"
    assert any(missing in each for each in told)
    (finding,) = [f for f in selection.findings if f.code == "ROBOT_GUESSED"]
    assert "none of the topics of the robot 'dogbot'" in finding.text
    named = MeasureOptions(robot="dogbot", odom_topic="/odom")
    assert "ROBOT_GUESSED" not in codes(select_topics(opened(channels(topics)), named))


def test_a_topic_of_another_type_makes_no_robot(opened: Opener) -> None:
    topics = dict.fromkeys([*DOGBOT][1:], TF) | {"/odom": ODOMETRY}
    assert select_topics(opened(channels(topics)), MeasureOptions()).robot.name == "generic"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (MeasureOptions(odom_topic="dogbot/odom"), "did you mean /dogbot/odom?"),
        (MeasureOptions(odom_topic="/dogbt/odom"), "did you mean /dogbot/odom?"),
        (MeasureOptions(foot={"back_left": "/dogbot/back_left"}), "did you mean /dogbot/"),
        (MeasureOptions(odom_topic="/none"), "no topic /none"),
        (MeasureOptions(odom_topic="/tf"), "is of type tf2_msgs/TFMessage"),
        (MeasureOptions(foot={"a": "/none"}), "--foot"),
        (MeasureOptions(foot={"a": "/dogbot/odom"}), "is of type nav_msgs/Odometry"),
        (MeasureOptions(robot="unicorn"), "dogbot, generic"),
        (MeasureOptions(robot="unicorn.toml"), "no such file"),
    ],
)
def test_options_that_do_not_fit(opened: Opener, options: MeasureOptions, said: str) -> None:
    log = opened(channels(DOGBOT | {"/tf": TF}))
    with pytest.raises(CallError, match=said):
        select_topics(log, options)


def test_what_cannot_be_decoded_is_not_used(opened: Opener) -> None:
    found: list[Channel] = [
        ("/dogbot/odom", ODOMETRY, b"string nonsense", "ros1", 1),
        ("/good/odom", ODOMETRY, definition(ODOMETRY), "ros1", 1),
        ("/foot_a", CONTACTS, b"string header", "ros1", 1),
        ("/foot_b", CONTACTS, definition(CONTACTS), "json", 1),
        ("/tf", TF, b"string[] transforms", "ros1", 1),
    ]
    selection = select_topics(opened(found), MeasureOptions(robot="dogbot"))
    assert [channel.topic for channel in selection.odometry] == ["/good/odom"]
    assert (selection.contacts, selection.transforms) == ((), ())
    unreadable = {(f.code, f.where) for f in selection.findings if "UNREADABLE" in f.code}
    assert unreadable == {
        ("UNREADABLE", "/dogbot/odom"),
        ("UNREADABLE", "/foot_a"),
        ("UNREADABLE", "/foot_b"),
        ("UNREADABLE", "/tf"),
    }


def test_several_senders_of_a_topic_are_all_used(opened: Opener) -> None:
    other = definition(CONTACTS) + b"\n# from another sender"
    topic = "/dogbot/front_left_contactsensor_state"
    found = [
        (topic, CONTACTS, definition(CONTACTS), "ros1", 1),
        (topic, CONTACTS, other, "ros1", 1),
    ]
    selection = select_topics(opened(found), MeasureOptions())
    assert len(selection.contacts) == 2
    assert set(selection.feet_of.values()) == {(0,)}


def test_nothing(opened: Opener) -> None:
    selection = select_topics(opened([("/x", "", b"", "json", 1)]), MeasureOptions())
    assert (selection.odometry, selection.contacts, selection.robot.feet) == ((), (), ())
    assert {"NO_BASE", "NO_FEET"} <= set(codes(selection))
