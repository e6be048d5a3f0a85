"""The plan of `stats`: which topics are read, and what is known of them before they are."""

from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

from dogbot_logtool.core.analysis import FindLegs
from dogbot_logtool.core.base.poses import scaled
from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.contact.foot_history import Thresholds
from dogbot_logtool.core.corrected import Corrected, on_one_clock, poses_of_base
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.errors import LogError
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.part import Wanted
from dogbot_logtool.robot.base import BASES
from dogbot_logtool.robot.feet import channels_of_feet, planned_feet
from dogbot_logtool.robot.measuring.foot_samples import decide_contacts, with_joined_sensors
from dogbot_logtool.robot.recorded import time_limits
from dogbot_logtool.robot.selection import Selection, select_topics
from dogbot_logtool.robot.topics import joint_channels, nothing_to_do, side_topic

if TYPE_CHECKING:
    from dogbot_logtool.core.legs.joints import LegSettings
    from dogbot_logtool.robot.urdf import RobotOfUrdf

_OF_ROBOT: Final = (
    *("mass_kg", "forward_axis", "com_offset_m", "foot_rolling_m"),
    *("world_frame", "base_frame"),
)
"""Settings that are those of the robot's file."""
_FRAMES: Final = {"world": WrenchFrame.WORLD, "link": WrenchFrame.LINK}


class MeasuringPlan(NamedTuple):
    """What is read of a log."""

    selection: Selection
    planned: Selection | None
    """The same feet as a plan in the log has them; None: it has none."""
    wanted: Wanted


def make_plan(log: Log, options: MeasureOptions) -> MeasuringPlan:
    """Decide what to read.

    Raises:
        LogError: the log has neither odometry nor contacts.
        CallError: an option names a topic, foot or time that the log does not have.
    """
    selection = select_topics(log, options)
    joints = tuple(joint_channels(log))
    if not (selection.odometry or selection.contacts or joints):
        raise LogError(nothing_to_do(log, selection.findings))
    planned = _planned(log, selection)
    findings = [*selection.findings]
    wanted = selection.wanted()._replace(
        joints=joints,
        commands=side_topic(log, selection.robot, "commands", findings),
        accelerations=side_topic(log, selection.robot, "accelerations", findings),
        planned=planned.wanted().feet if planned else None,
        limits=time_limits(log, options.start, options.end),
    )
    selection = selection._replace(findings=tuple(findings))
    return MeasuringPlan(selection, planned, wanted)


def _planned(log: Log, selection: Selection) -> Selection | None:
    """Return the selection of the feet of a plan that the log has beside their sensors."""
    feet = planned_feet(log, selection.robot, selection.contacts)
    robot = replace(selection.robot, feet=feet, tare="none")
    return selection._replace(robot=robot, feet_of=channels_of_feet(log, robot)) if feet else None


def settings_of(selection: Selection) -> WalkSettings:
    """Return what is known of a recording before its columns are looked at."""
    robot, guessed = selection.robot, selection.robot_is_guessed
    promised = {source.row.axes for source in selection.sources}
    time_source, reason = _time_source(selection)
    return WalkSettings(
        **{name: getattr(robot, name) for name in _OF_ROBOT},
        feet=tuple(_foot(selection, row) for row in range(len(robot.feet))),
        robot=robot.name,
        robot_is_guessed=guessed,
        mass_is_assumed=guessed and "mass_kg" not in robot.given,
        forward_axis_is_assumed=guessed and "forward_axis" not in robot.given,
        thresholds=Thresholds(
            robot.contact_on_n,
            robot.contact_off_n,
            robot.debounce_s,
            origin="option" if "contact_on_n" in robot.given else "robot",
        ),
        takes_offsets=robot.tare != "none",
        promised_frame=promised.pop() if len(promised) == 1 else None,
        wrench_frame=WrenchFrame.WORLD
        if selection.contact_from
        else _FRAMES.get(robot.wrench_frame, WrenchFrame.UNKNOWN),
        time_source=time_source,
        time_source_reason=reason,
        contact_from=selection.contact_from,
        base_from_legs=selection.base_from_legs,
        odometry_topic=selection.odometry[0].topic if selection.odometry else "",
    )


