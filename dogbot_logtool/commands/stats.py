"""`dogbot-logtool stats`: which gait, how loaded, and can the recording be trusted."""

from collections import Counter
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import field, replace
from functools import partial
from typing import TYPE_CHECKING, Final

from dogbot_logtool.commands.planned import options_of_plan, with_plan
from dogbot_logtool.core.accumulator import OnSamples, StatsAccumulator
from dogbot_logtool.core.contact.contact_rule import Thresholds
from dogbot_logtool.core.contact.silent_swing import SilentFeet, SwingInserter
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.clock import TimeSource, UnusableStamps
from dogbot_logtool.core.plausible import IMPLAUSIBLE
from dogbot_logtool.core.settings import FootSettings, StatsSettings
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogError
from dogbot_logtool.finding import Finding, warning
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.pipeline.batches import BatchReader
from dogbot_logtool.pipeline.feet.plans import planned_feet
from dogbot_logtool.pipeline.frames.world_frames import StreamedFrames, WorldFrames, follow_frames
from dogbot_logtool.pipeline.measuring import BatchMeasurer, MeasuredBatch
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.pipeline.probe import Probe, frame_names, probe_log
from dogbot_logtool.pipeline.probe_findings import probe_findings
from dogbot_logtool.pipeline.sensors import LearntSensors, learn_sensors
from dogbot_logtool.pipeline.side_types import has_side_topics
from dogbot_logtool.pipeline.time_span import TimeLimits, refuse_empty_span, time_limits
from dogbot_logtool.pipeline.topics.annotated import open_recorded
from dogbot_logtool.pipeline.topics.selection import Selection, nothing_to_do, select_topics
from dogbot_logtool.reader.containers.log import Log, Loss, lost_messages
from dogbot_logtool.reader.salvage.losses import malformed_messages, wrong_statistics
from dogbot_logtool.results import LogFacts, Measurement
from dogbot_logtool.robot import Foot, Robot
from dogbot_logtool.run.in_order import OnProgress, in_order

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.legs import LegReader
    from dogbot_logtool.pipeline.side_topics import SideTopics

_FRAMES: Final = {"world": WrenchFrame.WORLD, "link": WrenchFrame.LINK}


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
    planned, _ = _measured_feet(path, options_of_plan(options, plan), progress, None)
    return with_plan(measured, planned.stats)


def _measured_feet(
    path: Location,
    options: StatsOptions,
    progress: OnProgress | None,
    on_samples: OnSamples | None,
) -> tuple[Measurement, tuple[Foot, ...]]:
    """Work out the figures of the feet that are used; return also those of a plan in the log."""
    log = open_recorded(path, options.topics.joined)
    try:
        selection = select_topics(log, options.topics)
        if not selection.odometry and not selection.contacts:
            raise LogError(nothing_to_do(log, selection))
        probe = probe_log(log, selection, with_places=_may_tell_of_legs(log, selection))
        selection = selection.without_forces(probe.forceless)
        given = Thresholds(options.contact_on_n, options.contact_off_n, options.debounce_s)
        sensors = learn_sensors(log, selection, probe, options.topics, given)
        chosen = options.topics.feet
        plan = () if chosen else planned_feet(log, selection.robot, selection.contacts)
        side = _side_topics(log, options)
        try:
            settings = _settings(log, selection, probe, sensors, options, side)
            measured = _pass(
                log, selection, probe, sensors.silent, settings, options, progress, on_samples, side
            )
        except UnusableStamps as reason:
            because = str(reason)
            settings = _settings(log, selection, probe, sensors, options, side, because)
            measured = _pass(
                log, selection, probe, sensors.silent, settings, options, progress, on_samples, side
            )
        return measured, plan
    finally:
        log.close()


def _settings(
    log: Log,
    selection: Selection,
    probe: Probe,
    sensors: LearntSensors,
    options: StatsOptions,
    side: "SideTopics | None",
    log_time_because: str = "",
) -> StatsSettings:
    robot: Robot = selection.robot
    headless = selection.without_header
    if not options.time_source and not log_time_because:
        if headless:
            log_time_because = f"messages of {headless[0]} have no header"
        elif probe.zero_stamps:
            used = {channel.topic for channel in (*selection.odometry, *selection.contacts)}
            of = "" if probe.zero_stamps >= used else f" of {', '.join(sorted(probe.zero_stamps))}"
            log_time_because = f"header stamps{of} are zero"
    chosen = TimeSource(options.time_source) if options.time_source else None
    return StatsSettings(
        feet=tuple(
            FootSettings(
                foot.name,
                foot.topic,
                foot.place,
                has_force=selection.knows_force(index),
                sensor=sensors.feet[index],
                silent_in_swing=index in probe.intervals,
            )
            for index, foot in enumerate(robot.feet)
        ),
        mass_kg=robot.mass_kg,
        mass_is_assumed=selection.robot_is_guessed and options.topics.mass_kg is None,
        estimated_weight_n=sensors.estimated_weight_n,
        forward_axis=options.forward_axis or robot.forward_axis,
        forward_axis_is_assumed=selection.robot_is_guessed and options.forward_axis is None,
        com_offset_m=robot.com_offset_m,
        foot_rolling_m=robot.foot_rolling_m,
        contact_on_counts=robot.contact_on_counts,
        wrench_frame=_FRAMES.get(options.wrench_frame, probe.wrench_frame.frame),
        wrench_frame_is_inferred=options.wrench_frame not in _FRAMES
        and probe.wrench_frame.is_inferred,
        time_source=TimeSource.LOG if log_time_because else chosen,
        time_source_reason=log_time_because,
        odometry_topic=selection.odometry[0].topic if selection.odometry else "",
        command_topic=side.commands.topic if side and side.commands else "",
        imu_topic=side.inertial.topic if side and side.inertial else "",
        imu_mounting=_mounting(log, selection, probe, side) if side else None,
    )


