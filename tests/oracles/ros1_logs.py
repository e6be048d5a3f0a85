"""ROS 1 logs of messages made one by one, as bags and MCAP files."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from tests.oracles.recorded import (
    CONTACTS_TYPE,
    ODOMETRY,
    ODOMETRY_TYPE,
    TEXT_TYPE,
    TF_TYPE,
    S,
    contact_topic,
)


def typestore(stores: Stores) -> Typestore:
    store = get_typestore(stores)
    vectors = "geometry_msgs/Vector3[] contact_positions\ngeometry_msgs/Vector3[] contact_normals\n"
    state = (
        "string info\nstring collision1_name\nstring collision2_name\n"
        "geometry_msgs/Wrench[] wrenches\ngeometry_msgs/Wrench total_wrench\n"
        f"{vectors}float64[] depths\n"
    )
    store.register(get_types_from_msg(state, "gazebo_msgs/msg/ContactState"))
    contacts = "std_msgs/Header header\ngazebo_msgs/ContactState[] states\n"
    store.register(get_types_from_msg(contacts, CONTACTS_TYPE))
    if TF_TYPE not in store.fielddefs:
        definition = "geometry_msgs/TransformStamped[] transforms\n"
        store.register(get_types_from_msg(definition, TF_TYPE))
    return store


NOETIC = typestore(Stores.ROS1_NOETIC)
HUMBLE = typestore(Stores.ROS2_HUMBLE)


def make(name: str, *args: Any, **fields: Any) -> Any:
    return NOETIC.types[name](*args, **fields)


def vector(x: float, y: float, z: float) -> Any:
    return make("geometry_msgs/msg/Vector3", x, y, z)


def header(time: int, frame: str = "world") -> Any:
    stamp = make("builtin_interfaces/msg/Time", time // S, time % S)
    return make("std_msgs/msg/Header", 0, stamp, frame)


def odometry(time: int, position: tuple[float, float, float] = (0.0, 0.0, 0.5)) -> bytes:
    covariance = np.zeros(36)
    turn = make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    pose = make("geometry_msgs/msg/Pose", make("geometry_msgs/msg/Point", *position), turn)
    twist = make("geometry_msgs/msg/Twist", vector(0, 0, 0), vector(0, 0, 0))
    message = make(
        ODOMETRY_TYPE,
        header=header(time),
        child_frame_id="base_link",
        pose=make("geometry_msgs/msg/PoseWithCovariance", pose, covariance),
        twist=make("geometry_msgs/msg/TwistWithCovariance", twist, covariance),
    )
    return bytes(NOETIC.serialize_ros1(message, ODOMETRY_TYPE))


def contact(
    force: tuple[float, float, float],
    foot: str = "front_left",
    points: tuple[tuple[float, float, float], ...] = ((1.0, 2.0, 0.0),),
    info: str = "Debug:  i:(0/1)     my geom:a   other geom:b         time:1.000000000\n",
) -> Any:
    wrench = make("geometry_msgs/msg/Wrench", vector(*force), vector(0, 0, 0))
    return make(
        "gazebo_msgs/msg/ContactState",
        info=info,
        collision1_name=f"dogbot::{foot}_lowerleg::{foot}_foot_collision",
        collision2_name="ground_plane::link::collision",
        wrenches=[wrench] * len(points),
        total_wrench=wrench,
        contact_positions=[vector(*point) for point in points],
        contact_normals=[vector(0, 0, 1)] * len(points),
        depths=np.zeros(len(points)),
    )


def contacts(time: int, *states: Any) -> bytes:
    message = make(CONTACTS_TYPE, header=header(time), states=list(states))
    return bytes(NOETIC.serialize_ros1(message, CONTACTS_TYPE))


def transform(time: int, parent: str, child: str) -> bytes:
    turn = make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    one = make(
        "geometry_msgs/msg/TransformStamped",
        header=header(time, parent),
        child_frame_id=child,
        transform=make("geometry_msgs/msg/Transform", vector(0, 0, 0), turn),
    )
    return bytes(NOETIC.serialize_ros1(make(TF_TYPE, transforms=[one]), TF_TYPE))


def text(content: str) -> bytes:
    return bytes(NOETIC.serialize_ros1(make(TEXT_TYPE, content), TEXT_TYPE))


@dataclass(frozen=True, slots=True)
class Entry:
    topic: str
    type_name: str
    log_time: int
    data: bytes


def write_bag(
    path: Path, entries: Iterable[Entry], *, chunk_size: int = 1 << 19, compressed: bool = False
) -> Path:
    writer = BagWriter(path)
    writer.chunk_threshold = chunk_size
    if compressed:
        writer.set_compression(BagWriter.CompressionFormat.LZ4)
    with writer:
        connections: dict[str, Any] = {}
        for entry in entries:
            if entry.topic not in connections:
                connections[entry.topic] = writer.add_connection(
                    entry.topic, entry.type_name, typestore=NOETIC
                )
            writer.write(connections[entry.topic], entry.log_time, entry.data)
    return path


def write_ros1_mcap(
    path: Path,
    entries: Iterable[Entry],
    *,
    extras: bool = False,
    compression: CompressionType = CompressionType.LZ4,
    chunk_size: int = 1 << 18,
) -> Path:
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size, compression)
        writer.start(profile="ros1", library="the tests")
        if extras:
            writer.add_metadata("weather", {"sky": "grey", "wind": "none"})
        channels: dict[str, int] = {}
        for entry in entries:
            if entry.topic not in channels:
                definition, _ = NOETIC.generate_msgdef(entry.type_name)
                name = entry.type_name.replace("/msg/", "/")
                schema = writer.register_schema(name, "ros1msg", definition.encode())
                channels[entry.topic] = writer.register_channel(
                    entry.topic, "ros1", schema, {"callerid": "/tests"}
                )
            writer.add_message(
                channels[entry.topic], entry.log_time, entry.data, entry.log_time - 7, 3
            )
        if extras:
            writer.add_attachment(5, 6, "map.txt", "text/plain", b"here be dragons" * 100)
            writer.add_attachment(7, 8, "empty", "application/octet-stream", b"")
            writer.add_metadata("nothing", {})
        writer.finish()
    return path


def small_walk(seconds: float = 1.0) -> Iterator[Entry]:
    """Yield odometry at 250 Hz, and a front left foot that presses harder and harder."""
    for index in range(round(seconds * 250)):
        time = 10 * S + index * 4_000_000
        yield Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time, (index / 250, 0.0, 0.5)))
        states = [] if index % 50 < 10 else [contact((0.0, 3.0, 1.0 + index))]
        yield Entry(
            contact_topic("front_left"), CONTACTS_TYPE, time + 1000, contacts(time, *states)
        )


BOUNDS_NM = (380, 440, 490, 510, 580, 645, 750)


def odd_forces() -> Iterator[tuple[float, float, float]]:
    """Yield forces on and beside every bound of the colours, and those that are no numbers."""
    for bound in BOUNDS_NM:
        p = (bound - 380) / 370 * 2.0 * 100.0
        for force in (math.nextafter(p, 0.0), p, math.nextafter(p, math.inf)):
            yield 0.0, 0.0, force
    yield 0.0, 0.0, 200.0000001
    yield 0.0, -0.0, 0.0
    for odd in (math.nan, math.inf, -math.inf):
        yield odd, 1.0, 2.0
        yield 1.0, odd, math.nan
    yield 1e200, 1.0, 1.0
    yield 1e154, 1e154, 1e154
    yield 1e-200, 0.0, 0.0
    rng = np.random.default_rng(3)
    yield from rng.normal(0, 90, (400, 3)).tolist()


def odd_contacts() -> Iterator[Entry]:
    topic = contact_topic("front_left")
    time = 10 * S
    for force in odd_forces():
        time += 1_000_000
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, contact(force)))
    for states in ((), (contact((1.0, 2.0, 3.0), points=()),)):
        time += 1_000_000
        yield Entry(topic, CONTACTS_TYPE, time, contacts(time, *states))
