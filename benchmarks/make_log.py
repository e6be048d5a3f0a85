"""Writes the logs that the benchmarks read, as a fast Gazebo simulation records them.

Four feet at 500 Hz, or six at 1 kHz, each message of 0 to 4 states of 1 to 4 contact points with
names and `info` of real length, and odometry at 100 Hz. Eight seconds are serialised by rosbags;
the log repeats them with new times. They are longer than a codec looks back, in the log (a second
is) and in what is made of each foot, so the repetition makes nothing compress better.

Forces, torques, depths and heights are noise to the last bit, as a physics engine's are; normals
are upright and a standing foot's points stay where they are. It compresses by 3.8 (lz4) and 4.3
(zstd): less than recorded walks, which reach 4.5 and 6, so the codecs' share is not flattered.

    python benchmarks/make_log.py OUT SECONDS [none|lz4|bz2|ros1|cdr] [dogbot|hexapod]
"""

import struct
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import lz4.frame
import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
ODOMETRY: Final = "nav_msgs/msg/Odometry"
START_S: Final = 1_700_000_000
_FIRST_STEP: Final = b"time:%d." % START_S
_BAG_CHUNK_SIZE: Final = 768 << 10
_CONTACT_STATE: Final = """string info
string collision1_name
string collision2_name
geometry_msgs/Wrench[] wrenches
geometry_msgs/Wrench total_wrench
geometry_msgs/Vector3[] contact_positions
geometry_msgs/Vector3[] contact_normals
float64[] depths
"""
_CORNERS: Final = (
    (0.1309, 0.4107, -3.1e-5),
    (0.1309, 0.4411, -2.7e-5),
    (0.1613, 0.4107, -3.4e-5),
    (0.1613, 0.4411, -1.9e-5),
)
"""m, where a foot's contact points stay."""
_DIFFERENT_SECONDS: Final = 8
_STATES: Final = (0.55, 0.2, 0.15, 0.1)
"""Shares of messages with 1 to 4 states."""
_POINTS: Final = (0.4, 0.3, 0.15, 0.15)
"""Shares of states with 1 to 4 contact points."""
_STORE: Final = get_typestore(Stores.ROS1_NOETIC)
_ROS2_STORE: Final = get_typestore(Stores.ROS2_HUMBLE)
for _store, _header_type in ((_STORE, "Header"), (_ROS2_STORE, "std_msgs/Header")):
    _store.register(get_types_from_msg(_CONTACT_STATE, "gazebo_msgs/msg/ContactState"))
    _store.register(get_types_from_msg(f"{_header_type} header\nContactState[] states\n", CONTACTS))

Message = tuple[int, str, bytes]
"""Time in the second, ns; topic; payload, with its stamp at bytes 4 to 12."""


@dataclass(frozen=True)
class Robot:
    """What is recorded."""

    feet: tuple[str, ...]
    rate_hz: int
    """Contact messages of each foot."""

    @property
    def topics(self) -> dict[str, str]:
        """Types by topic."""
        feet = {f"/dogbot/{foot}_contactsensor_state": CONTACTS for foot in self.feet}
        return {"/dogbot/odom": ODOMETRY, **feet}


DOGBOT: Final = Robot(("front_left", "front_right", "back_left", "back_right"), 500)
ROBOTS: Final = {
    "dogbot": DOGBOT,
    "hexapod": Robot((*DOGBOT.feet, "middle_left", "middle_right"), 1000),
}


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
    collision = (
        f"dogbot::{foot}_lowerleg::{foot}_lowerleg_fixed_joint_lump__{foot}_foot_collision_5"
    )
    ground = "ground_plane::link::collision"
    forces = noise.normal((0.0, 0.0, load / points), 0.05 * load, (points, 3))
    return _make(
        "gazebo_msgs/msg/ContactState",
        info=f"Debug:  i:(0/1)     my geom:{collision}   other geom:{ground}"
        f"         time:{START_S}.000000000\n",
        collision1_name=collision,
        collision2_name=ground,
        wrenches=[_wrench(force) for force in forces],
        total_wrench=_wrench(forces.sum(axis=0)),
        contact_positions=[_vector(np.array(corner)) for corner in _CORNERS[:points]],
        contact_normals=[_vector(np.array([0.0, 0.0, 1.0])) for _ in range(points)],
        depths=noise.uniform(0.0, 1e-4, points),
    )


