"""How a walk was recorded: topics, rates, frames, and what went wrong."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from gait_model import FEET
from ros_messages import NS_PER_S

if TYPE_CHECKING:
    from gait_model import Gait

ODOMETRY_TOPIC = "/dogbot/odom"
JOINT_TOPIC = "/dogbot/joint_states"
IMU_TOPIC = "/dogbot/imu"
COMMAND_TOPIC = "/dogbot/cmd_vel"
TF_TOPIC = "/tf"
TF_STATIC_TOPIC = "/tf_static"

TWIST_NOISE_STD = 0.01
"""Of each component of odometry's twist, in m/s and rad/s."""

MAX_JITTER_NS = 300_000
_DELAY_NS = {
    ODOMETRY_TOPIC: 400_000,
    IMU_TOPIC: 700_000,
    JOINT_TOPIC: 1_000_000,
    COMMAND_TOPIC: 900_000,
    TF_TOPIC: 1_300_000,
    TF_STATIC_TOPIC: 0,
}
_FIRST_CONTACT_DELAY_NS, _CONTACT_DELAY_STEP_NS = 500_000, 50_000


@dataclass(frozen=True, slots=True)
class Silence:
    """A topic that says nothing for a while.

    Attributes:
        foot: The foot whose contact topic is silent.
        start_s: First moment without messages, since the log's start.
        duration_s: How long; messages whose stamp is in [start, start + duration) are missing.

    """

    foot: str
    start_s: float
    duration_s: float


@dataclass(frozen=True, slots=True)
class Damage:
    """What is wrong with a recording; message numbers count from 0 on their topic.

    Attributes:
        dead_foot: A foot whose sensor reports no contact, ever.
        silence: A drop-out of a contact topic.
        zero_stamps: All header stamps are 0.
        nan_force: Messages of a foot whose newest state has a vertical force that is not a number.
        infinite_position: Messages of a foot whose newest state lies at infinity.
        zero_quaternion: Odometry messages whose orientation is all zero.
        duplicate_log_time: Odometry messages logged at the same time as their predecessors.
        backward_log_time: Messages of a foot logged ``backward_step_ns`` too early, thus before
            their predecessors.
        backward_step_ns: By how much.

    """

    dead_foot: str | None = None
    silence: Silence | None = None
    zero_stamps: bool = False
    nan_force: dict[str, tuple[int, ...]] = field(default_factory=dict)
    infinite_position: dict[str, tuple[int, ...]] = field(default_factory=dict)
    zero_quaternion: tuple[int, ...] = ()
    duplicate_log_time: tuple[int, ...] = ()
    backward_log_time: dict[str, tuple[int, ...]] = field(default_factory=dict)
    backward_step_ns: int = 0


@dataclass(frozen=True, slots=True)
class Scenario:
    """A walk, and how it was recorded.

    Attributes:
        name: Stem of the file names.
        gait: The walk.
        ros_version: 1 or 2.
        compression: Of the chunks: ``lz4`` or ``bz2`` for a bag, ``zstd`` for an MCAP.
        start_ns: Simulation time at the walk's start.
        duration_ns: From the first to the last sample.
        physics_step_ns: Physics step; every step in contact is one state of a message.
        steps_per_contact_message: Physics steps that a contact message accumulates.
        odometry_interval_ns: Between odometry messages.
        world_frame_id: Odometry's frame.
        base_frame_id: Odometry's child frame.
        contact_frame_id: Frame of the contact topics' headers; a label without a meaning.
        wrench_frame: ``link`` for the frame of the link of collision 1, or ``world``.
        second_body_foot: A foot that is collision 2 of its pairs, with the ground as collision 1.
        pad_foot: A foot with a pad, which touches the ground at two points.
        seed: For the noise of the twist and the jitter of the log times.
        damage: What is wrong.

    """

    name: str
    gait: Gait
    ros_version: Literal[1, 2]
    compression: Literal["lz4", "bz2", "zstd"]
    start_ns: int
    duration_ns: int
    physics_step_ns: int
    steps_per_contact_message: int
    odometry_interval_ns: int
    world_frame_id: str
    base_frame_id: str
    contact_frame_id: str
    wrench_frame: Literal["link", "world"]
    second_body_foot: str | None
    pad_foot: str | None
    seed: int
    damage: Damage = field(default_factory=Damage)

    @property
    def duration_s(self) -> float:
        """From the first to the last sample, in seconds."""
        return self.duration_ns / NS_PER_S

    @property
    def contact_interval_ns(self) -> int:
        """Between messages of a contact topic."""
        return self.physics_step_ns * self.steps_per_contact_message


@dataclass(frozen=True, slots=True)
class LoggedMessage:
    """One message of a log.

    Attributes:
        topic: Topic.
        message_type: Type, as ``package/msg/Name``.
        log_time_ns: When the recorder received it.
        publish_time_ns: When it was sent.
        data: Serialised message.

    """

    topic: str
    message_type: str
    log_time_ns: int
    publish_time_ns: int
    data: bytes


def contact_topic(foot: str) -> str:
    """Return the name of a foot's contact topic."""
    return f"/dogbot/{foot}_contactsensor_state"


def foot_collision(foot: str) -> str:
    """Return Gazebo's name for a foot's collision: the foot is lumped into the lower leg."""
    link = f"{foot}_lowerleg"
    return f"dogbot::{link}::{link}_fixed_joint_lump__{foot}_foot_collision_5"


def transport_delay_ns(topic: str) -> int:
    """Return the fixed part of the time from a message's stamp to its log time."""
    if topic in _DELAY_NS:
        return _DELAY_NS[topic]
    rank = [contact_topic(foot) for foot in FEET].index(topic)
    return _FIRST_CONTACT_DELAY_NS + rank * _CONTACT_DELAY_STEP_NS
