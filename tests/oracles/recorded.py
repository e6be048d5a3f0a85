"""Messages of logs as the containers' own libraries and rosbags read them, to be written anew."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.rosbag1 import Reader as BagReader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.oracles.walks import Entry, Walk

FEET = ("front_left", "front_right", "back_left", "back_right")
ODOMETRY = "/dogbot/odom"
BODY_WEIGHT_N = 21.261 * 9.81
S = 1_000_000_000
ODOMETRY_TYPE = "nav_msgs/msg/Odometry"
CONTACTS_TYPE = "gazebo_msgs/msg/ContactsState"
TF_TYPE = "tf2_msgs/msg/TFMessage"
TEXT_TYPE = "std_msgs/msg/String"
DESCRIPTION = "/robot_description"


def contact_topic(foot: str) -> str:
    return f"/dogbot/{foot}_contactsensor_state"


def arrow_topic(foot: str) -> str:
    return f"/marker_basic_{foot}_foot"


def load_topic(foot: str) -> str:
    return f"/load/{foot}"


@dataclass(frozen=True, slots=True)
class Recorded:
    """A message as its container's own library reads it."""

    topic: str
    type_name: str
    definition: str
    log_time: int
    publish_time: int
    sequence: int
    data: bytes


def read_bag(path: Path) -> list[Recorded]:
    with BagReader(path) as reader:
        return [
            Recorded(c.topic, c.msgtype, c.msgdef.data, log_time, log_time, 0, data)
            for c, log_time, data in reader.messages()
        ]


def read_mcap(path: Path) -> list[Recorded]:
    with path.open("rb") as stream:
        return [
            Recorded(
                channel.topic,
                schema.name if schema else "",
                schema.data.decode("utf-8", "replace") if schema else "",
                message.log_time,
                message.publish_time,
                message.sequence,
                message.data,
            )
            for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages()
        ]


@cache
def read_log(path: Path) -> list[Recorded]:
    """Return a log's messages in the order of their log times."""
    return read_bag(path) if path.suffix == ".bag" else read_mcap(path)


@dataclass(frozen=True, slots=True)
class Decoded:
    log_time: int
    message: Any


@cache
def decoded_log(path: Path) -> dict[str, list[Decoded]]:
    """Decode a log's messages by topic; those of ROS 1 in the order in which they were sent."""
    topics: dict[str, list[Decoded]] = defaultdict(list)
    with AnyReader([path]) as log:
        for of, log_time, data in log.messages():
            topics[of.topic].append(Decoded(log_time, log.deserialize(data, of.msgtype)))
    if path.suffix == ".bag":
        for topic in topics.keys() & {ODOMETRY, *map(contact_topic, FEET)}:
            topics[topic].sort(key=lambda one: one.message.header.seq)
    return dict(topics)


BLOCK: Final = 97
"""Messages that change places with as many others where a file is out of order."""


@cache
def unpacked(bag: Path, ros: int) -> tuple[Walk, list[Entry]]:
    """Return the messages as those of a version of ROS, and what has their types."""
    walk, entries = Walk(ros), []
    walk.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    known: set[str] = set()
    for each in read_log(bag):
        if each.type_name not in known:
            known.add(each.type_name)
            types = get_types_from_msg(each.definition, each.type_name)
            walk.store.register({k: v for k, v in types.items() if k not in walk.store.fielddefs})
        data = each.data if ros == 1 else walk.store.ros1_to_cdr(each.data, each.type_name)
        entries.append(Entry(each.topic, each.type_name, each.log_time, bytes(data)))
    return walk, entries


def out_of_order(entries: Sequence[Entry]) -> list[Entry]:
    """Return the same messages as a recorder of several threads may write them."""
    blocks = [entries[first : first + BLOCK] for first in range(0, len(entries), BLOCK)]
    for first in range(0, len(blocks) - 1, 2):
        blocks[first : first + 2] = blocks[first + 1], blocks[first]
    return [entry for block in blocks for entry in block]
