"""Joint states of ROS, Foxglove and Unitree's motors: positions, velocities and efforts by name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.columns import Texts
from dogbot_logtool.reader.decode.paths import FieldPath
from dogbot_logtool.reader.messages.message_type import JOINTS
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, decode_channels
from dogbot_logtool.reader.messages.source import Source, fitting
from dogbot_logtool.reader.messages.table import TABLE

_MOST_CELLS: Final = 1 << 22
"""Values in a matrix of messages and joints: 32 MB."""


@dataclass(frozen=True, slots=True)
class JointStates:
    """Values of k joints in n messages, in the order of the log; NaN where a message has none."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, header stamp as recorded; 0: none."""
    names: tuple[str, ...]
    position: Floats
    """(n, k) rad or m."""
    velocity: Floats
    """(n, k) rad/s or m/s."""
    effort: Floats
    """(n, k) N m or N."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""


JOINT_TYPES: Final = tuple(
    row.name for row in sorted(TABLE, key=lambda row: not row.joint) if row.joint_position
)
"""The best first: those that name their joints."""
_VALUES: Final = ("joint_position", "joint_velocity", "joint_effort")


def check_joints(channel: Channel) -> str:
    """Check that a channel's messages tell of joints and can be decoded; see `check_channel`.

    Raises:
        DefinitionError: they do not, or cannot.
    """
    return check_channel(channel, _source(channel).fields)


def read_joints(batch: Batch, channel: Channel) -> list[JointStates]:
    """Read the joint states of a batch that a channel has, one entry a definition.

    Args:
        batch: the batch.
        channel: one that `check_joints` accepts.
    """
    source = _source(channel)
    decoded = decode_channels(batch, [channel], source.fields)
    return [_read(source, messages) for messages in decoded]


@lru_cache(maxsize=256)
def _source(channel: Channel) -> Source:
    if channel.type_name not in JOINT_TYPES:
        raise DefinitionError("it tells of no joints")
    rows = (row for row in TABLE if row.name == channel.type_name and row.joint_position)
    return fitting(channel, rows, JOINTS)


def _read(source: Source, messages: DecodedMessages) -> JointStates:
    paths = [source.paths[name][0] for name in _VALUES]
    if not source.row.joint:
        return _read_numbered(source, messages, paths, source.row.joints)
    name = source.paths["joint"][0]
    if not len(messages.table.nested(name.arrays[0].path).parent):
        # Some publishers leave the names out; positions keep their order.
        count = len(messages.table.nested(paths[0].arrays[0].path).parent)
        width = -(-count // max(len(messages.channel), 1))
        numbered = tuple(f"joint_{number}" for number in range(width))
        return _read_numbered(source, messages, paths, numbered)
    alike = _read_alike(source, messages, name, paths)
    if alike is not None:
        return alike
    parent, texts = name.texts(messages.table)
    joint, names = texts.encode()
    values = [path.beside(messages.table, name)[:, 0] for path in paths]
    return _matrices(messages, source.stamps(messages), names, parent, joint, values)


def _read_numbered(
    source: Source, messages: DecodedMessages, paths: Sequence[FieldPath], names: tuple[str, ...]
) -> JointStates:
    """Read joints that messages do not name, by their numbers."""
    told = messages.table.nested(paths[0].arrays[0].path)
    rows = np.flatnonzero(told.index < len(names))
    values = []
    for path in paths:
        own = path.all_values(messages.table)[:, 0]
        # Arrays that some publishers leave empty.
        values.append(own[rows] if len(own) == len(told.parent) else np.full(len(rows), np.nan))
    stamp = source.stamps(messages)
    return _matrices(messages, stamp, names, told.parent[rows], told.index[rows], values)


def _matrices(
    messages: DecodedMessages,
    stamp: Ints,
    names: tuple[str, ...],
    parent: Ints,
    joint: Ints,
    values: Sequence[Floats],
) -> JointStates:
    """Return values as matrices.

    Joints are left out where messages that each name others would make the matrices huge.

    Args:
        messages: n messages.
        stamp: (n,) ns.
        names: of k joints.
        parent: (m,) message of each value.
        joint: (m,) joint of each value.
        values: position, velocity and effort, (m,) each.
    """
    rows = len(messages.channel)
    most = max(_MOST_CELLS, len(parent)) // max(rows, 1)
    if len(names) > most:
        kept = joint < most
        names, parent, joint = names[:most], parent[kept], joint[kept]
        values = [each[kept] for each in values]
    found: list[Floats] = []
    for each in values:
        matrix = np.full((rows, len(names)), np.nan)
        matrix[parent, joint] = each
        # A name that stands twice in a message, with other numbers, tells nothing.
        twice = (matrix[parent, joint] != each) & ~np.isnan(each)
        matrix[parent[twice], joint[twice]] = np.nan
        found.append(matrix)
    position, velocity, effort = found
    return JointStates(
        messages.log_time, stamp, names, position, velocity, effort, messages.malformed
    )


def _read_alike(
    source: Source, messages: DecodedMessages, name: FieldPath, paths: Sequence[FieldPath]
) -> JointStates | None:
    """Read messages that all name the same joints and tell of each; None: they differ."""
    rows, table = len(messages.channel), messages.table
    named = table.nested(name.arrays[0].path)
    count = len(named.parent) // max(rows, 1)
    # Texts stand element by element: all messages' first names, then all second ones.
    if count == 0 or not np.array_equal(named.parent, np.tile(np.arange(rows), count)):
        return None
    _, called = name.texts(table)
    start, length = called.start.reshape(count, rows), called.length.reshape(count, rows)
    names = tuple(called.text(row) for row in range(0, count * rows, rows))
    # All names of a message, with what lies between them.
    whole = Texts(called.buffer, start[0], start[-1] + length[-1] - start[0])
    ends = np.stack([start, start + length]) - start[0]
    differ = (ends != ends[:, :, :1]).any() or len(whole.alike()[1]) > 1
    parents = np.repeat(np.arange(rows), count)
    if len(set(names)) < count or differ:
        return None
    found: list[Floats] = []
    for path in paths:
        told = table.nested(path.arrays[0].path)
        if len(told.parent) and not np.array_equal(told.parent, parents):
            return None
        values, shape = path.all_values(table)[:, 0], (rows, count)
        found.append(values.reshape(shape) if len(values) else np.full(shape, np.nan))
    position, velocity, effort = found
    stamp = source.stamps(messages)
    return JointStates(
        messages.log_time, stamp, names, position, velocity, effort, messages.malformed
    )
