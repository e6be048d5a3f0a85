"""`dogbot-logtool convert`: write an annotated MCAP of a log."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from typing import BinaryIO

from mcap import records

from dogbot_logtool.commands.stats import MeasuredLog, measure_log
from dogbot_logtool.conversion.annotate import DrawnCounts, Scene, draw
from dogbot_logtool.conversion.plan import ConversionPlan, make_plan
from dogbot_logtool.conversion.provenance import provenance_record
from dogbot_logtool.conversion.writing import SpanWriter, annotations_of, cut_spans
from dogbot_logtool.core.base.poses import usable_poses
from dogbot_logtool.core.known_frames import with_soles
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding, by_severity
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location
from dogbot_logtool.reader.containers.log import Log, Loss
from dogbot_logtool.reader.containers.mcap.records import channel_record, read_extra, schema_record
from dogbot_logtool.reader.salvage.losses import damage_of, malformed_messages, wrong_statistics
from dogbot_logtool.reader.workers import Start, in_order
from dogbot_logtool.results import Conversion
from dogbot_logtool.robot.options import ConvertOptions, StatsOptions
from dogbot_logtool.robot.time_span import time_limits
from dogbot_logtool.robot.topics.annotated import open_recorded
from dogbot_logtool.run.runner import OnProgress
from dogbot_logtool.writer.annotations import Annotations
from dogbot_logtool.writer.chunks import finish_chunk
from dogbot_logtool.writer.mcap_writer import McapWriter


@dataclass(frozen=True, slots=True)
class _Written:
    """What was written."""

    by_channel: Mapping[int, int]
    """Messages by channel id."""
    counts: DrawnCounts
    losses: Sequence[Loss]
    """All that could not be read."""


def convert(
    source: Location,
    target: Location,
    options: ConvertOptions,
    progress: OnProgress | None = None,
    start: Start | None = None,
) -> Conversion:
    """Write the annotated MCAP of a log.

    Args:
        source: a ROS 1 bag, a ROS 2 bag or an MCAP.
        target: the file to write; it appears when it is complete.
        options: what the user asks for.
        progress: called with the bytes done and the bytes in all.
        start: how processes start; None: as the system and the log allow.

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
        first, second = _halves(progress)
        measured = measure_log(log, _measuring(options), first)
        walk, metrics = measured.measurement.stats, measured.measurement.metrics
        frames = with_soles(walk.frames, measured.read.recording, walk.settings)
        plan = make_plan(log, measured.selection, walk, frames, options)
        scene = draw(plan, walk, metrics, _end(log, options))
        annotations, moved = annotations_of(log, plan)
        writer = SpanWriter(scene, annotations, time_limits(log, options.start_s, options.end_s))
        written = _write(log, target, writer, measured, second, start)
        findings = _findings(scene, measured, moved, written.counts)
        return _conversion(log, target, writer, measured, written, findings)
    finally:
        log.close()


def _measuring(options: ConvertOptions) -> StatsOptions:
    """Return the options of what is drawn, as `stats` takes them."""
    return StatsOptions(
        topics=options.topics,
        wrench_frame=options.wrench_frame,
        start_s=options.start_s,
        end_s=options.end_s,
        jobs=options.jobs,
    )


def _halves(progress: OnProgress | None) -> tuple[OnProgress | None, OnProgress | None]:
    """Return callbacks of the two passes over a log."""
    if progress is None:
        return None, None
    return (
        lambda done, total: progress(done, 2 * total),
        lambda done, total: progress(total + done, 2 * total),
    )


def _end(log: Log, options: ConvertOptions) -> int:
    """Return the log time, ns, of the last message that is taken."""
    _, end = time_limits(log, options.start_s, options.end_s)
    last = log.end_time or 0
    return last if end is None else min(end, last)


def _write(
    log: Log,
    target: Location,
    span_writer: SpanWriter,
    measured: MeasuredLog,
    progress: OnProgress | None,
    start: Start | None,
) -> _Written:
    """Write the output."""
    plan, spans = span_writer.scene.plan, measured.read.spans
    options, annotations = plan.options, span_writer.annotations
    counts, done, total = DrawnCounts(), 0, sum(chunk.data_size for chunk in log.chunks)
    with whole_file(target, overwrite=options.overwrite, makes_folder=options.makes_folder) as file:
        writer = _start(file, log, plan, annotations)
        if plan.description.urdf is not None and plan.opening is not None:
            message = annotations.robot_description(plan.description.urdf, plan.opening)
            writer.add_chunk(finish_chunk(message, options.compression or "zstd"))
        with closing(in_order(span_writer, log, cut_spans(spans), options.jobs, start)) as results:
            for span, result in zip(spans, results, strict=True):
                for chunk in (*span_writer.unread(log, span), *result.chunks):
                    writer.add_chunk(chunk)
                counts += result.counts
                done += sum(chunk.data_size for chunk in span.chunks)
                if progress is not None:
                    progress(done, total)
        losses = _write_end(writer, log, span_writer, measured)
    return _Written(writer.channel_counts, counts, losses)


