"""tf2_msgs/TFMessage, and Foxglove's transforms, to columns."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.frames.transforms import RecordedTransforms
from dogbot_logtool.core.plausible import plausible_translations
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.messages.message_type import BASE
from dogbot_logtool.reader.messages.messages import DecodedMessages, decode_channels
from dogbot_logtool.reader.messages.source import Source, fitted
from dogbot_logtool.reader.messages.table import TABLE

_SOURCES: Final = {row.name: fitted(row, BASE, None) for row in TABLE if len(row.choose) > 1}
"""How transforms are read, by type; no definition of theirs has arrays of numbers."""
FOXGLOVE_TYPES: Final = frozenset(name for name in _SOURCES if name.startswith("foxglove."))
"""In protobuf or JSON: what `convert` writes must be found again by `info`."""
TRANSFORM_TYPES: Final = frozenset(_SOURCES) - FOXGLOVE_TYPES


def is_static(channel: Channel) -> bool:
    """Tell whether a channel's transforms hold for ever, as those of ``/tf_static`` do."""
    return channel.topic.endswith("tf_static")


def decode_transforms(batch: Batch, channels: Sequence[Channel]) -> list[DecodedMessages]:
    """Decode the transform messages of a batch; see `decode_channels`."""
    kinds = dict.fromkeys(_SOURCES[channel.type_name].fields for channel in channels)
    return [
        messages
        for fields in kinds
        for messages in decode_channels(
            batch, [c for c in channels if _SOURCES[c.type_name].fields == fields], fields
        )
    ]


def transform_columns(messages: DecodedMessages) -> RecordedTransforms:
    """Return the columns of decoded transform messages."""
    table, source = messages.table, _source_of(messages)
    stamp, translation, rotation = (
        source.paths[name][0] for name in ("stamp", "position", "orientation")
    )
    (message, parent_texts), (_, child_texts) = (
        path.texts(table) for path in source.paths["choose"]
    )
    order = np.argsort(message, kind="stable")
    message = message[order]
    (parent, parents), (child, children) = parent_texts.encode(), child_texts.encode()
    return RecordedTransforms(
        channel=messages.channel[message],
        log_time=messages.log_time[message],
        stamp=stamp.times(table)[order],
        parent=parent[order],
        parents=parents,
        child=child[order],
        children=children,
        translation=plausible_translations(translation.all_values(table))[order],
        rotation=rotation.all_values(table)[order],
    )


def _source_of(messages: DecodedMessages) -> Source:
    """Return the source by which messages were decoded: the one whose columns they have."""
    return next(
        source for source in _SOURCES.values() if source.paths["choose"][0].is_in(messages.table)
    )
