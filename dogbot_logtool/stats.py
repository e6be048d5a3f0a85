"""`dogbot-logtool stats`: which gait, how loaded, and can the recording be trusted."""

from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core.arrays import Ints, rows_by_group
from dogbot_logtool.core.clock import TimeSource, UnusableStamps
from dogbot_logtool.core.contacts import Samples
from dogbot_logtool.core.curves import CurveDetail
from dogbot_logtool.core.odometry import Odometry
from dogbot_logtool.core.settings import FootPlace, StatsSettings
from dogbot_logtool.core.silent_swing import SwingTeller
from dogbot_logtool.core.walk_stats import Stats, StatsAccumulator
from dogbot_logtool.core.wrench_frame import WrenchFrame
from dogbot_logtool.errors import LogError
from dogbot_logtool.evidence import (
    Evidence,
    WrenchFrameOption,
    evidence_findings,
    frame_names,
    look_into,
)
from dogbot_logtool.findings import Finding
from dogbot_logtool.parallel import Progress, in_order
from dogbot_logtool.reader.columns import Texts
from dogbot_logtool.reader.contact_sources.registry import read_contacts
from dogbot_logtool.reader.contact_sources.source import FootChannels
from dogbot_logtool.reader.log import Batch, Log, Loss, Span, lost_messages
from dogbot_logtool.reader.losses import undecodable
from dogbot_logtool.reader.messages import DecodedMessages
from dogbot_logtool.reader.odometry import decode_odometry, joined_odometry
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.report.stats_json import LogFacts
from dogbot_logtool.robot import Robot
from dogbot_logtool.selection import (
    Selection,
    TopicOptions,
    nothing_to_do,
    select_topics,
    time_limits,
)
from dogbot_logtool.storage import Location, shown
from dogbot_logtool.world_frames import (
    BatchFrames,
    StreamedFrames,
    WorldFrames,
    follow_frames,
    read_frames,
)

TimeSourceOption = Literal["header", "log"]
_FRAMES: Final = {"world": WrenchFrame.WORLD, "link": WrenchFrame.LINK}


@dataclass(frozen=True, slots=True)
class StatsOptions:
    """What a user asks of `stats`. What is None is the robot's."""

    topics: TopicOptions = field(default_factory=TopicOptions)
    wrench_frame: WrenchFrameOption = "auto"
    forward_axis: str | None = None
    contact_on_n: float | None = None
    contact_off_n: float | None = None
    debounce_s: float | None = None
    time_source: TimeSourceOption | None = None
    """None: header stamps, or log time where those cannot be used."""
    start_s: float | None = None
    """s since the log's start; also `end_s`."""
    end_s: float | None = None
    jobs: int = 1
    curves: CurveDetail | None = None
    """Keep load curves for drawing; None: none."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """All figures of a log, and what is known of the log itself."""

    stats: Stats
    facts: LogFacts
    losses: tuple[Loss, ...]

    @property
    def exit_code(self) -> int:
        """0: done; 3: done, but the log was damaged."""
        return 3 if self.losses else 0


@dataclass(frozen=True, slots=True)
class _Times:
    """Times of a topic's messages in a batch, for its quality."""

    topic: str
    log_time: Ints
    stamp: Ints | None
    frame_ids: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MeasuredBatch:
    """What a batch holds of use."""

    samples: Sequence[Samples]
    odometry: Odometry
    frames: BatchFrames | None
    """What it tells of the links; None where no force must be turned into the world."""
    times: Sequence[_Times]
    malformed: Mapping[int, int]
    losses: Sequence[Loss]
    messages: int
    stored_size: int


@dataclass(frozen=True, slots=True)
class BatchMeasurer:
    """Reads batches; called in several threads or processes at once."""

    selection: Selection
    feet: FootChannels
    frames: WorldFrames | None
    """What turns forces into the world; None where none must be."""
    limits: tuple[int | None, int | None]
    """ns, log times from which and up to which messages are taken; None: no limit."""

    def __call__(self, log: Log, span: Span) -> MeasuredBatch:
        """Read and decode one batch."""
        return _measure_batch(log, self.selection, self.feet, span, self.limits, self.frames)


BatchSource = Callable[[Log, BatchMeasurer, Iterable[Span]], Generator[MeasuredBatch, None, None]]
"""Measures batches of a log and hands them back in order."""


