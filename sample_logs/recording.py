"""From a closed-form walk to the messages that a recorder would have logged.

``record`` samples a scenario's walk, fills the messages and damages them where the scenario asks.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from gait_model import (
    FEET,
    GRAVITY_MPS2,
    PAD_HALF_LENGTH_M,
    base_motion,
    ground_forces,
    leg_angles,
    leg_geometry,
    lower_leg_in_world,
    pad_front_share,
    sole_position,
)
from joint_torques import joint_torques
from leg_kinematics import (
    LOWER_LEG_LENGTH_M,
    UPPER_LEG_LENGTH_M,
    conjugate,
    joint_rotations,
    rotate,
    rotation_about_z,
)
from ros_messages import (
    NS_PER_S,
    BaseSample,
    ContactStep,
    Link,
    MessageFactory,
    Stamp,
    round_forces,
    round_lengths,
    round_quaternions,
    round_rates,
)
from scenario import (
    COMMAND_TOPIC,
    IMU_TOPIC,
    JOINT_TOPIC,
    MAX_JITTER_NS,
    ODOMETRY_TOPIC,
    TF_STATIC_TOPIC,
    TF_TOPIC,
    TWIST_NOISE_STD,
    Damage,
    LoggedMessage,
    Scenario,
    Silence,
    contact_topic,
    foot_collision,
    transport_delay_ns,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import numpy.typing as npt
    from leg_kinematics import Array

_JOINT_INTERVAL_NS = 20_000_000
_IMU_INTERVAL_NS = 10_000_000
_COMMAND_INTERVAL_NS = 20_000_000
_DIFFERENCE_S = 1e-3
_TF_TYPE = "tf2_msgs/msg/TFMessage"
_GROUND_NAME = "ground_plane::link::collision"


def record(scenario: Scenario) -> list[LoggedMessage]:
    """Return the log of a scenario, in the order of the file."""
    recorder = _Recorder(scenario)
    topics = [
        recorder.static_transforms(),
        recorder.odometry(),
        *(recorder.contacts(foot) for foot in FEET),
        recorder.imu(),
        recorder.joint_states(),
        recorder.transforms(),
        # Last, so that the jitter of the other topics does not depend on it.
        recorder.commands(),
    ]
    messages = [message for topic in topics for message in topic]
    messages.sort(key=lambda message: message.log_time_ns)
    return _disorder(messages, scenario.damage)


class _Recorder:
    """Samples a scenario's walk topic by topic."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._damage = scenario.damage
        self._factory = MessageFactory(scenario.ros_version)
        self._random = np.random.default_rng(scenario.seed)

    def odometry(self) -> Iterator[LoggedMessage]:
        """Pose without noise, twist with it, both in world."""
        scenario = self._scenario
        base = base_motion(scenario.gait, self._times_s(scenario.odometry_interval_ns))
        twist = np.concatenate([base.linear_velocity_mps, base.angular_velocity_radps], axis=1)
        twist = round_rates(twist + self._random.normal(0, TWIST_NOISE_STD, twist.shape))
        position_m = round_lengths(base.position_m)
        orientation = round_quaternions(base.orientation)
        orientation[list(self._damage.zero_quaternion)] = 0

        def serialise(seq: int, stamp_ns: int) -> bytes:
            stamp = Stamp(seq, stamp_ns, scenario.world_frame_id)
            sample = BaseSample(position_m[seq], orientation[seq], twist[seq, :3], twist[seq, 3:])
            return self._factory.odometry(stamp, scenario.base_frame_id, sample, TWIST_NOISE_STD)

        return self._periodic(
            ODOMETRY_TOPIC, "nav_msgs/msg/Odometry", scenario.odometry_interval_ns, serialise
        )

    def contacts(self, foot: str) -> Iterator[LoggedMessage]:
        """Every physics step since the previous message in which the foot was in contact."""
        scenario = self._scenario
        interval_ns = scenario.contact_interval_ns
        steps = self._contact_steps(foot)

        def serialise(seq: int, stamp_ns: int) -> bytes:
            offset_ns = seq * interval_ns
            first_ns = offset_ns - interval_ns + scenario.physics_step_ns
            step_offsets_ns = range(first_ns, offset_ns + 1, scenario.physics_step_ns)
            in_contact = [steps[ns] for ns in step_offsets_ns if ns in steps]
            if in_contact:
                in_contact[-1] = _with_non_finite(in_contact[-1], self._damage, foot, seq)
            stamp = Stamp(seq, stamp_ns, scenario.contact_frame_id)
            return self._factory.contacts(stamp, in_contact)

        messages = self._periodic(
            contact_topic(foot), "gazebo_msgs/msg/ContactsState", interval_ns, serialise
        )
        for message in messages:
            offset_s = (message.publish_time_ns - scenario.start_ns) / NS_PER_S
            if not _is_silent(self._damage.silence, foot, offset_s):
                yield message

    def imu(self) -> Iterator[LoggedMessage]:
        """Orientation in world; angular velocity and specific force in body axes."""
        base = base_motion(self._scenario.gait, self._times_s(_IMU_INTERVAL_NS))
        to_body = conjugate(base.orientation)
        gravity_reaction_mps2 = np.array([0.0, 0.0, GRAVITY_MPS2])
        specific_force = round_rates(
            rotate(to_body, base.linear_acceleration_mps2 + gravity_reaction_mps2)
        )
        rates_radps = round_rates(rotate(to_body, base.angular_velocity_radps))
        orientation = round_quaternions(base.orientation)

        def serialise(seq: int, stamp_ns: int) -> bytes:
            sample = BaseSample(
                np.zeros(0), orientation[seq], specific_force[seq], rates_radps[seq]
            )
            return self._factory.imu(Stamp(seq, stamp_ns, "base_link"), sample)

        return self._periodic(IMU_TOPIC, "sensor_msgs/msg/Imu", _IMU_INTERVAL_NS, serialise)

    def commands(self) -> Iterator[LoggedMessage]:
        """The velocity that the base is to have, and has; in ROS 1 without a header."""
        speed_mps = self._scenario.gait.speed_mps
        if self._scenario.ros_version == 1:
            name = "geometry_msgs/msg/Twist"
            data = self._factory.twist(speed_mps)
            return self._periodic(COMMAND_TOPIC, name, _COMMAND_INTERVAL_NS, lambda *_: data)

        def serialise(seq: int, stamp_ns: int) -> bytes:
            return self._factory.twist_stamped(Stamp(seq, stamp_ns, "base_link"), speed_mps)

        name = "geometry_msgs/msg/TwistStamped"
        return self._periodic(COMMAND_TOPIC, name, _COMMAND_INTERVAL_NS, serialise)

    def joint_states(self) -> Iterator[LoggedMessage]:
        """Angles of all joints, their rates by central differences, and their torques."""
        names = [f"{foot}_{joint}" for foot in FEET for joint in ("roll", "pitch", "knee")]
        time_s = self._times_s(_JOINT_INTERVAL_NS)
        before_rad, angles_rad, after_rad = (
            np.concatenate([leg_angles(self._scenario.gait, foot, t) for foot in FEET], axis=1)
            for t in (time_s - _DIFFERENCE_S, time_s, time_s + _DIFFERENCE_S)
        )
        angles_rad = round_rates(angles_rad)
        rates_radps = round_rates((after_rad - before_rad) / (2 * _DIFFERENCE_S))
        gait = self._scenario.gait
        torques_nm = round_forces(
            np.concatenate([joint_torques(gait, foot, time_s) for foot in FEET], axis=1)
        )

        def serialise(seq: int, stamp_ns: int) -> bytes:
            stamp = Stamp(seq, stamp_ns, "")
            return self._factory.joint_state(
                stamp, names, angles_rad[seq], rates_radps[seq], torques_nm[seq]
            )

        return self._periodic(
            JOINT_TOPIC, "sensor_msgs/msg/JointState", _JOINT_INTERVAL_NS, serialise
        )

    def transforms(self) -> Iterator[LoggedMessage]:
        """Legs; the rigid frames of feet and soles are among them in ROS 1 and apart in ROS 2."""
        time_s = self._times_s(_JOINT_INTERVAL_NS)
        rotations = {
            foot: round_quaternions(joint_rotations(leg_angles(self._scenario.gait, foot, time_s)))
            for foot in FEET
        }
        fixed_links = _fixed_links() if self._scenario.ros_version == 1 else []

        def serialise(seq: int, stamp_ns: int) -> bytes:
            links = [link for foot in FEET for link in _leg_links(foot, rotations[foot][seq])]
            return self._factory.transforms(stamp_ns, links + fixed_links)

        return self._periodic(TF_TOPIC, _TF_TYPE, _JOINT_INTERVAL_NS, serialise)

    def static_transforms(self) -> Iterator[LoggedMessage]:
        """Rigid frames of feet and soles once at the start, in ROS 2 only."""
        if self._scenario.ros_version == 2:
            time_ns = self._scenario.start_ns
            data = self._factory.transforms(time_ns, _fixed_links())
            yield LoggedMessage(TF_STATIC_TOPIC, _TF_TYPE, time_ns, time_ns, data)

    def _periodic(
        self,
        topic: str,
        message_type: str,
        interval_ns: int,
        serialise: Callable[[int, int], bytes],
    ) -> Iterator[LoggedMessage]:
        """Log a topic: ``serialise`` gets the message's number and its header stamp (ns)."""
        offsets_ns = self._offsets_ns(interval_ns)
        delays_ns = transport_delay_ns(topic) + self._random.integers(
            0, MAX_JITTER_NS, len(offsets_ns)
        )
        for seq, delay_ns in enumerate(delays_ns.tolist()):
            time_ns = self._scenario.start_ns + seq * interval_ns
            data = serialise(seq, 0 if self._damage.zero_stamps else time_ns)
            yield LoggedMessage(topic, message_type, time_ns + delay_ns, time_ns, data)

    def _contact_steps(self, foot: str) -> dict[int, ContactStep]:
        """Contacts of a foot by the offset of their physics step, in nanoseconds."""
        if foot == self._damage.dead_foot:
            return {}
        scenario, gait = self._scenario, self._scenario.gait
        offsets_ns = self._offsets_ns(scenario.physics_step_ns)
        offsets_ns = offsets_ns[gait.in_stance(foot, offsets_ns / NS_PER_S)]
        time_s = offsets_ns / NS_PER_S
        shares, points_m = self._contact_points(foot, time_s)
        on_ground = foot == scenario.second_body_foot
        sign = -1.0 if on_ground else 1.0
        force_n = sign * ground_forces(gait, time_s)[foot]
        if scenario.wrench_frame == "link" and not on_ground:
            force_n = rotate(conjugate(lower_leg_in_world(gait, foot, time_s)), force_n)
        forces_n = round_forces(shares[:, :, None] * force_n[:, None, :]).tolist()
        bodies = (foot_collision(foot), _GROUND_NAME)
        if on_ground:
            bodies = bodies[::-1]
        return {
            ns: ContactStep(scenario.start_ns + ns, bodies, forces, points, (0.0, 0.0, sign))
            for ns, forces, points in zip(
                offsets_ns.tolist(), forces_n, round_lengths(points_m).tolist(), strict=True
            )
        }

    def _contact_points(self, foot: str, time_s: Array) -> tuple[Array, Array]:
        """Share of the load ``(n, p)`` and position in world ``(n, p, 3)`` of each point."""
        gait = self._scenario.gait
        sole_m = sole_position(gait, foot, time_s)[:, None, :]
        if foot != self._scenario.pad_foot:
            return np.ones((len(time_s), 1)), sole_m
        forward = rotate(rotation_about_z(gait.heading_rad), np.array([0.0, 1.0, 0.0]))
        front_share = pad_front_share(gait, foot, time_s)
        ends_m = PAD_HALF_LENGTH_M * np.stack([forward, -forward])
        return np.stack([front_share, 1 - front_share], axis=-1), sole_m + ends_m

    def _offsets_ns(self, interval_ns: int) -> npt.NDArray[np.int64]:
        """Instants since the start of the log at an interval, in nanoseconds."""
        return np.arange(0, self._scenario.duration_ns + 1, interval_ns, dtype=np.int64)

    def _times_s(self, interval_ns: int) -> Array:
        """Instants since the start of the log at an interval, in seconds."""
        return self._offsets_ns(interval_ns) / NS_PER_S


