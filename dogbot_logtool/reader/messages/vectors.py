"""Velocity commands and inertial units: vectors that single messages hold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import concatenated, picked, stable_order
from dogbot_logtool.core.vectors import VectorSamples
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.messages.message_type import VECTOR, MessageType
from dogbot_logtool.reader.messages.messages import (
    DecodedMessages,
    check_channel,
    decode_channels,
    malformed_in,
)
from dogbot_logtool.reader.messages.source import Source, fitted, known_definition_of
from dogbot_logtool.reader.messages.table import TABLE

COMMANDS: Final = {row.name: row for row in TABLE if row.command}
"""Linear x and y in m/s and angular z in rad/s, by type."""
INERTIAL_UNITS: Final = {row.name: row for row in TABLE if row.acceleration}
"""Accelerations, m/s^2, by type; the best first."""


@dataclass(frozen=True, slots=True)
class ReadVectors:
    """Vectors of a batch."""

    samples: VectorSamples
    frames: tuple[str, ...]
    """Header frame ids among them."""
    malformed: Mapping[int, int]
    """Messages that could not be decoded, by channel id."""


def check_vectors(channel: Channel, rows: Mapping[str, MessageType]) -> str:
    """Check that a channel's messages can be decoded; see `check_channel`.

    Raises:
        DefinitionError: they cannot.
    """
    return check_channel(channel, _source(channel, rows).fields)


def read_vectors(
    batch: Batch, channels: Sequence[Channel], rows: Mapping[str, MessageType]
) -> ReadVectors:
    """Read the vectors of a batch, of the senders of one topic, in the order of their log times.

    Args:
        batch: the batch.
        channels: those that `check_vectors` accepts, all of one type.
        rows: of that type.
    """
    source = _source(channels[0], rows)
    decoded = decode_channels(batch, channels, source.fields)
    parts = [_samples(messages, source) for messages in decoded]
    samples = concatenated([_NONE, *parts])
    if len(parts) > 1:
        samples = picked(samples, stable_order(samples.log_time))
    frames = {frame for messages in decoded for frame in _frames(messages, source)}
    return ReadVectors(samples, tuple(sorted(frames)), malformed_in(decoded))


_NONE: Final = VectorSamples(
    np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3))
)


def _source(channel: Channel, rows: Mapping[str, MessageType]) -> Source:
    return fitted(rows[channel.type_name], VECTOR, known_definition_of(channel))


def _samples(messages: DecodedMessages, source: Source) -> VectorSamples:
    paths = source.paths.get("command") or source.paths["acceleration"]
    values = np.concatenate([path.first_values(messages.table) for path in paths], axis=1)
    turns = np.full(values.shape, np.nan)
    for path in source.paths.get("turn_rate", ()):
        turns = path.first_values(messages.table)
    return VectorSamples(messages.log_time, source.stamps(messages), values, turns)


def _frames(messages: DecodedMessages, source: Source) -> tuple[str, ...]:
    if "frame" not in source.paths:
        return ()
    return source.paths["frame"][0].texts(messages.table)[1].encode()[1]