def _foot(selection: Selection, row: int) -> FootSettings:
    """Return what is known of a foot."""
    robot, sources = selection.robot, selection.sources_of(row)
    foot, is_estimated = robot.feet[row], bool(selection.contact_from)
    is_given = f"tare.{foot.name}" in robot.given
    offset = foot.offset_n if is_given or robot.tare != "none" else None
    flagged = [source.has_flags and row not in selection.ignored_flags for source in sources]
    lists = [
        has_flags or not source.has_force or bool(source.row.pairs)
        for has_flags, source in zip(flagged, sources, strict=True)
    ]
    scaled = foot.newtons_per_count is not None
    in_newtons = all(s.has_force and (scaled or s.row.unit == "N") for s in sources)
    return FootSettings(
        foot.name,
        foot.topic,
        foot.leg_position,
        has_force=selection.contact_from == "joint_torques" if is_estimated else in_newtons,
        has_flags=is_estimated or (bool(sources) and all(flagged)),
        lists_contacts=is_estimated or (bool(sources) and all(lists)),
        only_presses=any(source.row.unit == "counts" or source.row.one_axis for source in sources),
        in_base=any(source.in_base for source in sources),
        silent_in_swing=any(source.row.silent_in_swing for source in sources),
        offset_n=offset,
        offset_from="option" if is_given or offset is None else "robot",
    )


def _time_source(selection: Selection) -> tuple[TimeSource | None, str]:
    """Return the clock, and why it is log time; None: header stamps, unless they are unusable."""
    if selection.robot.clock:
        return TimeSource(selection.robot.clock), ""
    used = [*selection.sources, *([selection.base.source] if selection.base else [])]
    for source in used:
        if not source.has_header:
            return TimeSource.LOG, f"messages of {source.row.name} have no header"
    return None, ""


class Prepared(NamedTuple):
    """A recording with all that is known of it before it is measured."""

    recording: Recording
    """On one clock, with what legs tell in place of what the log lacks."""
    settings: WalkSettings
    find_legs: FindLegs
    planned: WalkSettings | None
    """Settings of the feet as a plan in the log has them; None: there is no plan."""
    selection: Selection
    """Topics that it is measured by."""
    model: "RobotOfUrdf | None"
    """The robot's description, where joint states move it."""
    findings: tuple[Finding, ...]


def prepare(
    log: Log, recording: Recording, plan: MeasuringPlan, options: MeasureOptions
) -> Prepared:
    """Return a recording as it is measured.

    Raises:
        CallError: an option names a foot that the log does not have.
    """
    feet, selection = decide_contacts(recording.feet, plan.selection)
    planned_feet, plan_of_feet = recording.planned, plan.planned
    if plan_of_feet is not None:
        planned_feet, plan_of_feet = decide_contacts(planned_feet, plan_of_feet)
    recording = replace(recording, feet=feet, planned=planned_feet)
    if (scale := selection.robot.odometry_scale) is not None:
        recording = replace(recording, base=scaled(recording.base, scale))
    topic, base_frame = selection.base_name or "", selection.robot.base_frame
    recording, moved = poses_of_base(recording, topic, base_frame, BASES)
    recording, joined = on_one_clock(recording, topic)
    recording, selection, whole = with_joined_sensors(recording, selection)
    model = None
    if recording.joints:
        from dogbot_logtool.robot.description import read_model  # noqa: PLC0415
        from dogbot_logtool.robot.measuring.by_legs import (  # noqa: PLC0415
            facing,
            measured_by_legs,
        )

        found = read_model(log, options.urdf)
        model = found.robot
        if model is None and not found.call:
            whole = (*whole, Finding("ROBOT_DESCRIPTION", found.why_none))
        recording, selection = measured_by_legs(recording, selection, found)
    # Up to the ends of a log that is read whole, silence is known.
    wanted = plan.wanted
    start, end = wanted.limits
    settings = replace(
        settings_of(selection),
        command_topic=wanted.commands[0].topic if wanted.commands else "",
        imu_topic=wanted.accelerations[0].topic if wanted.accelerations else "",
        silent_from=log.start_time if start is None else None,
        silent_until=log.end_time if end is None else None,
    )
    if model is not None:
        settings = facing(settings, recording, model)
    if joined and not selection.robot.clock:
        # Messages without a header have stamps now.
        settings = replace(settings, time_source=None, time_source_reason="")
    return Prepared(
        recording,
        settings,
        _find_legs(selection, model),
        settings_of(plan_of_feet) if plan_of_feet else None,
        selection,
        model,
        (*selection.findings, *moved, *joined, *whole),
    )


def _find_legs(selection: Selection, model: "RobotOfUrdf | None") -> FindLegs:
    """Return what finds a recording's legs; nothing is imported for one that tells nothing."""

    def find(recording: Recording, corrected: Corrected) -> "LegSettings | None":
        if not recording.joints and not recording.transforms:
            return None
        from dogbot_logtool.robot.measuring.legs import find_legs  # noqa: PLC0415

        return find_legs(recording, selection, corrected.frames, model)

    return find
