"""tf2_msgs/TFMessage to columns."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.plausible import plausible_translations
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.fields import HEADER, table, text, vector
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, decode_channels

TRANSFORM_TYPES: Final = frozenset({"tf2_msgs/TFMessage", "tf/tfMessage"})
FIELDS: Final = (
    table(
        "transforms",
        *HEADER,
        text("child_frame_id"),
        *vector("transform.translation"),
        *vector("transform.rotation", "xyzw"),
    ),
)


def is_static(channel: Channel) -> bool:
    """Tell whether a channel's transforms hold for ever, as those of ``/tf_static`` do."""
    return channel.topic.endswith("tf_static")


def check_transforms(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`."""
    return check_channel(channel, FIELDS)


def decode_transforms(batch: Batch, channels: Sequence[Channel]) -> list[DecodedMessages]:
    """Decode the transform messages of a batch; see `decode_channels`."""
    return decode_channels(batch, channels, FIELDS)


def transform_columns(messages: DecodedMessages) -> RecordedTransforms:
    """Return the columns of decoded transform messages."""
    nested = messages.table.nested("transforms")
    return recorded_transforms(messages, nested.parent, nested.table, _ROS_PATHS)


@dataclass(frozen=True, slots=True)
class TransformPaths:
    """The fields that describe a transform."""

    stamp: str
    parent: str
    child: str
    translation: str
    rotation: str


_ROS_PATHS: Final = TransformPaths(
    "header.stamp",
    "header.frame_id",
    "child_frame_id",
    "transform.translation",
    "transform.rotation",
)


def recorded_transforms(
    messages: DecodedMessages, message: Ints, each: Table, paths: TransformPaths
) -> RecordedTransforms:
    """Return the columns of transforms.

    Args:
        messages: the messages that they stand in.
        message: (m,) row of the message of each transform.
        each: their fields, m rows.
        paths: the names of the fields.
    """
    order = np.argsort(message, kind="stable")
    message = message[order]
    parent, parents = each.texts(paths.parent).encode()
    child, children = each.texts(paths.child).encode()
    return RecordedTransforms(
        channel=messages.channel[message],
        log_time=messages.log_time[message],
        stamp=each.nanoseconds(paths.stamp)[order],
        parent=parent[order],
        parents=parents,
        child=child[order],
        children=children,
        translation=plausible_translations(each.vectors(paths.translation, "xyz"))[order],
        rotation=each.vectors(paths.rotation, "xyzw")[order],
    )


def frame_pairs(messages: DecodedMessages) -> set[tuple[str, str]]:
    """Return the different (parent, child) pairs of frames, as recorded."""
    each = messages.table.nested("transforms").table
    parent, parents = each.texts("header.frame_id").encode()
    child, children = each.texts("child_frame_id").encode()
    pairs = distinct(parent * max(len(children), 1) + child).tolist()
    return {(parents[pair // len(children)], children[pair % len(children)]) for pair in pairs}
