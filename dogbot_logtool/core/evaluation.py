"""All figures of a walk, worked out from what was kept of its log."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core.base.base_history import BaseHistory
from dogbot_logtool.core.base.base_motion import BaseMotion, BaseTrack, base_motion
from dogbot_logtool.core.base.falls import fallen_spans
from dogbot_logtool.core.base.forward_axis import with_forward_axis
from dogbot_logtool.core.base.ground import height_over_feet
from dogbot_logtool.core.base.pose_jumps import PoseJumps, find_jumps, without_jumps
from dogbot_logtool.core.base.tipping import find_tipping
from dogbot_logtool.core.base.travel import find_travel
from dogbot_logtool.core.command_tracking import command_track, tracking_in
from dogbot_logtool.core.consistency.silences import all_silent
from dogbot_logtool.core.consistency.stopped import without_stopped
from dogbot_logtool.core.consistency.worlds import Worlds, placed_poses
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.gait.foot_statistics import (
    FootStatistics,
    contact_time_without_pose_s,
    foot_statistics,
    overlap,
)
from dogbot_logtool.core.gait.reference_foot import any_strides, gait_input, reference_strides
from dogbot_logtool.core.gait.segments import (
    Segment,
    find_segments,
    main_segment,
    transition_strides,
)
from dogbot_logtool.core.gait.standing import Standing, standing_in, typical_period_s
from dogbot_logtool.core.gait.strides import (
    Strides,
)
from dogbot_logtool.core.gait.support_pattern import Support, support
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import Ints
from dogbot_logtool.core.leg_position import quadruped
from dogbot_logtool.core.load.load_figures import (
    LoadFigures,
    dead_feet,
    is_saturated,
    is_stuck,
    load_figures,
)
from dogbot_logtool.core.quality.clocks import ClockDifference, too_far_apart
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.stability.stability import Stability, stability
from dogbot_logtool.core.statistics import SegmentFigures, Stats
from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.commands.tracking import CommandTrack, Tracking
    from dogbot_logtool.core.geometry.delay import Delay
    from dogbot_logtool.core.imu.comparison import ImuComparison
    from dogbot_logtool.core.recorded.vectors import VectorHistory


@dataclass(frozen=True, slots=True)
class Recorded:
    """What was kept of a log while it streamed past."""

    feet: tuple[FootHistory, ...]
    base: BaseHistory
    clocks: tuple[ClockDifference, ...]
    """How far topics' clocks are from that of the feet; nothing on log time."""
    topics: tuple[TopicQuality, ...]
    commands: "VectorHistory | None" = None
    """Velocity commands; None: the log has none. Likewise `inertial`."""
    inertial: "VectorHistory | None" = None