def _leg_links(foot: str, rotations: Array) -> list[Link]:
    """Hip, upper leg and lower leg of a foot, from their rotations ``(3, 4)``."""
    leg = leg_geometry(foot)
    frames = ["base_link", f"{foot}_hip", f"{foot}_upperleg", f"{foot}_lowerleg"]
    translations_m = [leg.hip_m, (leg.hip_offset_m, 0.0, 0.0), (0.0, 0.0, -UPPER_LEG_LENGTH_M)]
    return [
        Link(parent, child, translation_m, rotation)
        for parent, child, translation_m, rotation in zip(
            frames[:-1], frames[1:], translations_m, rotations.tolist(), strict=True
        )
    ]


def _fixed_links() -> list[Link]:
    """Frames fixed to lower legs: a foot's at the knee, a sole's where it touches the ground."""
    height_m = {"foot": 0.0, "sole": -LOWER_LEG_LENGTH_M}
    return [
        Link(f"{foot}_lowerleg", f"{foot}_{name}", (0.0, 0.0, z), (0.0, 0.0, 0.0, 1.0))
        for foot in FEET
        for name, z in height_m.items()
    ]


def _is_silent(silence: Silence | None, foot: str, offset_s: float) -> bool:
    if silence is None or silence.foot != foot:
        return False
    return 0 <= offset_s - silence.start_s < silence.duration_s


