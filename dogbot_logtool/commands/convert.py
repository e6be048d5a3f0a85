"""`dogbot-logtool convert`: a recorded walk becomes an annotated MCAP."""

from collections import Counter
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field
from typing import BinaryIO

from mcap import records

from dogbot_logtool.core.plausible import IMPLAUSIBLE
from dogbot_logtool.errors import LogError
from dogbot_logtool.finding import Finding, by_severity, note, warning
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.pipeline.annotated import open_recorded
from dogbot_logtool.pipeline.conversion.batch import BatchConverter, ConvertedBatch, Counts
from dogbot_logtool.pipeline.conversion.carried import Carried
from dogbot_logtool.pipeline.conversion.channels import annotations_of
from dogbot_logtool.pipeline.conversion.provenance_record import provenance_record
from dogbot_logtool.pipeline.options import ConvertOptions
from dogbot_logtool.pipeline.plan import Plan, make_plan, without_tf
from dogbot_logtool.pipeline.probe import look_into
from dogbot_logtool.pipeline.selection import select_topics
from dogbot_logtool.pipeline.time_span import refuse_empty_span
from dogbot_logtool.pipeline.world_frames import frame_findings
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.containers.mcap.extras import read_extra
from dogbot_logtool.reader.salvage.losses import undecodable, wrong_statistics
from dogbot_logtool.results import Conversion
from dogbot_logtool.run.relay import Progress, relayed
from dogbot_logtool.writer.annotations import Annotations
from dogbot_logtool.writer.mcap_writer import McapWriter


class _BaseHasParent(Exception):  # noqa: N818 - it never leaves this module
    """The log's own transforms place the base, which a quick look had not shown."""

    def __init__(self, parent: str) -> None:
        super().__init__(parent)
        self.parent = parent


@dataclass(slots=True)
class _Tally:
    """What has happened so far."""

    counts: Counts = field(default_factory=Counts)
    by_channel: Counter[int] = field(default_factory=Counter)
    malformed: Counter[int] = field(default_factory=Counter)
    recorded: Counter[int] = field(default_factory=Counter)
    losses: list[Loss] = field(default_factory=list)
    moved_topics: Mapping[str, str] = field(default_factory=dict)

    def add(self, batch: ConvertedBatch) -> None:
        self.counts += batch.counts
        self.losses.extend(batch.losses)
        self.malformed.update(batch.malformed)
        self.recorded.update(batch.recorded)
        for chunk in batch.chunks:
            self.by_channel.update(chunk.counts)


def convert(
    source: Location,
    target: Location,
    options: ConvertOptions,
    progress: Progress | None = None,
) -> Conversion:
    """Write the annotated MCAP of a log.

    Args:
        source: a ROS 1 bag or an MCAP.
        target: the file to write; it appears only when it is whole.
        options: what is asked for.
        progress: is told how far it has come.

    Raises:
        CallError: no such file, a target that may not be written, a topic or time that the log
            does not have.
        LogError: the log cannot be read, has nothing to annotate, or is damaged and `strict`.
        LogtoolError: the target cannot be written.
    """
    overwrite, makes_folder = options.overwrite, options.makes_folder
    refuse_bad_target(target, source, overwrite=overwrite, makes_folder=makes_folder)
    log = open_recorded(source)
    try:
        selection = select_topics(log, options.topics)
        plan = make_plan(log, selection, look_into(log, selection), options)
        try:
            return _write(log, target, plan, progress)
        except _BaseHasParent as surprise:
            plan = without_tf(plan, surprise.parent)
            return _write(log, target, plan, progress)
    finally:
        log.close()


def _write(log: Log, target: Location, plan: Plan, progress: Progress | None) -> Conversion:
    total = sum(chunk.data_size for chunk in log.chunks)
    done = 0
    options = plan.options
    with whole_file(target, overwrite=options.overwrite, makes_folder=options.makes_folder) as file:
        annotations, moved_topics = annotations_of(log, plan)
        tally = _Tally(losses=list(log.losses), moved_topics=moved_topics)
        writer = _start(file, log, plan, annotations)
        with closing(_converted(log, plan, annotations)) as converted:
            for batch in converted:
                if batch.other_parent is not None:
                    raise _BaseHasParent(batch.other_parent)
                tally.add(batch)
                for chunk in batch.chunks:
                    writer.add_chunk(chunk)
                done += batch.stored_size
                if progress is not None:
                    progress(done, total)
        if not tally.losses:
            refuse_empty_span(log, plan.limits, tally.recorded.total())
        if options.copy:
            _copy_extras(log, writer, tally)
        _account_for_damage(log, plan, tally)
        writer.add_metadata(provenance_record(log, plan, tally.losses))
        writer.finish()
    return _conversion(log, target, plan, annotations, tally)


