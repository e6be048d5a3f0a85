"""The output file of `convert`: the recorded messages, and behind them the annotations.

Recorded messages are copied while they are read for the first time, when nothing is known of the
walk yet. So annotations stand behind all of them, in chunks of their own; the index has both in the
order of time, which is how viewers read a file. A file that was cut off in a transfer still has the
recorded messages.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import closing
from typing import BinaryIO

from mcap import records

from dogbot_logtool.conversion.annotate import Scene
from dogbot_logtool.conversion.copying import CopiedSpan, as_it_stands
from dogbot_logtool.conversion.writing import SpanWriter, time_spans
from dogbot_logtool.core.scene.arrows import Arrows, no_arrows
from dogbot_logtool.options import ConvertOptions
from dogbot_logtool.reader.containers.log import Chunk, Log, Loss
from dogbot_logtool.reader.containers.mcap.records import channel_record, read_extra, schema_record
from dogbot_logtool.reader.growing import GrowingColumns
from dogbot_logtool.reader.workers import Start, in_order
from dogbot_logtool.run.runner import OnProgress
from dogbot_logtool.writer.annotations import Annotations
from dogbot_logtool.writer.chunks import finish_chunk
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from dogbot_logtool.writer.mcap_writer import McapWriter


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
        profile = log.profile if options.copy else ENCODINGS[options.encoding].profile
        self._log, self._options = log, options
        self._writer = McapWriter(file, profile)
        self._arrows = GrowingColumns[Arrows]()
        self._arrow_counts = Counter[str]()
        if options.copy:
            copied = {n: c for n, c in log.channels.items() if n not in left_out}
            schemas = {c.schema.id: c.schema for c in copied.values() if c.schema is not None}
            self._describe(
                (schema_record(schema) for _, schema in sorted(schemas.items())),
                (channel_record(channel) for _, channel in sorted(copied.items())),
            )

    @property
    def messages(self) -> dict[int, int]:
        """Messages written, by channel id."""
        return self._writer.channel_counts

    def copy(self, span: CopiedSpan) -> None:
        """Write recorded messages, and keep the arrows that are made of them."""
        for chunk in span.chunks:
            if isinstance(chunk, Chunk):
                stored = self._log.source.read(chunk.offset, chunk.index_end - chunk.offset)
                self._writer.add_chunk(as_it_stands(chunk, stored))
            else:
                self._writer.add_chunk(chunk)
        self._arrows.add(span.arrows)
        self._arrow_counts += span.counts

    def recorded_arrows(self) -> Arrows:
        """Return the arrows that were made of recorded messages."""
        return self._arrows.finish(no_arrows())

    def annotate(
        self,
        scene: Scene,
        annotations: Annotations,
        progress: OnProgress | None = None,
        start: Start | None = None,
    ) -> Counter[str]:
        """Write everything that is drawn of the walk.

        Args:
            scene: what is drawn.
            annotations: as which messages.
            progress: called with the share done and all, as bytes of the log.
            start: how processes start; None: as the system and the log allow.
        """
        plan, total = scene.plan, sum(chunk.data_size for chunk in self._log.chunks)
        self._describe(annotations.added.schemas, annotations.added.channels)
        if plan.description.urdf is not None and plan.opening is not None:
            message = annotations.robot_description(plan.description.urdf, plan.opening)
            self._writer.add_chunk(finish_chunk(message, plan.options.compression or "zstd"))
        counts, spans = self._arrow_counts.copy(), time_spans(scene)
        work = SpanWriter(scene, annotations)
        with closing(in_order(work, self._log, spans, plan.options.jobs, start)) as results:
            for number, result in enumerate(results, 1):
                for chunk in result.chunks:
                    self._writer.add_chunk(chunk)
                counts += result.counts
                if progress is not None:
                    progress(total * number // len(spans), total)
        return counts

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

    def finish(self, provenance: records.Metadata) -> None:
        """Write how the file was made, and its end."""
        self._writer.add_metadata(provenance)
        self._writer.finish()

    def _describe(
        self, schemas: Iterable[records.Schema], channels: Iterable[records.Channel]
    ) -> None:
        for schema in schemas:
            self._writer.add_schema(schema)
        for channel in channels:
            self._writer.add_channel(channel)
