"""Writing logged messages into the containers: ROS 1 bags and MCAP."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import lz4.frame
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag1 import Writer as BagWriter

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rosbags.typesys.store import Typestore
    from scenario import LoggedMessage

_BAG_CHUNK_BYTES = 768 * 1024
_MCAP_CHUNK_BYTES = 512 * 1024
_LZ4_LEVEL = 12
_LIBRARY = "dogbot-logtool sample_logs"


def write_bag(
    path: Path,
    messages: Sequence[LoggedMessage],
    typestore: Typestore,
    compression: Literal["bz2", "lz4"],
) -> None:
    """Write a ROS 1 bag, with chunks as ``rosbag record`` makes them.

    The library's lz4 frames have small linked blocks; here a chunk is one independent block with a
    content checksum, as ``rosbag record --lz4`` writes it.
    """
    path.unlink(missing_ok=True)
    writer = BagWriter(path)
    writer.set_compression(BagWriter.CompressionFormat[compression.upper()])
    writer.chunk_threshold = _BAG_CHUNK_BYTES
    if compression == "lz4":
        writer.compressor = _compress_lz4
    with writer:
        connections = {
            topic: writer.add_connection(topic, message_type, typestore=typestore)
            for topic, message_type in _channels(messages).items()
        }
        for message in messages:
            writer.write(connections[message.topic], message.log_time_ns, message.data)


def write_mcap(path: Path, messages: Sequence[LoggedMessage], typestore: Typestore) -> None:
    """Write an MCAP of profile ``ros2`` with zstd chunks, as ``ros2 bag record`` makes it."""
    with path.open("wb") as stream:
        writer = McapWriter(stream, _MCAP_CHUNK_BYTES, CompressionType.ZSTD)
        writer.start(profile="ros2", library=_LIBRARY)
        channels = _channels(messages)
        schemas = {
            message_type: writer.register_schema(
                message_type, "ros2msg", _ros2_definition(typestore, message_type)
            )
            for message_type in dict.fromkeys(channels.values())
        }
        channel_ids = {
            topic: writer.register_channel(topic, "cdr", schemas[message_type])
            for topic, message_type in channels.items()
        }
        for message in messages:
            writer.add_message(
                channel_ids[message.topic],
                log_time=message.log_time_ns,
                data=message.data,
                publish_time=message.publish_time_ns,
            )
        writer.finish()


def _channels(messages: Sequence[LoggedMessage]) -> dict[str, str]:
    """Message type by topic, in the order of the first messages."""
    return {message.topic: message.message_type for message in messages}


def _compress_lz4(chunk: bytes) -> bytes:
    compressed: bytes = lz4.frame.compress(
        chunk,
        compression_level=_LZ4_LEVEL,
        block_size=lz4.frame.BLOCKSIZE_MAX1MB,
        block_linked=False,
        content_checksum=True,
        store_size=False,
    )
    return compressed


def _ros2_definition(typestore: Typestore, message_type: str) -> bytes:
    definition, _ = typestore.generate_msgdef(message_type, ros_version=2)
    return definition.encode()
