"""Findings about the base and its odometry."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core.base.base_motion import BaseMotion
from dogbot_logtool.core.base.forward_axis import WALKED_M
from dogbot_logtool.core.findings.wording import counted
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import norms
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding


def fall_findings(stats: Stats) -> Iterator[Finding]:
    """Yield when the robot falls, or tips over as the recording ends."""
    if len(stats.fallen):
        at = stats.seconds(stats.fallen[:, 0])[0]
        lies = timespans.total(stats.fallen) / 1e9
        text = (
            f"the robot falls at {at:.2f} s and lies for {lies:.1f} s in all; "
            "steps in that time are left out"
        )
        yield Finding("W_FALL", text, "base")
    if stats.tipping is not None and not len(stats.fallen):
        tipping = stats.tipping
        since = (tipping.since - stats.origin) / 1e9
        text = (
            f"the recording ends while the robot tips: its {tipping.angle} leaves the usual range "
            f"at {since:.2f} s and is {tipping.last_rad:.2f} rad at the end"
        )
        yield Finding("W_TIPPING", text, f"base.{tipping.angle}_rad")


def base_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing or doubtful in the figures of the base."""
    record, base = stats.base_history, stats.base
    if base is None:
        yield _without_base(stats)
        return
    if record.not_usable:
        poses = counted(record.not_usable, "pose")
        text = f"{poses} with a zero quaternion or a number that is not finite; left out"
        yield Finding("W_BAD_POSES", text, "base")
    if record.not_advancing:
        poses = counted(record.not_advancing, "pose")
        text = f"{poses} with a time that repeats or steps back; left out"
        yield Finding("W_NOT_ADVANCING", text, "base")
    if stats.rise_m:
        text = (
            f"the base {'rises' if stats.rise_m > 0.0 else 'sinks'} steadily by "
            f"{abs(stats.rise_m):.2f} m against the contact points while it walks: z of the "
            "odometry or of the contact points drifts, or the robot "
            f"{'stretches' if stats.rise_m > 0.0 else 'bends'} its legs more and more; "
            "no height, climb and Froude number"
        )
        yield Finding("W_HEIGHT_DRIFTS", text, "base.height_m")
    elif base.height_m is None:
        text = (
            "the base's height over its feet is not known: no contact points, or these lie in "
            "another world than the base"
        )
        yield Finding("N_NO_HEIGHT", text, "base.height_m")
    if base.froude is None and base.height_m is not None:
        yield Finding("N_NO_FROUDE", "no speed of the base: no Froude number", "base.froude")
    yield from _sides(stats)
    yield from _heading(stats, base)
    yield from _jumps(stats)


def _without_base(stats: Stats) -> Finding:
    """Return why there are no figures of the base."""
    record = stats.base_history
    if record.messages and record.not_usable == record.messages:
        poses = counted(record.messages, "pose")
        text = f"the odometry is useless: {poses}, all with NaN, infinity or a zero quaternion"
        return Finding("W_BAD_POSES", f"{text}; no base figures", "base")
    if stats.leaning_rad is not None:
        text = (
            f"the base leans by up to {np.degrees(stats.leaning_rad):.0f} degrees while the robot "
            "walks on: the z axis of the poses' world or body is not up, as with motion capture "
            "whose y is up; no base figures"
        )
        return Finding("W_UP_AXIS", text, "base")
    return Finding("N_NO_ODOMETRY", "fewer than two poses of the base: no base figures", "base")


def _sides(stats: Stats) -> Iterator[Finding]:
    """Yield where left feet touch on the right."""
    if not stats.swapped:
        return
    if len(stats.swapped) == stats.pairs:
        text = (
            "all left feet touch to the right of the right ones: the base's y axis points to the "
            "right, as in NED and in left-handed frames, or all sides are swapped; turns, the "
            "speed to the left and the centre of pressure may have the wrong sign"
        )
        yield Finding("W_SIDES_SWAPPED", text, "base.yaw_change_rad")
        return
    for left, right in stats.swapped:
        names = stats.feet[left].name, stats.feet[right].name
        text = (
            f"{names[0]} touches to the right of {names[1]}: their topics seem to be swapped; "
            "phases, the gait's sequence and sums over sides are those of the wrong feet"
        )
        yield Finding("W_SIDES_SWAPPED", text, f"feet.{names[0]}.topic")


def _heading(stats: Stats, base: BaseMotion) -> Iterator[Finding]:
    settings = stats.settings
    if settings.forward_axis_reason:
        text = f"forward is the body's {settings.forward_axis} axis: {settings.forward_axis_reason}"
        yield Finding("W_FORWARD_AXIS", text, "settings.forward_axis")
    forward, left = base.forward_speed_mps, base.lateral_speed_mps
    if forward is None or left is None or abs(left) * base.duration_s < WALKED_M:
        return
    if abs(left) > 2.0 * abs(forward):
        axis, side = settings.forward_axis, "left" if left > 0.0 else "right"
        text = (
            f"the robot moves to the {side} of its forward axis {axis}, at {abs(left):.2f} m/s "
            f"against {forward:.2f} m/s forward: if it does not walk sideways, another "
            "--forward-axis is right"
        )
        yield Finding("W_MOVES_SIDEWAYS", text, "base.forward_speed_mps")


def _jumps(stats: Stats) -> Iterator[Finding]:
    jumps = stats.jumps
    if len(jumps.spans) == 0:
        return
    size = norms(jumps.size_m)
    at = stats.seconds(jumps.spans[:, 1])[int(size.argmax())]
    text = (
        f"the base's pose has {counted(len(jumps.spans), 'jump')}, the largest of "
        f"{size.max():.2f} m at {at:.2f} s; path, speeds, turns and stride lengths leave them "
        "out"
    )
    yield Finding("W_POSE_JUMP", text, "base.path_length_m")
