"""Several files that are one log: the files of a ROS 2 bag that a recorder split."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.storage import Location, file_name
from dogbot_logtool.provenance import is_marked
from dogbot_logtool.reader.containers.batch import Batch
from dogbot_logtool.reader.containers.chunks.packed_messages import unpacked
from dogbot_logtool.reader.containers.contents import Channel, Chunk, Contents, Extra, Schema
from dogbot_logtool.reader.containers.log import Log, Span
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.sources.source import ByteSource


class Folder(ByteSource):
    """Stands for the bytes of all files."""

    def __init__(self, path: Location, size: int) -> None:
        self.path = path
        self.size = size

    def read(self, offset: int, size: int) -> bytes:
        """Return nothing: each file has its own source."""
        del offset, size
        return b""

    def close(self) -> None:
        """Do nothing: each file is closed by itself."""


@dataclass(frozen=True, slots=True)
class _Part:
    """One of the files."""

    log: Log
    channel: Ints
    """(c + 1,) joint channel id by the file's own."""
    first: int
    """Number of its first chunk among all."""


class SeveralLogs(Log):
    """Several files that are read as one log; they are closed with it."""

    def __init__(self, path: Location, logs: Sequence[Log], contents: Contents) -> None:
        super().__init__(Folder(path, sum(log.source.size for log in logs)), contents)
        self.logs = logs

    @property
    def can_fork(self) -> bool:
        """See `Log.can_fork`."""
        return all(log.can_fork for log in self.logs)

    def source_of(self, extra: Extra) -> ByteSource:
        """See `Log.source_of`."""
        return self.logs[extra.file].source

    def close(self) -> None:
        """Close all files."""
        for log in self.logs:
            log.close()


class JoinedLog(SeveralLogs):
    """Logs, one after the other. Channels that are alike in all are one."""

    container = "ROS 2 bag"

    def __init__(self, path: Location, logs: Sequence[Log], losses: Sequence[Loss]) -> None:
        """Join logs; they are closed with this one.

        Args:
            path: what the user named.
            logs: at least one.
            losses: damage to the whole.
        """
        joint = JointChannels()
        self._parts: list[_Part] = []
        chunks: list[Chunk] = []
        for log in logs:
            part = _Part(log, joint.take(log.channels), len(chunks))
            self._parts.append(part)
            chunks.extend(_renumbered(chunk, part, row) for row, chunk in enumerate(log.chunks))
        contents = joint_contents(joint.channels, logs, [part.channel for part in self._parts])
        of_files = (
            loss_in_file(_before(loss, following), log)
            for log, following in zip(logs, [*logs[1:], None], strict=True)
            for loss in log.losses
        )
        contents = replace(contents, chunks=chunks, losses=(*losses, *of_files))
        super().__init__(path, logs, contents)
        storage = logs[0].container
        self.container = storage if "ROS 2 bag" in storage else f"ROS 2 bag ({storage})"

    def grouped(self, chunks: Iterable[Chunk]) -> Iterator[Span]:
        """See `Log.grouped`; a batch never reaches over two files."""
        for span in super().grouped(chunks):
            group: list[Chunk] = []
            for chunk in span:
                if group and self._part(group[0]) is not self._part(chunk):
                    yield tuple(group)
                    group = []
                group.append(chunk)
            yield tuple(group)

    def read(self, span: Span) -> Batch:
        """See `Log.read`."""
        part = self._part(span[0])
        own = [part.log.chunks[chunk.offset - part.first] for chunk in span]
        joint = {one.offset: chunk for one, chunk in zip(own, span, strict=True)}
        batch = part.log.read(tuple(own))
        messages = replace(batch.messages, channel=part.channel[batch.messages.channel])
        chunks = tuple(
            replace(loaded, chunk=joint[loaded.chunk.offset], whole=False)
            for loaded in batch.chunks
        )
        losses = tuple(loss_in_file(loss, part.log) for loss in batch.losses)
        return unpacked(Batch(batch.buffer, messages, chunks, losses))

    def _part(self, chunk: Chunk) -> _Part:
        return next(part for part in reversed(self._parts) if part.first <= chunk.offset)


class JointChannels:
    """Channels of all files, each once."""

    def __init__(self) -> None:
        self.channels: dict[int, Channel] = {}
        self._numbers: dict[tuple[str, str, int, bool], int] = {}
        self._schemas: dict[tuple[str, str, bytes], Schema] = {}

    def take(self, channels: Mapping[int, Channel]) -> Ints:
        """Add a file's channels; return the joint id by the file's own."""
        joint = np.zeros(max(channels, default=0) + 1, np.int64)
        for number, channel in channels.items():
            schema = self._schema(channel.schema)
            kind = schema.id if schema else 0
            key = (channel.topic, channel.message_encoding, kind, is_marked(channel.metadata))
            if key not in self._numbers:
                self._numbers[key] = mine = len(self._numbers) + 1
                self.channels[mine] = replace(channel, id=mine, schema=schema)
            joint[number] = self._numbers[key]
        return joint

    def _schema(self, schema: Schema | None) -> Schema | None:
        if schema is None:
            return None
        key = (schema.name, schema.encoding, schema.data)
        fresh = replace(schema, id=len(self._schemas) + 1)
        return self._schemas.setdefault(key, fresh)


def joint_contents(
    channels: Mapping[int, Channel], logs: Sequence[Log], numbers: Sequence[Ints]
) -> Contents:
    """Return what is known of several files together, but for their chunks.

    Args:
        channels: of all files.
        logs: the files.
        numbers: joint channel id by each file's own, see `JointChannels.take`.
    """
    counts: dict[int, int] = {}
    for log, own in zip(logs, numbers, strict=True):
        for number, count in log.counts.items():
            mine = int(own[number])
            counts[mine] = counts.get(mine, 0) + count
    return Contents(
        channels=channels,
        chunks=(),
        counts=counts,
        start_time=min(
            (log.start_time for log in logs if log.start_time is not None), default=None
        ),
        end_time=max((log.end_time for log in logs if log.end_time is not None), default=None),
        profile=logs[0].profile,
        extras=[
            replace(extra, file=number) for number, log in enumerate(logs) for extra in log.extras
        ],
        losses=tuple(loss_in_file(loss, log) for log in logs for loss in log.losses),
    )


def _renumbered(chunk: Chunk, part: _Part, row: int) -> Chunk:
    """Return a chunk whose offset is its number among all, so that it stays unique."""
    counts = None
    if chunk.counts is not None:
        counts = {int(part.channel[number]): count for number, count in chunk.counts.items()}
    return replace(chunk, offset=part.first + row, counts=counts)


def _before(loss: Loss, following: Log | None) -> Loss:
    """End what is missing at the end of a file where the next file begins."""
    is_open = loss.start_time is not None and loss.end_time is None
    return replace(loss, end_time=following.start_time) if is_open and following else loss


def loss_in_file(loss: Loss, log: Log) -> Loss:
    """Say in which file it is."""
    name = file_name(log.source.path)
    return replace(loss, what=f"{name}: {loss.what}", file=name)
