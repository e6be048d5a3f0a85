"""Files of one recording as one log: those of a split series, or one bag a sensor.

Its chunks are those of all files, by the times at which they begin; the chunks of one file keep
their order. Chunks may overlap in time: what reads them sorts what it makes of their messages.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from operator import attrgetter, itemgetter
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.io.storage import Location, file_name
from dogbot_logtool.mcap_layout import is_marked
from dogbot_logtool.reader.containers.compression import unpacked
from dogbot_logtool.reader.containers.log import (
    Batch,
    Channel,
    Chunk,
    Log,
    Schema,
    Span,
    concatenate_messages,
    time_range,
)
from dogbot_logtool.reader.containers.loss import Loss
from dogbot_logtool.reader.containers.source import ByteSource

_EARLIEST: Final = -(1 << 62)


class _NoBytes(ByteSource):
    """Stands for the bytes of all files, each of which has its own source."""

    def __init__(self, path: Location, sources: Sequence[ByteSource]) -> None:
        self.path = path
        self.size = sum(source.size for source in sources)
        self.can_fork = all(source.can_fork for source in sources)

    def close(self) -> None:
        """Do nothing."""


class JoinedLog(Log):
    """Several logs that are read as one; they are closed with it."""

    def __init__(self, path: Location, logs: Sequence[Log], losses: Sequence[Loss] = ()) -> None:
        """Join logs of one recording. Channels that are alike in all are one.

        Args:
            path: what the user named.
            logs: at least one.
            losses: damage to the whole.
        """
        super().__init__(_NoBytes(path, [log.source for log in logs]))
        channels: dict[tuple[object, ...], Channel] = {}
        schemas: dict[tuple[str, str, bytes], Schema] = {}
        self.logs = [own for log in logs for own in _parts(log)]
        self._ids = [_joint_ids(log.channels, channels, schemas) for log in self.logs]
        self.channels = {channel.id: channel for channel in channels.values()}
        self.chunks = _by_time(self.logs, self._ids)
        counts: Counter[int] = Counter()
        for log, ids in zip(self.logs, self._ids, strict=True):
            counts.update(_joint(log.counts, ids))
        self.counts = counts
        self.start_time, self.end_time = time_range(logs)
        self.profile = logs[0].profile
        self.extras = [extra for log in logs for extra in log.extras]
        found = [_named(loss, log) for log in logs for loss in log.losses]
        self.losses = [*losses, *found]

    def overlaps(self, chunk: Chunk, start: int | None, end: int | None) -> bool:
        """See `Log.overlaps`."""
        return self.logs[chunk.file].overlaps(chunk, start, end)

    def _read(self, span: Span) -> Batch:
        """See `Log.read`."""
        parts: list[Batch] = []
        base = row = 0
        for file, chunks in groupby(span, key=attrgetter("file")):
            part = self._of_file(file, tuple(chunks))
            loaded = tuple(
                each._replace(
                    stored=memoryview(b""),
                    rows=slice(row + each.rows.start, row + each.rows.stop),
                    whole=False,
                )
                for each in part.chunks
            )
            parts.append(replace(part, messages=part.messages.shifted(base), chunks=loaded))
            base += len(part.buffer)
            row += len(part.messages)
        return Batch(
            np.concatenate([part.buffer for part in parts]) if len(parts) > 1 else parts[0].buffer,
            concatenate_messages([part.messages for part in parts]),
            tuple(each for part in parts for each in part.chunks),
            tuple(loss for part in parts for loss in part.losses),
        )

    def _of_file(self, file: int, span: Span) -> Batch:
        """Read chunks of a file, with joint channels."""
        log = self.logs[file]
        batch = unpacked(log.read(span))
        channel = self._ids[file][batch.messages.channel]
        return replace(
            batch,
            messages=replace(batch.messages, channel=channel),
            losses=tuple(_named(loss, log) for loss in batch.losses),
        )

    def close(self) -> None:
        """Close all files."""
        for log in self.logs:
            log.close()


def _parts(log: Log) -> Sequence[Log]:
    """Return the files of a log that is joined itself, or the log."""
    return log.logs if isinstance(log, JoinedLog) else [log]


def _by_time(logs: Sequence[Log], ids: Sequence[Ints]) -> list[Chunk]:
    """Return all chunks by the times at which they begin.

    None of a file is read earlier than those before it.
    """
    found: list[tuple[int, Chunk]] = []
    for file, log in enumerate(logs):
        reached = _EARLIEST
        for chunk in log.chunks:
            reached = max(reached, _EARLIEST if chunk.start_time is None else chunk.start_time)
            counts = None if chunk.counts is None else _joint(chunk.counts, ids[file])
            found.append((reached, chunk._replace(file=file, counts=counts)))
    return [chunk for _, chunk in sorted(found, key=itemgetter(0))]


def _joint(counts: Mapping[int, int], ids: Ints) -> dict[int, int]:
    """Return messages by joint channel; a file's channels may be one."""
    joint: Counter[int] = Counter()
    for number, count in counts.items():
        joint[int(ids[number])] += count
    return dict(joint)


def _joint_ids(
    own: Mapping[int, Channel],
    channels: dict[tuple[object, ...], Channel],
    schemas: dict[tuple[str, str, bytes], Schema],
) -> Ints:
    """Return joint ids by a file's own.

    Args:
        own: the file's channels.
        channels: receives those that are new, by all that makes channels alike.
        schemas: likewise.
    """
    ids = np.zeros(max(own, default=0) + 1, np.int64)
    for number, channel in own.items():
        schema = channel.schema
        if schema is not None:
            fresh = schema._replace(id=len(schemas) + 1)
            schema = schemas.setdefault((schema.name, schema.encoding, schema.data), fresh)
        kind = schema and schema.id
        key = (channel.topic, channel.message_encoding, kind, is_marked(channel.metadata))
        new = replace(channel, id=len(channels) + 1, schema=schema)
        ids[number] = channels.setdefault(key, new).id
    return ids


def _named(loss: Loss, log: Log) -> Loss:
    """Say in which file it is."""
    name = file_name(log.source.path)
    return loss._replace(what=f"{name}: {loss.what}", file=name)
