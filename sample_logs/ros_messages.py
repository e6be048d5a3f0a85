"""ROS messages, filled as Gazebo classic and its ROS plugins fill them, and their serialisation.

One ``MessageFactory`` serves ROS 1 and ROS 2: the messages differ only in the header's sequence
number, in how a contact's ``info`` is printed, and in the bytes.

All numbers are rounded to binary grids far below anything that matters. Libraries differ in the
last bit of a sine from one processor to the next; the rounding takes that out of the files, and it
makes them smaller.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from leg_kinematics import Array
    from rosbags.typesys.store import Msg, Msgarg, Typestore

NS_PER_S = 1_000_000_000

_FORCE_STEPS_PER_N = 2**16
_LENGTH_STEPS_PER_M = 2**24
_QUATERNION_STEPS = 2**28
_RATE_STEPS = 2**24

_CONTACT_DEPTH_M = 1e-4

_GAZEBO_DEFINITIONS = {
    "gazebo_msgs/msg/ContactState": """
        string info
        string collision1_name
        string collision2_name
        geometry_msgs/Wrench[] wrenches
        geometry_msgs/Wrench total_wrench
        geometry_msgs/Vector3[] contact_positions
        geometry_msgs/Vector3[] contact_normals
        float64[] depths
    """,
    "gazebo_msgs/msg/ContactsState": """
        std_msgs/Header header
        gazebo_msgs/ContactState[] states
    """,
}
_TF_DEFINITION = {"tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms"}


def round_forces(force_n: Array) -> Array:
    """Round to the grid of forces, 15 micronewtons."""
    return np.round(force_n * _FORCE_STEPS_PER_N) / _FORCE_STEPS_PER_N


def round_lengths(length_m: Array) -> Array:
    """Round to the grid of lengths, 60 nanometres."""
    return np.round(length_m * _LENGTH_STEPS_PER_M) / _LENGTH_STEPS_PER_M


def round_quaternions(quaternion: Array) -> Array:
    """Round components to a grid of 4e-9."""
    return np.round(quaternion * _QUATERNION_STEPS) / _QUATERNION_STEPS


def round_rates(rate: Array) -> Array:
    """Round angles, velocities and accelerations to a grid of 6e-8 of their SI units."""
    return np.round(rate * _RATE_STEPS) / _RATE_STEPS


@dataclass(frozen=True, slots=True)
class Stamp:
    """What identifies a message: its number on its topic, its time and its frame.

    Attributes:
        seq: Sequence number of the header (ROS 1 only).
        time_ns: Header stamp.
        frame_id: The header's frame.

    """

    seq: int
    time_ns: int
    frame_id: str


@dataclass(frozen=True, slots=True)
class ContactStep:
    """One pair of collisions in contact, in one physics step.

    Attributes:
        time_ns: Simulation time of the physics step.
        bodies: Names of collision 1 and collision 2.
        forces_n: Force on body 1 at each contact point, in the recorded frame.
        points_m: The contact points in world.
        normal: The contact normal in world, out of body 2.

    """

    time_ns: int
    bodies: tuple[str, str]
    forces_n: Sequence[Sequence[float]]
    points_m: Sequence[Sequence[float]]
    normal: Sequence[float]


@dataclass(frozen=True, slots=True)
class Link:
    """A transform from a parent frame to a child frame.

    Attributes:
        parent: Parent frame.
        child: Child frame.
        translation_m: The child's origin in the parent frame.
        rotation: Child to parent, a quaternion x, y, z, w.

    """

    parent: str
    child: str
    translation_m: Sequence[float]
    rotation: Sequence[float]


@dataclass(frozen=True, slots=True)
class BaseSample:
    """The base at one instant; odometry takes it in world, the inertial unit in body axes.

    Attributes:
        position_m: Position in world; an inertial unit has none.
        orientation: Body to world, a quaternion x, y, z, w.
        linear: Velocity in m/s (odometry) or specific force in m/s^2 (inertial unit).
        angular_radps: Angular velocity.

    """

    position_m: Array
    orientation: Array
    linear: Array
    angular_radps: Array


class MessageFactory:
    """Builds and serialises messages for one version of ROS."""

    def __init__(self, ros_version: int) -> None:
        """Take the version of ROS, 1 or 2."""
        self.ros_version = ros_version
        store = Stores.ROS1_NOETIC if ros_version == 1 else Stores.ROS2_HUMBLE
        self.typestore: Typestore = get_typestore(store)
        missing = _GAZEBO_DEFINITIONS if ros_version == 2 else _GAZEBO_DEFINITIONS | _TF_DEFINITION
        for name, definition in missing.items():
            self.typestore.register(get_types_from_msg(definition, name))

    def serialise(self, message: Msg, message_type: str) -> bytes:
        """Bytes of a message in this version's encoding (ROS 1 serialisation or CDR)."""
        if self.ros_version == 1:
            return bytes(self.typestore.serialize_ros1(message, message_type))
        return bytes(self.typestore.serialize_cdr(message, message_type, little_endian=True))

    def contacts(self, stamp: Stamp, steps: Sequence[ContactStep]) -> bytes:
        """``gazebo_msgs/ContactsState`` of a bumper: one state a physics step, the newest last."""
        states = [self._contact_state(step, i, len(steps)) for i, step in enumerate(steps)]
        message_type = "gazebo_msgs/msg/ContactsState"
        message = self._make(message_type, header=self._header(stamp), states=states)
        return self.serialise(message, message_type)

    def odometry(
        self, stamp: Stamp, child_frame_id: str, base: BaseSample, noise_std: float
    ) -> bytes:
        """``nav_msgs/Odometry`` as p3d fills it: the twist, too, in the header's frame.

        Args:
            stamp: Identity of the message.
            child_frame_id: The base's frame.
            base: Pose and twist of the base in the header's frame.
            noise_std: Standard deviation that p3d was configured with: it goes, squared, onto both
                covariances' diagonals, although the pose has no noise.

        """
        covariance = (np.eye(6) * noise_std**2).ravel()
        pose = self._make(
            "geometry_msgs/msg/Pose",
            position=self._make("geometry_msgs/msg/Point", *base.position_m),
            orientation=self._quaternion(base.orientation),
        )
        twist = self._make(
            "geometry_msgs/msg/Twist",
            linear=self._vector(base.linear),
            angular=self._vector(base.angular_radps),
        )
        message_type = "nav_msgs/msg/Odometry"
        message = self._make(
            message_type,
            header=self._header(stamp),
            child_frame_id=child_frame_id,
            pose=self._make("geometry_msgs/msg/PoseWithCovariance", pose, covariance),
            twist=self._make("geometry_msgs/msg/TwistWithCovariance", twist, covariance),
        )
        return self.serialise(message, message_type)

    def imu(self, stamp: Stamp, base: BaseSample) -> bytes:
        """``sensor_msgs/Imu`` of an ideal inertial unit at the base's origin."""
        message_type = "sensor_msgs/msg/Imu"
        message = self._make(
            message_type,
            header=self._header(stamp),
            orientation=self._quaternion(base.orientation),
            orientation_covariance=np.zeros(9),
            angular_velocity=self._vector(base.angular_radps),
            angular_velocity_covariance=np.zeros(9),
            linear_acceleration=self._vector(base.linear),
            linear_acceleration_covariance=np.zeros(9),
        )
        return self.serialise(message, message_type)

    def twist(self, forward_mps: float) -> bytes:
        """``geometry_msgs/Twist`` of a velocity along the base's +y, its forward axis."""
        return self.serialise(self._twist(forward_mps), "geometry_msgs/msg/Twist")

    def twist_stamped(self, stamp: Stamp, forward_mps: float) -> bytes:
        """``geometry_msgs/TwistStamped`` of the same."""
        message_type = "geometry_msgs/msg/TwistStamped"
        message = self._make(message_type, self._header(stamp), self._twist(forward_mps))
        return self.serialise(message, message_type)

    def joint_state(
        self,
        stamp: Stamp,
        names: list[str],
        angles_rad: Array,
        rates_radps: Array,
        torques_nm: Array,
    ) -> bytes:
        """``sensor_msgs/JointState``."""
        message_type = "sensor_msgs/msg/JointState"
        message = self._make(
            message_type,
            header=self._header(stamp),
            name=names,
            position=angles_rad,
            velocity=rates_radps,
            effort=torques_nm,
        )
        return self.serialise(message, message_type)

    def transforms(self, stamp_ns: int, links: Sequence[Link]) -> bytes:
        """``tf2_msgs/TFMessage`` of links at one time; broadcasters leave the numbers at 0."""
        message_type = "tf2_msgs/msg/TFMessage"
        transforms = [
            self._make(
                "geometry_msgs/msg/TransformStamped",
                header=self._header(Stamp(0, stamp_ns, link.parent)),
                child_frame_id=link.child,
                transform=self._make(
                    "geometry_msgs/msg/Transform",
                    translation=self._vector(link.translation_m),
                    rotation=self._quaternion(link.rotation),
                ),
            )
            for link in links
        ]
        return self.serialise(self._make(message_type, transforms=transforms), message_type)

    def _contact_state(self, step: ContactStep, index: int, count: int) -> Msg:
        total_n = np.sum(step.forces_n, axis=0).tolist()
        return self._make(
            "gazebo_msgs/msg/ContactState",
            info=self._contact_info(step, index, count),
            collision1_name=step.bodies[0],
            collision2_name=step.bodies[1],
            wrenches=[self._wrench(force_n) for force_n in step.forces_n],
            total_wrench=self._wrench(total_n),
            contact_positions=[self._vector(point_m) for point_m in step.points_m],
            contact_normals=[self._vector(step.normal) for _ in step.points_m],
            depths=np.full(len(step.points_m), _CONTACT_DEPTH_M),
        )

    def _contact_info(self, step: ContactStep, index: int, count: int) -> str:
        seconds, nanoseconds = divmod(step.time_ns, NS_PER_S)
        body1, body2 = step.bodies
        if self.ros_version == 1:
            return (
                f"Debug:  i:({index}/{count})     my geom:{body1}   other geom:{body2}"
                f"         time:{seconds}.{nanoseconds:09d}\n"
            )
        return (
            f"Debug:  i: ({index + 1}/{count})     my_geom: [{body1}]  other_geom: [{body2}]"
            f"        time: [{seconds}.{nanoseconds}]\n"
        )

    def _header(self, stamp: Stamp) -> Msg:
        time = self._make("builtin_interfaces/msg/Time", *divmod(stamp.time_ns, NS_PER_S))
        if self.ros_version == 1:
            return self._make("std_msgs/msg/Header", stamp.seq, time, stamp.frame_id)
        return self._make("std_msgs/msg/Header", time, stamp.frame_id)

    def _twist(self, forward_mps: float) -> Msg:
        linear, angular = self._vector((0.0, forward_mps, 0.0)), self._vector((0.0, 0.0, 0.0))
        return self._make("geometry_msgs/msg/Twist", linear, angular)

    def _wrench(self, force_n: Sequence[float]) -> Msg:
        """Wrench without torque: nothing reads the torques of a bumper."""
        zero = self._vector((0.0, 0.0, 0.0))
        return self._make("geometry_msgs/msg/Wrench", self._vector(force_n), zero)

    def _vector(self, components: Iterable[float]) -> Msg:
        return self._make("geometry_msgs/msg/Vector3", *components)

    def _quaternion(self, components: Iterable[float]) -> Msg:
        return self._make("geometry_msgs/msg/Quaternion", *components)

    def _make(self, message_type: str, *args: Msgarg, **fields: Msgarg) -> Msg:
        return self.typestore.types[message_type](*args, **fields)
