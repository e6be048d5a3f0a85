"""Which robot description the output has: the log's own, the user's file, or one of primitives."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.storage import content
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.robot_model.joints_of_log import (
    JointMotion,
    description_channels,
    joint_motion,
)
from dogbot_logtool.robot.robot_model.primitives import primitive_urdf
from dogbot_logtool.robot.robot_model.skeleton import robot_shape, skeleton
from dogbot_logtool.robot.robot_model.urdf import parse_urdf, said_of_left_out
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
    found = _moved(motion, base_frame) if motion else []
    if own:
        text = f"the log has its own robot description ({', '.join(own)}): none is written"
        found = [Finding("ROBOT_DESCRIPTION", text), *found]
    elif given is None:
        given = primitive_urdf(
            selection.robot.name,
            frames,
            shape.forward_axis,
            selection.robot.mass_kg,
            list(shape.hips.values()),
            upright=len(feet) == 2,
        )
    return RobotDescription(None if own else given, tuple(found), hips, motion, shape.height_m)


def _moved(motion: JointMotion, base_frame: str) -> list[Finding]:
    """Return findings about links that joint states move."""
    moving = sum(joint.kind != "fixed" for joint in motion.joints)
    text = (
        f"the log has no transforms of the links: they are computed from {motion.topic}, joints: "
        f"{moving}"
    )
    text += f"; {said_of_left_out(motion.left_out)}" if motion.left_out else ""
    found = [Finding("ROBOT_DESCRIPTION", text, motion.topic)]
    if base_frame not in {link for pair in motion.pairs for link in pair}:
        text = f"the robot description has no link {base_frame}: its robot does not go along"
        found.append(Finding("ROBOT_DESCRIPTION", text))
    return found


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