@dataclass(frozen=True, slots=True)
class _Walk:
    """What the figures of a log, or of a part of it, are taken from."""

    settings: StatsSettings
    records: tuple[FootHistory, ...]
    base: BaseHistory
    """Poses without jumps."""
    placed_base: BaseHistory
    """Poses among the contact points: with jumps, if these jump with the odometry."""
    track: BaseTrack
    fallen: Ints
    standing: Standing
    dead: tuple[bool, ...]
    saturated: tuple[bool, ...]
    refuted: tuple[bool, ...]
    """Feet whose sensor was assumed to read zero without load, on a robot that then makes no steps
    although it moves."""
    apart: frozenset[str]
    """Topics whose clocks are too far from the others'."""
    base_delay: "Delay | None"
    """By how much the base comes after the forces that drive it; None: not known, or little."""
    worlds: Worlds | None
    loses_way: bool
    """Whether the base drifts so far among the contact points that speeds are not known."""
    vertical_known: bool
    direction_known: bool
    """Whether nothing says that the feet's forces lean otherwise than they seem to."""
    upright: bool
    """Whether they are not so far from it that they are no vertical forces."""
    in_newtons: bool
    """Whether forces may be in N."""

    @property
    def feet_apart(self) -> bool:
        """Whether the clock of a foot is too far from that of the others."""
        return any(foot.topic in self.apart for foot in self.settings.feet)

    @property
    def base_apart(self) -> bool:
        """Whether the base is on another clock than the feet, or in another world."""
        differ = self.worlds is not None and not self.worlds.agree
        return self.settings.odometry_topic in self.apart or differ

    @property
    def period_s(self) -> float | None:
        """The usual stride, s; None: there are none."""
        return typical_period_s([each.stances for each in self.records])

    def feet(self, within: Ints | None = None) -> tuple[FootStatistics, ...]:
        """Return the figures of all feet, in some spans or in the whole log."""
        settings = self.settings
        return tuple(
            _on_clock(
                foot_statistics(
                    foot.name,
                    foot.topic,
                    foot.place,
                    record,
                    self.base,
                    fallen=self.fallen,
                    forward_axis=settings.forward_axis,
                    standing=self.standing,
                    foot_rolling_m=settings.foot_rolling_m,
                    is_dead=is_dead,
                    is_saturated=cut_off,
                    contact_known=not (is_dead or refuted),
                    direction_known=self.direction_known,
                    vertical_known=self.upright,
                    in_newtons=self.in_newtons,
                    within=within,
                ),
                settings.odometry_topic,
                self.apart,
                loses_way=self.loses_way,
            )
            for foot, record, is_dead, cut_off, refuted in zip(
                settings.feet, self.records, self.dead, self.saturated, self.refuted, strict=True
            )
        )

    def base_motion(self, within: Ints | None = None) -> BaseMotion | None:
        """Return how the base moved."""
        motion = base_motion(self.track, self.settings.forward_axis, within)
        return motion.without_way() if motion is not None and self.loses_way else motion

    def support(self, within: Ints | None = None) -> Support | None:
        """Return the support pattern; where one foot's state is not known, none is."""
        if any(self.dead) or any(self.refuted) or self.feet_apart:
            return None
        return support(self.records, within)

    def stability(self, within: Ints | None = None) -> Stability | None:
        """Return the figures of stability."""
        if any(self.dead) or any(self.refuted) or self.feet_apart or self.base_apart:
            return None
        return stability(
            self.records,
            self.placed_base,
            self.settings.forward_axis,
            vertical_known=self.vertical_known,
            height_known=bool(np.isfinite(self.track.height_m).any()),
            com_offset_m=self.settings.com_offset_m or (0.0, 0.0, 0.0),
            within=within,
        )

    def loads(self, strides: Ints, within: Ints | None = None) -> LoadFigures:
        """Return the loads of all feet over whole strides, (s, 2) ns."""
        loads = load_figures(
            self.records,
            self.settings.body_weight_n,
            strides,
            within,
            mass_is_assumed=self.settings.mass_is_assumed,
        )
        return replace(loads, share_of=None, shares=None) if any(self.dead) else loads

    def tracking(
        self, track: "CommandTrack | None", within: Ints | None = None
    ) -> "Tracking | None":
        """Return how the base follows its commands."""
        found = tracking_in(track, within)
        return found.without_way() if found is not None and self.loses_way else found


def work_out(settings: StatsSettings, recorded: Recorded) -> Stats:
    """Work out all figures of a log.

    Args:
        settings: what decides the figures.
        recorded: what was kept of the log.
    """
    walk, jumps = _walk(settings, recorded)
    settings, records = walk.settings, walk.records
    feet = walk.feet()
    supported = walk.support()
    gait = gait_input(feet, walk.standing, supported)
    segments = find_segments(gait) if feet and not walk.feet_apart else ()
    strides = reference_strides(feet)
    origin, end = _extent(records, walk.base)
    track = command_track(
        recorded.commands, walk.base, jumps, settings.forward_axis, segments, walk.period_s
    )
    return Stats(
        settings=settings,
        origin=origin,
        end=end,
        feet=feet,
        reference=gait.reference,
        corners=quadruped([foot.place for foot in settings.feet]),
        base_history=recorded.base,
        base=walk.base_motion(),
        jumps=jumps,
        tipping=find_tipping(recorded.base, settings.forward_axis),
        segments=segments,
        segment_figures=tuple(
            _segment_figures(walk, each.spans, strides, track) for each in segments
        ),
        transition_strides=_transition_strides(segments, feet, gait.reference),
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
        loses_way=walk.loses_way,
        all_silent=all_silent(records, walk.base),
        beside=tuple(each for each in (recorded.commands, recorded.inertial) if each),
        command_track=track,
        commands=walk.tracking(track),
        imu=_imu(walk, recorded.inertial, jumps),
    )


