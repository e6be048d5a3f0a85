"""The masks of a walk: jumps, falls, stands, clocks and worlds apart, dead sensors."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.axes import with_forward_axis
from dogbot_logtool.core.base.falls import fallen_spans
from dogbot_logtool.core.base.frozen import Frozen, find_frozen, without_frozen
from dogbot_logtool.core.base.ground import height_drift_m, height_over_feet
from dogbot_logtool.core.base.jumps import PoseJumps, find_jumps, without_jumps
from dogbot_logtool.core.base.motion import BaseTrack, base_motion, find_travel
from dogbot_logtool.core.base.moving_ground import MovingGround, find_moving_ground
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.base.witness import Witness, feet_witness
from dogbot_logtool.core.consistency.stopped import without_stopped
from dogbot_logtool.core.consistency.worlds import Worlds, placed_poses
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrected import Corrected
from dogbot_logtool.core.corrections.clock import too_far_apart
from dogbot_logtool.core.gait.feet import FootSteps, foot_steps, net_push
from dogbot_logtool.core.gait.segments import any_strides, reference_strides
from dogbot_logtool.core.gait.support import (
    Standing,
    Support,
    standing_in,
    support,
    typical_period_s,
)
from dogbot_logtool.core.loads import (
    WalkLoads,
    dead_feet,
    is_stuck,
    loads_of,
)
from dogbot_logtool.core.metrics import Base, Stability
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.stability import Unstable, stability
from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.consistency.heave import Delay


@dataclass(frozen=True, slots=True)
class MaskedWalk:
    """The columns that metrics are measured on, and what of them counts."""

    settings: StatsSettings
    records: tuple[FootHistory, ...]
    """Of each foot, without what its sensor cannot have measured."""
    poses: BaseHistory
    """Poses without jumps."""
    recorded_poses: BaseHistory
    """As recorded, jumps and all, but for time that is masked."""
    jumps: PoseJumps
    frozen: Frozen | None
    """Time in which one pose is repeated although the robot walks on; masked. None: there is
    none."""
    witness: Witness | None
    """The base's motion by its feet; None: their places are not known."""
    ground: MovingGround | None
    """How the ground moves; None: it rests."""
    placed_poses: BaseHistory
    """Poses among the contact points: with jumps, if these jump with the odometry."""
    track: BaseTrack
    base: Base | None
    """Motion of the base in the whole log."""
    fallen: Ints
    """(f, 2) ns, spans in which the robot lies."""
    standing: Standing
    feet: tuple[FootSteps, ...]
    """Steps of each foot."""
    clocks_apart: frozenset[str]
    """Topics whose clocks are too far from the others' for figures of both."""
    base_delay: "Delay | None"
    """By how much the base comes after the forces that drive it; None: not known, or little."""
    worlds: Worlds | None
    """Position of the base among the feet; None without contact points."""
    push: float | None
    """Share of the weight by which the feet push the robot on over whole stances; None: not
    known."""
    rise_m: float
    """m, how far the base rises steadily over the contact points while it walks."""
    vertical_known: bool

    @property
    def base_clock_is_apart(self) -> bool:
        """Whether the odometry's clock is too far from that of the feet."""
        return self.settings.odometry_topic in self.clocks_apart

    @property
    def feet_clocks_are_apart(self) -> bool:
        """Whether the clock of a foot is too far from that of the others."""
        return _feet_apart(self.settings, self.clocks_apart)

    @property
    def worlds_differ(self) -> bool:
        """Whether contact points and base are not in one world."""
        return self.worlds is not None and not self.worlds.agree

    @property
    def base_is_apart(self) -> bool:
        """Whether the base is on another clock than the feet, or in another world."""
        return self.base_clock_is_apart or self.worlds_differ

    @property
    def loses_way(self) -> bool:
        """Whether the base drifts so far among the contact points that speeds are not known."""
        path_m = 0.0 if self.base is None else self.base.path_length_m or 0.0
        return self.worlds is not None and self.worlds.lose_way(path_m)

    @property
    def period_s(self) -> float | None:
        """The usual stride, s; None: there are none."""
        return typical_period_s([each.stances for each in self.records])

    @property
    def contacts_known(self) -> bool:
        """Whether the contacts of all feet are known, on one clock."""
        known = all(foot.contact_known or foot.record.start is None for foot in self.feet)
        return known and not self.feet_clocks_are_apart


