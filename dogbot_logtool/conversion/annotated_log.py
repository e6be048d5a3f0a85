"""The output file of `convert`: the recorded messages, and behind them the annotations.

Recorded messages are copied while they are read for the first time, when nothing is known of the
walk yet. So annotations stand behind all of them, in chunks of their own; the index has both in the
order of time, which is how viewers read a file. A file that was cut off in a transfer still has the
recorded messages.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from functools import partial
from typing import BinaryIO, Final

from mcap import records

from dogbot_logtool import __version__
from dogbot_logtool.conversion.annotate import TimeSpan, annotate_span, time_spans
from dogbot_logtool.conversion.copying import Copied, as_it_stands
from dogbot_logtool.conversion.scene import Scene
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import file_name
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.provenance import PROVENANCE
from dogbot_logtool.reader.containers.log import Chunk, Log
from dogbot_logtool.reader.containers.loss import Loss, lost_messages
from dogbot_logtool.reader.containers.mcap.records import channel_record, read_extra, schema_record
from dogbot_logtool.reader.workers import Start, in_order
from dogbot_logtool.run.runner import OnProgress
from dogbot_logtool.writer.annotations import Annotations, types_by_topic
from dogbot_logtool.writer.channels import added_channels
from dogbot_logtool.writer.chunks import finish_chunk
from dogbot_logtool.writer.encodings.encoding import MessageType
from dogbot_logtool.writer.encodings.registry import encoding_named
from dogbot_logtool.writer.mcap_writer import McapWriter

_LONGEST_NUMBER: Final = 18
"""Digits of a count that a record tells."""


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
        self.counts = Counter[str]()
        """Annotations that lack something, by what."""
        self.added: Mapping[str, records.Channel] = {}
        """Channels of annotations by topic, which is another where the log has that."""
        copied = log.channels if options.copy else {}
        self._copied = {number: c for number, c in copied.items() if number not in left_out}
        schemas = {c.schema.id: c.schema for c in self._copied.values() if c.schema is not None}
        self._writer.add(*(schema_record(schema) for _, schema in sorted(schemas.items())))
        self._writer.add(*(channel_record(each) for _, each in sorted(self._copied.items())))

    @property
    def messages(self) -> dict[int, int]:
        """Messages written, by channel id."""
        return self._writer.channel_counts

    def add(self, chunks: Iterable[Copied]) -> None:
        """Write chunks."""
        for chunk in chunks:
            if isinstance(chunk, Chunk):
                stored = self._log.source.read(chunk.offset, chunk.index_end - chunk.offset)
                self._writer.add_chunk(as_it_stands(chunk, stored))
            else:
                self._writer.add_chunk(chunk)

    def annotate(
        self, scene: Scene, progress: OnProgress | None = None, start: Start | None = None
    ) -> None:
        """Write everything that is drawn of the walk.

        Args:
            scene: what is drawn.
            progress: called with the share done and all, as bytes of the log.
            start: how processes start; None: as the system and the log allow.
        """
        options, total = scene.options, sum(chunk.data_size for chunk in self._log.chunks)
        encoding = encoding_named(options.encoding)
        self._declare(types_by_topic(encoding, scene.wanted), scene.selection.contact_from)
        channels = {topic: int(channel.id) for topic, channel in self.added.items()}
        annotations = Annotations(encoding, scene.wanted, channels)
        if scene.description.urdf is not None and scene.opening is not None:
            message = annotations.robot_description(scene.description.urdf, scene.opening)
            self.add([finish_chunk(message, options.compression or "zstd")])
        spans: list[TimeSpan | None] = [None, *time_spans(scene)]
        work = partial(annotate_span, scene, annotations)
        with closing(in_order(work, self._log, spans, options.jobs, start)) as results:
            for number, (chunks, counts) in enumerate(results, 1):
                self.add(chunks)
                self.counts += counts
                if progress is not None:
                    progress(total * number // len(spans), total)

    def _declare(self, types: Mapping[str, MessageType], contact_from: str) -> None:
        """Declare the channels of annotations, beside those that are copied."""
        in_use = {c.topic: (c.type_name, c.message_encoding) for c in self._copied.values()}
        # Chunks that are copied as they are may describe channels that are left out.
        described = self._log.channels if self._options.copy else {}
        schema_ids = {channel.schema.id for channel in described.values() if channel.schema}
        notes = {"contact_from": contact_from} if contact_from else {}
        schemas, self.added = added_channels(types, schema_ids, set(described), in_use, notes)
        self._writer.add(*schemas, *self.added.values())

    def copy_extras(self) -> Iterator[Loss]:
        """Copy attachments and metadata records; yield those that cannot be read."""
        for extra in self._log.extras if self._options.copy else ():
            match read_extra(extra):
                case (record, records.Metadata() as metadata):
                    self._writer.copy_metadata(record, metadata)
                    continue
                case (record, records.Attachment() as attachment):
                    self._writer.copy_attachment(record, attachment)
                    continue
            what = f"the attachment or metadata record at byte {extra.offset} is damaged; left out"
            yield Loss(extra.offset, what, extra.size)

    def finish(self, scene: Scene, losses: Sequence[Loss]) -> None:
        """Write how the file was made, and its end."""
        self._writer.add_metadata(PROVENANCE, provenance(self._log, scene, losses))
        self._writer.finish()


def provenance(log: Log, scene: Scene, losses: Sequence[Loss]) -> dict[str, str]:
    """Return how a file was made: no dates, no paths."""
    options, robot = scene.options, scene.selection.robot
    values: dict[str, object] = {
        "version": __version__,
        "style": options.style,
        "encoding": options.encoding,
        "copy": options.copy,
        "wrench_frame": robot.wrench_frame,
        "force_in_world": scene.walk.settings.force_in_world,
        "tf": options.tf,
        "tf_rate_hz": options.tf_rate,
        "robot": robot.name,
        "mass_kg": robot.mass_kg,
        "world_frame": scene.wanted.world_frame,
        "base_frame": scene.wanted.base_frame,
        **_copied(options),
        **_origin(log, options),
        **_loss(log, losses),
    }
    return {key: "" if value is None else str(value) for key, value in values.items()}


def _copied(options: ConvertOptions) -> dict[str, object]:
    """Return which topics were copied, where that was not all."""
    globs = {"topics": options.copied_topics, "without": options.topics_left_out}
    return {key: " ".join(map(printable, value)) for key, value in globs.items() if value}


def _origin(log: Log, options: ConvertOptions) -> dict[str, object]:
    """Return where the recorded messages come from.

    For a log that was annotated before, that is the log which it was made from, as long as a part
    of its time is not cut out anew.
    """
    start_s, end_s = options.start, options.end
    earlier = _earlier(log)
    if earlier and not any(
        (start_s, end_s, *(each.get(key) for each in earlier[1:] for key in ("start_s", "end_s")))
    ):
        return {key: earlier[0].get(key) for key in ("input", "container", "start_s", "end_s")}
    return {
        "input": printable(file_name(log.source.path)),
        "container": log.container,
        "start_s": start_s,
        "end_s": end_s,
    }


def _loss(log: Log, losses: Sequence[Loss]) -> dict[str, object]:
    """Return what was lost on the way, also when the log was annotated before."""
    earlier = _earlier(log)
    messages = [lost_messages(losses), *(_number(each.get("lost_messages")) for each in earlier)]
    texts = [*(each.get("damage", "") for each in earlier), *(loss.what for loss in losses)]
    known = [count for count in messages if count is not None]
    return {
        "lost_messages": sum(known) if len(known) == len(messages) else None,
        "lost_bytes": sum(loss.bytes for loss in losses)
        + sum(_number(each.get("lost_bytes")) or 0 for each in earlier),
        "damage": "; ".join(text for text in texts if text),
    }


def _earlier(log: Log) -> Sequence[Mapping[str, str]]:
    annotations = log.annotations
    return annotations.records if annotations else ()


def _number(text: str | None) -> int | None:
    """Return a count that a record tells; None if it tells none."""
    sound = text and text.isascii() and text.isdigit() and len(text) <= _LONGEST_NUMBER
    return int(text) if text and sound else None
