"""Poses of the base, read of messages by any row of the table."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import Odometry, concatenate_odometry
from dogbot_logtool.core.rotations import from_roll_pitch_yaw
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.columns import Table, Texts
from dogbot_logtool.reader.decode.paths import FieldPath
from dogbot_logtool.reader.messages.message_type import BASE, MessageType
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    decode_channels,
)
from dogbot_logtool.reader.messages.source import (
    BASE_TYPES,
    Source,
    base_type,
    fitting,
)

ODOMETRY_TYPE: Final = "nav_msgs/Odometry"
FORMS: Final = (
    "a path to a pose, such as state.pose, or to numbers: data[0:7] (x y z and quaternion "
    "x y z w) or data[0:6] (x y z roll pitch yaw)"
)
"""Suffix that a user may write behind the topic."""
_SLICE: Final = r"([A-Za-z_][\w.]*)\[(\d{1,6}):(\d{1,6})\]"
_PATH: Final = r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*"
_ANGLES, _QUATERNION = 6, 7
"""Numbers of a pose with roll, pitch and yaw, or a quaternion, behind the position."""
_JOINTS: Final = 6
"""Of a base that is told as a list of joints: roll, pitch, yaw, x, y, z."""
_ORDERS: Final = {
    "wxyz": [1, 2, 3, 0],
    "xyz": [0, 1, 2],
    "zyx": [2, 1, 0],
}


@dataclass(frozen=True, slots=True)
class BasePoses:
    """Poses of the base that messages of one definition hold, in file order."""

    poses: Odometry
    channel: Ints
    """(n,) channel id of each pose."""
    worlds: tuple[str, ...] = ()
    """Frames that the poses are in, as recorded; also `bases`, the frames that they place."""
    bases: tuple[str, ...] = ()
    malformed: Mapping[int, int] = field(default_factory=dict)
    """Messages that could not be decoded, by channel id."""


@dataclass(frozen=True, slots=True)
class Base:
    """The source of the base's poses."""

    source: Source
    element: str = ""
    """Which of the poses in a message: a model, a link, a pair of frames; empty: the only one."""

    def read(self, batch: Batch, channels: Sequence[Channel]) -> list[BasePoses]:
        """Read the poses of a batch; one entry a definition, nearly always one."""
        decoded = decode_channels(batch, channels, self.source.fields)
        return [read_base(self.source, messages, self.element) for messages in decoded]


def base_types(channels: Iterable[Channel]) -> frozenset[str]:
    """Return the types that hold poses: all that are known, and those of channels read as such."""
    own = {channel.type_name for channel in channels}
    return frozenset({*BASE_TYPES, *(name for name in own if base_type(name))})


def joined_poses(parts: Sequence[BasePoses]) -> Odometry:
    """Return all poses, in the order of the log."""
    return concatenate_odometry([part.poses for part in parts])


def read_base(source: Source, messages: DecodedMessages, element: str = "") -> BasePoses:
    """Return the poses of messages; of those that list several, the poses of one element."""
    if source.lists_poses:
        return _chosen_poses(source, messages, element)
    if source.row.numbered:
        position, orientation = _poses_of_joints(source, messages.table)
        return _poses(source, messages, slice(None), position, orientation)
    path, table = source.paths["position"][0], messages.table
    message: Ints | slice = slice(None)
    if path.is_array_of_elements:
        held = np.bincount(table.nested(path.arrays[0].path).parent, minlength=table.rows)
        message = np.flatnonzero(held)
    values = [
        source.paths[name][0].first_values(table)[message]
        for name in ("position", "orientation", "linear", "angular")
        if name in source.paths
    ]
    return _poses(source, messages, message, *values)


def choices(source: Source, messages: DecodedMessages) -> frozenset[str]:
    """Return what messages hold poses of: models, links, pairs of frames."""
    return frozenset(name for name, _ in _names(source, messages.table)[1])


def _pair_name(parent: str, child: str) -> str:
    """Return the name of a pair of frames, without leading slashes."""
    return f"{parent.lstrip('/')}/{child.lstrip('/')}"


def _names(source: Source, table: Table) -> tuple[Ints, list[tuple[str, tuple[str, ...]]]]:
    """Return which name each listed pose has, (m,), and the names with their parts."""
    texts = [path.texts(table)[1] for path in source.paths["choose"]]
    if len(texts) == 1:
        code, names = texts[0].encode()
        return code, [(name, ()) for name in names]
    code, pairs = _pairs_of(*texts)
    return code, [(_pair_name(*pair), pair) for pair in pairs]


