"""MCAP files of channels with any definition and encoding, as the mcap library writes them."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from mcap.writer import Writer


class SentChannel(NamedTuple):
    """A channel, and what is sent on it."""

    topic: str
    type_name: str
    encoding: str
    """Of the messages."""
    schema_encoding: str = "jsonschema"
    definition: bytes = b"{}"
    messages: Sequence[tuple[int, bytes]] = ()
    """Log time (ns) and payload."""


def write_channels(path: Path, channels: Iterable[SentChannel]) -> Path:
    """Write an MCAP, one channel after the other."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        for sent in channels:
            schema = writer.register_schema(sent.type_name, sent.schema_encoding, sent.definition)
            channel = writer.register_channel(sent.topic, sent.encoding, schema)
            for log_time, data in sent.messages:
                writer.add_message(channel, log_time, data, log_time)
        writer.finish()
    return path
