"""One synthetic walk, told in every type of contact message, for every container."""

import copy
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.interfaces import Nodetype
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.rosbag2.enums import StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from tests.oracles.definitions import DEFINITIONS


class Entry(NamedTuple):
    """A message of a log."""

    topic: str
    kind: str
    log_time: int
    """ns"""
    data: bytes


LEGS: Final = ("front_left", "front_right", "back_left", "back_right")
START: Final = 1_700_000_000_000_000_000
STEP: Final = 10_000_000
SAMPLES: Final = 600
PERIOD: Final = 80
"""Samples a stride; the stance takes the first of them."""
STRIDES: Final = 7
STANCE: Final = 48
PHASES: Final = {"front_left": 10, "back_right": 10, "front_right": 50, "back_left": 50}
COUNTS_OFFSET: Final = {"front_left": 20, "front_right": -7, "back_left": 3, "back_right": 0}
NEWTONS_PER_COUNT: Final = 0.5
KINDS: Final = (
    "gazebo_msgs/msg/ContactsState",
    "ros_gz_interfaces/msg/Contacts",
    "geometry_msgs/msg/WrenchStamped",
    "unitree_legged_msgs/msg/LowState",
    "unitree_go/msg/LowState",
    "unitree_legged_msgs/msg/HighState",
    "unitree_go/msg/SportModeState",
    "spot_msgs/msg/FootStateArray",
    "champ_msgs/msg/ContactsStamped",
)
MASS_KG: Final = 20.0