def _mounting(
    log: Log, selection: Selection, probe: Probe, side: "SideTopics"
) -> tuple[float, float, float, float] | None:
    """Return how the inertial unit sits on the base; None: not recorded."""
    from dogbot_logtool.pipeline.side_topics import imu_mounting  # noqa: PLC0415

    _, base_frame = frame_names(selection.robot, probe)
    return imu_mounting(log, side.inertial, probe.statics, base_frame)


def _side_topics(log: Log, options: StatsOptions) -> "SideTopics | None":
    """Choose what is read beside feet and base; None: the log has nothing of the kind."""
    asked = options.command_topic is not None or options.imu_topic is not None
    if not asked and not has_side_topics(log):
        return None
    from dogbot_logtool.pipeline.side_topics import side_topics  # noqa: PLC0415

    return side_topics(log, options)


def _pass(
    log: Log,
    selection: Selection,
    probe: Probe,
    silent: SilentFeet,
    settings: StatsSettings,
    options: StatsOptions,
    progress: OnProgress | None,
    on_samples: OnSamples | None,
    side: "SideTopics | None",
) -> Measurement:
    """Read the log once, feeding all messages to the figures in order."""
    limits = time_limits(log, options.start_s, options.end_s)
    frames = _frames(selection, probe, settings)
    feet = replace(selection.foot_channels(), left_after_ns=probe.left_after_ns)
    sensors = [settings.sensor(foot) for foot in range(len(settings.feet))]
    legs = _leg_reader(log, selection, probe, settings)
    reads_transforms = legs is not None and bool(legs.moving)
    reader = BatchReader(selection, feet, frames, sensors, limits, reads_transforms)
    measurer = BatchMeasurer(reader, side, legs)
    feed = _Feed(
        StatsAccumulator(settings, options.curves, on_samples, legs.settings if legs else None),
        _swings(log, silent, limits),
        StreamedFrames(frames) if frames else None,
        list(log.losses),
    )
    done, total = 0, sum(chunk.data_size for chunk in log.chunks)
    with closing(_measured(log, measurer, options.jobs)) as measured:
        for batch in measured:
            feed.take(batch)
            done += batch.stored_size
            if progress is not None:
                progress(done, total)
    if not feed.losses:
        refuse_empty_span(log, limits, feed.counts.total())
    if limits == (None, None):
        feed.losses.extend(wrong_statistics(log, feed.counts, feed.losses))
    return feed.finish(log, selection, probe, side.findings if side else ())


def _may_tell_of_legs(log: Log, selection: Selection) -> bool:
    """Tell whether there are transforms, or types of messages that may be joint states."""
    types = {channel.type_name.rpartition("/")[2] for channel in log.channels.values()}
    return bool(selection.transforms) or any("Joint" in t or "LowState" in t for t in types)


def _leg_reader(
    log: Log, selection: Selection, probe: Probe, settings: StatsSettings
) -> "LegReader | None":
    """Return what reads of the legs; None, and nothing is imported, where no topic may tell."""
    if not _may_tell_of_legs(log, selection):
        return None
    from dogbot_logtool.pipeline.legs import leg_reader  # noqa: PLC0415

    return leg_reader(log, selection, probe, settings.clock)


def _measured(log: Log, measurer: BatchMeasurer, jobs: int) -> Generator[MeasuredBatch, None, None]:
    """Read all batches."""
    spans = log.spans(*measurer.reader.limits)
    return in_order(partial(measurer, log), spans, jobs, forks=log.can_fork)


def _swings(log: Log, silent: SilentFeet, limits: TimeLimits) -> SwingInserter:
    """Return what tells the swings of silent sensors, up to the log's ends if all of it is read."""
    start, end = limits
    return SwingInserter(
        silent,
        log.start_time if start is None else None,
        log.end_time if end is None else None,
    )


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

    def finish(
        self, log: Log, selection: Selection, probe: Probe, said: Sequence[Finding]
    ) -> Measurement:
        """End the log."""
        for samples in self.swings.finish():
            self.accumulator.add_contacts(samples)
        losses = [*self.losses, *malformed_messages(log.channels, self.malformed)]
        # The figures have a finding of their own for each topic's stamps.
        seen = [f for f in probe_findings(selection, probe) if f.code != "W_ZERO_STAMPS"]
        findings = [*selection.findings, *seen, *said]
        if self.implausible:
            findings.append(warning("IMPLAUSIBLE", f"{self.implausible:,} {IMPLAUSIBLE}"))
        if self.forces is not None:
            findings.extend(self.forces.findings())
        facts = _facts(log, selection.robot.name, findings, self.counts.total(), losses)
        return Measurement(self.accumulator.finish(), facts, tuple(losses))


def _frames(selection: Selection, probe: Probe, settings: StatsSettings) -> WorldFrames | None:
    """Return the frames that turn forces into the world, where they need it.

    Positions of sensors are left out: the origin of a foot's frame is no contact point, so neither
    slip nor the support polygon may be measured with it.
    """
    world, base = frame_names(selection.robot, probe)
    return follow_frames(
        selection,
        probe,
        world,
        base,
        settings.clock,
        turn_forces=settings.wrench_frame is WrenchFrame.LINK,
        place_sensors=False,
    )


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
