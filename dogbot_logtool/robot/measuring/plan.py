"""The plan of `stats`: what is read of a log, and what decides its figures once it is read."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.corrected import on_clock
from dogbot_logtool.core.corrections.clock import LogClock, TimeSource
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.recording import Recording, is_stamped
from dogbot_logtool.core.settings import FootSettings, StatsSettings
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import LogError
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.wanted import Wanted, WantedJoints
from dogbot_logtool.robot.feet.message_feet import planned_feet
from dogbot_logtool.robot.frames.world_frames import WorldFrames, follow_frames
from dogbot_logtool.robot.measuring.side_topics import SideTopics, side_topics
from dogbot_logtool.robot.probe import Probe, frame_names, probe_recording
from dogbot_logtool.robot.sensors import LearntSensors, learn_sensors
from dogbot_logtool.robot.time_span import time_limits
from dogbot_logtool.robot.topics.selection import Selection, nothing_to_do, select_topics

_FRAMES: Final = {"world": WrenchFrame.WORLD, "link": WrenchFrame.LINK}


@dataclass(frozen=True, slots=True)
class MeasuringPlan:
    """What is read of a log."""

    selection: Selection
    planned: Selection | None
    """The same feet as a plan in the log has them; None: it has none."""
    side: SideTopics
    """Topics beside feet and base."""
    wanted: Wanted


@dataclass(frozen=True, slots=True)
class LearntSettings:
    """What the columns of a recording tell of how to measure it."""

    selection: Selection
    probe: Probe
    settings: StatsSettings
    sensors: LearntSensors
    frames: WorldFrames | None
    """How the frames of forces are connected to the world; None: no force must be turned."""


def make_plan(log: Log, options: MeasureOptions) -> MeasuringPlan:
    """Decide what to read.

    Raises:
        LogError: the log has neither odometry nor contacts.
        CallError: an option names a topic, foot or time that the log does not have.
    """
    selection = select_topics(log, options)
    joints = _wanted_joints(log)
    if not (selection.odometry or selection.contacts or joints):
        raise LogError(nothing_to_do(log, selection))
    planned = _planned(log, selection, options)
    side = side_topics(log, selection.robot)
    wanted = replace(
        selection.wanted(),
        joints=joints,
        commands=side.commands,
        accelerations=side.inertial,
        planned=planned.contacts if planned else (),
        planned_feet=planned.foot_channels() if planned else None,
        limits=time_limits(log, options.start, options.end),
    )
    return MeasuringPlan(selection, planned, side, wanted)


def _planned(log: Log, selection: Selection, options: MeasureOptions) -> Selection | None:
    """Return the selection of the feet of a plan that the log has beside their sensors."""
    if options.feet:
        return None
    feet = planned_feet(log, selection.robot, selection.contacts)
    if not feet:
        return None
    return select_topics(log, replace(options, foot=None, set={"tare": "none"}, feet=feet))


def learn_settings(
    recording: Recording,
    selection: Selection,
    side: SideTopics,
    options: MeasureOptions,
    *,
    with_soles: bool = False,
) -> LearntSettings:
    """Learn from the columns of a recording how it is to be measured, or also drawn, with soles.

    Raises:
        CallError: an option names a foot that the log does not have.
    """
    with_soles |= bool(recording.joints or selection.transforms)
    probe = probe_recording(recording, selection, with_soles=with_soles)
    selection = selection.without_forces(probe.forceless)
    mass_is_given = options.mass is not None or selection.robot.is_given("mass_kg")
    sensors = learn_sensors(selection, probe, mass_is_given=mass_is_given)
    settings = _settings(recording, selection, probe, sensors, side, mass_is_given=mass_is_given)
    return LearntSettings(selection, probe, settings, sensors, _frames(selection, probe, settings))


def learnt_on_clock(learnt: LearntSettings, clock: LogClock) -> LearntSettings:
    """Return the settings for the clock that a recording is measured on."""
    if not clock.reason:
        return learnt
    settings = on_clock(learnt.settings, clock)
    frames = _frames(learnt.selection, learnt.probe, settings)
    return replace(learnt, settings=settings, frames=frames)


def _settings(
    recording: Recording,
    selection: Selection,
    probe: Probe,
    sensors: LearntSensors,
    side: SideTopics,
    *,
    mass_is_given: bool,
) -> StatsSettings:
    robot = selection.robot
    time_source, reason = _time_source(recording, selection, probe)
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
        mass_is_assumed=selection.robot_is_guessed and not mass_is_given,
        estimated_weight_n=sensors.estimated_weight_n,
        forward_axis=robot.forward_axis,
        forward_axis_is_assumed=selection.robot_is_guessed and not robot.is_given("forward_axis"),
        com_offset_m=robot.com_offset_m,
        foot_rolling_m=robot.foot_rolling_m,
        contact_on_counts=robot.contact_on_counts,
        wrench_frame=WrenchFrame.WORLD
        if selection.contact_from
        else _FRAMES.get(robot.wrench_frame, probe.wrench_frame.frame),
        wrench_frame_is_inferred=robot.wrench_frame not in _FRAMES
        and probe.wrench_frame.is_inferred,
        time_source=time_source,
        time_source_reason=reason,
        contact_from=selection.contact_from,
        base_from_legs=selection.base_from_legs,
        odometry_topic=selection.odometry[0].topic if selection.odometry else "",
        command_topic=side.commands.topic if side.commands else "",
        imu_topic=side.inertial.topic if side.inertial else "",
        imu_mounting=_mounting(recording, selection, probe),
    )


def _time_source(
    recording: Recording, selection: Selection, probe: Probe
) -> tuple[TimeSource | None, str]:
    """Return the clock, and why it is log time; None: header stamps, unless they are unusable."""
    if selection.robot.clock:
        return TimeSource(selection.robot.clock), ""
    headless = selection.without_header
    if headless and not is_stamped(recording):
        return TimeSource.LOG, f"messages of {headless[0]} have no header"
    if probe.zero_stamps:
        used = {channel.topic for channel in (*selection.odometry, *selection.contacts)}
        of = "" if probe.zero_stamps >= used else f" of {', '.join(sorted(probe.zero_stamps))}"
        return TimeSource.LOG, f"header stamps{of} are zero"
    return None, ""


def _mounting(
    recording: Recording, selection: Selection, probe: Probe
) -> tuple[float, float, float, float] | None:
    """Return how an inertial unit sits on the base, by recorded static transforms.

    Returns:
        x, y, z, w of its frame in the base's; None: not recorded, or it is the base's.
    """
    frames = recording.accelerations.frames if recording.accelerations else ()
    _, base_frame = frame_names(selection.robot, probe)
    if len(frames) != 1 or frames[0].lstrip("/") == base_frame or not probe.statics.frames:
        return None
    now = np.zeros(1, np.int64)
    pose = probe.statics.lookup(frames[0].lstrip("/"), base_frame, now, now)
    if not pose.known[0]:
        return None
    x, y, z, w = pose.rotation[0].tolist()
    return x, y, z, w


def _wanted_joints(log: Log) -> tuple[WantedJoints, ...]:
    """Choose the channels of joint states; nothing is imported where no topic may be one."""
    types = {channel.type_name.rpartition("/")[2] for channel in log.channels.values()}
    if not any("Joint" in name or "LowState" in name for name in types):
        return ()
    from dogbot_logtool.robot.measuring.legs import wanted_joints  # noqa: PLC0415

    return wanted_joints(log)


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
