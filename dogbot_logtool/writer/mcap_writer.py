"""The output file: chunks in the order of their arrival, then a complete summary."""

from collections.abc import Mapping
from typing import BinaryIO

from mcap import records
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from zlib_ng.zlib_ng import crc32

from dogbot_logtool import __version__
from dogbot_logtool.writer.chunks import FinishedChunk, indexed_channels

MAGIC = b"\x89MCAP0\r\n"
_SUMMARY_GROUPS = (
    Opcode.SCHEMA,
    Opcode.CHANNEL,
    Opcode.STATISTICS,
    Opcode.CHUNK_INDEX,
    Opcode.ATTACHMENT_INDEX,
    Opcode.METADATA_INDEX,
)


class McapWriter:
    """Writes an MCAP file front to back. Memory grows only with the number of chunks."""

    def __init__(self, file: BinaryIO, profile: str) -> None:
        self._file = file
        self._offset = 0
        self._crc = 0
        self._summary: dict[int, list[bytes]] = {opcode: [] for opcode in _SUMMARY_GROUPS}
        self.channel_counts: dict[int, int] = {}
        """Messages written, by channel id."""
        self._times: list[int] = []
        """ns, first and last log time of each chunk with messages."""
        self._write(MAGIC)
        self._write(_serialise(records.Header(profile, f"dogbot-logtool {__version__}")))

    def add(self, *described: records.Schema | records.Channel) -> None:
        """Write schemas, which must come before their channels, or these before their messages."""
        for record in described:
            self._write(self._keep(record))

    def add_chunk(self, chunk: FinishedChunk) -> None:
        """Write a chunk with its message index."""
        chunk_start = self._offset
        self._write(chunk.record.data)
        index_start = self._offset
        self._write(chunk.index.data)
        found = list(indexed_channels(chunk.index))
        index = records.ChunkIndex(
            chunk_length=len(chunk.record),
            chunk_start_offset=chunk_start,
            compression=chunk.compression,
            compressed_size=chunk.compressed_size,
            message_end_time=chunk.end_time,
            message_index_length=len(chunk.index),
            message_index_offsets={channel: index_start + offset for channel, offset, _ in found},
            message_start_time=chunk.start_time,
            uncompressed_size=chunk.size,
        )
        self._keep(index)
        for channel, _, count in found:
            self.channel_counts[channel] = self.channel_counts.get(channel, 0) + count
        if found:
            self._times += [chunk.start_time, chunk.end_time]

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record with its keys in order."""
        metadata = records.Metadata(name, dict(sorted(values.items())))
        self.copy_extra(_serialise(metadata), metadata)

    def copy_extra(self, record: bytes, extra: records.Attachment | records.Metadata) -> None:
        """Write a whole attachment or metadata record as it was recorded.

        Args:
            record: its bytes.
            extra: the same, decoded.
        """
        offset, length = self._offset, len(record)
        self._write(record)
        if isinstance(extra, records.Metadata):
            self._keep(records.MetadataIndex(offset, length, extra.name))
            return
        index = records.AttachmentIndex(
            offset=offset,
            length=length,
            log_time=extra.log_time,
            create_time=extra.create_time,
            data_size=len(extra.data),
            name=extra.name,
            media_type=extra.media_type,
        )
        self._keep(index)

    def finish(self) -> None:
        """Write the end of the data and the summary."""
        self._write(_serialise(records.DataEnd(self._crc)))
        numbers = {opcode: len(group) for opcode, group in self._summary.items()}
        statistics = records.Statistics(
            attachment_count=numbers[Opcode.ATTACHMENT_INDEX],
            channel_count=numbers[Opcode.CHANNEL],
            channel_message_counts=dict(sorted(self.channel_counts.items())),
            chunk_count=numbers[Opcode.CHUNK_INDEX],
            message_count=sum(self.channel_counts.values()),
            message_end_time=max(self._times, default=0),
            message_start_time=min(self._times, default=0),
            metadata_count=numbers[Opcode.METADATA_INDEX],
            schema_count=numbers[Opcode.SCHEMA],
        )
        self._keep(statistics)
        self._write_summary()

    def _write_summary(self) -> None:
        start = self._offset
        self._crc = 0
        offsets = bytearray()
        for opcode, written in self._summary.items():
            if group := b"".join(written):
                offset = records.SummaryOffset(Opcode(opcode), self._offset, len(group))
                offsets += _serialise(offset)
                self._write(group)
        offsets_start = self._offset
        self._write(bytes(offsets))
        # The summary's CRC covers the footer too, up to the CRC itself.
        footer = _serialise(records.Footer(start, offsets_start, 0))
        self._write(footer[:-4])
        self._write(self._crc.to_bytes(4, "little"))
        self._write(MAGIC)

    def _keep(self, record: records.McapRecord) -> bytes:
        """Keep a record for the summary, where those of a kind stand together; return its bytes."""
        data = _serialise(record)
        self._summary[data[0]].append(data)
        return data

    def _write(self, data: bytes | memoryview) -> None:
        self._file.write(data)
        self._crc = crc32(data, self._crc)
        self._offset += len(data)


def _serialise(record: records.McapRecord) -> bytes:
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())
