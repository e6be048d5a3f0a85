"""Joints, transforms, and vectors that single messages hold, read by any row of the table."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, header_time, picked, rows_by_group
from dogbot_logtool.core.frames.transforms import Edge, Transforms
from dogbot_logtool.core.recording import (
    MOST_JOINTS,
    JointSamples,
    JointTable,
    VectorSamples,
    plausible,
)
from dogbot_logtool.reader.containers.log import Batch, Channel
from dogbot_logtool.reader.messages.bases import chosen_names
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.messages import DecodedMessages
from dogbot_logtool.reader.messages.source import Source, decoded_by, source_of
from dogbot_logtool.reader.messages.table import TABLE

_TRANSFORMS: Final = frozenset(row.name for row in TABLE if len(row.choose) > 1)
FOXGLOVE_TYPES: Final = frozenset(name for name in _TRANSFORMS if name.startswith("foxglove."))
"""Of transforms in protobuf or JSON: what `convert` writes must be found again by `info`."""
TRANSFORM_TYPES: Final = _TRANSFORMS - FOXGLOVE_TYPES
_MOST_CELLS: Final = 1 << 22
"""Values in a matrix of messages and joints: 32 MB."""


def _decoded(
    batch: Batch, channels: Sequence[Channel], part: Part
) -> Iterator[tuple[Source, DecodedMessages]]:
    """Yield the messages of channels and how a part of them is read, one entry a definition."""
    return decoded_by(batch, ((channel, source_of(channel, part)) for channel in channels))


# Joints


def read_joints(batch: Batch, channel: Channel) -> Iterator[JointTable]:
    """Yield the joint states of a batch that a channel has, one entry a definition."""
    for source, messages in _decoded(batch, [channel], "joints"):
        yield JointTable(channel.topic, *_joints(source, messages))


def _joints(source: Source, messages: DecodedMessages) -> tuple[tuple[str, ...], JointSamples]:
    """Return the names of joints, and their values as matrices; NaN where a message has none.

    Joints are left out where messages that each name others would make the matrices huge.
    """
    table, rows = messages.table, len(messages.channel)
    paths = [source.paths[name][0] for name in ("joint_position", "joint_velocity", "joint_effort")]
    name = source.paths["joint"][0] if source.row.joint else None
    if name is not None and len(name.texts(table)[0]):
        key = name
        parent, called = name.texts(table)
        joint, names = called.encode()
    else:
        key, names = paths[0], source.row.joints
        nested = table.nested(key.arrays[0].path)
        parent, joint = nested.parent, nested.index
        if name is not None:
            # Some publishers leave the names out; positions keep their order.
            names = tuple(f"joint_{n}" for n in range(-(-len(parent) // max(rows, 1))))
    most = min(len(names), MOST_JOINTS, max(_MOST_CELLS, len(parent)) // max(rows, 1))
    kept = joint < most
    cells = parent[kept], joint[kept]
    found: list[Floats] = []
    for path in paths:
        own = path.beside(table, key)[kept, 0]
        matrix = np.full((rows, most), np.nan)
        matrix[cells] = own
        # A name that stands twice in a message, with other numbers, tells nothing.
        twice = (matrix[cells] != own) & ~np.isnan(own)
        matrix[cells[0][twice], cells[1][twice]] = np.nan
        found.append(matrix)
    stamp = header_time(source.stamps(messages), messages.log_time)
    return names[:most], JointSamples(messages.log_time, stamp, *found)


# Vectors


def read_vectors(
    batch: Batch, channels: Sequence[Channel], part: Part
) -> Iterator[tuple[VectorSamples, set[str]]]:
    """Yield the commands or accelerations of a batch, one entry a definition.

    Args:
        batch: the batch.
        channels: the senders of one topic, all of one type.
        part: which of them.

    Yields:
        the vectors, and the frames that their headers name.
    """
    for source, messages in _decoded(batch, channels, part):
        values, turns = (
            [path.first_values(messages.table) for path in source.paths.get(field, ())]
            for field in ("command" if part == "commands" else "acceleration", "turn_rate")
        )
        vectors = np.concatenate(values, axis=1)
        turn_rate = turns[0] if turns else np.full(vectors.shape, np.nan)
        frames = {
            name
            for path in source.paths.get("frame", ())
            for name in path.texts(messages.table)[1].encode()[1]
        }
        stamp = source.stamps(messages)
        yield VectorSamples(messages.log_time, stamp, vectors, turn_rate), frames


# Transforms


def is_static(channel: Channel) -> bool:
    """Tell whether a channel's transforms hold for ever, as those of ``/tf_static`` do."""
    return channel.topic.endswith("tf_static")


def read_transforms(
    batch: Batch, channels: Sequence[Channel], *, static: bool
) -> Iterator[tuple[dict[Edge, Transforms], set[str]]]:
    """Yield the transforms of a batch, one entry a definition.

    Args:
        batch: messages.
        channels: those that are read.
        static: whether their transforms hold for ever.

    Yields:
        transforms by parent and child, and frame ids that begin with a slash.
    """
    for source, messages in _decoded(batch, channels, "base"):
        yield _transforms(source, messages, static=static)


def _transforms(
    source: Source, messages: DecodedMessages, *, static: bool
) -> tuple[dict[Edge, Transforms], set[str]]:
    table, paths = messages.table, source.paths
    message, _ = paths["choose"][0].texts(table)
    recorded = Transforms(
        channel=messages.channel[message],
        static=np.full(len(message), static),
        log_time=messages.log_time[message],
        stamp=paths["stamp"][0].times(table),
        translation=paths["position"][0].all_values(table),
        rotation=paths["orientation"][0].all_values(table),
    )
    whole, _ = plausible(recorded)
    code, pairs = chosen_names(source, table)
    # Names that differ in leading slashes only are those of one frame.
    edges = [(parent.lstrip("/"), child.lstrip("/")) for parent, child in pairs]
    number = {edge: row for row, edge in enumerate(dict.fromkeys(edges))}
    edge_of = np.array([number[edge] for edge in edges], np.int64)[code]
    found = {[*number][one]: picked(whole, rows) for one, rows in rows_by_group(edge_of)}
    return found, {name for pair in pairs for name in pair if name.startswith("/")}