def _write_end(
    writer: McapWriter, log: Log, span_writer: SpanWriter, measured: MeasuredLog
) -> list[Loss]:
    """Write what follows the messages; return all that could not be read."""
    plan, read = span_writer.scene.plan, measured.read
    losses = [*log.losses, *read.losses]
    if plan.options.copy:
        losses.extend(_copy_extras(log, writer))
    if span_writer.limits == (None, None):
        losses.extend(wrong_statistics(log, read.counts, losses))
    losses.extend(malformed_messages(log.channels, read.malformed, ": copied, but not annotated"))
    in_world = measured.measurement.stats.settings.force_in_world
    writer.add_metadata(provenance_record(log, plan, losses, force_in_world=in_world))
    writer.finish()
    return losses


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


def _copy_extras(log: Log, writer: McapWriter) -> Iterator[Loss]:
    """Copy attachments and metadata records; yield those that cannot be read."""
    for extra in log.extras:
        match read_extra(extra):
            case (record, records.Metadata() as metadata):
                writer.copy_metadata(record, metadata)
                continue
            case (record, records.Attachment() as attachment):
                writer.copy_attachment(record, attachment)
                continue
        what = f"the attachment or metadata record at byte {extra.offset} is damaged; left out"
        yield Loss(extra.offset, what, extra.size)


def _conversion(
    log: Log,
    target: Location,
    span_writer: SpanWriter,
    measured: MeasuredLog,
    written: _Written,
    findings: Iterable[Finding],
) -> Conversion:
    plan, read = span_writer.scene.plan, measured.read
    topics = span_writer.annotations.added.topics()
    ours = {topic: written.by_channel.get(channel, 0) for channel, topic in topics.items()}
    copied = sum(n for channel, n in written.by_channel.items() if channel not in topics)
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
        messages=sum(read.counts.values()),
        copied=copied,
        annotations=ours,
        counts=written.counts,
        bad_poses=_bad_poses(read.recording),
        findings=tuple(sorted(dict.fromkeys(findings), key=by_severity)),
        damage=damage_of(log, written.losses),
    )


def _bad_poses(recording: Recording) -> int:
    return int((~usable_poses(recording.base)).sum())


def _findings(
    scene: Scene, measured: MeasuredLog, moved: Mapping[str, str], counts: DrawnCounts
) -> Iterator[Finding]:
    """Yield what was found in planning, measuring and drawing."""
    plan, recording, skipped = scene.plan, measured.read.recording, counts.arrows
    yield from (*plan.findings, *measured.measurement.facts.findings, *scene.findings)
    for topic, name in moved.items():
        text = f"the log has a topic {topic} of another type: ours is {name}"
        yield Finding("TOPIC_MOVED", text, name)
    if bad := _bad_poses(recording):
        text = f"poses with NaN or a zero quaternion (no /tf): {bad:,}"
        yield Finding("NOT_FINITE", text, cases=("base",))
    untimed = 0 if plan.style.needs_contact_states else recording.untimed_messages
    for count, code, text in (
        (untimed, "STATES_IGNORED", "contacts without a physics step (taken as one step)"),
        (
            recording.foreign_states,
            "STATES_IGNORED",
            "contact states between other bodies (ignored)",
        ),
        (skipped.not_finite, "NOT_FINITE", "contacts with NaN or infinity (not drawn)"),
        (skipped.no_position, "NOT_DRAWN", "contacts without a point (not drawn)"),
        (skipped.no_direction, "NOT_DRAWN", "contacts without a normal (not drawn)"),
        (
            skipped.overflow,
            "NOT_FINITE",
            "contacts whose force squared overflows (not drawn, as live)",
        ),
        (
            counts.support_unknown,
            "NO_SUPPORT_DRAWN",
            "/support messages without a polygon (contact of some foot unknown)",
        ),
        (
            counts.support_unweighed,
            "NO_SUPPORT_DRAWN",
            "/support messages without a centre of pressure (vertical forces unknown)",
        ),
    ):
        if count:
            yield Finding(code, f"{text}: {count:,}")
