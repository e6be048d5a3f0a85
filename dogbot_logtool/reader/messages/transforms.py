"""tf2_msgs/TFMessage, and Foxglove's transforms, to columns."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.plausible import plausible_translations
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.fields import HEADER, Fields, table, text, time, vector
from dogbot_logtool.reader.messages.messages import DecodedMessages, check_channel, decode_channels

TRANSFORM_TYPES: Final = frozenset({"tf2_msgs/TFMessage", "tf/tfMessage"})
_MANY: Final = "foxglove.FrameTransforms"
_ONE: Final = "foxglove.FrameTransform"
FOXGLOVE_TYPES: Final = frozenset({_MANY, _ONE})
"""In protobuf or JSON: what `convert` writes must be found again by `info`."""
_ROS_FIELDS: Final[Fields] = (
    table(
        "transforms",
        *HEADER,
        text("child_frame_id"),
        *vector("transform.translation"),
        *vector("transform.rotation", "xyzw"),
    ),
)
_FOXGLOVE_TRANSFORM: Final[Fields] = (
    time("timestamp"),
    text("parent_frame_id"),
    text("child_frame_id"),
    *vector("translation"),
    *vector("rotation", "xyzw"),
)
FIELDS: Final[Mapping[str, Fields]] = {
    **dict.fromkeys(sorted(TRANSFORM_TYPES), _ROS_FIELDS),
    _MANY: (table("transforms", *_FOXGLOVE_TRANSFORM),),
    _ONE: _FOXGLOVE_TRANSFORM,
}
"""Fields that are read, by type."""
_KINDS: Final = (FIELDS[_MANY], FIELDS[_ONE], _ROS_FIELDS)


def is_static(channel: Channel) -> bool:
    """Tell whether a channel's transforms hold for ever, as those of ``/tf_static`` do."""
    return channel.topic.endswith("tf_static")


def check_transforms(channel: Channel) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`."""
    return check_channel(channel, FIELDS[channel.type_name])


def decode_transforms(batch: Batch, channels: Sequence[Channel]) -> list[DecodedMessages]:
    """Decode the transform messages of a batch; see `decode_channels`."""
    return [
        messages
        for fields in _KINDS
        if (alike := [each for each in channels if FIELDS[each.type_name] is fields])
        for messages in decode_channels(batch, alike, fields)
    ]


@dataclass(frozen=True, slots=True)
class _Paths:
    """The fields that describe a transform."""

    stamp: str
    parent: str
    child: str
    translation: str
    rotation: str


_ROS_PATHS: Final = _Paths(
    "header.stamp",
    "header.frame_id",
    "child_frame_id",
    "transform.translation",
    "transform.rotation",
)
_FOXGLOVE_PATHS: Final = _Paths(
    "timestamp", "parent_frame_id", "child_frame_id", "translation", "rotation"
)


def transform_columns(messages: DecodedMessages) -> RecordedTransforms:
    """Return the columns of decoded transform messages."""
    message, each = np.arange(len(messages.channel)), messages.table
    if "transforms" in each.columns:
        nested = each.nested("transforms")
        message, each = nested.parent, nested.table
    paths = _ROS_PATHS if _ROS_PATHS.parent in each.columns else _FOXGLOVE_PATHS
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
