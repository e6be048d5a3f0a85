"""Poses of the base, read of messages by any row of the table."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.rotations import from_roll_pitch_yaw
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.messages.message_type import MessageType
from dogbot_logtool.reader.messages.messages import DecodedMessages, decode_channels
from dogbot_logtool.reader.messages.source import Source, Topic, first_fitting

ODOMETRY_TYPE: Final = "nav_msgs/Odometry"
FORMS: Final = (
    "a path to a pose, such as state.pose, or to numbers: data[0:7] (x y z and quaternion "
    "x y z w) or data[0:6] (x y z roll pitch yaw)"
)
"""Suffix that a user may write behind the topic."""
_PATH: Final = r"([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*)(?:\[(\d{1,6}):(\d{1,6})\])?"
_ANGLES, _QUATERNION = 6, 7
"""Numbers of a pose with roll, pitch and yaw, or a quaternion, behind the position."""
_JOINTS: Final = 6
"""Of a base that is told as a list of joints: roll, pitch, yaw, x, y, z."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BasePoses:
    """Poses of the base that messages of one definition hold, in file order."""

    poses: Odometry
    channel: Ints
    """(n,) channel id of each pose."""
    worlds: tuple[str, ...] = ()
    """Frames that the poses are in, as recorded; also `bases`, the frames that they place."""
    bases: tuple[str, ...] = ()
    has_stamps: bool = False
    """Each message has one pose and a stamp."""


def read_base(base: Topic, batch: Batch) -> list[BasePoses]:
    """Read the base's poses of a batch; one entry a definition, nearly always one."""
    decoded = decode_channels(batch, base.channels, base.source.columns)
    return [_read(base.source, messages, base.element) for messages in decoded]


def _read(source: Source, messages: DecodedMessages, element: str) -> BasePoses:
    """Return the poses of messages; of those that list several, the poses of one element."""
    table, paths = messages.table, source.paths
    if source.row.choose:
        return _chosen_poses(source, messages, element)
    if source.row.numbered:
        return _poses(source, messages, np.arange(table.rows), _poses_of_joints(source, table))
    message = np.arange(table.rows)
    if paths["position"][0].is_array_of_elements:
        message = np.unique(table.nested(paths["position"][0].arrays[0].path).parent)
    names = ("position", "orientation", "linear")
    values = {name: paths[name][0].first_values(table)[message] for name in names if name in paths}
    return _poses(source, messages, message, values)


def choices(source: Source, messages: DecodedMessages) -> dict[str, tuple[str, ...]]:
    """Return what messages hold poses of: models, links, pairs of frames; with the two frames."""
    return {_name(parts): parts for parts in chosen_names(source, messages.table)[1]}


def _name(parts: Sequence[str]) -> str:
    return "/".join(part.lstrip("/") for part in parts)


def chosen_names(source: Source, table: Table) -> tuple[Ints, list[tuple[str, ...]]]:
    """Return which names each listed pose has, (m,), and these: one, or two frames."""
    (code, names), *others = (path.texts(table)[1].encode() for path in source.paths["choose"])
    if not others:
        return code, [(name,) for name in names]
    ((other, other_names),) = others
    different, pair = np.unique(code * max(len(other_names), 1) + other, return_inverse=True)
    rows = (divmod(number, len(other_names)) for number in different.tolist())
    return pair, [(names[row], other_names[column]) for row, column in rows]


def _chosen_poses(source: Source, messages: DecodedMessages, element: str) -> BasePoses:
    """Return the poses of an element, wherever in each message it stands."""
    table, paths, name = messages.table, source.paths, source.paths["choose"][0]
    code, names = chosen_names(source, table)
    wanted = [number for number, parts in enumerate(names) if _name(parts) == element]
    message_of, _ = name.texts(table)
    named = np.flatnonzero(np.isin(code, wanted))
    rows = paths["position"][0].rows_beside(table, name)[named]
    named, rows = named[rows >= 0], rows[rows >= 0]
    values = {key: paths[key][0].all_values(table)[rows] for key in ("position", "orientation")}
    stamp = paths["stamp"][0].times(table)[rows] if source.has_header else None
    frames = None
    if source.is_transform:
        sides = zip(*(names[number] for number in wanted), strict=True)
        worlds, bases = (tuple(sorted(set(side))) for side in sides) if wanted else ((), ())
        frames = (worlds, bases)
    return _poses(source, messages, message_of[named], values, stamp, frames)


