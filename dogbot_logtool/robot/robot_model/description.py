"""A robot's description: the log's own, the user's file, or one of primitives; its moving links."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, header_time
from dogbot_logtool.core.frames.kinematics import Joint, LinkTransforms, link_poses
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.recording import JointTable
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.io.storage import content
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.paths import path_of
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.robot.robot_model.primitives import primitive_urdf
from dogbot_logtool.robot.robot_model.skeleton import robot_shape, skeleton
from dogbot_logtool.robot.robot_model.urdf import RobotOfUrdf, left_out_text, parse_urdf, read_robot
from dogbot_logtool.robot.selection import Selection
from dogbot_logtool.robot.topics import first_messages

_LARGEST: Final = 16 << 20
"""Bytes of a URDF that are read."""


def read_urdf(file: Path) -> str:
    """Read and check a URDF.

    Raises:
        CallError: it cannot be read, is too large, is no XML with a root `robot`, or declares
            entities, which viewers might fetch.
    """
    try:
        data = content(file, _LARGEST)
        if data is None:
            raise ValueError(f"is larger than {_LARGEST >> 20} MiB")
        text = data.decode("utf-8-sig")
        parse_urdf(text)
    except CallError as error:
        raise CallError(f"--urdf {error}") from None
    except OSError as error:
        raise CallError(f"--urdf {file}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise CallError(f"--urdf {file}: is not UTF-8 text") from None
    except ValueError as error:
        raise CallError(f"--urdf {file}: {error}") from None
    return text


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


@dataclass(frozen=True, slots=True)
class Model:
    """The robot's description, the log's own or the user's."""

    robot: RobotOfUrdf | None
    why_none: str = ""
    """Why there is none that can be used."""
    call: str = ""
    """A call that would give one."""


def read_model(log: Log, urdf: Path | None) -> Model:
    """Read the user's description, or else the log's.

    Raises:
        CallError: the user's file is no URDF.
    """
    text = own_description(log) if urdf is None else read_urdf(urdf)
    if text is None:
        call = shell_joined(["dogbot-logtool", "stats", *log.words, "--urdf", "ROBOT.urdf"])
        return Model(None, "the log has no robot description, which says how the legs go", call)
    try:
        return Model(read_robot(text))
    except ValueError as error:
        return Model(None, f"the robot description {error}")


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
        return LinkTransforms(log_time, stamp, *link_poses(self.joints, own[rows]))


def joint_motion(robot: RobotOfUrdf, walk: Walk) -> JointMotion | None:
    """Return how joint states move the links; None: they do not, or transforms do already."""
    table = next(iter(walk.recording.joints), None)
    placed = {*walk.frames.parents, walk.frames.base}
    kept = tuple(
        joint
        for joint in robot.joints
        if joint.child not in placed
        and table is not None
        and (joint.kind == "fixed" or joint.measured in table.names)
    )
    if table is None or all(joint.kind == "fixed" for joint in kept):
        return None
    return JointMotion(table.topic, kept, robot.left_out)


@dataclass(frozen=True, slots=True)
class RobotDescription:
    """The content of `/robot_description`."""

    urdf: str | None
    """None: nothing."""
    findings: tuple[Finding, ...] = ()
    hips: Floats | None = None
    """(feet, 3) m, base frame: where lines to standing feet begin, NaN where not known; None: the
    legs move by transforms, or no foot has a leg position."""
    motion: JointMotion | None = None
    """How joint states move its links; None: they do not."""
    height_m: float = 1.0
    """Height of the base above the feet."""


def robot_description(
    log: Log,
    selection: Selection,
    frames: KnownFrames,
    motion: JointMotion | None,
    urdf: Path | None,
    *,
    copy: bool,
) -> RobotDescription:
    """Choose the robot description.

    Args:
        log: its own description stays as it is.
        selection: the robot's feet.
        frames: the log's frames.
        motion: how joint states move links; None: they do not.
        urdf: the user's file; None: not given.
        copy: whether the log's messages are in the output.

    Raises:
        CallError: the user's file is no URDF.
    """
    given = None if urdf is None else read_urdf(urdf)
    shape, feet = robot_shape(selection, frames), selection.robot.feet
    bones = skeleton(selection, frames, frames.base)
    hips = None
    if shape.hips and not (bones.legs or motion):
        nowhere = (np.nan,) * 3
        hips = np.array([shape.hips.get(foot, nowhere) for foot in range(len(feet))])
    own = sorted({channel.topic for channel in description_channels(log)}) if copy else []
    told = list(_moved(motion, frames.base)) if motion else []
    if own:
        told = [found("ROBOT_DESCRIPTION", say="own", topics=", ".join(own)), *told]
    elif given is None:
        given = primitive_urdf(selection.robot, bones, shape)
    return RobotDescription(None if own else given, tuple(told), hips, motion, shape.height_m)


def _moved(motion: JointMotion, base_frame: str) -> Iterator[Finding]:
    """Yield findings about links that joint states move."""
    moving = sum(joint.kind != "fixed" for joint in motion.joints)
    left_out = f"; {left_out_text(motion.left_out)}" if motion.left_out else ""
    topic = motion.topic
    yield found("ROBOT_DESCRIPTION", say="moved", topic=topic, joints=moving, left_out=left_out)
    if base_frame not in {link for pair in motion.pairs for link in pair}:
        yield found("ROBOT_DESCRIPTION", say="no_base", base=base_frame)


def without_legs(reason: str, call: str) -> Finding:
    """Say why there is no gait, with a call that would give one; empty: none is known."""
    told = found("NO_FEET", say="joints", reason=reason)
    text = f"{told.text}; with it, this measures the gait: {call}" if call else told.text
    return replace(told, text=text, command=call)
