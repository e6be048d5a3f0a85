"""`dogbot-logtool convert`: write an annotated MCAP of a log."""

from collections import Counter
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing
from dataclasses import field, replace
from typing import BinaryIO

from mcap import records

from dogbot_logtool.core.plausible import IMPLAUSIBLE
from dogbot_logtool.core.scene.arrows import ArrowCounts
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding, by_severity
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location
from dogbot_logtool.pipeline.conversion.annotating import annotations_of
from dogbot_logtool.pipeline.conversion.batch import BatchConverter, ConvertedBatch, Counts
from dogbot_logtool.pipeline.conversion.batch_state import BatchState
from dogbot_logtool.pipeline.conversion.events import WalkEvents, event_records, walk_events
from dogbot_logtool.pipeline.conversion.plan import ConversionPlan, make_plan, without_tf
from dogbot_logtool.pipeline.conversion.provenance_record import provenance_record
from dogbot_logtool.pipeline.frames.world_frames import frame_findings
from dogbot_logtool.pipeline.options import ConvertOptions, StatsOptions
from dogbot_logtool.pipeline.probe import probe_recording
from dogbot_logtool.pipeline.probe_findings import order_findings
from dogbot_logtool.pipeline.time_span import refuse_empty_span, time_limits
from dogbot_logtool.pipeline.topics.annotated import open_recorded
from dogbot_logtool.pipeline.topics.selection import select_topics
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.containers.mcap.records import channel_record, read_extra, schema_record
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.salvage.losses import damage_of, malformed_messages, wrong_statistics
from dogbot_logtool.results import Conversion
from dogbot_logtool.run.in_order import OnProgress, in_order_with_state
from dogbot_logtool.writer.annotations import Annotations
from dogbot_logtool.writer.chunks import finish_chunk, finish_chunks
from dogbot_logtool.writer.mcap_writer import McapWriter


@dataclass(slots=True)
class _Tally:
    """Counts of what was converted so far."""

    counts: Counts = field(default_factory=Counts)
    by_channel: Counter[int] = field(default_factory=Counter)
    malformed: Counter[int] = field(default_factory=Counter)
    recorded: Counter[int] = field(default_factory=Counter)
    losses: list[Loss] = field(default_factory=list)
    moved_topics: Mapping[str, str] = field(default_factory=dict)
    second_parent: str | None = None
    """See `ConvertedBatch.second_parent`."""

    def add(self, batch: ConvertedBatch) -> None:
        self.second_parent = batch.second_parent
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
    progress: OnProgress | None = None,
) -> Conversion:
    """Write the annotated MCAP of a log.

    Args:
        source: a ROS 1 bag, a ROS 2 bag or an MCAP.
        target: the file to write; it appears when it is complete.
        options: what the user asks for.
        progress: called with the bytes done and the bytes in all.

    Raises:
        CallError: no such file, a target that may not be written, a topic or time that the log
            does not have.
        LogError: the log cannot be read, or has nothing to annotate.
        LogtoolError: the target cannot be written.
    """
    overwrite, makes_folder = options.overwrite, options.makes_folder
    for file in (source, *options.topics.joined):
        refuse_bad_target(target, file, overwrite=overwrite, makes_folder=makes_folder)
    log = open_recorded(source, options.topics.joined)
    try:
        selection = select_topics(log, options.topics)
        limits = time_limits(log, options.start_s, options.end_s)
        wanted = replace(selection.wanted(), limits=limits)
        recording = read_recording(log, wanted, options.jobs).recording
        probe = probe_recording(recording, selection, with_soles=True)
        plan = make_plan(log, selection, probe, options)
        events = _events(source, log, options, progress)
        annotations, tally = _write(log, target, plan, events, progress)
        if tally.second_parent is not None:
            # The probe, which reads a few chunks only, had not seen it: begin anew without /tf.
            plan = without_tf(plan, tally.second_parent)
            annotations, tally = _write(log, target, plan, events, progress)
        return _conversion(log, target, plan, annotations, tally)
    finally:
        log.close()