def _one_second(robot: Robot, noise: np.random.Generator) -> list[Message]:
    second: list[Message] = []
    for number, foot in enumerate(robot.feet):
        for sample in range(robot.rate_hz):
            time = sample * (10**9 // robot.rate_hz) + number * 100_000
            phase = (sample / robot.rate_hz * 2 + number / 4) % 1.0
            count = int(noise.choice(4, p=_STATES)) + 1 if phase < 0.6 else 0
            states = [
                _state(foot, int(noise.choice(4, p=_POINTS)) + 1, 90.0 / count, noise)
                for _ in range(count)
            ]
            message = _make(CONTACTS, header=_header(sample, foot), states=states)
            topic = f"/dogbot/{foot}_contactsensor_state"
            second.append((time, topic, bytes(_STORE.serialize_ros1(message, CONTACTS))))
    second.extend(
        (sample * 10_000_000 + 50_000, "/dogbot/odom", _odometry(sample, noise))
        for sample in range(100)
    )
    return sorted(second)


def _odometry(sample: int, noise: np.random.Generator) -> bytes:
    turn = noise.normal((0.0, 0.0, 0.0, 1.0), 0.01)
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


def _repeated(different: list[list[Message]], seconds: int) -> Iterator[Message]:
    """Yield log time (ns), topic and payload of every message."""
    for number in range(seconds):
        now = START_S + number
        step = b"time:%d." % now
        for time, topic, payload in different[number % len(different)]:
            stamped = payload[:4] + struct.pack("<II", now, time) + payload[12:]
            yield now * 10**9 + time, topic, stamped.replace(_FIRST_STEP, step)


def _messages(seconds: int, encoding: str, robot: Robot) -> Iterator[Message]:
    noise = np.random.default_rng(1)
    different = [_one_second(robot, noise) for _ in range(min(_DIFFERENT_SECONDS, seconds))]
    if encoding == "cdr":
        # Without Header.seq, and with the encapsulation's four bytes, stamps stay where they are.
        different = [
            [
                (time, topic, bytes(_ROS2_STORE.ros1_to_cdr(payload, robot.topics[topic])))
                for time, topic, payload in second
            ]
            for second in different
        ]
    return _repeated(different, seconds)


def write_bag(path: Path, seconds: int, compression: str, robot: Robot = DOGBOT) -> None:
    """Write a ROS 1 bag with chunks as `rosbag record` makes them."""
    path.unlink(missing_ok=True)
    writer = BagWriter(path)
    if compression != "none":
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    if compression == "lz4":
        writer.compressor = _compress_as_rosbag
    writer.chunk_threshold = _BAG_CHUNK_SIZE
    with writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=_STORE)
            for topic, kind in robot.topics.items()
        }
        for time, topic, payload in _messages(seconds, "ros1", robot):
            writer.write(connections[topic], time, payload)


def _compress_as_rosbag(chunk: bytes) -> bytes:
    """Return one independent block with a checksum; rosbags' own frames have many small ones."""
    compressed: bytes = lz4.frame.compress(
        chunk,
        block_size=lz4.frame.BLOCKSIZE_MAX1MB,
        block_linked=False,
        content_checksum=True,
        store_size=False,
    )
    return compressed


def write_mcap(path: Path, seconds: int, encoding: str, robot: Robot = DOGBOT) -> None:
    """Write an MCAP with zstd chunks of the library's own size; ``ros1`` or ``cdr`` messages."""
    version: Literal[1, 2] = 1 if encoding == "ros1" else 2
    store = _STORE if version == 1 else _ROS2_STORE
    with path.open("wb") as file:
        writer = McapWriter(file, compression=CompressionType.ZSTD)
        writer.start(profile=f"ros{version}", library="make_log")
        channels: dict[str, int] = {}
        for topic, kind in robot.topics.items():
            definition, _ = store.generate_msgdef(kind, ros_version=version)
            name = kind if version == 2 else kind.replace("/msg/", "/")
            schema = writer.register_schema(name, f"ros{version}msg", definition.encode())
            channels[topic] = writer.register_channel(topic, encoding, schema)
        for time, topic, payload in _messages(seconds, encoding, robot):
            writer.add_message(channels[topic], time, payload, time)
        writer.finish()


if __name__ == "__main__":
    target, kind = Path(sys.argv[1]), sys.argv[3] if len(sys.argv) > 3 else "lz4"
    walker = ROBOTS[sys.argv[4] if len(sys.argv) > 4 else "dogbot"]
    if kind in {"ros1", "cdr"}:
        write_mcap(target, int(sys.argv[2]), kind, walker)
    else:
        write_bag(target, int(sys.argv[2]), kind, walker)