def _start(file: BinaryIO, log: Log, plan: Plan, annotations: Annotations) -> McapWriter:
    """Write the header and everything that messages refer to."""
    ours = "" if plan.options.encoding == "foxglove" else plan.options.encoding
    writer = McapWriter(file, log.profile if plan.options.copy else ours)
    if plan.options.copy:
        schemas = {c.schema.id: c.schema for c in log.channels.values() if c.schema is not None}
        for _, schema in sorted(schemas.items()):
            writer.add_schema(
                records.Schema(
                    id=schema.id, name=schema.name, encoding=schema.encoding, data=schema.data
                )
            )
        for _, channel in sorted(log.channels.items()):
            writer.add_channel(
                records.Channel(
                    id=channel.id,
                    topic=channel.topic,
                    message_encoding=channel.message_encoding,
                    metadata=dict(channel.metadata),
                    schema_id=channel.schema.id if channel.schema else 0,
                )
            )
    for ours_schema in annotations.schemas:
        writer.add_schema(ours_schema)
    for ours_channel in annotations.channels:
        writer.add_channel(ours_channel)
    return writer


def _converted(
    log: Log, plan: Plan, annotations: Annotations
) -> Generator[ConvertedBatch, None, None]:
    """Convert all batches of a log."""
    return relayed(
        BatchConverter(log, plan, annotations),
        log.spans(*plan.limits),
        plan.options.jobs,
        Carried.nothing(plan),
        forks=log.can_fork,
    )


def _copy_extras(log: Log, writer: McapWriter, tally: _Tally) -> None:
    """Copy attachments and metadata records."""
    for extra in log.extras:
        match read_extra(log.source_of(extra), extra):
            case (record, records.Metadata() as metadata):
                writer.copy_metadata(record, metadata)
                continue
            case (record, records.Attachment() as attachment):
                writer.copy_attachment(record, attachment)
                continue
        what = f"the attachment or metadata record at byte {extra.offset} is damaged; left out"
        tally.losses.append(Loss(extra.offset, what, extra.size))


def _account_for_damage(log: Log, plan: Plan, tally: _Tally) -> None:
    """Turn malformed messages and a wrong index into losses.

    Raises:
        LogError: there is damage, and the user asked for it to be an error.
    """
    if plan.limits == (None, None):
        tally.losses.extend(wrong_statistics(log, tally.recorded, tally.losses))
    consequence = ": copied, but not annotated"
    tally.losses.extend(undecodable(log.channels, tally.malformed, consequence))
    if tally.losses and plan.options.strict:
        first = tally.losses[0]
        raise LogError(
            f"{shown(log.source.path)}: is damaged, and --strict refuses that: {first.what}"
            + (f" (and {len(tally.losses) - 1} more)" if len(tally.losses) > 1 else "")
        )


def _conversion(
    log: Log, target: Location, plan: Plan, annotations: Annotations, tally: _Tally
) -> Conversion:
    topics = annotations.topics()
    ours = {topic: tally.by_channel.get(channel, 0) for channel, topic in topics.items()}
    copied = sum(n for channel, n in tally.by_channel.items() if channel not in topics)
    findings = (*plan.findings, *_findings(plan, tally))
    return Conversion(
        source=log.source.path,
        target=target,
        container=log.container,
        plan=plan,
        messages=tally.recorded.total(),
        copied=copied,
        annotations=ours,
        counts=tally.counts,
        findings=tuple(sorted(findings, key=by_severity)),
        losses=tuple(tally.losses),
    )


def _findings(plan: Plan, tally: _Tally) -> Iterator[Finding]:
    """Say what was counted on the way."""
    if plan.frames is not None:
        yield from frame_findings(plan.frames, tally.counts.frames)
    for topic, name in tally.moved_topics.items():
        text = f"the log has a topic {topic} of another type, so ours is {name}"
        yield note("TOPIC_MOVED", text, name)
    counts, arrows = tally.counts, tally.counts.arrows
    unknown, unweighed = counts.support_unknown, counts.support_unweighed
    untimed = 0 if plan.options.style == "classic" else counts.untimed_messages
    for count, say, code, text in (
        (counts.bad_poses, warning, "BAD_POSES", "poses not written for NaN or a zero quaternion"),
        (counts.implausible, warning, "IMPLAUSIBLE", IMPLAUSIBLE),
        (arrows.not_finite, warning, "NOT_FINITE", "contacts not drawn for NaN or infinity"),
        (arrows.no_position, warning, "NO_POSITION", "contacts not drawn for want of a point"),
        (arrows.no_direction, warning, "NO_DIRECTION", "contacts not drawn for want of a normal"),
        (arrows.overflow, warning, "OVERFLOW", "forces skipped, as live, for overflow of a square"),
        (untimed, warning, "UNTIMED_STATES", "contacts that tell no physics step, taken for one"),
        (
            unknown,
            note,
            "SUPPORT_UNKNOWN",
            "/support without polygon, not knowing which feet are down",
        ),
        (
            unweighed,
            note,
            "NO_PRESSURE",
            "/support without centre of pressure, not knowing vertical forces",
        ),
        (counts.foreign_states, note, "FOREIGN_STATES", "contact states of other pairs, left out"),
    ):
        if count:
            yield say(code, f"{text}: {count:,}")
