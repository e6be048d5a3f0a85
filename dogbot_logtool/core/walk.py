"""From the columns of a recording to all that is measured of its walk.

    stats = analyse(recording, StatsSettings(feet, mass_kg=19.2))

The order is the same for every log: corrections (`corrected.py`), masks (`masked_walk.py`), what is
measured here. Checks (`checks/`) then look for reasons to doubt it; `walk_metrics/` makes records
of it, and sets to null what the findings void.
"""

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.falls import find_tipping
from dogbot_logtool.core.base.ground import swapped_pairs
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.consistency.stopped import all_silent
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrected import Corrected, clocks_of_joints, correct
from dogbot_logtool.core.gait.segments import (
    Segment,
    any_strides,
    find_segments,
    gait_input,
    main_segment,
)
from dogbot_logtool.core.leg_position import quadruped
from dogbot_logtool.core.masked_walk import (
    MaskedWalk,
    loads_in,
    mask_walk,
    stability_in,
    support_in,
)
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import Stats

if TYPE_CHECKING:
    from dogbot_logtool.core.commands import CommandTrack
    from dogbot_logtool.core.frames.transforms import TransformBuffer
    from dogbot_logtool.core.imu import ImuComparison
    from dogbot_logtool.core.legs.paths import LegSettings
    from dogbot_logtool.core.vectors import VectorHistory


def analyse(
    recording: Recording,
    settings: StatsSettings,
    legs: "tuple[LegSettings, TransformBuffer] | None" = None,
) -> Stats:
    """Measure all that a recording tells of its walk.

    Args:
        recording: its columns, with forces above the sensors' offsets and in the world.
        settings: what decides the metrics.
        legs: where the recording tells of legs, and their frames that transforms move; None: it
            does not.
    """
    corrected = correct(recording, settings)
    walk = mask_walk(corrected)
    settings, records, feet = walk.settings, walk.records, walk.feet
    supported = support_in(walk)
    gait = gait_input(feet, walk.standing, supported)
    segments = find_segments(gait) if feet and not walk.feet_clocks_are_apart else ()
    origin, end = _extent(records, walk.poses)
    positions = [foot.leg_position for foot in settings.feet]
    forward_rad = FORWARD_ANGLES[settings.forward_axis]
    swapped, pairs = swapped_pairs(walk.placed_poses, records, positions, forward_rad)
    stable, unstable = stability_in(walk)
    stats = Stats(
        **{each.name: getattr(walk, each.name) for each in fields(walk)},
        origin=origin,
        end=end,
        reference=gait.reference,
        corners=quadruped(positions),
        swapped=swapped,
        pairs=pairs,
        base_history=walk.recorded_poses,
        leaning_rad=corrected.leaning_rad,
        tipping=find_tipping(walk.recorded_poses, settings.forward_axis),
        segments=segments,
        main=main_segment(segments),
        support=supported,
        loads=loads_in(walk),
        stability=stable,
        unstable=unstable,
        topics=corrected.topics,
        overlap_s=timespans.total(_overlap(records, walk.poses)) / 1e9,
        contact_without_pose_s=tuple(
            walk.poses.unplaced(record.in_contact) / 1e9 for record in records
        ),
        clocks=corrected.clocks,
        all_silent=all_silent(records, walk.poses),
        beside=tuple(each for each in (corrected.commands, corrected.inertial) if each),
        command_track=_command_track(walk, corrected.commands, segments),
        imu=_imu(walk, corrected.inertial),
    )
    return stats if legs is None else _with_legs(stats, recording, corrected, *legs)


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
        walk.track.history,
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


def _with_legs(
    stats: Stats,
    recording: Recording,
    corrected: Corrected,
    settings: "LegSettings",
    frames: "TransformBuffer",
) -> Stats:
    """Add the metrics of the legs."""
    from dogbot_logtool.core.leg_evaluation import with_legs  # noqa: PLC0415

    clocks = clocks_of_joints(corrected, recording.joints)
    return with_legs(stats, recording.joints, settings, frames, clocks)
