"""From the columns of a recording to all figures: corrections, the walk, its plan."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core.base.foot_path import path_in_base, path_of
from dogbot_logtool.core.base.poses import Odometry, base_history
from dogbot_logtool.core.contact.contact_rule import without_offset
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.silent_swing import with_swings
from dogbot_logtool.core.corrected import log_clock
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.planned import follow_plan
from dogbot_logtool.core.plausible import IMPLAUSIBLE
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.core.walk import analyse
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.robot.frames.world_frames import frame_findings
from dogbot_logtool.robot.measuring.moved_base import with_poses_of_base
from dogbot_logtool.robot.measuring.one_clock import on_one_clock
from dogbot_logtool.robot.measuring.plan import (
    LearntSettings,
    MeasuringPlan,
    learn_settings,
    learnt_on_clock,
)
from dogbot_logtool.robot.probe_findings import probe_findings

if TYPE_CHECKING:
    from dogbot_logtool.core.base.foot_path import FootPath
    from dogbot_logtool.core.frames.transforms import TransformBuffer
    from dogbot_logtool.core.legs.paths import LegSettings
    from dogbot_logtool.robot.robot_model.robot_of_urdf import RobotOfUrdf


@dataclass(frozen=True, slots=True)
class Measured:
    """All figures of a recording."""

    stats: Stats
    recording: Recording
    """The columns as they are measured: corrected."""
    findings: tuple[Finding, ...]
    """Found while topics, frames and sensors were chosen."""
    learnt: LearntSettings
    """What the columns told."""


def measure_recording(
    log: Log,
    recording: Recording,
    plan: MeasuringPlan,
    options: MeasureOptions,
    *,
    with_soles: bool = False,
) -> Measured:
    """Work out all figures of a recording, and how the feet follow their plan.

    Args:
        log: the log that it is of.
        recording: its columns.
        plan: what they tell of.
        options: what is asked for.
        with_soles: find where the feet's soles are, too, which pictures of the robot need.

    Raises:
        CallError: an option names a foot that the log does not have.
    """
    recording, moved = with_poses_of_base(recording, plan.selection)
    recording, joined = on_one_clock(recording, plan.selection)
    selection, model = plan.selection, None
    if recording.joints:
        from dogbot_logtool.robot.measuring.by_legs import read_model, told_by_legs  # noqa: PLC0415

        found = read_model(log, options.urdf)
        model = found.robot
        recording, selection = told_by_legs(recording, selection, found)
    learnt = learn_settings(recording, selection, plan.side, options, with_soles=with_soles)
    measured = _measured(log, recording, learnt, plan, model)
    measured = replace(measured, findings=(*measured.findings, *moved, *joined))
    if plan.planned is None:
        return measured
    of_plan = replace(recording, feet=recording.planned, links={}, joints=())
    learnt = learn_settings(of_plan, plan.planned, plan.side, options)
    planned = _measured(log, of_plan, learnt, plan)
    return _with_plan(measured, planned.stats)


def _measured(
    log: Log,
    recording: Recording,
    learnt: LearntSettings,
    plan: MeasuringPlan,
    model: "RobotOfUrdf | None" = None,
) -> Measured:
    """Correct the columns, and work out all figures."""
    learnt = learnt_on_clock(learnt, log_clock(recording, learnt.settings))
    findings = _findings(recording, learnt, plan)
    legs = _legs(recording, learnt, model)
    feet = _with_swings(log, _without_offsets(recording, learnt), learnt, plan)
    places = _places(feet, recording.base, learnt)
    if learnt.frames is None:
        feet = _without_places(feet, places)
    else:
        tracks = learnt.frames.tracks(recording.transforms, recording.base)
        placed = learnt.frames.place(feet, tracks)
        feet = placed.samples
        findings.extend(frame_findings(learnt.frames, placed))
    corrected = replace(recording, feet=feet, places=places)
    stats = analyse(corrected, learnt.settings, legs)
    return Measured(stats, corrected, tuple(findings), learnt)


def _places(
    feet: Sequence[Samples], base: Odometry, learnt: LearntSettings
) -> "tuple[FootPath | None, ...]":
    """Return the places of feet in the base's axes, where messages or joints tell those."""
    selection, clock = learnt.selection, learnt.settings.clock
    told = [any(each.in_base for each in selection.sources_of(foot)) for foot in range(len(feet))]
    by_joints = bool(selection.contact_from and selection.odometry)
    if not any(told) and not by_joints:
        return ()

    if by_joints:
        # Joints have told these places, and the poses have placed them in the world.
        poses = base_history(base, clock)
        return tuple(path_in_base(clock.of(each), each.position, poses) for each in feet)
    return tuple(
        path_of(clock.of(samples), samples.position) if is_told else None
        for samples, is_told in zip(feet, told, strict=True)
    )


