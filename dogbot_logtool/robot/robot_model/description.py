"""Which robot description the output has: the log's own, the user's file, or one of primitives."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import shell_joined
from dogbot_logtool.io.storage import content
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.robot_model.joints_of_log import (
    JointMotion,
    description_channels,
    joint_motion,
    own_description,
)
from dogbot_logtool.robot.robot_model.primitives import primitive_urdf
from dogbot_logtool.robot.robot_model.skeleton import robot_shape, skeleton
from dogbot_logtool.robot.robot_model.urdf import (
    RobotOfUrdf,
    parse_urdf,
    read_robot,
    said_of_left_out,
)
from dogbot_logtool.robot.selection import Selection

_LARGEST: Final = 16 << 20
"""Bytes of a URDF that are read."""


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
    probe: KnownFrames,
    base_frame: str,
    urdf: Path | None,
    *,
    copy: bool,
) -> RobotDescription:
    """Choose the robot description.

    Args:
        log: its own description stays as it is.
        selection: the robot's feet.
        probe: the log's frames.
        base_frame: the base's frame.
        urdf: the user's file; None: not given.
        copy: whether the log's messages are in the output.

    Raises:
        CallError: the user's file is no URDF.
    """
    given = None if urdf is None else read_urdf(urdf)
    shape, feet = robot_shape(selection, probe), selection.robot.feet
    frames = skeleton(selection, probe, base_frame)
    motion = joint_motion(log, probe, base_frame, given)
    hips = None
    if shape.hips and not (frames.legs or motion):
        nowhere = (np.nan,) * 3
        hips = np.array([shape.hips.get(foot, nowhere) for foot in range(len(feet))])
    own = sorted({channel.topic for channel in description_channels(log)}) if copy else []
    told = list(_moved(motion, base_frame)) if motion else []
    if own:
        told = [found("ROBOT_DESCRIPTION", say="own", topics=", ".join(own)), *told]
    elif given is None:
        given = primitive_urdf(
            selection.robot.name,
            frames,
            shape.forward_axis,
            selection.robot.mass_kg,
            list(shape.hips.values()),
            upright=len(feet) == 2,
        )
    return RobotDescription(None if own else given, tuple(told), hips, motion, shape.height_m)


def _moved(motion: JointMotion, base_frame: str) -> Iterator[Finding]:
    """Yield findings about links that joint states move."""
    moving = sum(joint.kind != "fixed" for joint in motion.joints)
    left_out = f"; {said_of_left_out(motion.left_out)}" if motion.left_out else ""
    topic = motion.topic
    yield found("ROBOT_DESCRIPTION", say="moved", topic=topic, joints=moving, left_out=left_out)
    if base_frame not in {link for pair in motion.pairs for link in pair}:
        yield found("ROBOT_DESCRIPTION", say="no_base", base=base_frame)


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


def without_legs(reason: str, call: str) -> Finding:
    """Say why there is no gait, with a call that would give one; empty: none is known."""
    told = found("NO_FEET", say="joints", reason=reason)
    text = f"{told.text}; with it, this measures the gait: {call}" if call else told.text
    return replace(told, text=text, command=call)