def _events(
    source: Location, log: Log, options: ConvertOptions, progress: OnProgress | None
) -> WalkEvents | None:
    """Measure the log for its events; None: they are not wanted."""
    if not options.events:
        return None
    from dogbot_logtool.commands.stats import measure  # noqa: PLC0415 - only where it is wanted

    wanted = StatsOptions(
        topics=options.topics,
        wrench_frame=options.wrench_frame,
        start_s=options.start_s,
        end_s=options.end_s,
        jobs=options.jobs,
    )
    stats = measure(source, wanted, progress).stats
    return walk_events(stats, log.start_time, log.end_time)


def _write(
    log: Log,
    target: Location,
    plan: ConversionPlan,
    events: WalkEvents | None,
    progress: OnProgress | None,
) -> tuple[Annotations, _Tally]:
    """Write the output, or nothing where a second parent of the base contradicts the plan."""
    options = plan.options
    annotations, moved_topics = annotations_of(log, plan)
    tally = _Tally(losses=list(log.losses), moved_topics=moved_topics)
    with whole_file(
        target,
        overwrite=options.overwrite,
        makes_folder=options.makes_folder,
        is_wanted=lambda: tally.second_parent is None,
    ) as file:
        writer = _start(file, log, plan, annotations)
        _write_robot_description(writer, plan, annotations, tally)
        _write_batches(writer, log, plan, annotations, tally, progress)
        if tally.second_parent is None and events is not None:
            _write_events(writer, plan, annotations, events, tally)
        if tally.second_parent is None:
            _write_end(writer, log, plan, tally)
    return annotations, tally


def _write_batches(
    writer: McapWriter,
    log: Log,
    plan: ConversionPlan,
    annotations: Annotations,
    tally: _Tally,
    progress: OnProgress | None,
) -> None:
    """Convert and write all batches, up to a second parent of the base."""
    total = sum(chunk.data_size for chunk in log.chunks)
    done = 0
    with closing(_converted(log, plan, annotations)) as converted:
        for batch in converted:
            tally.add(batch)
            if tally.second_parent is not None:
                return
            for chunk in batch.chunks:
                writer.add_chunk(chunk)
            done += batch.stored_size
            if progress is not None:
                progress(done, total)


def _write_robot_description(
    writer: McapWriter, plan: ConversionPlan, annotations: Annotations, tally: _Tally
) -> None:
    """Write the robot's description at the output's first time."""
    if plan.urdf is None or plan.opening_time is None:
        return
    message = annotations.robot_description(plan.urdf, plan.opening_time)
    chunk = finish_chunk(message, plan.options.compression or "zstd")
    writer.add_chunk(chunk)
    tally.by_channel.update(chunk.counts)


def _write_events(
    writer: McapWriter,
    plan: ConversionPlan,
    annotations: Annotations,
    events: WalkEvents,
    tally: _Tally,
) -> None:
    """Write the messages of `/gait` and `/events`, in chunks of their own."""
    for messages in event_records(annotations, events):
        for chunk in finish_chunks(messages, plan.options.compression or "zstd"):
            writer.add_chunk(chunk)
            tally.by_channel.update(chunk.counts)


def _write_end(writer: McapWriter, log: Log, plan: ConversionPlan, tally: _Tally) -> None:
    """Write what follows the messages."""
    if not tally.losses:
        refuse_empty_span(log, plan.limits, tally.recorded.total())
    if plan.options.copy:
        _copy_extras(log, writer, tally)
    _account_for_damage(log, plan, tally)
    writer.add_metadata(provenance_record(log, plan, tally.losses))
    writer.finish()


def _start(file: BinaryIO, log: Log, plan: ConversionPlan, annotations: Annotations) -> McapWriter:
    """Write the header, schemas and channels."""
    writer = McapWriter(file, log.profile if plan.options.copy else plan.encoding.profile)
    if plan.options.copy:
        copied = {n: c for n, c in log.channels.items() if n not in plan.left_out}
        schemas = {c.schema.id: c.schema for c in copied.values() if c.schema is not None}
        for _, schema in sorted(schemas.items()):
            writer.add_schema(schema_record(schema))
        for _, channel in sorted(copied.items()):
            writer.add_channel(channel_record(channel))
    for ours_schema in annotations.added.schemas:
        writer.add_schema(ours_schema)
    for ours_channel in annotations.added.channels:
        writer.add_channel(ours_channel)
    return writer


