"""All figures of a walk, worked out from what was kept of its log."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.axes import leaning_walk_rad
from dogbot_logtool.core.base.falls import find_tipping
from dogbot_logtool.core.base.ground import swapped_pairs
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.consistency.stopped import all_silent
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.foot_statistics import (
    contact_time_without_pose_s,
    overlap,
)
from dogbot_logtool.core.gait.reference_foot import any_strides, gait_input, reference_strides
from dogbot_logtool.core.gait.segments import (
    Segment,
    find_segments,
    main_segment,
    transition_strides,
)
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.leg_position import quadruped
from dogbot_logtool.core.masked_walk import MaskedWalk, Recorded, mask_walk
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import SegmentFigures, Stats

if TYPE_CHECKING:
    from dogbot_logtool.core.commands import CommandTrack
    from dogbot_logtool.core.imu import ImuComparison
    from dogbot_logtool.core.vectors import VectorHistory


def work_out(settings: StatsSettings, recorded: Recorded) -> Stats:
    """Work out all figures of a log.

    Args:
        settings: what decides the figures.
        recorded: what was kept of the log.
    """
    leaning = leaning_walk_rad(recorded.base, recorded.feet)
    if leaning is not None:
        recorded = replace(recorded, base=recorded.base.without_poses())
    walk = mask_walk(settings, recorded)
    settings, records = walk.settings, walk.records
    feet = walk.feet()
    supported = walk.support()
    gait = gait_input(feet, walk.standing, supported)
    segments = find_segments(gait) if feet and not walk.feet_apart else ()
    strides = reference_strides(feet)
    origin, end = _extent(records, walk.base)
    positions = [foot.leg_position for foot in settings.feet]
    forward_rad = FORWARD_ANGLES[settings.forward_axis]
    swapped, pairs = swapped_pairs(walk.placed_base, records, positions, forward_rad)
    return Stats(
        settings=settings,
        origin=origin,
        end=end,
        feet=feet,
        reference=gait.reference,
        corners=quadruped(positions),
        swapped=swapped,
        pairs=pairs,
        base_history=recorded.base,
        base=walk.base_motion(),
        leaning_rad=leaning,
        jumps=walk.jumps,
        tipping=find_tipping(recorded.base, settings.forward_axis),
        segments=segments,
        segment_figures=tuple(_segment_figures(walk, each.spans, strides) for each in segments),
        transition_strides=transition_strides(segments, feet[gait.reference].strides)
        if feet
        else 0,
        main=main_segment(segments),
        support=supported,
        loads=walk.loads(strides.spans),
        stability=walk.stability(),
        fallen=walk.fallen,
        topics=recorded.topics,
        overlap_s=timespans.total(overlap(records, walk.base)) / 1e9,
        contact_without_pose_s=tuple(
            contact_time_without_pose_s(record, walk.base) for record in records
        ),
        clocks=recorded.clocks,
        clocks_apart=walk.apart,
        base_delay=walk.base_delay,
        worlds=walk.worlds,
        push=walk.push,
        rise_m=walk.rise_m,
        all_silent=all_silent(records, walk.base),
        beside=tuple(each for each in (recorded.commands, recorded.inertial) if each),
        command_track=_command_track(walk, recorded.commands, segments),
        imu=_imu(walk, recorded.inertial),
    )


def _segment_figures(walk: MaskedWalk, spans: Ints, strides: Strides) -> SegmentFigures:
    """Measure a segment."""
    return SegmentFigures(
        base=walk.base_motion(spans),
        feet=walk.feet(spans),
        support=walk.support(spans),
        loads=walk.loads(strides.within(spans).spans, spans),
        stability=walk.stability(spans),
    )


def _command_track(
    walk: MaskedWalk, commands: "VectorHistory | None", segments: Sequence[Segment]
) -> "CommandTrack | None":
    """Compare commands with the base's velocity over time, in logs that have any."""
    if commands is None:
        return None
    from dogbot_logtool.core.commands import follow_commands  # noqa: PLC0415

    # In segments with strides the robot steps.
    steps = [each.spans for each in segments if each.strides]
    return follow_commands(
        commands,
        walk.base,
        walk.jumps.spans,
        walk.settings.forward_axis,
        timespans.merge(np.concatenate([timespans.no_spans(), *steps])),
        walk.period_s,
    )


def _imu(walk: MaskedWalk, inertial: "VectorHistory | None") -> "ImuComparison | None":
    """Compare accelerometer, forces and poses, in logs that have all of them."""
    if inertial is None:
        return None
    from dogbot_logtool.core.imu import compare_imu  # noqa: PLC0415

    comparable = walk.vertical_known and not (walk.feet_apart or walk.base_apart)
    strides = any_strides(walk.records, walk.fallen, walk.standing.without_steps)
    return compare_imu(
        inertial,
        walk.base,
        walk.jumps.spans,
        walk.records if comparable else (),
        mass_kg=walk.settings.mass_kg,
        mounting=walk.settings.imu_mounting,
        period_s=walk.period_s,
        fallen=walk.fallen,
        strides=timespans.merge(strides),
    )


def _extent(feet: Sequence[FootHistory], base: BaseHistory) -> tuple[int, int]:
    """First and last time of any used message, ns; zeros in an empty log."""
    starts = [foot.start for foot in feet if foot.start is not None]
    ends = [foot.end for foot in feet if foot.end is not None]
    if len(base.time):
        starts.append(int(base.time[0]))
        ends.append(int(base.time[-1]))
    return min(starts, default=0), max(ends, default=0)
