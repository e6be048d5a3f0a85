"""ROS messages of the sensors: each kind serialised once by rosbags, then filled with numbers."""

import struct
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.oracles.walks import DEFINITIONS
from tests.truth.recording import Flags, Floats, Ints

ODOMETRY: Final = "nav_msgs/msg/Odometry"
WRENCH: Final = "geometry_msgs/msg/WrenchStamped"
CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
TF: Final = "tf2_msgs/msg/TFMessage"
TWIST: Final = "geometry_msgs/msg/Twist"
TWIST_STAMPED: Final = "geometry_msgs/msg/TwistStamped"
IMU: Final = "sensor_msgs/msg/Imu"
FLAGS: Final = "champ_msgs/msg/ContactsStamped"
SPOT: Final = "spot_msgs/msg/FootStateArray"
GROUND: Final = "ground_plane::link::collision"
GZ_CONTACTS: Final = "ros_gz_interfaces/msg/Contacts"
_NEEDED: Final = (
    "gazebo_msgs/msg/ContactState",
    CONTACTS,
    TF,
    "ros_gz_interfaces/msg/Entity",
    "ros_gz_interfaces/msg/JointWrench",
    "ros_gz_interfaces/msg/Contact",
    GZ_CONTACTS,
    FLAGS,
)
FOOT_STATES: Final = "std_msgs/Header header\nspot_msgs/FootState[] states"
"""As a fork has it: with a header."""
MARK: Final = 0xE0
"""Stands for the contact of the first foot, until it is set."""
_STAMP: Final = (0x5A5A5A5A, 0x3B3B3B3B)
"""s and ns of a stamp that is to be filled."""
_FIRST: Final = 1.0e200
"""Number i that is to be filled is (i + 1) times this."""


class Template:
    """A serialised message, to be filled with a stamp and numbers."""

    def __init__(self, data: bytes, numbers: int) -> None:
        self._data = data
        stamp = struct.pack("<iI", *_STAMP)
        self._stamps = [at for at in range(len(data)) if data.startswith(stamp, at)]
        self._numbers = [data.index(struct.pack("<d", each)) for each in _blanks(numbers)]

    def filled(self, stamp: int, numbers: Sequence[float]) -> bytes:
        """Return the message with its stamp, ns, and its numbers."""
        return self.all_filled(np.array([stamp]), np.array([numbers], np.float64))[0]

    def all_filled(self, stamps: Ints, numbers: Floats) -> list[bytes]:
        """Return n messages with their stamps, (n,) ns, and their numbers, (n, ...)."""
        count, size = len(stamps), len(self._data)
        data = np.tile(np.frombuffer(self._data, np.uint8), (count, 1))
        seconds, rest = np.divmod(stamps, 1_000_000_000)
        stamp = np.column_stack([seconds, rest]).astype("<u4").view(np.uint8)
        for at in self._stamps:
            data[:, at : at + 8] = stamp
        filled = np.ascontiguousarray(numbers, "<f8").view(np.uint8)
        filled = filled.reshape(count, len(self._numbers), 8)
        for row, at in enumerate(self._numbers):
            data[:, at : at + 8] = filled[:, row]
        whole = data.tobytes()
        return [whole[start : start + size] for start in range(0, len(whole), size)]


def _blanks(count: int) -> list[float]:
    return [(number + 1) * _FIRST for number in range(count)]


