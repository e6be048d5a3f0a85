"""A robot's description: the log's own, the user's file, or one of primitives; its moving links."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, header_time
from dogbot_logtool.core.frames.kinematics import Joint, LinkTransforms, link_poses
from dogbot_logtool.core.recording import JointTable
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.io.toml_table import read_text
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.paths import path_of
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.robot.robot_model.drawing import primitive_urdf, robot_shape, skeleton
from dogbot_logtool.robot.robot_model.urdf import RobotOfUrdf, parse_urdf, read_robot
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
        text = read_text(file, "a URDF", _LARGEST)
        parse_urdf(text)
    except CallError as error:
        raise CallError(f"--urdf {error}") from None
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


class Model(NamedTuple):
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


class RobotDescription(NamedTuple):
    """The content of `/robot_description`."""

    urdf: str | None
    """None: nothing."""
    findings: tuple[Finding, ...] = ()
    hips: Floats | None = None
    """(feet, 3) m, base frame: where lines to standing feet begin, NaN where not known; None: the
    legs move by transforms, or no foot has a leg position."""
    joints: tuple[Joint, ...] = ()
    """Those by which joint states move its links, where no transforms do."""
    height_m: float = 1.0
    """Height of the base above the feet."""


def robot_description(
    log: Log, selection: Selection, model: RobotOfUrdf | None, walk: Walk, options: ConvertOptions
) -> RobotDescription:
    """Choose the robot description.

    Args:
        log: its own description stays as it is.
        selection: the robot's feet.
        model: the robot's description, where joint states move it.
        walk: what was measured.
        options: with the user's file, and whether the log's messages are in the output.

    Raises:
        CallError: the user's file is no URDF.
    """
    urdf = None if options.urdf is None else read_urdf(options.urdf)
    frames = walk.frames
    shape, bones = robot_shape(walk), skeleton(selection, frames, {})
    joints = _moved_joints(model, walk) if model and options.tf != "never" else ()
    hips = None
    if shape.hips and not (bones.legs or joints):
        feet, nowhere = range(len(selection.robot.feet)), (np.nan,) * 3
        hips = np.array([shape.hips.get(foot, nowhere) for foot in feet])
    own = sorted({channel.topic for channel in description_channels(log)}) if options.copy else []
    told = [found("ROBOT_DESCRIPTION", say="own", topics=", ".join(own))] if own else []
    if model and joints:
        moving, topic = sum(each.kind != "fixed" for each in joints), walk.recording.joints[0].topic
        told.append(found("ROBOT_DESCRIPTION", say="moved", topic=topic, joints=f"{moving}"))
        if frames.base not in {link for joint in joints for link in (joint.parent, joint.child)}:
            told.append(found("ROBOT_DESCRIPTION", say="no_base", base=frames.base))
    if not own and urdf is None:
        urdf = primitive_urdf(selection.robot, bones, shape)
    return RobotDescription(None if own else urdf, tuple(told), hips, joints, shape.height_m)


def _moved_joints(model: RobotOfUrdf, walk: Walk) -> tuple[Joint, ...]:
    """Return the joints by which joint states move links; none: they do not, or transforms do."""
    placed = {*walk.frames.parents, walk.frames.base}
    told = next((table.names for table in walk.recording.joints), ())
    kept = tuple(
        joint
        for joint in model.joints
        if joint.child not in placed and (joint.kind == "fixed" or joint.measured in told)
    )
    return kept if any(joint.kind != "fixed" for joint in kept) else ()


def moved_links(joints: Sequence[Joint], table: JointTable) -> LinkTransforms:
    """Return the links of joint states; those that lack a joint are left out."""
    told = table.samples
    own = np.full((len(told.log_time), len(joints)), np.nan)
    for column, joint in enumerate(joints):
        if joint.measured in table.names:
            own[:, column] = told.position[:, table.names.index(joint.measured)]
    moving = np.array([joint.kind != "fixed" for joint in joints])
    rows = np.flatnonzero(np.isfinite(own[:, moving]).all(axis=1))
    log_time = told.log_time[rows]
    poses = link_poses(joints, own[rows])
    return LinkTransforms(log_time, header_time(told.stamp[rows], log_time), *poses)


def without_legs(reason: str, call: str) -> Finding:
    """Say why there is no gait, with a call that would give one; empty: none is known."""
    told = found("NO_FEET", say="joints", reason=reason)
    text = f"{told.text}; with it, this measures the gait: {call}" if call else told.text
    return replace(told, text=text, command=call)
