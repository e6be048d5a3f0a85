"""Joint states of ROS, Foxglove and Unitree's motors: positions, velocities and efforts by name."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.columns import Nested, Texts
from dogbot_logtool.reader.decode.fields import (
    Fields,
    number,
    numbers,
    optional_number,
    table,
    text,
    texts,
    time,
)
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, decode_channels

_MOTORS: Final = tuple(
    f"{leg}_{joint}_joint" for leg in ("FR", "FL", "RR", "RL") for joint in ("hip", "thigh", "calf")
)
"""Unitree's quadrupeds in the order of their messages, named as in their robot descriptions."""
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


@dataclass(frozen=True, slots=True)
class _JointSource:
    """How messages of a type tell of joints."""

    type_name: str
    fields: Fields
    read: Callable[[DecodedMessages], JointStates]


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


def _read_ros(messages: DecodedMessages) -> JointStates:
    """Read arrays of names and values that stand side by side."""
    named = messages.table.nested("name")
    alike = _read_alike(messages, named)
    if alike is not None:
        return alike
    joint, names = named.table.texts(ELEMENT).encode()
    values = [
        _beside(named, messages.table.nested(path)) for path in ("position", "velocity", "effort")
    ]
    stamp = messages.table.nanoseconds("header.stamp")
    return _matrices(messages, stamp, names, named.parent, joint, values)


def _read_alike(messages: DecodedMessages, named: Nested) -> JointStates | None:
    """Read messages that all name the same joints and tell of each; None: they differ."""
    rows = len(messages.channel)
    count = len(named.parent) // max(rows, 1)
    # Texts stand element by element: all messages' first names, then all second ones.
    if count == 0 or not np.array_equal(named.parent, np.tile(np.arange(rows), count)):
        return None
    called: Texts = named.table.texts(ELEMENT)
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
    for path in ("position", "velocity", "effort"):
        told = messages.table.nested(path)
        if len(told.parent) and not np.array_equal(told.parent, parents):
            return None
        values = told.table.numbers(ELEMENT).astype(np.float64)
        shape = rows, count
        found.append(values.reshape(shape) if len(values) else np.full(shape, np.nan))
    position, velocity, effort = found
    stamp = messages.table.nanoseconds("header.stamp")
    return JointStates(
        messages.log_time, stamp, names, position, velocity, effort, messages.malformed
    )


def _beside(named: Nested, told: Nested) -> Floats:
    """(m,) value with the index of each name; NaN where an array is shorter than that of names."""
    rows, exist = told.rows_at(named.parent, named.index)
    values = np.full(len(rows), np.nan)
    values[exist] = told.table.numbers(ELEMENT)[rows[exist]]
    return values


def _read_foxglove(messages: DecodedMessages) -> JointStates:
    joints = messages.table.nested("joints")
    called: Texts = joints.table.texts("name")
    joint, names = called.encode()
    values = [
        joints.table.numbers(path).astype(np.float64) for path in ("position", "velocity", "effort")
    ]
    stamp = messages.table.nanoseconds("timestamp")
    return _matrices(messages, stamp, names, joints.parent, joint, values)


def _read_motors(messages: DecodedMessages, *, motors: str, values: Sequence[str]) -> JointStates:
    told = messages.table.nested(motors)
    rows = np.flatnonzero(told.index < len(_MOTORS))
    columns = [told.table.numbers(path).astype(np.float64)[rows] for path in values]
    stamp = np.zeros(len(messages.channel), np.int64)
    return _matrices(messages, stamp, _MOTORS, told.parent[rows], told.index[rows], columns)


def _motors(type_name: str, motors: str, effort: str) -> _JointSource:
    values = ("q", "dq", effort)
    return _JointSource(
        type_name,
        (table(motors, *map(number, values)),),
        partial(_read_motors, motors=motors, values=values),
    )


def _foxglove(type_name: str) -> _JointSource:
    joint = (text("name"), *map(optional_number, ("position", "velocity", "effort")))
    return _JointSource(type_name, (time("timestamp"), table("joints", *joint)), _read_foxglove)


_SOURCES: Final = {
    source.type_name: source
    for source in (
        _JointSource(
            "sensor_msgs/JointState",
            (
                time("header.stamp"),
                texts("name"),
                numbers("position"),
                numbers("velocity"),
                numbers("effort"),
            ),
            _read_ros,
        ),
        _foxglove("foxglove.JointStates"),
        _foxglove("foxglove_msgs/JointStates"),
        _motors("unitree_go/LowState", "motor_state", "tau_est"),
        _motors("go2_interfaces/LowState", "motor_state", "tau_est"),
        _motors("unitree_legged_msgs/LowState", "motorState", "tauEst"),
        _motors("ros2_unitree_legged_msgs/LowState", "motor_state", "tau_est"),
    )
}
JOINT_TYPES: Final = tuple(_SOURCES)
"""The best first."""


def check_joints(channel: Channel) -> str:
    """Check that a channel's messages tell of joints and can be decoded; see `check_channel`.

    Raises:
        DefinitionError: they do not, or cannot.
    """
    if channel.type_name not in _SOURCES:
        raise DefinitionError("it tells of no joints")
    return check_channel(channel, _SOURCES[channel.type_name].fields)


def read_joints(batch: Batch, channel: Channel) -> list[JointStates]:
    """Read the joint states of a batch that a channel has, one entry a definition.

    Args:
        batch: the batch.
        channel: one that `check_joints` accepts.
    """
    source = _SOURCES[channel.type_name]
    return [source.read(messages) for messages in decode_channels(batch, [channel], source.fields)]
