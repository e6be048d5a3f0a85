"""One synthetic walk, told in every type of contact message, for every container."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from rosbags.interfaces import Msgdef
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.rosbag2.enums import StoragePlugin
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from tests.oracles.mcap_file import write_mcap as write_entries

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
DEFINITIONS: Final = {
    "gazebo_msgs/msg/ContactState": "string info\nstring collision1_name\nstring collision2_name\n"
    "geometry_msgs/Wrench[] wrenches\ngeometry_msgs/Wrench total_wrench\n"
    "geometry_msgs/Vector3[] contact_positions\ngeometry_msgs/Vector3[] contact_normals\n"
    "float64[] depths",
    "gazebo_msgs/msg/ContactsState": "std_msgs/Header header\ngazebo_msgs/ContactState[] states",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "ros_gz_interfaces/msg/Entity": "uint8 LINK=3\nuint64 id\nstring name\nuint8 type",
    "ros_gz_interfaces/msg/JointWrench": "std_msgs/Header header\nstd_msgs/String body_1_name\n"
    "std_msgs/UInt32 body_1_id\nstd_msgs/String body_2_name\nstd_msgs/UInt32 body_2_id\n"
    "geometry_msgs/Wrench body_1_wrench\ngeometry_msgs/Wrench body_2_wrench",
    "ros_gz_interfaces/msg/Contact": "ros_gz_interfaces/Entity collision1\n"
    "ros_gz_interfaces/Entity collision2\ngeometry_msgs/Vector3[] positions\n"
    "geometry_msgs/Vector3[] normals\nfloat64[] depths\nros_gz_interfaces/JointWrench[] wrenches",
    "ros_gz_interfaces/msg/Contacts": "std_msgs/Header header\n"
    "ros_gz_interfaces/Contact[] contacts",
    "unitree_legged_msgs/msg/LowState": "uint8[2] head\nuint32[2] SN\nfloat32[4] quaternion\n"
    "int16[4] footForce\nint16[4] footForceEst\nuint32 tick\nuint8[40] wirelessRemote\nuint32 crc",
    "unitree_go/msg/LowState": "uint8[2] head\nuint8 level_flag\nuint16 bandwidth\n"
    "int16[4] foot_force\nint16[4] foot_force_est\nuint32 tick\nuint8[40] wireless_remote",
    "unitree_legged_msgs/msg/HighState": "uint8[2] head\nuint8 mode\nint16[4] footForce\n"
    "int16[4] footForceEst\nfloat32[3] position",
    "unitree_go/msg/TimeSpec": "int32 sec\nuint32 nanosec",
    "unitree_go/msg/SportModeState": "unitree_go/TimeSpec stamp\nuint32 error_code\n"
    "int16[4] foot_force\nfloat32[12] foot_position_body",
    "spot_msgs/msg/FootState": "geometry_msgs/Point foot_position_rt_body\nuint8 contact",
    "spot_msgs/msg/FootStateArray": "spot_msgs/FootState[] states",
    "champ_msgs/msg/ContactsStamped": "std_msgs/Header header\nbool[] contacts",
}
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
CONTAINERS: Final = ("bag", "mcap", "rosbag2-sqlite3", "rosbag2-mcap")
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
    known = {} if ros == 1 else {"tf2_msgs/msg/TFMessage"}
    for name, text in DEFINITIONS.items():
        if name not in known:
            store.register(get_types_from_msg(text, name))
    return store


class SharedStore(Typestore):
    """A store of one's own, with the types of another one as it has compiled them."""

    def __init__(self, known: Typestore) -> None:
        super().__init__()
        self._known = known
        self.fielddefs, self.types = dict(known.fielddefs), dict(known.types)

    def get_msgdef(self, typename: str) -> Msgdef[object]:
        """Compile a type only where it differs from the other store's."""
        if self.types[typename] is self._known.types.get(typename):
            return self._known.get_msgdef(typename)
        return super().get_msgdef(typename)


@dataclass(frozen=True)
class Entry:
    topic: str
    kind: str
    log_time: int
    data: bytes


