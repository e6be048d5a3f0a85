"""Which robot description the output has: the log's own, the user's file, or one of primitives."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, median_of
from dogbot_logtool.core.base.ground import nearest_axis
from dogbot_logtool.core.known_frames import KnownFrames
from dogbot_logtool.core.scene.foot_style import foot_colour
from dogbot_logtool.core.soles import Point, rounded
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.storage import content
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.robot_model.joint_motion import (
    JointMotion,
    description_channels,
    joint_motion,
)
from dogbot_logtool.robot.robot_model.primitives import body_size_m, primitive_urdf
from dogbot_logtool.robot.robot_model.skeleton import ModelFoot, Skeleton, skeleton
from dogbot_logtool.robot.robot_model.urdf import parse_urdf, said_of_left_out
from dogbot_logtool.robot.selection import Selection

_LARGEST: Final = 16 << 20
"""Bytes of a URDF that are read."""


_INSIDE: Final = 0.75
"""Hips over feet: how much nearer to the middle of the body they are assumed to be."""


@dataclass(frozen=True, slots=True)
class RobotShape:
    """The known shape of the robot."""

    forward_axis: str
    """The body axis that points forward, ``+x`` ..."""
    hips: Mapping[int, Point]
    """m, base frame: where legs are assumed to begin, by foot."""
    height_m: float
    """Height of the base above the feet."""
    size_m: float
    """Length of the body, or its height above the feet if that is more."""


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
    shape = robot_shape(selection, probe)
    frames = log_skeleton(selection, probe, base_frame)
    hips = None if frames.legs else _hips(shape, len(selection.robot.feet))
    own = sorted({channel.topic for channel in description_channels(log)}) if copy else []
    motion = joint_motion(log, probe, base_frame, given)
    hips = None if motion else hips
    moved = tuple(_moved(motion, base_frame)) if motion else ()
    if own:
        text = f"the log has its own robot description ({', '.join(own)}): none is written"
        found = (Finding("ROBOT_DESCRIPTION", text), *moved)
        return RobotDescription(None, found, hips, motion, shape.height_m)
    if given is None:
        given = primitive_urdf(
            selection.robot.name,
            frames,
            shape.forward_axis,
            selection.robot.mass_kg,
            list(shape.hips.values()),
            upright=len(selection.robot.feet) == 2,
        )
    return RobotDescription(given, moved, hips, motion, shape.height_m)


def _moved(motion: JointMotion, base_frame: str) -> Iterator[Finding]:
    """Yield findings about links that joint states move."""
    moving = sum(joint.kind != "fixed" for joint in motion.joints)
    topic = motion.channel.topic
    text = f"the log has no transforms of the links: they are computed from {topic}"
    text += f", joints: {moving}"
    if motion.left_out:
        text += f"; {said_of_left_out(motion.left_out)}"
    yield Finding("ROBOT_DESCRIPTION", text, topic)
    links = {link for pair in motion.pairs for link in pair}
    if base_frame not in links:
        yield Finding(
            "ROBOT_DESCRIPTION",
            f"the robot description has no link {base_frame}: its robot does not go along",
        )


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


def log_skeleton(selection: Selection, probe: KnownFrames, base_frame: str) -> Skeleton:
    """Return the log's frames below the base."""
    ambiguous = {child for child, parents in probe.parents.items() if len(parents) > 1}
    return skeleton(base_frame, probe.frame_poses, ambiguous, tuple(model_feet(selection, probe)))


def _hips(shape: RobotShape, feet: int) -> Floats | None:
    """Return where the lines of legs begin; None: no foot has a leg position."""
    if not shape.hips:
        return None
    nowhere = (np.nan,) * 3
    return np.array([shape.hips.get(foot, nowhere) for foot in range(feet)])


def model_feet(selection: Selection, probe: KnownFrames) -> Iterator[ModelFoot]:
    """Yield the feet whose frames are known, with the points where they touch the ground."""
    soles = rounded(probe.soles)
    for number, foot in enumerate(selection.robot.feet):
        if foot.frame is not None:
            frame, point = foot.frame.lstrip("/"), foot.contact_point_m
        else:
            link, like = link_of_foot(selection, probe, number)
            if link is None:
                continue
            frame, point = link, soles.get(number, soles.get(like, (0.0, 0.0, 0.0)))
        yield ModelFoot(foot.name, frame, point, foot_colour(number))


def link_of_foot(selection: Selection, probe: KnownFrames, number: int) -> tuple[str | None, int]:
    """Return the link of a foot, and the foot that is made like it.

    A foot that reports no contact has a link that is named as another's, but for the foot's name.
    """
    if (link := probe.links[number]) is not None:
        return link.lstrip("/"), number
    names = [foot.name for foot in selection.robot.feet]
    for like, link in enumerate(probe.links):
        if link is not None and names[like] in link:
            named = link.lstrip("/").replace(names[like], names[number])
            if named in probe.frame_poses:
                return named, like
    return None, number


def robot_shape(selection: Selection, probe: KnownFrames) -> RobotShape:
    """Return what the positions of standing feet, else the mass, tell of a robot's shape."""
    robot, stances = selection.robot, probe.stances
    length = body_size_m(robot.mass_kg)[0]
    height = length
    if stances:
        points = np.array(list(stances.values()))
        height = max(-float(median_of(points[:, 2])), 0.0) or length
        length = max(float(np.ptp(points[:, :2], axis=0).max()), 0.5 * length)
    hips = {foot: (_INSIDE * x, _INSIDE * y, 0.0) for foot, (x, y, _) in stances.items()}
    axis = _axis_by_feet(robot, stances) if selection.robot_is_guessed else None
    return RobotShape(axis or robot.forward_axis, hips, height, max(length, height))


def _axis_by_feet(robot: Robot, stances: Mapping[int, Point]) -> str | None:
    """Return the axis from hind to fore feet; None: their positions are not known."""
    ends: Sequence[list[Point]] = [
        [
            stances[number]
            for number, foot in enumerate(robot.feet)
            if number in stances and foot.leg_position is not None and foot.leg_position[0] == end
        ]
        for end in ("front", "back")
    ]
    if not all(ends):
        return None
    fore, hind = (np.mean(points, axis=0) for points in ends)
    return nearest_axis((fore - hind)[:2])
