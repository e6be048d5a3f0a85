"""Poses that stand in arrays of numbers, and poses at any path that a user names."""

import re
from collections.abc import Callable
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats
from dogbot_logtool.core.geometry.rotations import from_roll_pitch_yaw
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.fields import fixed_numbers, numbers
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.bases.source import BasePoses, BaseSource, pose_source, poses_of
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel

_SLICE: Final = r"([A-Za-z_][\w.]*)\[(\d{1,6}):(\d{1,6})\]"
_PATH: Final = r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*"
_EULER: Final = 6
"""Numbers of a pose with roll, pitch and yaw behind the position."""
_QUATERNION: Final = 7
"""Numbers of a pose with a quaternion x, y, z, w behind the position."""
FORMS: Final = (
    "a path to a pose, such as state.pose, or to numbers: data[0:7] (x y z and quaternion "
    "x y z w) or data[0:6] (x y z roll pitch yaw)"
)
"""Suffix that a user may write behind the topic."""


def path_source(channel: Channel, path: str) -> BaseSource:
    """Return the source of poses at a path in a channel's messages.

    Raises:
        DefinitionError: the path is none, or the messages have no pose there.
    """
    if match := re.fullmatch(_SLICE, path):
        return _slice_source(channel, match[1], slice(int(match[2]), int(match[3])))
    if not re.fullmatch(_PATH, path):
        raise DefinitionError(f"{path!r} is not {FORMS}")
    header = [("header.stamp", "header.frame_id"), ("", "")]
    names = [("position", "orientation"), ("translation", "rotation")]
    reason = ""
    for position, orientation in names:
        for stamp, world in header:
            source = pose_source(
                channel.type_name,
                path,
                position=position,
                orientation=orientation,
                stamp=stamp,
                world=world,
            )
            try:
                check_channel(channel, source.fields)
            except DefinitionError as error:
                reason = reason or str(error)
                continue
            return source
    raise DefinitionError(reason)


def _slice_source(channel: Channel, path: str, part: slice) -> BaseSource:
    size = part.stop - part.start
    if size not in (_EULER, _QUATERNION):
        raise DefinitionError(
            f"{path}[{part.start}:{part.stop}] has {size} numbers; a pose is {FORMS}"
        )
    to_pose = _from_euler if size == _EULER else _from_quaternion
    fixed = array_source(channel.type_name, path, part, to_pose, fixed=True)
    try:
        check_channel(channel, fixed.fields)
    except DefinitionError:
        source = array_source(channel.type_name, path, part, to_pose)
        check_channel(channel, source.fields)
        return source
    return fixed


def array_source(
    type_name: str,
    path: str,
    part: slice,
    to_pose: Callable[[Floats], tuple[Floats, Floats]],
    *,
    fewest: int = 0,
    fixed: bool = False,
    any_package: bool = False,
    is_planned: bool = False,
) -> BaseSource:
    """Return the source of poses in an array of numbers, of messages without a header.

    Args:
        type_name: the type.
        path: of the array.
        part: the elements that are the pose.
        to_pose: makes positions, (n, 3), and quaternions, (n, 4), of those elements, (n, k).
        fewest: elements below which an array holds no pose.
        fixed: the array's length stands in its definition.
        any_package: see `BaseSource`.
        is_planned: see `BaseSource`.
    """
    read = partial(_read_array, path=path, part=part, to_pose=to_pose, fewest=fewest, fixed=fixed)
    declared = fixed_numbers(path, max(part.stop, fewest)) if fixed else numbers(path)
    return BaseSource(
        type_name,
        (declared,),
        read,
        has_header=False,
        any_package=any_package,
        is_planned=is_planned,
    )


def _read_array(
    messages: DecodedMessages,
    element: str,
    *,
    path: str,
    part: slice,
    to_pose: Callable[[Floats], tuple[Floats, Floats]],
    fewest: int,
    fixed: bool,
) -> BasePoses:
    """Read the pose in each message's array; see `array_source`."""
    del element
    count, stop = len(messages.channel), max(part.stop, fewest)
    if fixed:
        values = messages.table.numbers(path).astype(np.float64)
    else:
        values = _by_message(messages, path, count, stop)
    position, orientation = to_pose(values[:, part])
    poses = poses_of(messages.log_time, np.zeros(count, np.int64), position, orientation)
    return BasePoses(poses, messages.channel, malformed=messages.malformed)


def _by_message(messages: DecodedMessages, path: str, count: int, elements: int) -> Floats:
    """Return the first elements of each message's array, (n, k); NaN where it has fewer than k."""
    nested = messages.table.nested(path)
    values = nested.table.numbers(ELEMENT).astype(np.float64)
    index = nested.index
    found = np.full((count, elements), np.nan)
    kept = index < elements
    found[nested.parent[kept], index[kept]] = values[kept]
    found[np.isnan(found[:, -1])] = np.nan
    return found


def _from_quaternion(values: Floats) -> tuple[Floats, Floats]:
    return values[:, :3], values[:, 3:]


def _from_euler(values: Floats) -> tuple[Floats, Floats]:
    return values[:, :3], from_roll_pitch_yaw(values[:, 3:])


def _from_yaw_first(values: Floats) -> tuple[Floats, Floats]:
    return values[:, :3], from_roll_pitch_yaw(values[:, [5, 4, 3]])


OCS2: Final = array_source(
    # Of a legged robot: momentum over mass (6), position, yaw, pitch, roll, joints.
    "ocs2_msgs/mpc_observation",
    "state.value",
    slice(6, 12),
    _from_yaw_first,
    fewest=18,
    any_package=True,
    is_planned=True,
)
