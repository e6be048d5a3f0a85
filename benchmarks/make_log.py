"""Writes the logs that the benchmarks read: a bag as a fast Gazebo simulation records it.

Four feet at 500 Hz, each message of 0 to 4 states of 1 to 4 contact points with names and `info`
of real length, and odometry at 100 Hz. One second is serialised by rosbags; the log is that second
over and over with new times.

    python benchmarks/make_log.py OUT.bag SECONDS [none|lz4|bz2]
"""

import struct
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
ODOMETRY: Final = "nav_msgs/msg/Odometry"
FEET: Final = ("front_left", "front_right", "back_left", "back_right")
START_S: Final = 1_700_000_000
_CONTACT_STATE: Final = """string info
string collision1_name
string collision2_name
geometry_msgs/Wrench[] wrenches
geometry_msgs/Wrench total_wrench
geometry_msgs/Vector3[] contact_positions
geometry_msgs/Vector3[] contact_normals
float64[] depths
"""
_STORE: Final = get_typestore(Stores.ROS1_NOETIC)
_STORE.register(get_types_from_msg(_CONTACT_STATE, "gazebo_msgs/msg/ContactState"))
_STORE.register(get_types_from_msg("Header header\nContactState[] states\n", CONTACTS))

Message = tuple[int, str, bytes]
"""Time in the second, ns; topic; payload, with its stamp at bytes 4 to 12."""


def _make(name: str, **fields: Any) -> Any:  # noqa: ANN401 - types made at run time
    return _STORE.types[name](**fields)


def _vector(values: np.ndarray) -> Any:  # noqa: ANN401
    x, y, z = (float(value) for value in values)
    return _make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def _wrench(force: np.ndarray) -> Any:  # noqa: ANN401
    return _make("geometry_msgs/msg/Wrench", force=_vector(force), torque=_vector(force * 0.01))


def _header(seq: int, frame: str) -> Any:  # noqa: ANN401
    stamp = _make("builtin_interfaces/msg/Time", sec=0, nanosec=0)
    return _make("std_msgs/msg/Header", seq=seq, stamp=stamp, frame_id=frame)


def _state(foot: str, points: int, load: float, noise: np.random.Generator) -> Any:  # noqa: ANN401
    collision = f"dogbot::{foot}_lowerleg::{foot}_lowerleg_fixed_joint_lump__{foot}_foot_collision_5"
    ground = "ground_plane::link::collision"
    forces = noise.normal(0.0, 0.05 * load, (points, 3)) + [0.0, 0.0, load / points]
    return _make(
        "gazebo_msgs/msg/ContactState",
        info=f"Debug:  i:(0/1)     my geom:{collision}   other geom:{ground}"
        f"         time:{START_S}.000000000\n",
        collision1_name=collision,
        collision2_name=ground,
        wrenches=[_wrench(force) for force in forces],
        total_wrench=_wrench(forces.sum(axis=0)),
        contact_positions=[_vector(noise.normal(size=3)) for _ in range(points)],
        contact_normals=[_vector(np.array([0.0, 0.0, 1.0])) for _ in range(points)],
        depths=np.full(points, 1e-4),
    )


def _one_second() -> list[Message]:
    noise = np.random.default_rng(1)
    second: list[Message] = []
    for number, foot in enumerate(FEET):
        for sample in range(500):
            time = sample * 2_000_000 + number * 100_000
            phase = (sample / 500 * 2 + number / 4) % 1.0
            count = int(noise.integers(1, 5)) if phase < 0.6 else 0
            states = [
                _state(foot, int(noise.integers(1, 5)), 90.0 / count, noise) for _ in range(count)
            ]
            message = _make(CONTACTS, header=_header(sample, foot), states=states)
            topic = f"/dogbot/{foot}_contactsensor_state"
            second.append((time, topic, bytes(_STORE.serialize_ros1(message, CONTACTS))))
    for sample in range(100):
        second.append((sample * 10_000_000 + 50_000, "/dogbot/odom", _odometry(sample, noise)))
    return sorted(second)


def _odometry(sample: int, noise: np.random.Generator) -> bytes:
    turn = noise.normal(0.0, 0.01, 4) + [0.0, 0.0, 0.0, 1.0]
    x, y, z, w = (float(part) for part in turn)
    point = _make("geometry_msgs/msg/Point", x=0.25 * sample / 100, y=0.0, z=0.46)
    turned = _make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)
    pose = _make("geometry_msgs/msg/Pose", position=point, orientation=turned)
    speed = _vector(noise.normal(size=3))
    twist = _make("geometry_msgs/msg/Twist", linear=speed, angular=speed)
    nothing = np.zeros(36)
    message = _make(
        ODOMETRY,
        header=_header(sample, "world"),
        child_frame_id="base_link",
        pose=_make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=nothing),
        twist=_make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=nothing),
    )
    return bytes(_STORE.serialize_ros1(message, ODOMETRY))


def messages(seconds: int) -> Iterator[Message]:
    """Yield log time (ns), topic and payload of every message."""
    second = _one_second()
    for number in range(seconds):
        for time, topic, payload in second:
            stamp = struct.pack("<II", START_S + number, time)
            yield (START_S + number) * 10**9 + time, topic, payload[:4] + stamp + payload[12:]


def write_bag(path: Path, seconds: int, compression: str) -> None:
    """Write a ROS 1 bag."""
    writer = Writer(path)
    if compression != "none":
        writer.set_compression(Writer.CompressionFormat[compression.upper()])
    with writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=_STORE)
            for topic, kind in (
                ("/dogbot/odom", ODOMETRY),
                *((f"/dogbot/{foot}_contactsensor_state", CONTACTS) for foot in FEET),
            )
        }
        for time, topic, payload in messages(seconds):
            writer.write(connections[topic], time, payload)


if __name__ == "__main__":
    write_bag(Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3] if len(sys.argv) > 3 else "lz4")