def _with_non_finite(step: ContactStep, damage: Damage, foot: str, seq: int) -> ContactStep:
    """Put NaN into the first force, or infinity into the first position, where damage says so."""
    forces_n, points_m = step.forces_n, step.points_m
    if seq in damage.nan_force.get(foot, ()):
        forces_n = [[*forces_n[0][:2], float("nan")], *forces_n[1:]]
    if seq in damage.infinite_position.get(foot, ()):
        points_m = [[float("inf"), *points_m[0][1:]], *points_m[1:]]
    return replace(step, forces_n=forces_n, points_m=points_m)


def _disorder(messages: list[LoggedMessage], damage: Damage) -> list[LoggedMessage]:
    """Change log times as the damage says, without moving the messages in the file."""
    backward = {contact_topic(foot): numbers for foot, numbers in damage.backward_log_time.items()}
    counts: Counter[str] = Counter()
    last_time_ns: dict[str, int] = {}
    disordered = []
    for message in messages:
        topic, log_time_ns = message.topic, message.log_time_ns
        if counts[topic] in backward.get(topic, ()):
            log_time_ns -= damage.backward_step_ns
        if topic == ODOMETRY_TOPIC and counts[topic] in damage.duplicate_log_time:
            log_time_ns = last_time_ns[topic]
        counts[topic] += 1
        last_time_ns[topic] = log_time_ns
        disordered.append(replace(message, log_time_ns=log_time_ns))
    return disordered