def _without_places(
    feet: tuple[Samples, ...], places: "Sequence[FootPath | None]"
) -> tuple[Samples, ...]:
    """Return samples without positions that nothing turns into the world."""
    return tuple(
        replace(samples, position=np.full_like(samples.position, np.nan)) if path else samples
        for samples, path in zip(feet, places or (None,) * len(feet), strict=True)
    )


def _legs(
    recording: Recording, learnt: LearntSettings, model: "RobotOfUrdf | None"
) -> "tuple[LegSettings, TransformBuffer] | None":
    """Find what tells of the legs; nothing is imported for a log that tells nothing."""
    if not recording.joints and not learnt.selection.transforms:
        return None
    from dogbot_logtool.robot.measuring.legs import find_legs  # noqa: PLC0415

    clock = learnt.settings.clock
    return find_legs(recording, learnt.selection, learnt.probe, clock, model)


def _without_offsets(recording: Recording, learnt: LearntSettings) -> tuple[Samples, ...]:
    """Take off what unloaded sensors read, and positions that nothing turns into the world."""
    feet = []
    for foot, recorded in enumerate(recording.feet):
        sources = learnt.selection.sources_of(foot)
        samples = without_offset(
            recorded,
            learnt.settings.sensor(foot),
            lists_contacts=bool(learnt.selection.contact_from)
            or any(source.lists_contacts for source in sources),
            only_presses=any(source.is_raw or source.one_axis for source in sources),
        )
        feet.append(samples)
    return tuple(feet)


def _with_swings(
    log: Log, feet: tuple[Samples, ...], learnt: LearntSettings, plan: MeasuringPlan
) -> tuple[Samples, ...]:
    """Insert samples without contact where silence is swing; up to the ends of a log read whole."""
    probe = learnt.probe
    if not probe.intervals:
        return feet
    start, end = plan.wanted.limits
    return with_swings(
        feet,
        probe.intervals,
        probe.silence_clock,
        log.start_time if start is None else None,
        log.end_time if end is None else None,
    )


def _findings(recording: Recording, learnt: LearntSettings, plan: MeasuringPlan) -> list[Finding]:
    """Return what was found while topics, frames and sensors were chosen."""
    # The figures have a finding of their own for each topic's stamps.
    seen = probe_findings(learnt.selection, learnt.probe)
    findings = [*learnt.selection.findings, *(f for f in seen if f.code != "BAD_STAMPS")]
    findings.extend(plan.side.findings)
    if recording.implausible:
        findings.append(Finding("NOT_FINITE", f"{recording.implausible:,} {IMPLAUSIBLE}"))
    return findings


def _with_plan(measured: Measured, planned: Stats) -> Measured:
    """Add how the feet follow their plan.

    Args:
        measured: of the feet by their sensors.
        planned: of the planned ones.
    """
    stats = measured.stats
    clocks = [each.settings.time_source or TimeSource.HEADER for each in (stats, planned)]
    plan = {foot.name: foot for foot in planned.feet}
    if clocks[0] is not clocks[1]:
        topic = min(foot.topic for foot in planned.feet)
        text = f"{topic} is a plan on another clock than the feet: they are not compared"
        return replace(
            measured,
            findings=(*measured.findings, Finding("PLANNED", text, cases=("not_compared",))),
        )
    found = tuple(
        follow_plan(foot, plan[foot.name]) if foot.name in plan else None for foot in stats.feet
    )
    return replace(measured, stats=replace(stats, planned=found))
