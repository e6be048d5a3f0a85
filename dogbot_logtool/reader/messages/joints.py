"""sensor_msgs/JointState to columns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.fields import numbers, texts, time
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    check_channel,
    decode_channels,
)

JOINT_TYPE: Final = "sensor_msgs/JointState"
_FIELDS: Final = (time("header.stamp"), texts("name"), numbers("position"))


@dataclass(frozen=True, slots=True)
class JointPositions:
    """Positions of some joints, in the order of the log."""

    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns, header stamp as recorded."""
    position: Floats
    """(n, joints) rad or m; NaN where a message does not tell."""


def check_joints(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`."""
    return check_channel(channel, _FIELDS)


def decode_joints(batch: Batch, channels: Sequence[Channel]) -> list[DecodedMessages]:
    """Decode the joint states of a batch; see `decode_channels`."""
    return decode_channels(batch, channels, _FIELDS)


def joint_names(messages: DecodedMessages) -> frozenset[str]:
    """Return the joints that messages name."""
    _, names = messages.table.nested("name").table.texts(ELEMENT).encode()
    return frozenset(names)


def joint_positions(messages: DecodedMessages, joints: Sequence[str]) -> JointPositions:
    """Return the positions of joints by name.

    Args:
        messages: decoded by `decode_joints`.
        joints: names.
    """
    position = np.full((len(messages.channel), len(joints)), np.nan)
    named, told = messages.table.nested("name"), messages.table.nested("position")
    code, names = named.table.texts(ELEMENT).encode()
    columns = [[column for column, joint in enumerate(joints) if joint == n] for n in names]
    # A joint's position stands where its name does.
    values = np.full((len(messages.channel), int(told.index.max(initial=-1)) + 1), np.nan)
    values[told.parent, told.index] = told.table.numbers(ELEMENT).astype(np.float64)
    has_value = named.index < values.shape[1]
    for number, wanted in enumerate(columns):
        rows = np.flatnonzero((code == number) & has_value)
        for column in wanted:
            position[named.parent[rows], column] = values[named.parent[rows], named.index[rows]]
    return JointPositions(messages.log_time, messages.table.nanoseconds("header.stamp"), position)
