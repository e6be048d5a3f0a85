"""The plan of `stats` for a log, made before it is read through."""

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from dogbot_logtool.core.contact.contact_rule import Thresholds
from dogbot_logtool.core.contact.silent_swing import SilentFeet, SwingInserter
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.settings import FootSettings, StatsSettings
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogError
from dogbot_logtool.pipeline.batches import BatchReader
from dogbot_logtool.pipeline.frames.world_frames import WorldFrames, follow_frames
from dogbot_logtool.pipeline.measuring.batch import BatchMeasurer
from dogbot_logtool.pipeline.measuring.side_types import has_side_topics
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.pipeline.probe import Probe, frame_names, probe_log
from dogbot_logtool.pipeline.sensors import LearntSensors, learn_sensors
from dogbot_logtool.pipeline.time_span import TimeLimits, time_limits
from dogbot_logtool.pipeline.topics.selection import Selection, nothing_to_do, select_topics
from dogbot_logtool.reader.containers.log import Log

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.measuring.legs import LegReader
    from dogbot_logtool.pipeline.measuring.side_topics import SideTopics

_FRAMES: Final = {"world": WrenchFrame.WORLD, "link": WrenchFrame.LINK}


@dataclass(frozen=True, slots=True)
class MeasuringPlan:
    """The plan of `stats` for one log."""

    selection: Selection
    probe: Probe
    settings: StatsSettings
    silent: SilentFeet
    """The feet that are silent in swing."""
    side: "SideTopics | None"
    """Topics beside feet and base; None: the log has nothing of the kind."""
    limits: TimeLimits
    """Log times of the messages that are taken."""
    frames: WorldFrames | None
    """How the frames of forces are connected to the world; None: no force must be turned."""
    legs: "LegReader | None"
    """Reads what is told of the legs; None: nothing is."""

    @property
    def measurer(self) -> BatchMeasurer:
        """The measurer of the log's batches."""
        feet = replace(self.selection.foot_channels(), left_after_ns=self.probe.left_after_ns)
        sensors = [self.settings.sensor(foot) for foot in range(len(self.settings.feet))]
        reads_transforms = self.legs is not None and bool(self.legs.moving)
        reader = BatchReader(
            self.selection, feet, self.frames, sensors, self.limits, reads_transforms
        )
        return BatchMeasurer(reader, self.side, self.legs)

    def swings(self, log: Log) -> SwingInserter:
        """Return what tells the swings of silent sensors; up to the ends of a log read whole."""
        start, end = self.limits
        return SwingInserter(
            self.silent,
            log.start_time if start is None else None,
            log.end_time if end is None else None,
        )

    def on_log_time(self, log: Log, reason: str) -> "MeasuringPlan":
        """Return the plan for a log whose header stamps cannot be used."""
        settings = replace(self.settings, time_source=TimeSource.LOG, time_source_reason=reason)
        return replace(
            self,
            settings=settings,
            frames=_frames(self.selection, self.probe, settings),
            legs=_leg_reader(log, self.selection, self.probe, settings),
        )


def make_plan(log: Log, options: StatsOptions) -> MeasuringPlan:
    """Decide what to do.

    Raises:
        LogError: the log has neither odometry nor contacts.
        CallError: an option names a topic, foot or time that the log does not have.
    """
    selection = select_topics(log, options.topics)
    if not selection.odometry and not selection.contacts:
        raise LogError(nothing_to_do(log, selection))
    probe = probe_log(log, selection, with_soles=_may_tell_of_legs(log, selection))
    selection = selection.without_forces(probe.forceless)
    given = Thresholds(options.contact_on_n, options.contact_off_n, options.debounce_s)
    sensors = learn_sensors(log, selection, probe, options.topics, given)
    side = _side_topics(log, options)
    settings = _settings(log, selection, probe, sensors, options, side)
    return MeasuringPlan(
        selection=selection,
        probe=probe,
        settings=settings,
        silent=sensors.silent,
        side=side,
        limits=time_limits(log, options.start_s, options.end_s),
        frames=_frames(selection, probe, settings),
        legs=_leg_reader(log, selection, probe, settings),
    )


def _settings(
    log: Log,
    selection: Selection,
    probe: Probe,
    sensors: LearntSensors,
    options: StatsOptions,
    side: "SideTopics | None",
) -> StatsSettings:
    robot = selection.robot
    time_source, reason = _time_source(selection, probe, options)
    return StatsSettings(
        feet=tuple(
            FootSettings(
                foot.name,
                foot.topic,
                foot.leg_position,
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
        time_source=time_source,
        time_source_reason=reason,
        odometry_topic=selection.odometry[0].topic if selection.odometry else "",
        command_topic=side.commands.topic if side and side.commands else "",
        imu_topic=side.inertial.topic if side and side.inertial else "",
        imu_mounting=_mounting(log, selection, probe, side) if side else None,
    )


def _time_source(
    selection: Selection, probe: Probe, options: StatsOptions
) -> tuple[TimeSource | None, str]:
    """Return the clock, and why it is log time; None: header stamps, unless they are unusable."""
    if options.time_source:
        return TimeSource(options.time_source), ""
    headless = selection.without_header
    if headless:
        return TimeSource.LOG, f"messages of {headless[0]} have no header"
    if probe.zero_stamps:
        used = {channel.topic for channel in (*selection.odometry, *selection.contacts)}
        of = "" if probe.zero_stamps >= used else f" of {', '.join(sorted(probe.zero_stamps))}"
        return TimeSource.LOG, f"header stamps{of} are zero"
    return None, ""


def _mounting(
    log: Log, selection: Selection, probe: Probe, side: "SideTopics"
) -> tuple[float, float, float, float] | None:
    """Return how the inertial unit sits on the base; None: not recorded."""
    from dogbot_logtool.pipeline.measuring.side_topics import imu_mounting  # noqa: PLC0415

    _, base_frame = frame_names(selection.robot, probe)
    return imu_mounting(log, side.inertial, probe.statics, base_frame)


def _side_topics(log: Log, options: StatsOptions) -> "SideTopics | None":
    """Choose what is read beside feet and base; None: the log has nothing of the kind."""
    asked = options.command_topic is not None or options.imu_topic is not None
    if not asked and not has_side_topics(log):
        return None
    from dogbot_logtool.pipeline.measuring.side_topics import side_topics  # noqa: PLC0415

    return side_topics(log, options)


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
    from dogbot_logtool.pipeline.measuring.legs import leg_reader  # noqa: PLC0415

    return leg_reader(log, selection, probe, settings.clock)


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
