"""The sample logs, decoded message by message.

They are read with the containers' own libraries and the definitions that are recorded in them;
nothing of the generator or of the product takes part.
"""

import json
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from tests.paths import SAMPLE_LOGS

Array = npt.NDArray[np.float64]

TROT, WALK, TROUBLED = "dogbot_trot.bag", "dogbot_walk.mcap", "dogbot_troubled.bag"
LOGS = (TROT, WALK, TROUBLED)
FEET = ("front_left", "front_right", "back_left", "back_right")
ODOMETRY = "/dogbot/odom"


@dataclass(frozen=True, slots=True)
class Log:
    """Decoded messages with their log times, by topic."""

    truth: dict[str, Any]
    topics: dict[str, list[tuple[int, Any]]]

    def messages(self, topic: str) -> list[Any]:
        return [message for _, message in self.topics[topic]]

    def contacts(self, foot: str) -> list[Any]:
        return self.messages(contact_topic(foot))

    def log_times_ns(self, topic: str) -> list[int]:
        return [log_time_ns for log_time_ns, _ in self.topics[topic]]


def contact_topic(foot: str) -> str:
    return f"/dogbot/{foot}_contactsensor_state"


@cache
def read_log(name: str) -> Log:
    """Decode a committed log with the definitions that it holds."""
    path = SAMPLE_LOGS / name
    topics: dict[str, list[tuple[int, Any]]] = defaultdict(list)
    if path.suffix == ".bag":
        with AnyReader([path]) as bag:
            for connection, log_time_ns, data in bag.messages():
                message = bag.deserialize(data, connection.msgtype)
                topics[connection.topic].append((log_time_ns, message))
    else:
        with path.open("rb") as stream:
            reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
            for _, channel, raw, message in reader.iter_decoded_messages():
                topics[channel.topic].append((raw.log_time, message))
    truth = json.loads((SAMPLE_LOGS / f"{path.stem}.truth.json").read_text(encoding="utf-8"))
    return Log(truth, dict(topics))


def has_stamp(message: Any) -> bool:
    """Tell whether a message has a time: all but `geometry_msgs/Twist` do."""
    return hasattr(message, "header") or hasattr(message, "transforms")


def by_number(log: Log, topic: str) -> list[tuple[int, Any]]:
    """Put a ROS 1 topic into the order in which it was sent, whatever its log times say."""
    return sorted(log.topics[topic], key=lambda entry: entry[1].header.seq)


def stamp_ns(header: Any) -> int:
    return int(header.stamp.sec) * 10**9 + int(header.stamp.nanosec)


def vector(message: Any) -> Array:
    return np.array([message.x, message.y, message.z])


def rotation_matrix(quaternion: Any) -> Array:
    """Matrix from the child's into the parent's frame."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def pose_matrix(rotation: Any, translation: Any) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3] = rotation_matrix(rotation)
    matrix[:3, 3] = vector(translation)
    return matrix


def poses_in_world(log: Log) -> Iterator[tuple[int, dict[str, Array]]]:
    """Every /tf message's time, with the poses of all links, chained up to odometry's world."""
    base = {stamp_ns(odometry.header): odometry.pose.pose for odometry in log.messages(ODOMETRY)}
    fixed = [link for message in log.topics.get("/tf_static", []) for link in message[1].transforms]
    for message in log.messages("/tf"):
        time_ns = stamp_ns(message.transforms[0].header)
        body = pose_matrix(base[time_ns].orientation, base[time_ns].position)
        poses = {"base_link": body}
        for link in [*message.transforms, *fixed]:
            local = pose_matrix(link.transform.rotation, link.transform.translation)
            poses[link.child_frame_id] = poses[link.header.frame_id] @ local
        yield time_ns, poses


def step_time_ns(state: Any) -> int:
    """Physics time of a state: ROS 1 pads the nanoseconds, ROS 2 does not."""
    match = re.search(r"time:(?: \[)?(\d+)\.(\d+)", state.info)
    assert match is not None
    return int(match[1]) * 10**9 + int(match[2])


def newest_step(message: Any) -> list[Any]:
    if not message.states:
        return []
    newest_ns = step_time_ns(message.states[-1])
    return [state for state in message.states if step_time_ns(state) == newest_ns]


def force_on_foot(state: Any) -> Array:
    """Force of a state's pair on the foot, in the recorded frame."""
    sign = -1 if state.collision1_name.startswith("ground_plane") else 1
    return sign * vector(state.total_wrench.force)


def states_by_step(log: Log, foot: str) -> dict[int, Any]:
    return {
        step_time_ns(state): state for message in log.contacts(foot) for state in message.states
    }


def world_forces(log: Log) -> Iterator[tuple[int, dict[str, Array]]]:
    """Forces on the feet in contact in world, at the times of /tf."""
    in_link = log.truth["forces"]["wrench_frame"] == "link"
    states = {foot: states_by_step(log, foot) for foot in FEET}
    for time_ns, poses in poses_in_world(log):
        yield (
            time_ns,
            {
                foot: (poses[f"{foot}_lowerleg"][:3, :3] if in_link else np.eye(3))
                @ force_on_foot(states[foot][time_ns])
                for foot in FEET
                if time_ns in states[foot]
            },
        )


def seconds(log: Log, time_ns: int) -> float:
    """Time on the axis of the truth."""
    return time_ns / 1e9 - float(log.truth["log"]["start_stamp_s"])
