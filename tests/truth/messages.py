"""ROS messages of the sensors: each kind serialised once by rosbags, then filled with numbers."""

import struct
from collections.abc import Sequence
from functools import cache
from typing import Any, Final

import numpy as np
from rosbags.typesys import get_types_from_msg

from tests.oracles.walks import Walk
from tests.truth.recording import Floats, Ints

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
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
STRING: Final = "std_msgs/msg/String"
FOOT_STATES: Final = "std_msgs/Header header\nspot_msgs/FootState[] states"
"""As a fork has it: with a header."""
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
        self.numbers = [data.index(struct.pack("<d", each)) for each in _blanks(numbers)]
        """Where the numbers are; also `flags`, of one byte each."""
        self.flags: list[int] = []

    def filled(self, stamp: int, numbers: Sequence[float]) -> bytes:
        """Return the message with its stamp, ns, and its numbers."""
        return self.all_filled(np.array([stamp]), np.array([numbers], np.float64))[0]

    def all_filled(self, stamps: Ints, numbers: Floats, flags: Ints | None = None) -> list[bytes]:
        """Return n messages with their stamps, (n,) ns, numbers and flags, (n, ...) each."""
        count, size = len(stamps), len(self._data)
        data = np.tile(np.frombuffer(self._data, np.uint8), (count, 1))
        seconds, rest = np.divmod(stamps, 1_000_000_000)
        stamp = np.column_stack([seconds, rest]).astype("<u4").view(np.uint8)
        for at in self._stamps:
            data[:, at : at + 8] = stamp
        filled = np.ascontiguousarray(numbers, "<f8").view(np.uint8)
        filled = filled.reshape(count, len(self.numbers), 8)
        for row, at in enumerate(self.numbers):
            data[:, at : at + 8] = filled[:, row]
        if flags is not None:
            data[:, self.flags] = flags
        whole = data.tobytes()
        return [whole[start : start + size] for start in range(0, len(whole), size)]


def _blanks(count: int) -> list[float]:
    return [(number + 1) * _FIRST for number in range(count)]


class Messages:
    """Messages of ROS 2."""

    def __init__(self) -> None:
        self._of = Walk(2)
        del self._of.store.fielddefs[SPOT]
        self._of.store.register(get_types_from_msg(FOOT_STATES, SPOT))
        self._definitions: dict[str, str] = {}

    def definition(self, kind: str) -> str:
        """Return a type's definition with those that it needs."""
        if kind not in self._definitions:
            self._definitions[kind] = self._of.definition(kind)
        return self._definitions[kind]

    def odometry(self, frame: str, child: str) -> Template:
        """Fill with a position, a quaternion and a velocity: 10 numbers."""
        blank = _blanks(10)
        return self._template(
            ODOMETRY,
            10,
            header=_header(frame),
            child_frame_id=child,
            pose={"pose": [blank[:3], blank[3:7]]},
            twist={"twist": [blank[7:]]},
        )

    def wrench_stamped(self, frame: str) -> Template:
        """Fill with a force: 3 numbers."""
        return self._template(WRENCH, 3, header=_header(frame), wrench=[_blanks(3)])

    def spot(self, feet: int) -> Template:
        """Fill with the place of each foot, 3 numbers, and a flag of each."""
        places = np.array(_blanks(3 * feet)).reshape(feet, 3)
        states = [{"foot_position_rt_body": place} for place in places]
        template = self._template(SPOT, 3 * feet, header=_header(""), states=states)
        template.flags = [at + 8 for at in template.numbers[2::3]]
        return template

    def contacts(self, feet: int) -> Template:
        """Fill with a flag of each foot: they are the last bytes."""
        template = self._template(FLAGS, 0, header=_header(""), contacts=[False] * feet)
        template.flags = list(range(-feet, 0))
        return template

    def no_contact(self, frame: str) -> Template:
        """Nothing to fill: a bumper that touches nothing."""
        return self._template(CONTACTS, 0, header=_header(frame))

    def contact(self, frame: str, collision: str, other: str = GROUND) -> Template:
        """Fill with a force, the same force again, a point and a normal: 12 numbers."""
        blank = _blanks(12)
        state = {
            "collision1_name": collision,
            "collision2_name": other,
            "wrenches": [[blank[:3]]],
            "total_wrench": [blank[3:6]],
            "contact_positions": [blank[6:9]],
            "contact_normals": [blank[9:]],
            "depths": [0.0],
        }
        return self._template(CONTACTS, 12, header=_header(frame), states=[state])

    def gz_contact(self, frame: str, collision: str) -> Template:
        """Fill as `contact`; the foot is body 1."""
        blank = _blanks(12)
        wrenches = {"body_1_wrench": [blank[:3]], "body_2_wrench": [blank[3:6]]}
        pair = {
            "collision1": {"name": collision, "type": 4},
            "collision2": {"name": GROUND, "type": 4},
            "positions": [blank[6:9]],
            "normals": [blank[9:]],
            "depths": [0.0],
            "wrenches": [{"header": _header(frame), **wrenches}],
        }
        return self._template(GZ_CONTACTS, 12, header=_header(frame), contacts=[pair])

    def transforms(self, parent: str, children: Sequence[str]) -> Template:
        """Fill with a place and a quaternion of each child: 7 numbers each."""
        blank = np.array(_blanks(7 * len(children))).reshape(-1, 7)
        transforms = [
            {
                "header": _header(parent),
                "child_frame_id": child,
                "transform": [row[:3], row[3:]],
            }
            for child, row in zip(children, blank, strict=True)
        ]
        return self._template(TF, blank.size, transforms=transforms)

    def twist(self) -> Template:
        """Fill with linear x and y and angular z: 3 numbers."""
        x, y, yaw = _blanks(3)
        return self._template(TWIST, 3, linear=(x, y, 0.0), angular=(0.0, 0.0, yaw))

    def twist_stamped(self, frame: str) -> Template:
        """Fill as `twist`."""
        x, y, yaw = _blanks(3)
        twist = [(x, y, 0.0), (0.0, 0.0, yaw)]
        return self._template(TWIST_STAMPED, 3, header=_header(frame), twist=twist)

    def imu(self, frame: str, *, turns: bool = False) -> Template:
        """Fill with a linear acceleration and, if asked for, a turn rate: 3 or 6 numbers."""
        blank = _blanks(6)
        fields = {"linear_acceleration": blank[:3], "angular_velocity": blank[3:]}
        if not turns:
            del fields["angular_velocity"]
        return self._template(IMU, 3 * len(fields), header=_header(frame), **fields)

    def joint_states(self, names: Sequence[str]) -> Template:
        """Fill with positions, velocities and efforts: 3 numbers a joint."""
        parts = np.split(np.array(_blanks(3 * len(names))), 3)
        told = dict(zip(("position", "velocity", "effort"), parts, strict=True))
        return self._template(
            JOINT_STATE, 3 * len(names), header=_header(""), name=list(names), **told
        )

    def text(self, text: str) -> bytes:
        """Return a message that holds a text, such as a robot description."""
        return self._of.bytes_of(STRING, self._of.make(STRING, data=text))

    def _template(self, kind: str, numbers: int, **fields: Any) -> Template:
        return Template(self._of.bytes_of(kind, self._of.make(kind, **fields)), numbers)


@cache
def ros_messages() -> Messages:
    """Return what makes messages."""
    return Messages()


def _header(frame: str) -> dict[str, Any]:
    return {"stamp": _STAMP, "frame_id": frame}
