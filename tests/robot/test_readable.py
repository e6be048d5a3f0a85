"""What is said of topics that cannot be decoded, and which definitions stand in for the log's."""

from collections.abc import Iterable
from contextlib import closing
from pathlib import Path

import pytest

from dogbot_logtool.errors import LogError
from dogbot_logtool.finding import Severity
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.selection import Selection, select_topics
from dogbot_logtool.robot.topics import nothing_to_do
from tests.oracles.mcap_channels import SentChannel, write_channels

ODOMETRY, CONTACTS, TF = "nav_msgs/Odometry", "gazebo_msgs/ContactsState", "tf2_msgs/TFMessage"


def selected(
    folder: Path, channels: Iterable[SentChannel], options: MeasureOptions | None = None
) -> tuple[Selection, str]:
    """Return what is used of a log that has channels and no messages, and what is said of it."""
    with closing(open_log(write_channels(folder / "log.mcap", channels))) as log:
        selection = select_topics(log, options or MeasureOptions())
        return selection, nothing_to_do(log, selection.findings)


@pytest.mark.parametrize(
    ("type_name", "encoding", "said"),
    [
        (ODOMETRY, "json", "/robot_009 and 290 more: messages encoded as 'json' are not read"),
        ("demo.Thing", "flatbuffer", "and 290 more: messages encoded as 'flatbuffer' are not read"),
    ],
)
def test_topics_of_one_reason_are_told_together(
    tmp_path: Path, type_name: str, encoding: str, said: str
) -> None:
    topics = [f"/robot_{number:03}" for number in range(300)]
    channels = (SentChannel(topic, type_name, encoding) for topic in topics)
    selection, text = selected(tmp_path, channels)
    (finding,) = [f for f in selection.findings if "UNREADABLE" in f.code]
    assert said in finding.text
    assert text.endswith(finding.text.removesuffix("; not used"))


def test_of_many_topics_some_are_named(tmp_path: Path) -> None:
    topics = (f"/a{n:03}" for n in range(650))
    found = (SentChannel(topic, "demo/Thing", "cdr", "ros2msg", b"bool x") for topic in topics)
    _, text = selected(tmp_path, found)
    assert len(text) < 1000
    assert text.splitlines()[1] == "  /a000  demo/Thing"
    assert "and 640 more; `dogbot-logtool info" in text


@pytest.mark.parametrize(
    "options", [MeasureOptions(odom_topic="/odom"), MeasureOptions(foot={"a": "/foot"})]
)
def test_options_that_name_what_cannot_be_decoded(tmp_path: Path, options: MeasureOptions) -> None:
    found = SentChannel("/odom", ODOMETRY, "json"), SentChannel("/foot", CONTACTS, "json")
    with pytest.raises(LogError, match="cannot be read: messages encoded as 'json'"):
        selected(tmp_path, found, options)


DEFINITIONS = (
    ("ros1msg", b""),
    ("ros2msg", b"# nothing but a comment\n"),
    ("ros2msg", b"\xff\xfe]"),
    ("ros2idl", b"module x {"),
    ("", b""),
    ("jsonschema", b"{}"),
)


@pytest.mark.parametrize(("encoding", "text"), DEFINITIONS)
def test_known_types_need_no_definition(tmp_path: Path, encoding: str, text: bytes) -> None:
    topics = {"/odom": ODOMETRY, "/left": CONTACTS, "/right": CONTACTS, "/tf": TF}
    found = (SentChannel(topic, topics[topic], "cdr", encoding, text) for topic in topics)
    selection, _ = selected(tmp_path, found, MeasureOptions(robot="generic"))
    assert [channel.topic for channel in selection.odometry] == ["/odom"]
    assert [channel.topic for channel in selection.contacts] == ["/left", "/right"]
    assert [channel.topic for channel in selection.transforms] == ["/tf"]
    own = [f for f in selection.findings if f.code == "UNREADABLE"]
    assert {f.severity for f in own} == {Severity.NOTE}
    assert sum("/left, /right: " in f.text for f in own) == 1


def test_feet_of_another_encoding_are_named_beside_a_base_that_is_read(tmp_path: Path) -> None:
    topics = {"/robot/pose": "foxglove.PoseInFrame", "/feet": "my.Feet"}
    selection, _ = selected(tmp_path, (SentChannel(t, topics[t], "json") for t in topics))
    assert selection.base_name == "/robot/pose"
    (finding,) = [f for f in selection.findings if f.code == "UNREADABLE"]
    assert finding.text == "/feet: messages encoded as 'json' are not read, only ROS 1's and CDR"
