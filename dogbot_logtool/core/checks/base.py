"""Checks of the base's poses, among the contact points, and of what happens to the base."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import median_of, norms
from dogbot_logtool.core.base.axes import WALKED_M, displacements_m, has_heading
from dogbot_logtool.core.base.ground import swapped_pairs
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.consistency import Worlds
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

STANDS: Final = 0.5
"""Share of a drift that the points of standing feet would go with it, if they drifted, too."""


def worlds_differ(walk: Walk) -> Iterator[Finding]:
    """Yield where base and contact points are not in one world, or drift apart.

    The base may also not be above the contact points although it is among them.
    """
    worlds = walk.worlds
    if worlds is not None and walk.worlds_differ:
        cases = ("loses_way",) if walk.loses_track else ()
        feet = _feet_astray(walk, worlds)
        yield found("WORLDS_DIFFER", "aside", *cases, feet=feet, where="stability", worlds=worlds)
    elif worlds is not None and walk.base is not None and walk.base.height_m is None:
        yield found("WORLDS_DIFFER", "below", where="base.height_m")


def _feet_astray(walk: Walk, worlds: Worlds) -> tuple[str, ...]:
    """Return the feet whose lengths drift with the base: those whose points do, as they stand."""
    path_m = 0.0 if walk.base is None else walk.base.path_length_m or 0.0
    share = worlds.drift_m / path_m if path_m else 0.0
    on_poses = walk.feet_on_poses
    return tuple(
        foot.name
        for foot in walk.feet
        if foot.name in on_poses or not _travels_less(foot, STANDS * share)
    )


def _travels_less(foot: FootSteps, share: float) -> bool:
    """Tell whether a foot's contact point travels by less than a share of the base's way."""
    travel = foot.stances.figures.contact_travel_m[foot.strides.stance]
    displacement = foot.base_displacement_m * foot.strides.duty_factor
    known = np.isfinite(travel) & np.isfinite(displacement)
    return bool(known.any()) and float(median_of(travel[known])) < share * float(
        median_of(displacement[known])
    )


def falls(walk: Walk) -> Iterator[Finding]:
    """Yield when the robot falls, or tips over as the recording ends."""
    if len(walk.fallen):
        at, seconds = walk.seconds(walk.fallen[:, 0])[0], timespans.total(walk.fallen) / 1e9
        yield found("FALL", where="base", at=at, seconds=seconds)
    elif (tips := walk.tipping) is not None:
        at, where = (tips.since - walk.origin) / 1e9, f"base.{tips.angle}_rad"
        yield found("FALL", where=where, say="tips", tipping=tips, at=at)


def poses(walk: Walk) -> Iterator[Finding]:
    """Yield how many poses are missing or cannot be used."""
    record = walk.base_history
    if walk.base is None and (walk.corrected.leaning_rad is not None or walk.frozen is not None):
        return
    if record.messages and record.not_usable == record.messages:
        yield found("NOT_FINITE", "base", where="base", say="useless", record=record)
    elif walk.base is None:
        yield found("NO_BASE", "few_poses", where="base")
    else:
        if record.not_usable:
            yield found("NOT_FINITE", "base", where="base", say="poses", record=record)
        if record.not_advancing:
            yield found("BAD_STAMPS", where="base", say="poses", record=record)


def by_feet(walk: Walk) -> Iterator[Finding]:
    """Yield that the feet's motion stands in for poses of the base."""
    if walk.base_by_feet and walk.witness is not None:
        by = walk.witness.by
        part = ("part",) if by == "contact points" else ()
        yield found("BASE_FROM_LEGS", "feet", *part, where="base", say="plain", by=by)


def up_axis(walk: Walk) -> Iterator[Finding]:
    """Yield that z is not up: such poses are left out of all that is computed."""
    if walk.corrected.leaning_rad is not None:
        yield found("UP_AXIS", where="base", degrees=np.degrees(walk.corrected.leaning_rad))


def height_drifts(walk: Walk) -> Iterator[Finding]:
    """Yield that the base rises or sinks over the contact points while it walks."""
    if walk.rise_m:
        say = "rises" if walk.rise_m > 0.0 else "sinks"
        where, metres = "base.height_m", abs(walk.rise_m)
        yield found("WORLDS_DIFFER", "drifts", where=where, say=say, metres=metres)


def sides_swapped(walk: Walk) -> Iterator[Finding]:
    """Yield where left feet touch on the right; where all do, the walk is a mirror image."""
    # In another world, contact points tell nothing of the body's sides.
    apart = walk.worlds_differ or walk.base_by_feet
    apart |= walk.base is not None and not has_heading(walk.base)
    poses = walk.poses.without_poses() if apart else walk.placed_poses
    positions = [foot.leg_position for foot in walk.settings.feet]
    forward_rad = FORWARD_ANGLES[walk.settings.forward_axis]
    swapped, pairs = swapped_pairs(poses, walk.records, positions, forward_rad)
    if swapped and len(swapped) == pairs:
        yield found("SIDES_SWAPPED", where="base.yaw_change_rad")
        return
    for pair in swapped:
        left, right = (walk.feet[row].name for row in pair)
        where = f"feet.{left}.topic"
        yield found("SIDES_SWAPPED", "one_pair", where=where, left=left, right=right)


def forward_axis(walk: Walk) -> Iterator[Finding]:
    """Yield that another axis than the guessed one is forward, or may be."""
    settings, base = walk.settings, walk.base
    if base is not None and settings.forward_axis_reason:
        yield found("FORWARD_AXIS", where="settings.forward_axis", settings=settings)
    forward, left = displacements_m(base)
    if abs(left) > max(WALKED_M, 2.0 * abs(forward)):
        side = "left" if left > 0.0 else "right"
        where = "base.forward_speed_mps"
        speed = abs((base and base.lateral_speed_mps) or 0.0)
        words: Words = {"settings": settings, "base": base, "side": side, "speed": speed}
        yield found("FORWARD_AXIS", where=where, say="sideways", **words)


def pose_jumps(walk: Walk) -> Iterator[Finding]:
    """Yield that the pose jumps."""
    jumps = walk.jumps
    if len(jumps.spans):
        size, turn = norms(jumps.size_m), np.abs(jumps.turn_rad)
        yield found(
            "POSE_JUMP",
            where="base.path_length_m",
            jumps=len(jumps.spans),
            metres=size.max(),
            degrees=np.degrees(turn).max(),
            at=walk.seconds(jumps.spans[:, 1])[int((size + turn).argmax())],
        )