class Messages:
    """Messages of one version of ROS."""

    def __init__(self, ros: int) -> None:
        self.ros = ros
        self._definitions: dict[str, str] = {}
        self.store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
        self.store.register(get_types_from_msg(FOOT_STATES, SPOT))
        self.store.register(
            get_types_from_msg(DEFINITIONS["spot_msgs/msg/FootState"], "spot_msgs/msg/FootState")
        )
        for name in _NEEDED:
            if name not in self.store.types:
                self.store.register(get_types_from_msg(DEFINITIONS[name], name))

    def definition(self, kind: str) -> str:
        """Return a type's definition with those that it needs."""
        if kind not in self._definitions:
            text, _ = self.store.generate_msgdef(kind, ros_version=self.ros)
            self._definitions[kind] = text
        return self._definitions[kind]

    def odometry(self, frame: str, child: str) -> Template:
        """Fill with a position, a quaternion and a velocity: 10 numbers."""
        blank = _blanks(10)
        pose = self._make(
            "geometry_msgs/msg/Pose",
            position=self._xyz("geometry_msgs/msg/Point", blank[:3]),
            orientation=self._quaternion(blank[3:7]),
        )
        still = self._vector((0.0, 0.0, 0.0))
        twist = self._make("geometry_msgs/msg/Twist", linear=self._vector(blank[7:]), angular=still)
        none = np.zeros(36)
        message = self._make(
            ODOMETRY,
            header=self._header(frame),
            child_frame_id=child,
            pose=self._make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=none),
            twist=self._make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=none),
        )
        return self._template(ODOMETRY, message, 10)

    def wrench_stamped(self, frame: str) -> Template:
        """Fill with a force: 3 numbers."""
        wrench = self._wrench(_blanks(3))
        return self._template(
            WRENCH, self._make(WRENCH, header=self._header(frame), wrench=wrench), 3
        )

    def spot(self, feet: int) -> Template:
        """Fill with the place of each foot: 3 numbers a foot; contacts are set afterwards."""
        blank = _blanks(3 * feet)
        states = [
            self._make(
                "spot_msgs/msg/FootState",
                foot_position_rt_body=self._xyz(
                    "geometry_msgs/msg/Point", blank[3 * foot : 3 * foot + 3]
                ),
                contact=MARK + foot,
            )
            for foot in range(feet)
        ]
        return self._template(
            SPOT, self._make(SPOT, header=self._header(""), states=states), 3 * feet
        )

    def flags(self, feet: int) -> Template:
        """Nothing to fill but the flags, which are the last bytes, one a foot."""
        message = self._make(FLAGS, header=self._header(""), contacts=np.zeros(feet, np.bool_))
        return self._template(FLAGS, message, 0)

    def with_contacts(self, data: Sequence[bytes], feet: int, touching: Flags) -> list[bytes]:
        """Set the contacts, (n, feet), in messages that `spot` made: 1 made, 2 lost."""
        blank = self.spot(feet).filled(0, [0.0] * (3 * feet))
        at = [blank.index(MARK + foot) for foot in range(feet)]
        filled = [bytearray(each) for each in data]
        for message, row in zip(filled, touching.tolist(), strict=True):
            for offset, touches in zip(at, row, strict=True):
                message[offset] = 1 if touches else 2
        return [bytes(each) for each in filled]

    def no_contact(self, frame: str) -> Template:
        """Nothing to fill: a bumper that touches nothing."""
        return self._template(
            CONTACTS, self._make(CONTACTS, header=self._header(frame), states=[]), 0
        )

    def contact(self, frame: str, collision: str, other: str = GROUND) -> Template:
        """Fill with a force, the same force again, a point and a normal: 12 numbers."""
        blank = _blanks(12)
        state = self._make(
            "gazebo_msgs/msg/ContactState",
            info="",
            collision1_name=collision,
            collision2_name=other,
            wrenches=[self._wrench(blank[:3])],
            total_wrench=self._wrench(blank[3:6]),
            contact_positions=[self._vector(blank[6:9])],
            contact_normals=[self._vector(blank[9:])],
            depths=np.zeros(1),
        )
        message = self._make(CONTACTS, header=self._header(frame), states=[state])
        return self._template(CONTACTS, message, 12)

    def gz_contact(self, frame: str, collision: str) -> Template:
        """Fill as `contact`; the foot is body 1."""
        blank = _blanks(12)
        names = [
            self._make("ros_gz_interfaces/msg/Entity", id=0, name=name, type=4)
            for name in (collision, GROUND)
        ]
        number = self._make("std_msgs/msg/UInt32", data=0)
        text = self._make("std_msgs/msg/String", data="")
        joint = self._make(
            "ros_gz_interfaces/msg/JointWrench",
            header=self._header(frame),
            body_1_name=text,
            body_1_id=number,
            body_2_name=text,
            body_2_id=number,
            body_1_wrench=self._wrench(blank[:3]),
            body_2_wrench=self._wrench(blank[3:6]),
        )
        pair = self._make(
            "ros_gz_interfaces/msg/Contact",
            collision1=names[0],
            collision2=names[1],
            positions=[self._vector(blank[6:9])],
            normals=[self._vector(blank[9:])],
            depths=np.zeros(1),
            wrenches=[joint],
        )
        message = self._make(GZ_CONTACTS, header=self._header(frame), contacts=[pair])
        return self._template(GZ_CONTACTS, message, 12)

    def transforms(self, parent: str, children: Sequence[str]) -> Template:
        """Fill with a place and a quaternion of each child: 7 numbers each."""
        blank = np.array(_blanks(7 * len(children))).reshape(-1, 7)
        transforms = [
            self._make(
                "geometry_msgs/msg/TransformStamped",
                header=self._header(parent),
                child_frame_id=child,
                transform=self._make(
                    "geometry_msgs/msg/Transform",
                    translation=self._vector(row[:3]),
                    rotation=self._quaternion(row[3:]),
                ),
            )
            for child, row in zip(children, blank, strict=True)
        ]
        return self._template(TF, self._make(TF, transforms=transforms), blank.size)

    def twist(self) -> Template:
        """Fill with linear x and y and angular z: 3 numbers."""
        return self._template(TWIST, self._twist(), 3)

    def twist_stamped(self, frame: str) -> Template:
        """Fill as `twist`."""
        message = self._make(TWIST_STAMPED, header=self._header(frame), twist=self._twist())
        return self._template(TWIST_STAMPED, message, 3)

    def imu(self, frame: str, *, turns: bool = False) -> Template:
        """Fill with a linear acceleration and, if asked for, a turn rate: 3 or 6 numbers."""
        blank = _blanks(6)
        message = self._make(
            IMU,
            header=self._header(frame),
            orientation=self._quaternion((0.0, 0.0, 0.0, 1.0)),
            linear_acceleration=self._vector(blank[:3]),
            angular_velocity=self._vector(blank[3:] if turns else (0.0, 0.0, 0.0)),
            **{
                f"{name}_covariance": np.zeros(9)
                for name in ("orientation", "angular_velocity", "linear_acceleration")
            },
        )
        return self._template(IMU, message, 6 if turns else 3)

    def _twist(self) -> Any:
        x, y, yaw = _blanks(3)
        return self._make(
            TWIST, linear=self._vector((x, y, 0.0)), angular=self._vector((0.0, 0.0, yaw))
        )

    def _header(self, frame: str) -> Any:
        time = self._make("builtin_interfaces/msg/Time", sec=_STAMP[0], nanosec=_STAMP[1])
        sequence = {"seq": 0} if self.ros == 1 else {}
        return self._make("std_msgs/msg/Header", stamp=time, frame_id=frame, **sequence)

    def _wrench(self, force: Any) -> Any:
        zero = self._vector((0.0, 0.0, 0.0))
        return self._make("geometry_msgs/msg/Wrench", force=self._vector(force), torque=zero)

    def _vector(self, values: Any) -> Any:
        return self._xyz("geometry_msgs/msg/Vector3", values)

    def _xyz(self, kind: str, values: Any) -> Any:
        return self._make(kind, **dict(zip("xyz", map(float, values), strict=True)))

    def _quaternion(self, values: Any) -> Any:
        fields = dict(zip("xyzw", map(float, values), strict=True))
        return self._make("geometry_msgs/msg/Quaternion", **fields)

    def _make(self, kind: str, **fields: Any) -> Any:
        return self.store.types[kind](**fields)

    def _template(self, kind: str, message: Any, numbers: int) -> Template:
        serialise = self.store.serialize_ros1 if self.ros == 1 else self.store.serialize_cdr
        return Template(bytes(serialise(message, kind)), numbers)
