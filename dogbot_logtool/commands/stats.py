"""`dogbot-logtool stats`: which gait, how loaded, and can the recording be trusted."""

from collections import Counter
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import field, replace
from functools import partial

from dogbot_logtool.core.accumulator import OnSamples, StatsAccumulator
from dogbot_logtool.core.contact.silent_swing import SwingInserter
from dogbot_logtool.core.gait.planned import follow_plan
from dogbot_logtool.core.geometry.clock import TimeSource, UnusableStamps
from dogbot_logtool.core.plausible import IMPLAUSIBLE
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.pipeline.feet.message_feet import planned_feet
from dogbot_logtool.pipeline.frames.world_frames import StreamedFrames
from dogbot_logtool.pipeline.measuring.batch import BatchMeasurer, MeasuredBatch
from dogbot_logtool.pipeline.measuring.plan import MeasuringPlan, make_plan
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.pipeline.probe_findings import order_findings, probe_findings
from dogbot_logtool.pipeline.time_span import refuse_empty_span
from dogbot_logtool.pipeline.topics.annotated import open_recorded
from dogbot_logtool.reader.containers.log import Log, Loss, lost_messages
from dogbot_logtool.reader.salvage.losses import malformed_messages, wrong_statistics
from dogbot_logtool.results import LogFacts, Measurement
from dogbot_logtool.robot import Foot
from dogbot_logtool.run.in_order import OnProgress, in_order


def measure(
    path: Location,
    options: StatsOptions,
    progress: OnProgress | None = None,
    on_samples: OnSamples | None = None,
) -> Measurement:
    """Work out all figures of a log.

    Args:
        path: the log.
        options: what is asked for.
        progress: called with bytes done and bytes in all.
        on_samples: called with each foot's samples; twice, if only the first pass tells that stamps
            are unusable.

    Raises:
        CallError: no such file, or a topic or time in the options that the log does not have.
        LogError: it is no log, or has nothing to measure.
    """
    measured, plan = _measured_feet(path, options, progress, on_samples)
    if not plan:
        return measured
    planned, _ = _measured_feet(path, _options_of_plan(options, plan), progress, None)
    return _with_plan(measured, planned.stats)


def _options_of_plan(options: StatsOptions, feet: tuple[Foot, ...]) -> StatsOptions:
    """Return the options that measure a plan of the feet instead of their sensors."""
    topics = replace(
        options.topics, foot_topics=None, offsets_n=None, takes_offsets=False, feet=feet
    )
    return replace(options, topics=topics, curves=None)


def _with_plan(measured: Measurement, planned: Stats) -> Measurement:
    """Add how the feet follow their plan.

    Args:
        measured: of the feet by their sensors.
        planned: of the planned ones.
    """
    stats = measured.stats
    clocks = [each.settings.time_source or TimeSource.HEADER for each in (stats, planned)]
    plan = {foot.name: foot for foot in planned.feet}
    topics = sorted({foot.topic for foot in planned.feet})
    if clocks[0] is not clocks[1]:
        text = f"{topics[0]} is a plan on another clock than the feet: they are not compared"
        facts = replace(
            measured.facts,
            findings=[*measured.facts.findings, Finding("N_PLAN_NOT_COMPARED", text)],
        )
        return replace(measured, facts=facts)
    found = tuple(
        follow_plan(foot, plan[foot.name]) if foot.name in plan else None for foot in stats.feet
    )
    return replace(measured, stats=replace(stats, planned=found))


def _measured_feet(
    path: Location,
    options: StatsOptions,
    progress: OnProgress | None,
    on_samples: OnSamples | None,
) -> tuple[Measurement, tuple[Foot, ...]]:
    """Work out the figures of the feet that are used; return also those of a plan in the log."""
    log = open_recorded(path, options.topics.joined)
    try:
        plan = make_plan(log, options)
        robot, contacts = plan.selection.robot, plan.selection.contacts
        planned = () if options.topics.feet else planned_feet(log, robot, contacts)
        try:
            return _pass(log, plan, options, progress, on_samples), planned
        except UnusableStamps as reason:
            plan = plan.on_log_time(log, str(reason))
            return _pass(log, plan, options, progress, on_samples), planned
    finally:
        log.close()