def _walk(settings: StatsSettings, recorded: Recorded) -> tuple[_Walk, PoseJumps]:
    """Find jumps, falls, stands, dead sensors and clocks that cannot be compared."""
    records = tuple(
        record.without_force()
        if is_stuck(record, [each for each in recorded.feet if each is not record])
        else record
        for record in recorded.feet
    )
    jumps = find_jumps(recorded.base)
    base = without_jumps(recorded.base, jumps)
    records = without_stopped(records, base)
    placed_base, worlds = placed_poses(records, recorded.base, base)
    height = height_over_feet(placed_base, records)
    fallen = fallen_spans(recorded.base, records, height, jumps.spans)
    weighed = load_figures(
        records, settings.body_weight_n, any_strides(records, fallen, timespans.no_spans())
    )
    dead = tuple(dead_feet(records, weighed))
    period_s = typical_period_s([each.stances for each in records])
    apart = too_far_apart(recorded.clocks, period_s)
    feet_apart = any(foot.topic in apart for foot in settings.feet)
    supported = None if any(dead) or feet_apart else support(records)
    # Sensors that never report a contact say nothing of where the feet are.
    touching = any(len(each.in_contact) for each in records)
    sensors = [settings.sensor(row) for row in range(len(records))]
    standing = standing_in(
        supported if touching else None,
        [each.stances for each in records],
        base,
        fallen,
        is_steady=bool(sensors) and all(sensor.is_steady for sensor in sensors),
    )
    strides = any_strides(records, fallen, standing.without_steps)
    loads = load_figures(
        records,
        settings.body_weight_n,
        strides,
        mass_is_assumed=settings.mass_is_assumed,
    )
    delay = None
    if not apart and period_s and len(base.time):
        from dogbot_logtool.core.consistency.heave import long_delay  # noqa: PLC0415

        delay = long_delay(records, base, period_s, strides)
        apart |= {settings.odometry_topic} if delay else set()
    parted = worlds is not None and not worlds.agree
    over_feet = np.full_like(height, np.nan) if parted else height
    track = BaseTrack(base, find_travel(base), over_feet, records, standing.still)
    motion = base_motion(track, settings.forward_axis)
    path_m = 0.0 if motion is None else motion.path_length_m or 0.0
    walk = _Walk(
        settings=with_forward_axis(settings, track),
        records=records,
        base=base,
        placed_base=placed_base,
        track=track,
        fallen=fallen,
        standing=standing,
        dead=dead,
        saturated=_saturated(settings, records),
        refuted=tuple(bool(each.level.reason and len(standing.moving)) for each in sensors),
        apart=apart,
        base_delay=delay,
        worlds=worlds,
        loses_way=worlds is not None and worlds.lose_way(path_m),
        vertical_known=weighed.share_of == "vertical_impulse",
        direction_known=not (
            loads.direction_refuted or (settings.wrench_frame_is_inferred and loads.may_be_tilted)
        ),
        upright=not (loads.vertical_refuted or loads.other_units),
        in_newtons=not loads.other_units,
    )
    return walk, jumps


def _saturated(settings: StatsSettings, records: Sequence[FootHistory]) -> tuple[bool, ...]:
    """Tell which feet's sensors are cut off at a limit, in an axis or in the magnitude."""
    levels = [settings.sensor(foot).level for foot in range(len(records))]
    return tuple(
        level.limit_n is not None
        or is_saturated(
            record, [each for each in records if each is not record], level.resolution_n
        )
        for level, record in zip(levels, records, strict=True)
    )


def _segment_figures(
    walk: _Walk, spans: Ints, strides: Strides, track: "CommandTrack | None"
) -> SegmentFigures:
    """Measure a segment."""
    return SegmentFigures(
        base=walk.base_motion(spans),
        feet=walk.feet(spans),
        support=walk.support(spans),
        loads=walk.loads(strides.within(spans).spans, spans),
        stability=walk.stability(spans),
        commands=walk.tracking(track, spans),
    )


def _imu(walk: _Walk, inertial: "VectorHistory | None", jumps: PoseJumps) -> "ImuComparison | None":
    """Compare accelerometer, forces and poses, in logs that have all of them."""
    if inertial is None:
        return None
    from dogbot_logtool.core.imu.comparison import compare_imu  # noqa: PLC0415

    comparable = walk.vertical_known and not (walk.feet_apart or walk.base_apart)
    strides = any_strides(walk.records, walk.fallen, walk.standing.without_steps)
    return compare_imu(
        inertial,
        walk.base,
        jumps.spans,
        walk.records if comparable else (),
        mass_kg=walk.settings.mass_kg,
        mounting=walk.settings.imu_mounting,
        period_s=walk.period_s,
        fallen=walk.fallen,
        strides=timespans.merge(strides),
    )


def _transition_strides(
    segments: Sequence[Segment], feet: Sequence[FootStatistics], reference: int
) -> int:
    return transition_strides(segments, feet[reference].strides) if feet else 0


def _on_clock(
    foot: FootStatistics, odometry_topic: str, apart: frozenset[str], *, loses_way: bool
) -> FootStatistics:
    """Leave out the lengths of a foot's strides where the odometry does not tell them."""
    if not loses_way and not apart & {foot.topic, odometry_topic}:
        return foot
    return replace(foot, length_m=np.full_like(foot.length_m, np.nan), stride_length_m=None)


def _extent(feet: Sequence[FootHistory], base: BaseHistory) -> tuple[int, int]:
    """First and last time of any used message, ns; zeros in an empty log."""
    starts = [foot.start for foot in feet if foot.start is not None]
    ends = [foot.end for foot in feet if foot.end is not None]
    if len(base.time):
        starts.append(int(base.time[0]))
        ends.append(int(base.time[-1]))
    return min(starts, default=0), max(ends, default=0)
