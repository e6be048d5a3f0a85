"""The masks of a walk: jumps, falls, stands, clocks and worlds apart, dead sensors."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.axes import with_forward_axis
from dogbot_logtool.core.base.falls import fallen_spans
from dogbot_logtool.core.base.ground import find_moving_ground, height_drift_m, height_over_feet
from dogbot_logtool.core.base.motion import FORWARD_ANGLES, BaseTrack, base_motion, find_travel
from dogbot_logtool.core.base.poses import BaseHistory, find_jumps, without_jumps
from dogbot_logtool.core.base.witness import feet_witness, find_frozen, without_frozen
from dogbot_logtool.core.consistency import placed_poses, without_stopped
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrected import Corrected
from dogbot_logtool.core.corrections.clock import too_far_apart
from dogbot_logtool.core.gait.feet import foot_steps
from dogbot_logtool.core.gait.strides import any_strides, typical_period_s
from dogbot_logtool.core.gait.support import Support, standing_in, support
from dogbot_logtool.core.loads import WalkLoads, dead_feet, is_stuck, loads_of
from dogbot_logtool.core.metrics import Base, Stability
from dogbot_logtool.core.stability import stability
from dogbot_logtool.core.walk import Walk

if TYPE_CHECKING:
    from dogbot_logtool.core.heave import Delay


def base_in(walk: Walk, within: Ints) -> Base | None:
    """Return how the base moved in a part of the log."""
    return base_motion(walk.track, walk.settings.forward_axis, within)


def support_in(walk: Walk) -> Support | None:
    """Return the support pattern; where one foot's state is not known, none is."""
    return support(walk.records) if walk.contacts_known else None


def stability_in(walk: Walk, within: Ints | None = None) -> Stability | None:
    """Return the stability, where base and feet are on one clock and in one world."""
    if walk.instants is None:
        return None
    height_known = bool(np.isfinite(walk.track.height_m).any())
    vertical_known = walk.vertical_known
    return stability(
        walk.instants, within, vertical_known=vertical_known, height_known=height_known
    )


def loads_in(walk: Walk, within: Ints | None = None) -> WalkLoads:
    """Return the loads of all feet over whole strides of the first foot that has any."""
    own = [foot.strides for foot in walk.feet if len(foot.strides.stance)]
    strides = [each if within is None else each.within(within) for each in own[:1]]
    return loads_of(
        walk.records,
        walk.settings.body_weight_n,
        strides[0].spans if strides else None,
        within,
        mass_is_assumed=walk.settings.mass_is_assumed,
        lacks_feet=walk.settings.lacks_feet,
    )


def mask_walk(corrected: Corrected) -> Walk:
    """Find jumps, falls, stands, dead sensors, clocks and worlds that cannot be compared.

    What is measured with these masks is not in the result yet.
    """
    settings = corrected.settings
    period_s = typical_period_s([each.stances for each in corrected.feet])
    # Feet of bipeds are named by their side only.
    positions = [foot.leg_position or ("", foot.name) for foot in settings.feet]
    witness = feet_witness(corrected.feet, corrected.places, positions, corrected.base)
    frozen = find_frozen(corrected.base, corrected.feet, witness, period_s)
    recorded = without_frozen(corrected.base, frozen.spans) if frozen else corrected.base
    stand_in = None
    if witness is not None and corrected.leaning_rad is None:
        stand_in = witness.stand_in(recorded, FORWARD_ANGLES[settings.forward_axis])
    if stand_in is not None:
        recorded, settings = stand_in, replace(settings, base_from_legs=True)
    jumps = find_jumps(recorded)
    base = without_jumps(recorded, jumps)
    records = without_stopped(_without_stuck(corrected.feet), base)
    placed, worlds = placed_poses(records, recorded, base)
    height = _steadiest_height(records, placed, base)
    fallen = fallen_spans(recorded, records, height, jumps.spans)
    weighed = loads_of(
        records,
        settings.body_weight_n,
        any_strides(records, fallen, timespans.no_spans()),
        lacks_feet=settings.lacks_feet,
    )
    dead = tuple(dead_feet(records, weighed))
    period_s = typical_period_s([each.stances for each in records])
    apart = too_far_apart(corrected.clocks, period_s)
    unsupported = any(dead) or settings.lacks_feet or any(f.topic in apart for f in settings.feet)
    supported = None if unsupported else support(records)
    # Sensors that never report a contact say nothing of where the feet are.
    touching = any(len(each.in_contact) for each in records)
    standing = standing_in(supported if touching else None, period_s, base, fallen)
    strides = any_strides(records, fallen, standing.without_steps)
    # Joints that tell both forces and poses tell them at the same time.
    by_joints = settings.base_from_legs and bool(settings.contact_from)
    comparable = not (apart or settings.lacks_feet or by_joints)
    delay = _long_delay(records, base, period_s, strides) if comparable else None
    apart = apart | {settings.odometry_topic} if delay else apart
    rise_m = height_drift_m(base, height, strides)
    placed_by_poses = any(path is not None for path in corrected.places)
    ground = find_moving_ground(records, base, placed_by_poses=placed_by_poses)
    walked = base if ground is None else ground.on_ground(base)
    track = BaseTrack(walked, find_travel(walked), height, records, standing.still)
    guessed = settings.forward_axis
    motion = base_motion(track, guessed)
    in_one_world = stand_in is None and (worlds is None or worlds.agree)
    settings = with_forward_axis(settings, track, motion, in_one_world=in_one_world)
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
    return Walk(
        corrected=corrected,
        settings=settings,
        base_history=recorded,
        records=records,
        poses=base,
        jumps=jumps,
        frozen=frozen,
        base_by_feet=stand_in is not None,
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
        rise_m=rise_m,
        vertical_known=weighed.share_of == "vertical_impulse",
        loads=weighed,
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
    return tuple(foot.without_force() if is_stuck(foot, feet) else foot for foot in feet)


def _long_delay(
    records: Sequence[FootHistory], base: BaseHistory, period_s: float | None, strides: Ints
) -> "Delay | None":
    """Tell by physics whether the base comes late; only of logs with strides and poses."""
    if not period_s or not len(base.time):
        return None
    from dogbot_logtool.core.heave import long_delay  # noqa: PLC0415

    return long_delay(records, base, period_s, strides)
