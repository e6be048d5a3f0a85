"""The masks of a walk: jumps, falls, stands, clocks and worlds apart, dead sensors."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.axes import with_forward_axis
from dogbot_logtool.core.base.falls import fallen_spans
from dogbot_logtool.core.base.ground import height_drift_m, height_over_feet
from dogbot_logtool.core.base.motion import BaseMotion, BaseTrack, base_motion, find_travel
from dogbot_logtool.core.base.poses import BaseHistory, PoseJumps, find_jumps, without_jumps
from dogbot_logtool.core.consistency.stopped import without_stopped
from dogbot_logtool.core.consistency.worlds import Worlds, placed_poses
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import ClockDifference, too_far_apart
from dogbot_logtool.core.gait.foot_statistics import FootStatistics, foot_statistics
from dogbot_logtool.core.gait.foot_steps import FootSteps, foot_steps, net_push
from dogbot_logtool.core.gait.reference_foot import any_strides
from dogbot_logtool.core.gait.standing import Standing, standing_in, typical_period_s
from dogbot_logtool.core.gait.support_pattern import Support, support
from dogbot_logtool.core.load.load_figures import (
    LoadFigures,
    dead_feet,
    is_stuck,
    load_figures,
)
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.stability.stability import Stability, stability
from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.consistency.heave import Delay
    from dogbot_logtool.core.vectors import VectorHistory


@dataclass(frozen=True, slots=True)
class Recorded:
    """Everything kept of a log while it streamed past."""

    feet: tuple[FootHistory, ...]
    base: BaseHistory
    clocks: tuple[ClockDifference, ...]
    """How far topics' clocks are from that of the feet; nothing on log time."""
    topics: tuple[TopicQuality, ...]
    commands: "VectorHistory | None" = None
    """Velocity commands; None: the log has none. Likewise `inertial`."""
    inertial: "VectorHistory | None" = None


@dataclass(frozen=True, slots=True)
class MaskedWalk:
    """The source of the metrics of a log, or of a part of it, and what of it counts."""

    settings: StatsSettings
    records: tuple[FootHistory, ...]
    base: BaseHistory
    """Poses without jumps."""
    jumps: PoseJumps
    placed_base: BaseHistory
    """Poses among the contact points: with jumps, if these jump with the odometry."""
    track: BaseTrack
    motion: BaseMotion | None
    """Motion of the base in the whole log."""
    fallen: Ints
    standing: Standing
    steps: tuple[FootSteps, ...]
    """Steps of each foot."""
    dead: tuple[bool, ...]
    """Which feet never touch, and nothing says that they are lifted."""
    refuted: tuple[bool, ...]
    """Which feet's sensors were taken to read zero without load, on a robot that then makes no
    steps although it moves."""
    apart: frozenset[str]
    """Topics whose clocks are too far from the others'."""
    base_delay: "Delay | None"
    """By how much the base comes after the forces that drive it; None: not known, or little."""
    worlds: Worlds | None
    push: float | None
    """Share of the weight by which the feet push the robot on over whole stances; None: not
    known."""
    rise_m: float
    """m, how far the base rises steadily over the contact points while it walks."""
    vertical_known: bool

    @property
    def feet_apart(self) -> bool:
        """Whether the clock of a foot is too far from that of the others."""
        return _feet_apart(self.settings, self.apart)

    @property
    def base_apart(self) -> bool:
        """Whether the base is on another clock than the feet, or in another world."""
        differ = self.worlds is not None and not self.worlds.agree
        return self.settings.odometry_topic in self.apart or differ

    @property
    def period_s(self) -> float | None:
        """The usual stride, s; None: there are none."""
        return typical_period_s([each.stances for each in self.records])

    @property
    def contacts_known(self) -> bool:
        """Whether the contacts of all feet are known, on one clock."""
        return not (any(self.dead) or any(self.refuted) or self.feet_apart)

    def feet(self, within: Ints | None = None) -> tuple[FootStatistics, ...]:
        """Return the figures of all feet, in some spans or in the whole log."""
        rolling_m = self.settings.foot_rolling_m
        return tuple(
            foot_statistics(
                foot, self.base, rolling_m, within, is_dead=is_dead, is_refuted=is_refuted
            )
            for foot, is_dead, is_refuted in zip(self.steps, self.dead, self.refuted, strict=True)
        )

    def base_motion(self, within: Ints | None = None) -> BaseMotion | None:
        """Return how the base moved."""
        if within is None:
            return self.motion
        return base_motion(self.track, self.settings.forward_axis, within)

    def support(self, within: Ints | None = None) -> Support | None:
        """Return the support pattern; where one foot's state is not known, none is."""
        return support(self.records, within) if self.contacts_known else None

    def stability(self, within: Ints | None = None) -> Stability | None:
        """Return the figures of stability."""
        if not self.contacts_known or self.base_apart:
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
        return load_figures(
            self.records,
            self.settings.body_weight_n,
            strides,
            within,
            mass_is_assumed=self.settings.mass_is_assumed,
        )


