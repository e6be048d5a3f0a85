"""Checks of the base's poses, among the contact points, and of what happens to the base."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import norms
from dogbot_logtool.core.base.axes import WALKED_M
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding, counted


def worlds_differ(stats: Stats) -> Iterator[Finding]:
    """Yield where base and contact points are not in one world, or drift apart."""
    worlds = stats.worlds
    if worlds is None:
        return
    if not stats.worlds_differ:
        yield from _heights_differ(stats)
        return
    text = (
        "contact points and odometry are not in one world, or one drifts: the base is "
        f"{worlds.distance_m:.2f} m from the centroid of the feet (at most {worlds.largest_m:.2f} "
        f"m), which are {worlds.spread_m:.2f} m from it; from the log's start to its end that "
        f"changes by {max(worlds.change_m, worlds.drift_m):.2f} m"
    )
    cases = ("aside", "loses_way") if stats.loses_way else ("aside",)
    yield Finding("WORLDS_DIFFER", text, "stability", cases=cases)


def _heights_differ(stats: Stats) -> Iterator[Finding]:
    """Yield that the base is not above the contact points although it is among them."""
    if stats.base is not None and stats.base.height_m is None:
        text = "no height of the base over the contact points: z of one is counted from elsewhere"
        yield Finding("WORLDS_DIFFER", text, "base.height_m", cases=("below",))


def falls(stats: Stats) -> Iterator[Finding]:
    """Yield when the robot falls, or tips over as the recording ends."""
    if len(stats.fallen):
        at = stats.seconds(stats.fallen[:, 0])[0]
        lies = timespans.total(stats.fallen) / 1e9
        text = (
            f"the robot falls at {at:.2f} s and lies for {lies:.1f} s in all; "
            "steps in that time are left out"
        )
        yield Finding("FALL", text, "base")
    elif stats.tipping is not None:
        tipping = stats.tipping
        since = (tipping.since - stats.origin) / 1e9
        text = (
            f"the recording ends while the robot tips: its {tipping.angle} leaves the usual range "
            f"at {since:.2f} s and is {tipping.last_rad:.2f} rad at the end"
        )
        yield Finding("FALL", text, f"base.{tipping.angle}_rad")


def poses(stats: Stats) -> Iterator[Finding]:
    """Yield how many poses are missing or cannot be used."""
    record = stats.base_history
    if stats.base is None and (stats.leaning_rad is not None or stats.frozen is not None):
        return
    if record.messages and record.not_usable == record.messages:
        all_poses = counted(record.messages, "pose")
        text = f"the odometry is useless: {all_poses}, all with NaN, infinity or a zero quaternion"
        yield Finding("NOT_FINITE", text, "base", cases=("base",))
    elif stats.base is None:
        yield Finding("NO_BASE", "fewer than two poses of the base", "base", cases=("few_poses",))
    else:
        yield from _left_out(stats)


def _left_out(stats: Stats) -> Iterator[Finding]:
    record = stats.base_history
    if record.not_usable:
        unusable = counted(record.not_usable, "pose")
        text = f"{unusable} with a zero quaternion or a number that is not finite; left out"
        yield Finding("NOT_FINITE", text, "base", cases=("base",))
    if record.not_advancing:
        repeated = counted(record.not_advancing, "pose")
        text = f"{repeated} with a time that repeats or steps back; left out"
        yield Finding("BAD_STAMPS", text, "base")


def up_axis(stats: Stats) -> Iterator[Finding]:
    """Yield that z is not up: such poses are left out of all that is computed."""
    if stats.leaning_rad is None:
        return
    text = (
        f"the base leans by up to {np.degrees(stats.leaning_rad):.0f} degrees while the robot "
        "walks on: the z axis of the poses' world or body is not up, as with motion capture "
        "whose y is up"
    )
    yield Finding("UP_AXIS", text, "base")


def height_drifts(stats: Stats) -> Iterator[Finding]:
    """Yield that the base rises or sinks over the contact points while it walks."""
    if not stats.rise_m:
        return
    rises = stats.rise_m > 0.0
    text = (
        f"the base {'rises' if rises else 'sinks'} steadily by {abs(stats.rise_m):.2f} m against "
        "the contact points while it walks: z of the odometry or of the contact points drifts, or "
        f"the robot {'stretches' if rises else 'bends'} its legs more and more"
    )
    yield Finding("HEIGHT_DRIFTS", text, "base.height_m")


def sides_swapped(stats: Stats) -> Iterator[Finding]:
    """Yield where left feet touch on the right; where all do, the walk is a mirror image."""
    if not stats.swapped:
        return
    if len(stats.swapped) == stats.pairs:
        text = (
            "all left feet touch to the right of the right ones: the base's y axis points to the "
            "right, as in NED and in left-handed frames, or all sides are swapped; turns, the "
            "speed to the left and the centre of pressure may have the wrong sign"
        )
        yield Finding("SIDES_SWAPPED", text, "base.yaw_change_rad")
        return
    for left, right in stats.swapped:
        names = stats.feet[left].name, stats.feet[right].name
        text = (
            f"{names[0]} touches to the right of {names[1]}: their topics seem to be swapped; "
            "phases and sums over sides are those of the wrong feet"
        )
        where = f"feet.{names[0]}.topic"
        yield Finding("SIDES_SWAPPED", text, where, cases=("one_pair",))


def forward_axis(stats: Stats) -> Iterator[Finding]:
    """Yield that another axis than the guessed one is forward, or may be."""
    settings, base = stats.settings, stats.base
    if base is None:
        return
    if settings.forward_axis_reason:
        text = f"forward is the body's {settings.forward_axis} axis: {settings.forward_axis_reason}"
        yield Finding("FORWARD_AXIS", text, "settings.forward_axis")
    forward, left = base.forward_speed_mps, base.lateral_speed_mps
    if forward is None or left is None or abs(left) * (base.duration_s or 0.0) < WALKED_M:
        return
    if abs(left) > 2.0 * abs(forward):
        axis, side = settings.forward_axis, "left" if left > 0.0 else "right"
        text = (
            f"the robot moves to the {side} of its forward axis {axis}, at {abs(left):.2f} m/s "
            f"against {forward:.2f} m/s forward: if it does not walk sideways, another "
            "forward_axis is right"
        )
        yield Finding("FORWARD_AXIS", text, "base.forward_speed_mps")


def pose_jumps(stats: Stats) -> Iterator[Finding]:
    """Yield that the pose jumps."""
    jumps = stats.jumps
    if len(jumps.spans) == 0:
        return
    size = norms(jumps.size_m)
    turn = np.degrees(np.abs(jumps.turn_rad))
    at = stats.seconds(jumps.spans[:, 1])[int((size + np.radians(turn)).argmax())]
    text = (
        f"the base's pose has {counted(len(jumps.spans), 'jump')} that neither the speeds nor the "
        f"turns around them explain, of up to {size.max():.2f} m and {turn.max():.0f} degrees, the "
        f"largest at {at:.2f} s; path, speeds, turns and stride lengths leave them out"
    )
    yield Finding("POSE_JUMP", text, "base.path_length_m")
