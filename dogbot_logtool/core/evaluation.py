"""All figures of a walk, worked out from what was kept of its log."""

from collections.abc import Sequence
from dataclasses import fields, replace
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
from dogbot_logtool.core.gait.reference_foot import any_strides, gait_input
from dogbot_logtool.core.gait.segments import Segment, find_segments, main_segment
from dogbot_logtool.core.leg_position import quadruped
from dogbot_logtool.core.masked_walk import (
    MaskedWalk,
    Recorded,
    loads_in,
    mask_walk,
    stability_in,
    support_in,
)
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import Stats

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
    settings, records, feet = walk.settings, walk.records, walk.feet
    supported = support_in(walk)
    gait = gait_input(feet, walk.standing, supported)
    segments = find_segments(gait) if feet and not walk.feet_clocks_are_apart else ()
    origin, end = _extent(records, walk.poses)
    positions = [foot.leg_position for foot in settings.feet]
    forward_rad = FORWARD_ANGLES[settings.forward_axis]
    swapped, pairs = swapped_pairs(walk.placed_poses, records, positions, forward_rad)
    stable, unstable = stability_in(walk)
    return Stats(
        **{each.name: getattr(walk, each.name) for each in fields(walk)},
        origin=origin,
        end=end,
        reference=gait.reference,
        corners=quadruped(positions),
        swapped=swapped,
        pairs=pairs,
        base_history=recorded.base,
        leaning_rad=leaning,
        tipping=find_tipping(recorded.base, settings.forward_axis),
        segments=segments,
        main=main_segment(segments),
        support=supported,
        loads=loads_in(walk),
        stability=stable,
        unstable=unstable,
        topics=recorded.topics,
        overlap_s=timespans.total(_overlap(records, walk.poses)) / 1e9,
        contact_without_pose_s=tuple(
            walk.poses.unplaced(record.in_contact) / 1e9 for record in records
        ),
        clocks=recorded.clocks,
        all_silent=all_silent(records, walk.poses),
        beside=tuple(each for each in (recorded.commands, recorded.inertial) if each),
        command_track=_command_track(walk, recorded.commands, segments),
        imu=_imu(walk, recorded.inertial),
    )


def _overlap(feet: Sequence[FootHistory], base: BaseHistory) -> Ints:
    """Return the time known to all feet that have samples, and to the base if it has poses."""
    known = [foot.known for foot in feet if foot.start is not None]
    if len(base.time):
        known.append(base.known)
    return timespans.intersect(known)


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
        walk.poses,
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

    comparable = walk.vertical_known and not (walk.feet_clocks_are_apart or walk.base_is_apart)
    strides = any_strides(walk.records, walk.fallen, walk.standing.without_steps)
    return compare_imu(
        inertial,
        walk.poses,
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
