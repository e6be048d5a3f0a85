"""A log's own robot description and joint states, and the links that these move."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import header_time
from dogbot_logtool.core.frames.kinematics import Joint, LinkTransforms, link_poses
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.legs.joints import JointTable
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.paths import path_of
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.others import JOINT_TYPES, read_joints
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.robot.robot_model.urdf import read_robot
from dogbot_logtool.robot.topics import first_batches, first_messages

_MOST_CHANNELS: Final = 16
_NOT_MEASURED: Final = ("command", "cmd", "desired", "target", "goal", "reference", "foot")
"""Words in topics whose joint states are no positions of joints."""


@dataclass(frozen=True, slots=True)
class JointMotion:
    """How joint states move the links of a robot description, where no transforms do."""

    topic: str
    joints: tuple[Joint, ...]
    left_out: int
    """Joints of the description that make no tree of links."""

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Parent and child of each joint."""
        return tuple((joint.parent, joint.child) for joint in self.joints)

    def links(self, table: JointTable) -> LinkTransforms:
        """Return the links of joint states; those that lack a joint are left out."""
        told = table.samples
        own = np.full((len(told.log_time), len(self.joints)), np.nan)
        for column, joint in enumerate(self.joints):
            if joint.measured in table.names:
                own[:, column] = told.position[:, table.names.index(joint.measured)]
        moving = np.array([joint.kind != "fixed" for joint in self.joints])
        rows = np.flatnonzero(np.isfinite(own[:, moving]).all(axis=1))
        log_time = told.log_time[rows]
        stamp = header_time(told.stamp[rows], log_time)
        return LinkTransforms(log_time, stamp, link_poses(self.joints, own[rows]))


def joint_motion(
    log: Log, probe: KnownFrames, base: str, description: str | None
) -> JointMotion | None:
    """Return how joint states move the links; None: they do not, or transforms do already.

    Args:
        log: the log.
        probe: the frames that its transforms place.
        base: the base's frame.
        description: URDF; None: the log's own, if it has one.
    """
    channel = next(iter(joint_channels(log)), None)
    if channel is None:
        return None
    urdf = own_description(log) if description is None else description
    try:
        robot = read_robot(urdf or "")
    except ValueError:
        return None
    named = joint_names(log, channel)
    kept = tuple(
        joint
        for joint in robot.joints
        if joint.child not in {*probe.parents, base}
        and (joint.kind == "fixed" or joint.measured in named)
    )
    moves = any(joint.kind != "fixed" for joint in kept)
    return JointMotion(channel.topic, kept, robot.left_out) if moves else None


def description_channels(log: Log) -> Sequence[Channel]:
    """Return the channels that describe a robot."""
    return [
        channel
        for channel in log.channels.values()
        if channel.topic.rpartition("/")[2] == "robot_description"
        and channel.type_name == "std_msgs/String"
        and log.counts.get(channel.id, 1)
    ]


def own_description(log: Log) -> str | None:
    """Return the log's first robot description; None: it has none that can be read."""
    for channel in description_channels(log):
        try:
            urdf = path_of("data", "text", definition_of(channel))
        except DefinitionError:
            continue
        for messages in first_messages(log, channel, urdf.columns):
            if len(messages.channel):
                return urdf.texts(messages.table)[1].text(0)
    return None


def joint_channels(log: Log) -> list[Channel]:
    """Return the first channels of joints' measured states: best type, then shortest topic."""
    found = []
    for channel in log.channels.values():
        words = channel.topic.lower()
        if any(word in words for word in _NOT_MEASURED):
            continue
        source = source_of(channel, "joints")
        if source is not None and not source.fault and log.counts.get(channel.id, 1):
            found.append(channel)
    found.sort(key=lambda each: (JOINT_TYPES.index(each.type_name), len(each.topic), each.topic))
    return found[:_MOST_CHANNELS]


def joint_names(log: Log, channel: Channel) -> frozenset[str]:
    """Return the joints that the first messages of a channel name."""
    for batch in first_batches(log, channel):
        for told, _ in read_joints(batch, channel):
            if len(told.samples.log_time):
                return frozenset(told.names)
    return frozenset()