def _pass(
    log: Log,
    plan: MeasuringPlan,
    options: StatsOptions,
    progress: OnProgress | None,
    on_samples: OnSamples | None,
) -> Measurement:
    """Read the log once, feeding all messages to the figures in order."""
    legs = plan.legs.settings if plan.legs else None
    feed = _Feed(
        StatsAccumulator(plan.settings, options.curves, on_samples, legs),
        plan.swings(log),
        StreamedFrames(plan.frames) if plan.frames else None,
        list(log.losses),
    )
    done, total = 0, sum(chunk.data_size for chunk in log.chunks)
    with closing(_measured(log, plan.measurer, options.jobs)) as measured:
        for batch in measured:
            feed.take(batch)
            done += batch.stored_size
            if progress is not None:
                progress(done, total)
    if not feed.losses:
        refuse_empty_span(log, plan.limits, feed.counts.total())
    if plan.limits == (None, None):
        feed.losses.extend(wrong_statistics(log, feed.counts, feed.losses))
    return feed.finish(log, plan)


def _measured(log: Log, measurer: BatchMeasurer, jobs: int) -> Generator[MeasuredBatch, None, None]:
    """Read all batches."""
    spans = log.spans(*measurer.reader.limits)
    return in_order(partial(measurer, log), spans, jobs, forks=log.can_fork)


@dataclass(slots=True)
class _Feed:
    """Hands batches, in their order, to the figures."""

    accumulator: StatsAccumulator
    swings: SwingInserter
    forces: StreamedFrames | None
    losses: list[Loss]
    malformed: Counter[int] = field(default_factory=Counter)
    counts: Counter[int] = field(default_factory=Counter)
    implausible: int = 0
    out_of_order: int = 0

    def take(self, batch: MeasuredBatch) -> None:
        """Take the next batch."""
        self.accumulator.add_odometry(batch.odometry)
        ready = self.swings.add(batch.samples)
        if self.forces is not None and batch.frames is not None:
            ready = self.forces.add(ready, batch.frames)
        for samples in ready:
            self.accumulator.add_contacts(samples)
        for times in batch.times:
            self.accumulator.add_message_times(
                times.topic, times.log_time, times.stamp, times.frame_ids
            )
        if batch.commands is not None:
            self.accumulator.add_commands(batch.commands.samples, batch.commands.frames)
        if batch.inertial is not None:
            self.accumulator.add_accelerations(batch.inertial.samples, batch.inertial.frames)
        if batch.legs is not None:
            legs = batch.legs
            self.accumulator.add_legs(legs.joints, legs.frames, legs.end)
            self.malformed.update(legs.malformed)
        self.losses.extend(batch.losses)
        self.malformed.update(batch.malformed)
        self.counts.update(batch.counts)
        self.implausible += batch.implausible
        self.out_of_order += batch.out_of_order

    def finish(self, log: Log, plan: MeasuringPlan) -> Measurement:
        """End the log."""
        for samples in self.swings.finish():
            self.accumulator.add_contacts(samples)
        losses = [*self.losses, *malformed_messages(log.channels, self.malformed)]
        # The figures have a finding of their own for each topic's stamps.
        seen = probe_findings(plan.selection, plan.probe)
        findings = [*plan.selection.findings, *(f for f in seen if f.code != "W_ZERO_STAMPS")]
        findings.extend(plan.side.findings if plan.side else ())
        findings.extend(order_findings(log, self.out_of_order))
        if self.implausible:
            findings.append(Finding("W_IMPLAUSIBLE", f"{self.implausible:,} {IMPLAUSIBLE}"))
        if self.forces is not None:
            findings.extend(self.forces.findings())
        robot = plan.selection.robot.name
        facts = _facts(log, robot, findings, self.counts.total(), losses)
        return Measurement(self.accumulator.finish(), facts, tuple(losses))


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