def _poses_of_joints(source: Source, table: Table) -> Mapping[str, Floats]:
    """Return positions, (n, 3) m, NaN where one is missing, and roll, pitch, yaw, (n, 3) rad."""
    number, position = source.paths["numbered"]
    parent = table.nested(number.arrays[0].path).parent
    joint = number.all_values(table)[:, 0].astype(np.int64)
    known = (joint >= 0) & (joint < _JOINTS)
    values = np.full((table.rows, _JOINTS), np.nan)
    # A base that cannot turn has no joints for it.
    values[:, :3] = 0.0
    values[parent[known], joint[known]] = position.all_values(table)[known, 0]
    return {"position": values[:, 3:], "orientation": values[:, :3]}


def _poses(
    source: Source,
    messages: DecodedMessages,
    message: Ints,
    values: Mapping[str, Floats],
    stamp: Ints | None = None,
    frames: tuple[tuple[str, ...], tuple[str, ...]] | None = None,
) -> BasePoses:
    """Return poses of some messages.

    Args:
        source: of the messages.
        messages: all.
        message: (n,) the message of each pose.
        values: by the row's field, (n, w); without velocities these are NaN.
        stamp: (n,) ns; None: that of the message.
        frames: worlds and bases; None: those that headers and bodies name.
    """
    turned = source.row.turned
    axes = "xyz" if len(turned) < len("xyzw") else "xyzw"
    orientation = values["orientation"][:, [turned.index(axis) for axis in axes]]
    if axes == "xyz":
        orientation = from_roll_pitch_yaw(orientation)
    unknown = np.full((len(message), 3), np.nan)
    poses = Odometry(
        log_time=messages.log_time[message],
        stamp=source.stamps(messages)[message] if stamp is None else stamp,
        position=values["position"],
        orientation=orientation,
        linear_velocity=values.get("linear", unknown),
    )
    worlds, bases = frames or (
        path[0].texts(messages.table)[1].encode()[1] if path else ()
        for path in (source.paths.get("frame"), source.paths.get("body"))
    )
    return BasePoses(poses, messages.channel[message], worlds, bases, source.has_one_stamp)


def path_source(channel: Channel, path: str) -> Source:
    """Return the source of poses at a path in a channel's messages, as ``--odom-topic`` names it.

    Raises:
        DefinitionError: the path is none, or the messages have no pose there.
    """
    source = first_fitting(channel, _rows_of_words(channel.type_name, path), "base")
    if source.fault:
        raise DefinitionError(source.fault)
    return source


def _rows_of_words(type_name: str, path: str) -> Iterator[MessageType]:
    """Yield the rows that may read poses at a path.

    Raises:
        DefinitionError: the path is none.
    """
    match = re.fullmatch(_PATH, path)
    if match is None:
        raise DefinitionError(f"{path!r} is not {FORMS}")
    if match[2]:
        name, first, last = match[1], int(match[2]), int(match[3])
        size = last - first
        if size not in {_ANGLES, _QUATERNION}:
            raise DefinitionError(f"{path} has {size} numbers; a pose is {FORMS}")
        yield MessageType(
            type_name,
            stamp="",
            frame="",
            turned="xyz" if size == _ANGLES else "xyzw",
            position=f"{name}[{first}:{first + 3} by 3 of {last}+]",
            orientation=f"{name}[{first + 3}:{last} by {size - 3} of {last}+]",
        )
        return
    for position, orientation in (("position", "orientation"), ("translation", "rotation")):
        yield MessageType(
            type_name,
            stamp="header.stamp|",
            frame="header.frame_id|",
            position=f"{path}.{position}",
            orientation=f"{path}.{orientation}",
        )
