"""Checks of the base among the contact points, of its axes, and of what happens to it."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.base.axes import has_heading, usual_places
from dogbot_logtool.core.base.witness import POINTS
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, Words, found

SIDES_APART_M: Final = 0.02
"""m by which a left foot must be to the right of the right one for that to be said."""
MOST_TURNED_RAD: Final = np.radians(10.0)
"""By which the world of contact points may be turned against that of the poses."""
WALKED_M: Final = 0.5
"""m, way to a side from which its direction means something."""


def worlds_differ(walk: Walk) -> Iterator[Finding]:
    """Yield where base and contact points are not in one world, or drift apart.

    The base may also not be above the contact points although it is among them.
    """
    worlds = walk.worlds
    if worlds is not None and walk.worlds_differ:
        cases, say = ["aside"], "plain"
        if walk.settings.base_from_legs:
            cases, say = [*cases, "reckoned"], "reckoned"
        elif walk.loses_track:
            cases.append("loses_way")
        if walk.settings.force_in_world and _headings_differ(walk):
            cases.append("turned")
        feet, where = [foot.name for foot in walk.feet], "stability"
        yield found("WORLDS_DIFFER", *cases, feet=feet, where=where, say=say, worlds=worlds)
    elif worlds is not None and walk.base is not None and walk.base.height_m is None:
        yield found("WORLDS_DIFFER", "below", where="base.height_m")


def _headings_differ(walk: Walk) -> bool:
    """Tell whether the robot heads elsewhere by its feet's places than by the poses, or may."""
    witness, poses = walk.witness, walk.poses
    if witness is None or not witness.tells_heading:
        return True
    time = witness.poses.time
    heading = np.interp(time - time[0], poses.time - time[0], poses.angles[:, 2])
    apart = witness.poses.angles[:, 2] - heading - walk.settings.forward_rad
    return bool(abs(np.angle(np.exp(1j * apart).mean())) > MOST_TURNED_RAD)


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
    if walk.base is None and (walk.corrected.leaning_rad is not None or len(walk.frozen)):
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
        part = ("part",) if by == POINTS else ()
        yield found("BASE_FROM_LEGS", "feet", *part, where="base", say="plain", by=by)


def up_axis(walk: Walk) -> Iterator[Finding]:
    """Yield that z is not up: such poses are left out of all that is computed."""
    if walk.corrected.leaning_rad is not None:
        yield found("UP_AXIS", where="base", degrees=np.degrees(walk.corrected.leaning_rad))


def sides_swapped(walk: Walk) -> Iterator[Finding]:
    """Yield where left feet touch on the right; where all do, the walk is a mirror image."""
    # In another world, contact points tell nothing of the body's sides.
    apart = walk.worlds_differ or walk.base_by_feet
    apart |= walk.base is not None and not has_heading(walk.base)
    poses = walk.poses.without_poses() if apart else walk.placed_poses
    positions = [foot.leg_position for foot in walk.settings.feet]
    places, forward_rad = usual_places(poses, walk.records, positions), walk.settings.forward_rad
    to_the_left = np.array([-np.sin(forward_rad), np.cos(forward_rad)])
    apart_m = {
        end: float((place - places[end, "right"]) @ to_the_left)
        for (end, side), place in places.items()
        if side == "left" and (end, "right") in places
    }
    swapped = [end for end, metres in apart_m.items() if metres < -SIDES_APART_M]
    if swapped and len(swapped) == len(apart_m):
        yield found("SIDES_SWAPPED", where="base.yaw_change_rad")
        return
    for end in swapped:
        left, right = (walk.feet[positions.index((end, side))].name for side in ("left", "right"))
        where = f"feet.{left}.topic"
        yield found("SIDES_SWAPPED", "one_pair", where=where, left=left, right=right)


def forward_axis(walk: Walk) -> Iterator[Finding]:
    """Yield that another axis than the guessed one is forward, or may be."""
    settings, base = walk.settings, walk.base
    if base is None:
        return
    if settings.forward_axis_reason:
        yield found("FORWARD_AXIS", where="settings.forward_axis", settings=settings)
    forward, left = base.forward_speed_mps or 0.0, base.lateral_speed_mps or 0.0
    goes = has_heading(base) and abs(left) * (base.duration_s or 0.0) > WALKED_M
    if goes and abs(left) > 2.0 * abs(forward):
        where, side = "base.forward_speed_mps", "left" if left > 0.0 else "right"
        words: Words = {"settings": settings, "base": base, "side": side, "speed": abs(left)}
        cases = ("assumed",) if settings.forward_axis_is_assumed else ()
        yield found("FORWARD_AXIS", *cases, where=where, say="sideways", **words)