def measure(
    path: Location,
    options: StatsOptions,
    progress: Progress | None = None,
    batches: BatchSource | None = None,
) -> Measurement:
    """Work out all figures of a log.

    Args:
        path: the log.
        options: what is asked for.
        progress: is told how far it has come.
        batches: who reads the batches; None: this machine.

    Raises:
        CallError: no such file, or a topic in the options that the log does not have.
        LogError: it is no log, or has nothing to measure.
    """
    log = open_log(path)
    try:
        selection = select_topics(log, options.topics)
        if not selection.odometry and not selection.contacts:
            raise LogError(nothing_to_do(log))
        evidence = look_into(log, selection)
        try:
            settings = _settings(selection, evidence, options)
            return _pass(log, selection, evidence, settings, options, progress, batches)
        except UnusableStamps as reason:
            settings = _settings(selection, evidence, options, log_time_because=str(reason))
            return _pass(log, selection, evidence, settings, options, progress, batches)
    finally:
        log.close()


def _settings(
    selection: Selection, evidence: Evidence, options: StatsOptions, log_time_because: str = ""
) -> StatsSettings:
    robot: Robot = selection.robot
    headless = [source.type_name for source in selection.sources if not source.has_header]
    if headless and not options.time_source and not log_time_because:
        log_time_because = f"messages of {headless[0]} have no header"
    chosen = TimeSource(options.time_source) if options.time_source else None
    return StatsSettings(
        feet=tuple(
            FootPlace(
                foot.name,
                foot.topic,
                foot.place,
                has_force=selection.knows_force(index),
            )
            for index, foot in enumerate(robot.feet)
        ),
        mass_kg=robot.mass_kg,
        forward_axis=options.forward_axis or robot.forward_axis,
        foot_rolling_m=robot.foot_rolling_m,
        contact_on_n=options.contact_on_n or robot.contact_on_n,
        contact_off_n=options.contact_off_n or robot.contact_off_n,
        contact_on_counts=robot.contact_on_counts,
        debounce_s=robot.debounce_s if options.debounce_s is None else options.debounce_s,
        wrench_frame=_FRAMES.get(options.wrench_frame, evidence.wrench_frame.frame),
        time_source=TimeSource.LOG if log_time_because else chosen,
        time_source_reason=log_time_because,
        odometry_topic=selection.odometry[0].topic if selection.odometry else "",
    )


def _pass(
    log: Log,
    selection: Selection,
    evidence: Evidence,
    settings: StatsSettings,
    options: StatsOptions,
    progress: Progress | None,
    batches: BatchSource | None,
) -> Measurement:
    """Read the log once, feeding all messages to the figures in order."""
    start, end = time_limits(log, options.start_s, options.end_s)
    accumulator = StatsAccumulator(settings, options.curves)
    losses = list(log.losses)
    malformed: Counter[int] = Counter()
    messages = done = 0
    total = sum(chunk.data_size for chunk in log.chunks)

    frames = _frames(selection, evidence, settings)
    forces = StreamedFrames(frames) if frames else None
    swings = SwingTeller(
        evidence.intervals,
        log.start_time if start is None else None,
        log.end_time if end is None else None,
    )
    feet = replace(
        selection.foot_channels(settings.contact_on_n, settings.contact_off_n),
        left_after_ns=evidence.left_after_ns,
    )

    measurer = BatchMeasurer(selection, feet, frames, (start, end))
    spans = log.spans(start, end)
    if batches is None:
        measured = in_order(partial(measurer, log), spans, options.jobs, forks=log.can_fork)
    else:
        measured = batches(log, measurer, spans)
    for batch in measured:
        accumulator.add_odometry(batch.odometry)
        ready = swings.add(batch.samples)
        if forces is not None and batch.frames is not None:
            ready = forces.add(ready, batch.frames)
        for samples in ready:
            accumulator.add_contacts(samples)
        for times in batch.times:
            accumulator.add_message_times(times.topic, times.log_time, times.stamp, times.frame_ids)
        losses.extend(batch.losses)
        malformed.update(batch.malformed)
        messages += batch.messages
        done += batch.stored_size
        if progress is not None:
            progress(done, total)
    for samples in swings.finish():
        accumulator.add_contacts(samples)
    losses.extend(undecodable(log.channels, malformed))
    # The figures have a finding of their own for each topic's stamps.
    seen = [f for f in evidence_findings(selection, evidence) if f.code != "W_ZERO_STAMPS"]
    findings = [*selection.findings, *seen]
    if forces is not None:
        findings.extend(forces.findings())
    facts = _facts(log, selection.robot.name, findings, messages, losses)
    return Measurement(accumulator.finish(), facts, tuple(losses))