def base_in(walk: MaskedWalk, within: Ints) -> Base | None:
    """Return how the base moved in a part of the log."""
    return base_motion(walk.track, walk.settings.forward_axis, within)


def support_in(walk: MaskedWalk, within: Ints | None = None) -> Support | None:
    """Return the support pattern; where one foot's state is not known, none is."""
    return support(walk.records, within) if walk.contacts_known else None


def stability_in(
    walk: MaskedWalk, within: Ints | None = None
) -> tuple[Stability, Unstable] | tuple[None, None]:
    """Return the stability, and when the robot is not stable."""
    if not walk.contacts_known or walk.base_is_apart:
        return None, None
    found = stability(
        walk.records,
        walk.placed_poses,
        walk.settings.forward_axis,
        vertical_known=walk.vertical_known,
        height_known=bool(np.isfinite(walk.track.height_m).any()),
        com_offset_m=walk.settings.com_offset_m or (0.0, 0.0, 0.0),
        within=within,
    )
    return found or (None, None)


def loads_in(walk: MaskedWalk, within: Ints | None = None) -> WalkLoads:
    """Return the loads of all feet over whole strides of the first foot that has any."""
    strides = reference_strides(walk.feet)
    return loads_of(
        walk.records,
        walk.settings.body_weight_n,
        (strides if within is None else strides.within(within)).spans,
        within,
        mass_is_assumed=walk.settings.mass_is_assumed,
    )


def mask_walk(corrected: Corrected) -> MaskedWalk:
    """Find jumps, falls, stands, dead sensors, clocks and worlds that cannot be compared."""
    settings = corrected.settings
    period_s = typical_period_s([each.stances for each in corrected.feet])
    positions = [foot.leg_position for foot in settings.feet]
    witness = feet_witness(corrected.feet, corrected.places, positions, corrected.base)
    frozen = find_frozen(corrected.base, corrected.feet, witness, period_s)
    recorded = without_frozen(corrected.base, frozen.spans) if frozen else corrected.base
    jumps = find_jumps(recorded)
    base = without_jumps(recorded, jumps)
    records = without_stopped(_without_stuck(corrected.feet), base)
    placed, worlds = placed_poses(records, recorded, base)
    height = _steadiest_height(records, placed, base)
    fallen = fallen_spans(recorded, records, height, jumps.spans)
    weighed = loads_of(
        records, settings.body_weight_n, any_strides(records, fallen, timespans.no_spans())
    )
    dead = tuple(dead_feet(records, weighed))
    period_s = typical_period_s([each.stances for each in records])
    apart = too_far_apart(corrected.clocks, period_s)
    supported = None if any(dead) or _feet_apart(settings, apart) else support(records)
    standing = _standing(settings, records, supported, base, fallen)
    strides = any_strides(records, fallen, standing.without_steps)
    delay = None if apart else _long_delay(records, base, period_s, strides)
    apart = apart | {settings.odometry_topic} if delay else apart
    rise_m = height_drift_m(base, height, strides)
    placed_by_poses = any(path is not None for path in corrected.places)
    ground = find_moving_ground(records, base, placed_by_poses=placed_by_poses)
    walked = base if ground is None else ground.on_ground(base)
    track = BaseTrack(walked, find_travel(walked), height, records, standing.still)
    guessed = settings.forward_axis
    motion = base_motion(track, guessed)
    settings = with_forward_axis(settings, track, motion)
    if settings.forward_axis != guessed:
        motion = base_motion(track, settings.forward_axis)
    feet = tuple(
        foot_steps(
            settings,
            row,
            record,
            base,
            fallen,
            standing,
            path=None if path is None else path.in_world(base),
            ground=ground,
            is_dead=dead[row],
        )
        for row, (record, path) in enumerate(zip(records, corrected.places, strict=True))
    )
    return MaskedWalk(
        settings=settings,
        records=records,
        poses=base,
        recorded_poses=recorded,
        jumps=jumps,
        frozen=frozen,
        witness=witness,
        ground=ground,
        placed_poses=placed,
        track=track,
        base=motion,
        fallen=fallen,
        standing=standing,
        feet=feet,
        clocks_apart=apart,
        base_delay=delay,
        worlds=worlds,
        push=net_push(feet),
        rise_m=rise_m,
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