class Walk:
    """Messages of one version of ROS."""

    def __init__(self, ros: int) -> None:
        self.ros = ros
        self.store: Typestore = SharedStore(_known(ros))

    def make(self, kind: str, **fields: Any) -> Any:
        package, _, name = kind.partition("/")
        name = name if "/msg/" in kind else f"msg/{name}"
        return self.store.types[f"{package}/{name}"](**fields)

    def bytes_of(self, kind: str, message: Any) -> bytes:
        if self.ros == 1:
            return bytes(self.store.serialize_ros1(message, kind))
        return bytes(self.store.serialize_cdr(message, kind))

    def header(self, sample: int, frame: str) -> Any:
        seconds, nanoseconds = divmod(START + sample * STEP, 1_000_000_000)
        stamp = self.make("builtin_interfaces/Time", sec=seconds, nanosec=nanoseconds)
        sequence = {"seq": 0} if self.ros == 1 else {}
        return self.make("std_msgs/Header", stamp=stamp, frame_id=frame, **sequence)

    def vector(self, values: Any, kind: str = "geometry_msgs/Vector3") -> Any:
        return self.make(kind, **dict(zip("xyz", map(float, values), strict=True)))

    def wrench(self, values: Any) -> Any:
        return self.make(
            "geometry_msgs/Wrench", force=self.vector(values), torque=self.vector((0, 0, 0))
        )

    def odometry(self, sample: int) -> bytes:
        pose = self.make(
            "geometry_msgs/Pose",
            position=self.vector((0.003 * sample, 0.0, 0.4), "geometry_msgs/Point"),
            orientation=self.make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
        )
        zero = self.vector((0.0, 0.0, 0.0))
        twist = self.make("geometry_msgs/Twist", linear=zero, angular=zero)
        none = np.zeros(36)
        message = self.make(
            "nav_msgs/Odometry",
            header=self.header(sample, "odom"),
            child_frame_id="base",
            pose=self.make("geometry_msgs/PoseWithCovariance", pose=pose, covariance=none),
            twist=self.make("geometry_msgs/TwistWithCovariance", twist=twist, covariance=none),
        )
        return self.bytes_of("nav_msgs/msg/Odometry", message)

    def messages(self, kind: str) -> Iterator[Entry]:
        for sample in range(SAMPLES):
            time = START + sample * STEP
            yield Entry("/odom", "nav_msgs/msg/Odometry", time, self.odometry(sample))
            for topic, message in self.contacts(kind, sample):
                yield Entry(topic, kind, time, self.bytes_of(kind, message))

    def contacts(  # noqa: C901
        self, kind: str, sample: int
    ) -> Iterator[tuple[str, Any]]:
        forces = {leg: FORCES[leg][sample] for leg in LEGS}
        down = {leg: bool(TOUCHES[leg][sample]) for leg in LEGS}
        match kind.split("/", maxsplit=1)[0]:
            case "gazebo_msgs":
                for leg in LEGS:
                    states = [self.classic_state(leg, forces[leg])] if down[leg] else []
                    header = self.header(sample, "world")
                    yield foot_topic(kind, leg), self.make(kind, header=header, states=states)
            case "ros_gz_interfaces":
                for leg in LEGS:
                    if down[leg]:
                        pairs = [self.gazebo_pair(sample, leg, forces[leg])]
                        header = self.header(sample, "world")
                        yield foot_topic(kind, leg), self.make(kind, header=header, contacts=pairs)
            case "geometry_msgs":
                for leg in LEGS:
                    noise = forces[leg] + (0.5, -0.25, 0.0) if not down[leg] else forces[leg]
                    header = self.header(sample, f"{leg}_sensor")
                    message = self.make(kind, header=header, wrench=self.wrench(noise))
                    yield foot_topic(kind, leg), message
            case "unitree_legged_msgs":
                high = kind.endswith("HighState")
                yield "/feet", (self.high if high else self.legged)(sample, forces)
            case "unitree_go":
                sport = kind.endswith("SportModeState")
                yield "/feet", (self.sport if sport else self.go)(sample, forces)
            case "spot_msgs":
                zero = self.vector((0, 0, 0), "geometry_msgs/Point")
                states = [
                    self.make(
                        "spot_msgs/FootState",
                        foot_position_rt_body=zero,
                        contact=1 if down[leg] else 2,
                    )
                    for leg in LEGS
                ]
                yield "/feet", self.make(kind, states=states)
            case _:
                flags = np.array([down[leg] for leg in LEGS], np.bool_)
                yield "/feet", self.make(kind, header=self.header(sample, ""), contacts=flags)

    def classic_state(self, leg: str, newtons: Any) -> Any:
        return self.make(
            "gazebo_msgs/ContactState",
            info="",
            collision1_name=f"robot::{leg}_leg::{leg}_foot",
            collision2_name="ground_plane::link::collision",
            wrenches=[self.wrench(newtons)],
            total_wrench=self.wrench(newtons),
            contact_positions=[self.vector((1.0, 0.0, 0.0))],
            contact_normals=[self.vector((0.0, 0.0, 1.0))],
            depths=np.zeros(1),
        )

    def gazebo_pair(self, sample: int, leg: str, newtons: Any) -> Any:
        """Make a pair; on one side of the robot the foot is body 2, so that the sign matters."""
        foot, ground = f"robot::{leg}_leg::{leg}_foot", "ground_plane::link::collision"
        turned = "left" in leg
        sign = -1.0 if turned else 1.0
        names = (ground, foot) if turned else (foot, ground)
        entities = [self.make("ros_gz_interfaces/Entity", id=0, name=n, type=4) for n in names]
        number, text = (
            self.make("std_msgs/UInt32", data=0),
            self.make("std_msgs/String", data=""),
        )
        joint = self.make(
            "ros_gz_interfaces/JointWrench",
            header=self.header(sample, ""),
            body_1_name=text,
            body_1_id=number,
            body_2_name=text,
            body_2_id=number,
            body_1_wrench=self.wrench(sign * newtons),
            body_2_wrench=self.wrench(-sign * newtons),
        )
        return self.make(
            "ros_gz_interfaces/Contact",
            collision1=entities[0],
            collision2=entities[1],
            positions=[self.vector((1.0, 0.0, 0.0))],
            normals=[self.vector((0.0, 0.0, sign))],
            depths=np.zeros(1),
            wrenches=[joint],
        )

    def counts(self, forces: Mapping[str, Any]) -> Any:
        """FR, FL, RR, RL."""
        order = ("front_right", "front_left", "back_right", "back_left")
        return np.array(
            [round(forces[g][2] / NEWTONS_PER_COUNT) + COUNTS_OFFSET[g] for g in order], np.int16
        )

    def legged(self, sample: int, forces: Mapping[str, Any]) -> Any:
        return self.make(
            "unitree_legged_msgs/LowState",
            head=np.zeros(2, np.uint8),
            SN=np.zeros(2, np.uint32),
            quaternion=np.zeros(4, np.float32),
            footForce=self.counts(forces),
            footForceEst=np.zeros(4, np.int16),
            tick=sample,
            wirelessRemote=np.zeros(40, np.uint8),
            crc=0,
        )

    def go(self, sample: int, forces: Mapping[str, Any]) -> Any:
        return self.make(
            "unitree_go/LowState",
            head=np.zeros(2, np.uint8),
            level_flag=0,
            bandwidth=0,
            foot_force=self.counts(forces),
            foot_force_est=np.zeros(4, np.int16),
            tick=sample,
            wireless_remote=np.zeros(40, np.uint8),
        )

    def high(self, sample: int, forces: Mapping[str, Any]) -> Any:
        return self.make(
            "unitree_legged_msgs/HighState",
            head=np.zeros(2, np.uint8),
            mode=sample % 7,
            footForce=self.counts(forces),
            footForceEst=np.zeros(4, np.int16),
            position=np.zeros(3, np.float32),
        )

    def sport(self, sample: int, forces: Mapping[str, Any]) -> Any:
        # A clock of its own, that is none of the log's.
        return self.make(
            "unitree_go/SportModeState",
            stamp=self.make("unitree_go/TimeSpec", sec=sample, nanosec=5),
            error_code=100,
            foot_force=self.counts(forces),
            foot_position_body=np.zeros(12, np.float32),
        )

    def definition(self, kind: str) -> str:
        text, _ = self.store.generate_msgdef(kind, ros_version=self.ros)
        return text


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
            _write_bag(path, walk, entries)
        case "mcap":
            write_mcap(path, walk, entries)
        case _:
            plugin = StoragePlugin.MCAP if container.endswith("mcap") else StoragePlugin.SQLITE3
            _write_rosbag2(path, walk, entries, plugin)
    return path


def _write_bag(path: Path, walk: Walk, entries: list[Entry]) -> None:
    with BagWriter(path) as writer:
        topics = {
            topic: writer.add_connection(topic, kind, typestore=walk.store)
            for topic, kind in {e.topic: e.kind for e in entries}.items()
        }
        for entry in entries:
            writer.write(topics[entry.topic], entry.log_time, entry.data)


def write_mcap(path: Path, walk: Walk, entries: list[Entry], chunk_size: int = 1 << 20) -> None:
    """Write messages into an MCAP file."""
    rows = [(entry.log_time, entry.topic, entry.kind, entry.data) for entry in entries]
    write_entries(path, rows, walk.definition, chunk_size, "zstd")


def _write_rosbag2(path: Path, walk: Walk, entries: list[Entry], plugin: StoragePlugin) -> None:
    with Rosbag2Writer(path, version=9, storage_plugin=plugin) as writer:
        topics = {
            topic: writer.add_connection(topic, kind, typestore=walk.store)
            for topic, kind in {e.topic: e.kind for e in entries}.items()
        }
        for entry in entries:
            writer.write(topics[entry.topic], entry.log_time, entry.data)


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