def _pairs_of(first: Texts, second: Texts) -> tuple[Ints, list[tuple[str, str]]]:
    """Return which pair each two texts are, (m,), and the different pairs."""
    (one, ones), (other, others) = first.encode(), second.encode()
    different, code = np.unique(one * max(len(others), 1) + other, return_inverse=True)
    pairs = [divmod(number, len(others)) for number in different.tolist()]
    return code, [(ones[row], others[column]) for row, column in pairs]


def _chosen_poses(source: Source, messages: DecodedMessages, element: str) -> BasePoses:
    """Return the poses of an element, wherever in each message it stands."""
    table, (name, *_) = messages.table, source.paths["choose"]
    code, names = _names(source, table)
    wanted = [number for number, (each, _) in enumerate(names) if each == element]
    named = np.flatnonzero(np.isin(code, wanted))
    named = named[np.argsort(name.texts(table)[0][named], kind="stable")]
    position, orientation = source.paths["position"][0], source.paths["orientation"][0]
    beside = position.rows_beside(table, name)
    rows = named if beside is None else beside[named]
    named, rows = named[rows >= 0], rows[rows >= 0]
    message = name.texts(table)[0][named]
    stamp = source.paths["stamp"][0].times(table)[rows] if source.has_header else None
    parts = [names[number][1] for number in wanted]
    found = _poses(
        source,
        messages,
        message,
        position.all_values(table)[rows],
        orientation.all_values(table)[rows],
        stamp=stamp,
    )
    if not source.is_transform:
        return found
    worlds, bases = ({pair[side] for pair in parts} for side in (0, 1))
    return BasePoses(
        found.poses,
        found.channel,
        tuple(sorted(worlds)),
        tuple(sorted(bases)),
        found.malformed,
    )


def _poses_of_joints(source: Source, table: Table) -> tuple[Floats, Floats]:
    """Return positions, (n, 3) m, NaN where one is missing, and roll, pitch, yaw, (n, 3) rad."""
    number, position = source.paths["numbered"]
    nested = table.nested(number.arrays[0].path)
    joint = number.all_values(table)[:, 0].astype(np.int64)
    known = (joint >= 0) & (joint < _JOINTS)
    values = np.full((table.rows, _JOINTS), np.nan)
    # A base that cannot turn has no joints for it.
    values[:, :3] = 0.0
    values[nested.parent[known], joint[known]] = position.all_values(table)[known, 0]
    return values[:, 3:], values[:, :3]


def _poses(
    source: Source,
    messages: DecodedMessages,
    message: Ints | slice,
    position: Floats,
    orientation: Floats,
    linear: Floats | None = None,
    angular: Floats | None = None,
    *,
    stamp: Ints | None = None,
) -> BasePoses:
    """Return poses of some messages as columns; without velocities these are NaN."""
    if source.row.turned != "xyzw":
        orientation = orientation[:, _ORDERS[source.row.turned]]
    if len(source.row.turned) < len("xyzw"):
        orientation = from_roll_pitch_yaw(orientation)
    unknown = np.full((len(position), 3), np.nan)
    poses = Odometry(
        log_time=messages.log_time[message],
        stamp=source.stamps(messages)[message] if stamp is None else stamp,
        position=position,
        orientation=orientation,
        linear_velocity=unknown if linear is None else linear,
        angular_velocity=unknown if angular is None else angular,
    )
    worlds, bases = (_texts(source.paths.get(name), messages.table) for name in ("frame", "body"))
    return BasePoses(poses, messages.channel[message], worlds, bases, messages.malformed)


def _texts(paths: Sequence[FieldPath] | None, table: Table) -> tuple[str, ...]:
    return paths[0].texts(table)[1].encode()[1] if paths else ()


def path_source(channel: Channel, path: str) -> Source:
    """Return the source of poses at a path in a channel's messages, as ``--odom-topic`` names it.

    Raises:
        DefinitionError: the path is none, or the messages have no pose there.
    """
    if re.fullmatch(_SLICE, path) or re.fullmatch(_PATH, path):
        return fitting(channel, _rows_of_words(channel.type_name, path), BASE)
    raise DefinitionError(f"{path!r} is not {FORMS}")


def _rows_of_words(type_name: str, path: str) -> Iterator[MessageType]:
    """Yield the rows that may read poses at a path."""
    if match := re.fullmatch(_SLICE, path):
        name, first, last = match[1], int(match[2]), int(match[3])
        size = last - first
        if size not in {_ANGLES, _QUATERNION}:
            raise DefinitionError(f"{path} has {size} numbers; a pose is {FORMS}")
        whole = f" of {last}+]"
        yield MessageType(
            type_name,
            stamp="",
            frame="",
            turned="xyz" if size == _ANGLES else "xyzw",
            position=f"{name}[{first}:{first + 3} by 3{whole}",
            orientation=f"{name}[{first + 3}:{last} by {size - 3}{whole}",
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