def mask_walk(settings: StatsSettings, recorded: Recorded) -> MaskedWalk:
    """Find jumps, falls, stands, dead sensors, clocks and worlds that cannot be compared.

    Args:
        settings: what decides the figures.
        recorded: what was kept of the log.
    """
    jumps = find_jumps(recorded.base)
    base = without_jumps(recorded.base, jumps)
    records = without_stopped(_without_stuck(recorded.feet), base)
    placed_base, worlds = placed_poses(records, recorded.base, base)
    height = _steadiest_height(records, placed_base, base)
    fallen = fallen_spans(recorded.base, records, height, jumps.spans)
    weighed = load_figures(
        records, settings.body_weight_n, any_strides(records, fallen, timespans.no_spans())
    )
    dead = tuple(dead_feet(records, weighed))
    period_s = typical_period_s([each.stances for each in records])
    apart = too_far_apart(recorded.clocks, period_s)
    supported = None if any(dead) or _feet_apart(settings, apart) else support(records)
    standing = _standing(settings, records, supported, base, fallen)
    strides = any_strides(records, fallen, standing.without_steps)
    delay = None if apart else _long_delay(records, base, period_s, strides)
    apart = apart | {settings.odometry_topic} if delay else apart
    rise_m = height_drift_m(base, height, strides)
    track = BaseTrack(base, find_travel(base), height, records, standing.still, jumps)
    guessed = settings.forward_axis
    motion = base_motion(track, guessed)
    settings = with_forward_axis(settings, track, motion)
    if settings.forward_axis != guessed:
        motion = base_motion(track, settings.forward_axis)
    steps = tuple(
        foot_steps(
            *foot, base, forward_axis=settings.forward_axis, fallen=fallen, standing=standing
        )
        for foot in zip(settings.feet, records, strict=True)
    )
    return MaskedWalk(
        settings=settings,
        records=records,
        base=base,
        jumps=jumps,
        placed_base=placed_base,
        track=track,
        motion=motion,
        fallen=fallen,
        standing=standing,
        steps=steps,
        dead=dead,
        refuted=tuple(
            bool(settings.sensor(row).level.reason and len(standing.moving))
            for row in range(len(records))
        ),
        push=net_push(steps),
        rise_m=rise_m,
        apart=apart,
        base_delay=delay,
        worlds=worlds,
        vertical_known=weighed.share_of == "vertical_impulse",
    )


def _steadiest_height(
    records: Sequence[FootHistory], placed: BaseHistory, without: BaseHistory
) -> Floats:
    """(n,) m, over the feet: z may be reset in poses of which x and y jump with the feet, or not.

    Args:
        records: of all feet.
        placed: poses among the contact points.
        without: poses without jumps.
    """
    height = height_over_feet(placed, records)
    if placed is without:
        return height
    other = height_over_feet(without, records)
    known = np.isfinite(height) & np.isfinite(other)
    if not known.any():
        return height if np.isfinite(height).any() else other
    return other if np.std(other[known]) < np.std(height[known]) else height


def _without_stuck(feet: Sequence[FootHistory]) -> tuple[FootHistory, ...]:
    """Return histories without the forces of sensors that show one constant force."""
    return tuple(
        foot.without_force()
        if is_stuck(foot, [each for each in feet if each is not foot])
        else foot
        for foot in feet
    )


def _feet_apart(settings: StatsSettings, apart: frozenset[str]) -> bool:
    return any(foot.topic in apart for foot in settings.feet)


def _standing(
    settings: StatsSettings,
    records: Sequence[FootHistory],
    supported: Support | None,
    base: BaseHistory,
    fallen: Ints,
) -> Standing:
    """Find the time in which the robot stands, or moves without steps."""
    # Sensors that never report a contact say nothing of where the feet are.
    touching = any(len(each.in_contact) for each in records)
    sensors = [settings.sensor(row) for row in range(len(records))]
    return standing_in(
        supported if touching else None,
        [each.stances for each in records],
        base,
        fallen,
        is_steady=bool(sensors) and all(sensor.is_steady for sensor in sensors),
    )


def _long_delay(
    records: Sequence[FootHistory], base: BaseHistory, period_s: float | None, strides: Ints
) -> "Delay | None":
    """Tell by physics whether the base comes late; only of logs with strides and poses."""
    if not period_s or not len(base.time):
        return None
    from dogbot_logtool.core.consistency.heave import long_delay  # noqa: PLC0415

    return long_delay(records, base, period_s, strides)
