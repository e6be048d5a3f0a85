"""foxglove.FrameTransforms and foxglove.FrameTransform to columns, in protobuf or JSON.

What `convert` writes must be found again by `info`.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.recorded_transforms import (
    RecordedTransforms,
    concatenate_transforms,
)
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.decode.fields import table, text, time, vector
from dogbot_logtool.reader.decode.objects import table_of_rows
from dogbot_logtool.reader.messages.messages import DecodedMessages, decode_channels, malformed_in
from dogbot_logtool.reader.messages.transforms import TransformPaths, recorded_transforms

MANY: Final = "foxglove.FrameTransforms"
ONE: Final = "foxglove.FrameTransform"
FOXGLOVE_TYPES: Final = frozenset({MANY, ONE})
_TRANSFORM: Final = (
    time("timestamp"),
    text("parent_frame_id"),
    text("child_frame_id"),
    *vector("translation"),
    *vector("rotation", "xyzw"),
)
FIELDS: Final = {MANY: (table("transforms", *_TRANSFORM),), ONE: _TRANSFORM}
"""Fields that are read, by type."""
_PATHS: Final = TransformPaths(
    "timestamp", "parent_frame_id", "child_frame_id", "translation", "rotation"
)


def foxglove_transforms(
    batch: Batch, channels: Sequence[Channel]
) -> tuple[RecordedTransforms, dict[int, int]]:
    """Decode the transforms of a batch.

    Args:
        batch: the batch.
        channels: channels of `FOXGLOVE_TYPES`, encoded as protobuf or JSON.

    Returns:
        the transforms, and the number of messages that could not be decoded by channel id.
    """
    decoded: list[DecodedMessages] = []
    parts: list[RecordedTransforms] = []
    for type_name, fields in FIELDS.items():
        of_type = [channel for channel in channels if channel.type_name == type_name]
        for messages in decode_channels(batch, of_type, fields):
            decoded.append(messages)
            parts.append(foxglove_columns(messages))
    return concatenate_transforms(parts or [_no_transforms()]), malformed_in(decoded)


def foxglove_columns(messages: DecodedMessages) -> RecordedTransforms:
    """Return the transforms of decoded messages of either type."""
    if "transforms" in messages.table.columns:
        nested = messages.table.nested("transforms")
        return recorded_transforms(messages, nested.parent, nested.table, _PATHS)
    message = np.arange(len(messages.channel))
    return recorded_transforms(messages, message, messages.table, _PATHS)


def _no_transforms() -> RecordedTransforms:
    nothing = np.empty(0, np.int64)
    return foxglove_columns(DecodedMessages(nothing, nothing, table_of_rows([], _TRANSFORM), {}))
