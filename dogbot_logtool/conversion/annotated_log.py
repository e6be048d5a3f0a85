"""The output file of `convert`: the recorded messages, and behind them the annotations.

Recorded messages are copied while they are read for the first time, when nothing is known of the
walk yet. So annotations stand behind all of them, in chunks of their own; the index has both in the
order of time, which is how viewers read a file. A file that was cut off in a transfer still has the
recorded messages.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from fnmatch import fnmatchcase
from functools import partial
from typing import BinaryIO

import numpy as np
from mcap import records

from dogbot_logtool import __version__
from dogbot_logtool.conversion.annotate import TimeSpan, annotate_span, time_spans
from dogbot_logtool.conversion.scene import Scene
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import file_name
from dogbot_logtool.mcap_layout import PROVENANCE
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.containers.log import Batch, Chunk, Log
from dogbot_logtool.reader.containers.loss import Loss, lost_messages
from dogbot_logtool.reader.containers.mcap.records import channel_record, read_extra, schema_record
from dogbot_logtool.reader.workers import in_order
from dogbot_logtool.run.runner import OnProgress
from dogbot_logtool.writer.annotations import Annotations, types_by_topic
from dogbot_logtool.writer.channels import added_channels
from dogbot_logtool.writer.chunks import Compression, FinishedChunk, finish_chunks, recorded
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.encodings.registry import encoding_named
from dogbot_logtool.writer.mcap_writer import McapWriter

Copied = FinishedChunk | Chunk
"""A chunk of the log itself is copied as it stands."""


class AnnotatedLog:
    """An output while it is written."""

    def __init__(
        self, file: BinaryIO, log: Log, options: ConvertOptions, left_out: frozenset[int]
    ) -> None:
        """Write the header, and the channels that are copied.

        Args:
            file: the output.
            log: the input.
            options: what the user asks for.
            left_out: ids of the channels that are not copied.
        """
        profile = log.profile if options.copy else encoding_named(options.encoding).profile
        self._log, self._options = log, options
        self._writer = McapWriter(file, profile)
        self.messages: Mapping[int, int] = self._writer.channel_counts
        """Messages written, by channel id."""
        self.counts = Counter[str]()
        """Annotations that lack something, by what."""
        self.added: Mapping[str, records.Channel] = {}
        """Channels of annotations by topic, which is another where the log has that."""
        copied = log.channels if options.copy else {}
        self._copied = {number: c for number, c in copied.items() if number not in left_out}
        schemas = {c.schema.id: c.schema for c in self._copied.values() if c.schema is not None}
        self._writer.add(*(schema_record(schema) for _, schema in sorted(schemas.items())))
        self._writer.add(*(channel_record(each) for _, each in sorted(self._copied.items())))

    def add(self, chunks: Iterable[Copied]) -> None:
        """Write chunks."""
        for chunk in chunks:
            if isinstance(chunk, Chunk):
                stored = self._log.source.read(chunk.offset, chunk.index_end - chunk.offset)
                self._writer.add_chunk(as_it_stands(chunk, stored))
            else:
                self._writer.add_chunk(chunk)

    def annotate(self, scene: Scene, progress: OnProgress | None = None) -> None:
        """Write everything that is drawn of the walk.

        Args:
            scene: what is drawn.
            progress: called with the share done and all, as bytes of the log.
        """
        options, total = scene.options, sum(chunk.data_size for chunk in self._log.chunks)
        encoding = encoding_named(options.encoding)
        self._declare(types_by_topic(encoding, scene.wanted))
        channels = {topic: int(channel.id) for topic, channel in self.added.items()}
        annotations = Annotations(encoding, scene.wanted, channels)
        spans: list[TimeSpan | None] = [None, *time_spans(scene)]
        work = partial(annotate_span, scene, annotations)
        with closing(in_order(work, self._log, spans, options.jobs)) as results:
            for number, (chunks, counts) in enumerate(results, 1):
                self.add(chunks)
                self.counts += counts
                if progress is not None:
                    progress(total * number // len(spans), total)

    def _declare(self, types: Mapping[str, MessageType]) -> None:
        """Declare the channels of annotations, beside those that are copied."""
        in_use = {c.topic: (c.type_name, c.message_encoding) for c in self._copied.values()}
        # Chunks that are copied as they are may describe channels that are left out.
        described = self._log.channels if self._options.copy else {}
        schema_ids = {channel.schema.id for channel in described.values() if channel.schema}
        schemas, self.added = added_channels(types, schema_ids, set(described), in_use)
        self._writer.add(*schemas, *self.added.values())

    def copy_extras(self) -> Iterator[Loss]:
        """Copy attachments and metadata records; yield those that cannot be read."""
        for extra in self._log.extras if self._options.copy else ():
            if (found := read_extra(extra)) is not None:
                self._writer.copy_extra(*found)
                continue
            what = f"the attachment or metadata record at byte {extra.offset} is damaged; left out"
            yield Loss(extra.offset, what, extra.size)

    def finish(self, scene: Scene, losses: Sequence[Loss]) -> None:
        """Write how the file was made, and its end."""
        self._writer.add_metadata(PROVENANCE, provenance(self._log, scene, losses))
        self._writer.finish()


def copied_chunks(
    left_out: frozenset[int], compression: Compression | None, log: Log, batch: Batch
) -> list[Copied]:
    """Copy the messages of a batch: sound chunks of an MCAP verbatim, others in new chunks.

    Args:
        left_out: ids of the channels that are not copied.
        compression: None: zstd, and their own for chunks that are copied as they stand.
        log: the log.
        batch: of its messages.
    """
    batch = batch.without(left_out) if left_out else batch
    chunks: list[Copied] = []
    partial: list[slice] = []
    for loaded in batch.chunks:
        chunk = loaded.chunk
        is_kept = log.copies_chunks and compression in {None, chunk.compression or "none"}
        if is_kept and loaded.whole:
            chunks += _new_chunks(batch, partial, compression)
            partial = []
            # Where processes share the file, its bytes need not be sent from one to another.
            chunks.append(chunk if log.source.can_fork else as_it_stands(chunk, loaded.stored))
        else:
            partial.append(loaded.rows)
    return [*chunks, *_new_chunks(batch, partial, compression)]


def _new_chunks(
    batch: Batch, rows: list[slice], compression: Compression | None
) -> Iterator[FinishedChunk]:
    if not rows:
        return
    own = batch.messages.pick(slice(rows[0].start, rows[-1].stop))
    times = own.log_time, own.publish_time
    records = recorded(own.channel, own.sequence, *times, batch.buffer, own.start, own.end)
    yield from finish_chunks(records, compression or "zstd")


def as_it_stands(chunk: Chunk, stored: bytes | memoryview) -> FinishedChunk:
    """Return a chunk of an MCAP with its own index, both of which are known to be sound.

    Args:
        chunk: in the log.
        stored: its bytes, those of the index included.
    """
    record, index = np.split(np.frombuffer(stored, np.uint8), [chunk.end - chunk.offset])
    times = chunk.start_time or 0, chunk.end_time or 0
    return FinishedChunk(record, index, *times, chunk.compression, chunk.data_size, chunk.size)


def channels_left_out(log: Log, options: ConvertOptions) -> frozenset[int]:
    """Return the ids of the channels that are not copied; annotations are made of all.

    Raises:
        CallError: topics are chosen, but nothing is copied.
    """
    if options.topics and not options.copy:
        raise CallError("--topics chooses what is copied; --no-copy copies nothing")
    return frozenset(
        channel.id
        for channel in log.channels.values()
        if (options.copied_topics and not _fits(channel.topic, options.copied_topics))
        or _fits(channel.topic, options.topics_left_out)
    )


def _fits(topic: str, globs: Sequence[str]) -> bool:
    return any(fnmatchcase(topic, glob) for glob in globs)


def provenance(log: Log, scene: Scene, losses: Sequence[Loss]) -> dict[str, str]:
    """Return how a file was made: no dates, no paths."""
    options, robot = scene.options, scene.selection.robot
    globs = {"topics": options.copied_topics, "without": options.topics_left_out}
    values: dict[str, object] = {
        "version": __version__,
        **{key: getattr(options, key) for key in ("style", "encoding", "copy", "tf")},
        "tf_rate_hz": options.tf_rate,
        "wrench_frame": robot.wrench_frame,
        "force_in_world": scene.walk.settings.force_in_world,
        "robot": robot.name,
        "mass_kg": robot.mass_kg,
        "world_frame": scene.wanted.world_frame,
        "base_frame": scene.wanted.base_frame,
        **{key: " ".join(map(printable, each)) for key, each in globs.items() if each},
        **_origin(log, options, losses),
    }
    return {key: "" if value is None else str(value) for key, value in values.items()}


def _origin(log: Log, options: ConvertOptions, losses: Sequence[Loss]) -> Mapping[str, object]:
    """Return where the recorded messages come from, and what was lost on the way.

    A log that was annotated before still comes from the log which it was made from, as long as it
    is used whole.
    """
    origin = {
        "input": printable(file_name(log.source.path)),
        "container": log.container,
        "start_s": options.start,
        "end_s": options.end,
        "lost_messages": lost_messages(losses),
        "lost_bytes": sum(loss.bytes for loss in losses),
        "damage": "; ".join(loss.what for loss in losses),
    }
    match log.annotations.records if log.annotations else ():
        case [earlier] if not (losses or options.start or options.end):
            return {key: earlier.get(key) for key in origin}
    return origin