def _frames(
    selection: Selection, evidence: Evidence, settings: StatsSettings
) -> WorldFrames | None:
    """Return the frames that turn forces into the world, where they need it.

    Places of sensors are left out: the origin of a foot's frame is no contact point, so neither
    slip nor the support polygon may be measured with it.
    """
    world, base = frame_names(selection.robot, evidence)
    return follow_frames(
        selection,
        evidence,
        world,
        base,
        settings.clock,
        turn_forces=settings.wrench_frame is WrenchFrame.LINK,
        place_sensors=False,
    )


def _measure_batch(
    log: Log,
    selection: Selection,
    feet: FootChannels,
    span: Span,
    limits: tuple[int | None, int | None],
    frames: WorldFrames | None,
) -> MeasuredBatch:
    batch = log.read(span).cropped(*limits)
    decoded = decode_odometry(batch, selection.odometry)
    odometry = joined_odometry(decoded)
    contacts = read_contacts(batch, selection.contacts, feet)
    samples = [read.felt.samples for read in contacts]
    with_header = [read.messages for read in contacts if read.source.has_header]
    stamped: dict[str, _Times] = {}
    for messages in (*decoded, *with_header):
        stamped.update(_stamped_times(log, messages))
    return MeasuredBatch(
        samples=samples,
        odometry=odometry,
        frames=(
            read_frames(log, selection, frames, span, batch, odometry, samples, limits)
            if frames is not None
            else None
        ),
        times=list((_log_times(log, batch) | stamped).values()),
        malformed={
            channel: count
            for messages in (*decoded, *(read.messages for read in contacts))
            for channel, count in messages.malformed.items()
        },
        losses=batch.losses,
        messages=len(batch.messages),
        stored_size=sum(chunk.data_size for chunk in span),
    )


def _log_times(log: Log, batch: Batch) -> dict[str, _Times]:
    """Return the log times of every topic in a batch."""
    log_time = batch.messages.log_time
    return {
        topic: _Times(topic, log_time[rows], None, ())
        for topic, rows in _by_topic(log, batch.messages.channel)
    }


def _stamped_times(log: Log, messages: DecodedMessages) -> dict[str, _Times]:
    """Return log times, stamps and frames of the topics of decoded messages."""
    stamp = messages.table.nanoseconds("header.stamp")
    frame = messages.table.texts("header.frame_id")
    topics = {}
    for topic, rows in _by_topic(log, messages.channel):
        _, frames = Texts(frame.buffer, frame.start[rows], frame.length[rows]).encode()
        topics[topic] = _Times(topic, messages.log_time[rows], stamp[rows], frames)
    return topics


def _by_topic(log: Log, channel: Ints) -> Iterator[tuple[str, Ints]]:
    """Yield each topic, whoever sends on it, with the rows of its messages in their order."""
    topics = sorted({each.topic for each in log.channels.values()})
    number = {topic: row for row, topic in enumerate(topics)}
    ids = sorted(log.channels)
    numbers = np.array([number[log.channels[each].topic] for each in ids], np.int64)
    for row, rows in rows_by_group(numbers[np.searchsorted(ids, channel)]):
        yield topics[row], rows


def _facts(
    log: Log, robot: str, findings: Sequence[Finding], messages: int, losses: Sequence[Loss]
) -> LogFacts:
    duration = None
    if log.start_time is not None and log.end_time is not None:
        duration = (log.end_time - log.start_time) / 1e9
    return LogFacts(
        path=shown(log.source.path),
        container=log.container,
        profile=log.profile,
        start_s=None if log.start_time is None else log.start_time / 1e9,
        duration_s=duration,
        messages=messages,
        lost_messages=lost_messages(list(losses)),
        lost_bytes=sum(loss.bytes for loss in losses),
        losses=[loss.what for loss in losses],
        findings=findings,
        robot=robot,
    )