def _converted(
    log: Log, plan: ConversionPlan, annotations: Annotations
) -> Generator[ConvertedBatch, None, None]:
    """Convert all batches of a log."""
    return in_order_with_state(
        BatchConverter(log, plan, annotations),
        log.spans(*plan.limits),
        plan.options.jobs,
        BatchState.initial(plan),
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


def _account_for_damage(log: Log, plan: ConversionPlan, tally: _Tally) -> None:
    """Turn malformed messages and a wrong index into losses."""
    if plan.limits == (None, None):
        tally.losses.extend(wrong_statistics(log, tally.recorded, tally.losses))
    consequence = ": copied, but not annotated"
    tally.losses.extend(malformed_messages(log.channels, tally.malformed, consequence))


def _conversion(
    log: Log, target: Location, plan: ConversionPlan, annotations: Annotations, tally: _Tally
) -> Conversion:
    topics = annotations.added.topics()
    ours = {topic: tally.by_channel.get(channel, 0) for channel, topic in topics.items()}
    copied = sum(n for channel, n in tally.by_channel.items() if channel not in topics)
    ordered = order_findings(log, tally.counts.out_of_order)
    findings = (*plan.findings, *ordered, *_findings(plan, tally))
    return Conversion(
        source=log.source.path,
        target=target,
        container=log.container,
        robot=plan.selection.robot,
        style=plan.options.style,
        encoding=plan.options.encoding,
        odometry_topics=tuple(sorted({each.topic for each in plan.selection.odometry})),
        world_frame=plan.world_frame,
        base_frame=plan.base_frame,
        messages=tally.recorded.total(),
        copied=copied,
        annotations=ours,
        counts=tally.counts,
        findings=tuple(sorted(findings, key=by_severity)),
        damage=damage_of(log, tally.losses),
    )


def _findings(plan: ConversionPlan, tally: _Tally) -> Iterator[Finding]:
    """Yield findings about what was counted while converting."""
    if plan.frames is not None:
        yield from frame_findings(plan.frames, tally.counts.frames)
    for topic, name in tally.moved_topics.items():
        text = f"the log has a topic {topic} of another type: ours is {name}"
        yield Finding("TOPIC_MOVED", text, name)
    counts = tally.counts
    untimed = 0 if plan.style.needs_contact_states else counts.untimed_messages
    for count, finding in (
        (
            counts.bad_poses,
            Finding("NOT_FINITE", "poses with NaN or a zero quaternion (no /tf)", cases=("base",)),
        ),
        (counts.implausible, Finding("NOT_FINITE", IMPLAUSIBLE)),
        (
            untimed,
            Finding("STATES_IGNORED", "contacts without a physics step (taken as one step)"),
        ),
        (
            counts.foreign_states,
            Finding("STATES_IGNORED", "contact states between other bodies (ignored)"),
        ),
        *_arrow_findings(counts.arrows),
        (
            counts.support_unknown,
            Finding(
                "NO_SUPPORT_DRAWN",
                "/support messages without a polygon (contact of some foot unknown)",
            ),
        ),
        (
            counts.support_unweighed,
            Finding(
                "NO_SUPPORT_DRAWN",
                "/support messages without a centre of pressure (vertical forces unknown)",
            ),
        ),
    ):
        if count:
            yield replace(finding, text=f"{finding.text}: {count:,}")


def _arrow_findings(skipped: ArrowCounts) -> Iterator[tuple[int, Finding]]:
    """Yield the contacts without an arrow by reason, with their finding."""
    yield (
        skipped.not_finite,
        Finding("NOT_FINITE", "contacts with NaN or infinity (not drawn)"),
    )
    yield skipped.no_position, Finding("NOT_DRAWN", "contacts without a point (not drawn)")
    yield skipped.no_direction, Finding("NOT_DRAWN", "contacts without a normal (not drawn)")
    yield (
        skipped.overflow,
        Finding("NOT_FINITE", "contacts whose force squared overflows (not drawn, as live)"),
    )