def touches(leg: str) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Tell at which samples a leg is in contact; all swing at the start and at the end."""
    phase = np.arange(SAMPLES) - PHASES[leg]
    return (phase >= 0) & (phase % PERIOD < STANCE) & (phase < STRIDES * PERIOD)


def force(leg: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    """(n, 3) N in the world: whole newtons that every kind of sensor can tell."""
    phase = (np.arange(SAMPLES) - PHASES[leg]) % PERIOD
    vertical = np.round(40.0 + 80.0 * np.sin(np.pi * (phase + 0.5) / STANCE))
    along = np.zeros(SAMPLES)
    return np.where(touches(leg)[:, None], np.stack([along, along, vertical], axis=1), 0.0)


def foot_topic(kind: str, leg: str) -> str:
    """Return the topic that tells of a leg."""
    return "/feet" if kind in KINDS[3:] else f"/{leg}/contact"


@cache
def _known(ros: int) -> Typestore:
    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    # A duration has the parts of a time.
    theirs, ours = "builtin_interfaces/Duration", "builtin_interfaces/Time"
    known: dict[str, Any] = {}
    for name, text in DEFINITIONS.items():
        known |= get_types_from_msg(text.replace(theirs, ours), name)
    store.register({name: known[name] for name in known.keys() - store.fielddefs.keys()})
    return store


class Walk:
    """Messages of one version of ROS."""

    def __init__(self, ros: int) -> None:
        self.ros = ros
        # Types can be added to a store of its own.
        known = _known(ros)
        self.store = copy.copy(known)
        self.store.fielddefs, self.store.types = dict(known.fielddefs), dict(known.types)
        self.store.cache = {}

    def make(self, kind: str, **fields: Any) -> Any:
        """Make a message of some fields; the others are zero.

        Messages below it may be mappings of fields, or their first fields in order.
        """
        kind = kind if "/msg/" in kind else kind.replace("/", "/msg/", 1)
        known = self.store.fielddefs[kind][1]
        values = {name: self._value(node, fields.get(name)) for name, node in known}
        return self.store.types[kind](**values)

    def _value(self, node: Any, value: Any) -> Any:
        what, detail = node
        if what is Nodetype.BASE:
            return ("" if detail[0] == "string" else 0) if value is None else value
        if what is not Nodetype.NAME:
            of, size = detail
            if of[0] is Nodetype.BASE and of[1][0] != "string":
                return np.array(np.zeros(size) if value is None else value, of[1][0])
            return [self._value(of, each) for each in value or [None] * size]
        if detail == "geometry_msgs/msg/Quaternion" and value is None:
            value = 0.0, 0.0, 0.0, 1.0
        if value is not None and not isinstance(value, Mapping | Sequence | np.ndarray):
            return value  # a message already
        if value is not None and not isinstance(value, Mapping):
            names = (name for name, _ in self.store.fielddefs[detail][1])
            value = dict(zip(names, value, strict=False))
        return self.make(detail, **(value or {}))

    def bytes_of(self, kind: str, message: Any) -> bytes:
        if self.ros == 1:
            return bytes(self.store.serialize_ros1(message, kind))
        return bytes(self.store.serialize_cdr(message, kind))

    def header(self, sample: int, frame: str) -> Any:
        stamp = divmod(START + sample * STEP, 1_000_000_000)
        return self.make("std_msgs/Header", stamp=stamp, frame_id=frame)

    def odometry(self, sample: int) -> bytes:
        message = self.make(
            "nav_msgs/Odometry",
            header=self.header(sample, "odom"),
            child_frame_id="base",
            pose={"pose": {"position": (0.003 * sample, 0.0, 0.4)}},
        )
        return self.bytes_of("nav_msgs/msg/Odometry", message)

    def wrench(self, newtons: Any) -> Any:
        """Return the fields of a wrench."""
        return [newtons]

    def messages(self, kind: str) -> Iterator[Entry]:
        for sample in range(SAMPLES):
            time = START + sample * STEP
            yield Entry("/odom", "nav_msgs/msg/Odometry", time, self.odometry(sample))
            for topic, message in self.contacts(kind, sample):
                yield Entry(topic, kind, time, self.bytes_of(kind, message))

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        """Yield topic and message of a sample: one a foot, or one of all feet."""
        forces = {leg: FORCES[leg][sample] for leg in LEGS}
        down = [bool(TOUCHES[leg][sample]) for leg in LEGS]
        if kind not in KINDS[:3]:
            yield "/feet", self.make(kind, **self._of_all_feet(kind, sample, forces, down))
            return
        for leg, touching in zip(LEGS, down, strict=True):
            header, newtons = self.header(sample, "world"), forces[leg]
            if kind.startswith("geometry_msgs"):
                header = self.header(sample, f"{leg}_sensor")
                noise = (0.0, 0.0, 0.0) if touching else (0.5, -0.25, 0.0)
                fields: dict[str, Any] = {"wrench": self.wrench(newtons + noise)}
            elif kind.startswith("gazebo_msgs"):
                fields = {"states": [self.classic_state(leg, newtons)] if touching else []}
            elif touching:
                fields = {"contacts": [_gazebo_pair(header, leg, newtons)]}
            else:
                continue
            yield foot_topic(kind, leg), self.make(kind, header=header, **fields)

    def _of_all_feet(
        self, kind: str, sample: int, forces: Mapping[str, Any], down: Sequence[bool]
    ) -> dict[str, Any]:
        counts = self.counts(forces)
        match kind:
            case "unitree_legged_msgs/msg/HighState":
                return {"mode": sample % 7, "footForce": counts}
            case "unitree_legged_msgs/msg/LowState":
                return {"footForce": counts, "tick": sample}
            case "unitree_go/msg/SportModeState":
                # A clock of its own, that is none of the log's.
                return {"stamp": (sample, 5), "error_code": 100, "foot_force": counts}
            case "unitree_go/msg/LowState":
                return {"foot_force": counts, "tick": sample}
            case "spot_msgs/msg/FootStateArray":
                return {"states": [{"contact": 1 if each else 2} for each in down]}
        return {"header": self.header(sample, ""), "contacts": down}

    def classic_state(self, leg: str, newtons: Any) -> Any:
        return self.make(
            "gazebo_msgs/msg/ContactState",
            collision1_name=f"robot::{leg}_leg::{leg}_foot",
            collision2_name="ground_plane::link::collision",
            wrenches=[self.wrench(newtons)],
            total_wrench=self.wrench(newtons),
            contact_positions=[(1.0, 0.0, 0.0)],
            contact_normals=[(0.0, 0.0, 1.0)],
            depths=[0.0],
        )

    def counts(self, forces: Mapping[str, Any]) -> Any:
        """FR, FL, RR, RL."""
        order = ("front_right", "front_left", "back_right", "back_left")
        return np.array(
            [round(forces[g][2] / NEWTONS_PER_COUNT) + COUNTS_OFFSET[g] for g in order], np.int16
        )

    def definition(self, kind: str) -> str:
        text, _ = self.store.generate_msgdef(kind, ros_version=self.ros)
        return text


def _gazebo_pair(header: Any, leg: str, newtons: Any) -> dict[str, Any]:
    """Make a pair; on one side of the robot the foot is body 2, so that the sign matters."""
    names = f"robot::{leg}_leg::{leg}_foot", "ground_plane::link::collision"
    sign = -1.0 if "left" in leg else 1.0
    one, other = ({"name": name, "type": 4} for name in names[:: int(sign)])
    wrenches = {"body_1_wrench": [sign * newtons], "body_2_wrench": [-sign * newtons]}
    return {
        "collision1": one,
        "collision2": other,
        "positions": [(1.0, 0.0, 0.0)],
        "normals": [(0.0, 0.0, sign)],
        "depths": [0.0],
        "wrenches": [{"header": {"stamp": header.stamp}, **wrenches}],
    }


TOUCHES: Final = {leg: touches(leg) for leg in LEGS}
FORCES: Final = {leg: force(leg) for leg in LEGS}


@cache
def messages(ros: int, kind: str) -> list[Entry]:
    """Return the walk in a kind of message, made once."""
    return list(Walk(ros).messages(kind))


def write_walk(folder: Path, kind: str, container: str) -> Path:
    """Write the walk; return the file or directory."""
    path = folder / f"walk.{container}"
    walk = Walk(1 if container == "bag" else 2)
    entries = messages(walk.ros, kind)
    match container:
        case "bag":
            write_bag(path, walk, entries)
        case "mcap":
            write_mcap(path, walk, entries)
        case _:
            plugin = StoragePlugin.MCAP if container.endswith("mcap") else StoragePlugin.SQLITE3
            write_rosbag2(path, walk, entries, plugin)
    return path


def write_bag(
    path: Path, walk: Walk, entries: Iterable[Entry], chunk_size: int = 0, compression: str = ""
) -> Path:
    """Write messages into a ROS 1 bag; without a size, chunks are those of its library."""
    writer = BagWriter(path)
    writer.chunk_threshold = chunk_size or writer.chunk_threshold
    if compression:
        writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    with writer:
        write_entries(writer, walk.store, entries)
    return path


def write_mcap(
    path: Path,
    walk: Walk,
    entries: Iterable[Entry],
    chunk_size: int = 1 << 20,
    compression: CompressionType = CompressionType.ZSTD,
    *,
    extras: bool = False,
) -> Path:
    """Write an MCAP file; extras: attachments and metadata, too."""
    profile, encoding = ("ros1", "ros1") if walk.ros == 1 else ("ros2", "cdr")
    with path.open("wb") as stream:
        writer = McapWriter(stream, chunk_size, compression)
        writer.start(profile=profile, library="the tests")
        if extras:
            writer.add_metadata("weather", {"sky": "grey", "wind": "none"})
        schemas: dict[str, int] = {}
        channels: dict[str, int] = {}
        for topic, kind, log_time, data in entries:
            if kind not in schemas:
                name = kind.replace("/msg/", "/") if walk.ros == 1 else kind
                definition = walk.definition(kind).encode()
                schemas[kind] = writer.register_schema(name, f"{profile}msg", definition)
            if topic not in channels:
                about = {"callerid": "/tests"}
                channels[topic] = writer.register_channel(topic, encoding, schemas[kind], about)
            writer.add_message(channels[topic], log_time, data, max(log_time - 7, 0), 3)
        if extras:
            writer.add_attachment(5, 6, "map.txt", "text/plain", b"here be dragons" * 100)
            writer.add_attachment(7, 8, "empty", "application/octet-stream", b"")
            writer.add_metadata("nothing", {})
        writer.finish()
    return path


def write_log(folder: Path, walk: Walk, entries: Iterable[Entry]) -> Path:
    """Write a bag of ROS 1, or an MCAP of ROS 2."""
    if walk.ros == 1:
        return write_bag(folder / "walk.bag", walk, entries)
    return write_mcap(folder / "walk.mcap", walk, entries)


def write_rosbag2(path: Path, walk: Walk, entries: Iterable[Entry], plugin: StoragePlugin) -> Path:
    """Write the folder of a ROS 2 bag."""
    with Rosbag2Writer(path, version=9, storage_plugin=plugin) as writer:
        write_entries(writer, walk.store, entries)
    return path


def write_entries(
    writer: BagWriter | Rosbag2Writer, types: Typestore, entries: Iterable[Entry]
) -> None:
    """Write messages with one of rosbags' writers, a connection a topic."""
    connections: dict[str, Any] = {}
    for topic, kind, log_time, data in entries:
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=types)
        writer.write(connections[topic], log_time, data)


def robot_file(folder: Path, kind: str) -> Path:
    """Write the robot's file that tells topics, scales and the mass."""
    order = ("front_right", "front_left", "back_right", "back_left")
    raw = kind.startswith("unitree")
    feet = [
        f'[feet.{leg}]\ntopic = "{foot_topic(kind, leg)}"\nplace = {json.dumps(leg.split("_"))}\n'
        + (
            f"element = {order.index(leg)}\noffset = {COUNTS_OFFSET[leg]}\n"
            f"newtons_per_count = {NEWTONS_PER_COUNT}\n"
            if raw
            else f"element = {LEGS.index(leg)}\n"
        )
        for leg in LEGS
    ]
    path = folder / "walker.toml"
    path.write_text(
        f"mass_kg = {MASS_KG}\n[arrows]\nnewtons_per_metre = 100\n" + "".join(feet),
        encoding="utf-8",
    )
    return path
