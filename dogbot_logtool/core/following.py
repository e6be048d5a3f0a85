"""How the base follows its velocity commands, and feet their plan.

All velocities are means over one stride: a robot's gait swings about its speed once or twice a
stride, which is no error. Commands are averaged alike, so that this delays nothing. A command holds
until the next, but not beyond a time-out.
"""

from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Integral, Ints, aggregate, median_of, nearest_rows
from dogbot_logtool.core.base.witness import motion_in
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.metrics import Planned
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.core.vectors import AXES, TRACKING_HZ, CommandTrack, PlannedFoot, VectorHistory
from dogbot_logtool.core.walk import Walk

USUAL_WINDOW_S: Final = 0.5
"""s, what velocities are averaged over in a log without strides."""
TIMEOUT_S: Final = 0.5
"""s; what ros2_controllers' diff_drive_controller waits for a command before it stops."""
_WORLD_FRAMES: Final = frozenset({"world", "odom", "map", "earth"})
_CLEARLY: Final = 0.7
"""The better of two readings of the axes has at most this share of the other's error."""
OPPOSED: Final = -0.7
"""Correlation up to which the base does the opposite of its command."""
_DELAYS_NS: Final = (0, 200_000_000, 400_000_000)
"""ns, by which the base may follow later: it does the opposite only if it does with each."""
_LEAST_CHANGE: Final = 0.03
"""m/s or rad/s, standard deviation from which a correlation means something."""
_FEWEST_WINDOWS: Final = 4
"""Times the window; a correlation over less time means nothing."""


def follow_commands(walk: Walk) -> CommandTrack | None:
    """Compare commands with the base's velocity over time.

    Args:
        walk: its commands (linear x and y, angular z), and its base.

    Returns:
        None without commands or poses.
    """
    history, base = walk.corrected.commands, walk.track.history
    forward_rad = walk.settings.forward_rad
    if history is None or len(base.time) < 2:
        return None
    window = round((walk.period_s or USUAL_WINDOW_S) * 1e9)
    timeout = round(max(TIMEOUT_S * 1e9, history.gap_ns if np.isfinite(history.gap_ns) else 0.0))
    until = np.append(history.time[1:], history.time[-1:] + timeout)
    held = np.stack([history.time, np.minimum(until, history.time + timeout)], axis=1)
    holds = timespans.merge(held)
    known = timespans.subtract(base.known, timespans.merge(walk.jumps.spans))
    both = timespans.intersect([known, holds])
    time = timespans.ticks(both, round(1e9 / TRACKING_HZ))
    half = window // 2
    time = time[timespans.hold_window(both, time, half, half)]
    motion = motion_in(base, time[:, None] + np.array([-half, half]), forward_rad)
    moved = motion.displacement.real, motion.displacement.imag, motion.turn
    measured = np.stack(moved, axis=1) / (2e-9 * half)
    axes, velocity = _in_axes(history, held, time, window, measured, forward_rad)
    command = _command(held, velocity)
    longest = timespans.hold_window(holds, time, half + max(_DELAYS_NS), half)
    opposed = []
    if longest.sum() / TRACKING_HZ >= _FEWEST_WINDOWS * window / 1e9:
        late = [command.mean(time[longest] - delay, window) for delay in _DELAYS_NS]
        opposed = [
            name
            for axis, name in enumerate(AXES)
            if (axes or axis == 2)
            and all(_oppose(measured[longest, axis], each[:, axis]) for each in late)
        ]
    return CommandTrack(
        history=history,
        axes=axes,
        window_ns=window,
        timeout_ns=timeout,
        commanded_s=timespans.total(both) / 1e9,
        no_command_s=(timespans.total(known) - timespans.total(both)) / 1e9,
        time=time,
        commanded=command.mean(time, window),
        measured=measured,
        opposed=tuple(opposed),
    )


def _command(held: Ints, velocity: Floats) -> Integral:
    """Add up commands: (n, 2) ns for which each holds, (n, 3) as in `AXES`; none counts as zero."""
    each = velocity * ((held[:, 1] - held[:, 0]) / 1e9)[:, None]
    total = np.zeros((2 * len(held), 3))
    total[1::2] = np.cumsum(each, axis=0)
    total[2::2] = total[1:-1:2]
    return Integral(held.ravel(), total)


def _in_axes(
    history: VectorHistory,
    held: Ints,
    time: Ints,
    window_ns: int,
    measured: Floats,
    forward_rad: float,
) -> tuple[str | None, Floats]:
    """Tell by the smaller error whose axes the commands are in, where that makes a difference.

    Returns:
        The axes, see `CommandTrack`, and (n, 3) velocities in the robot's own.
    """
    if not _WORLD_FRAMES.isdisjoint(name.strip("/") for name in history.frames):
        return None, history.vector
    if forward_rad == 0.0:
        return "forward", history.vector
    forward, left = along_heading(history.vector, np.full(len(history.time), forward_rad))
    turned = np.stack([forward, left, history.vector[:, 2]], axis=1)
    readings = {"forward": history.vector, "body": turned}
    means = {key: _command(held, each).mean(time, window_ns) for key, each in readings.items()}
    squares = {key: ((measured - each)[:, :2] ** 2).sum() for key, each in means.items()}
    better, worse = sorted(readings, key=squares.__getitem__)
    clear = squares[better] <= _CLEARLY**2 * squares[worse] or not means[worse][:, :2].any()
    return better if clear else None, readings[better]


def _oppose(measured: Floats, commanded: Floats) -> bool:
    """Tell whether what is measured, (n,), does the opposite of what is commanded, (n,)."""
    if min(measured.std(), commanded.std()) < _LEAST_CHANGE:
        return False
    return float(np.corrcoef(measured, commanded)[0, 1]) <= OPPOSED


ON_TIME_S: Final = 0.02
"""s; touchdowns that are off by less are on time, and by less than a sample of either, too."""
_LONE_NS: Final = 250_000_000
"""ns around a touchdown without neighbours in which its match is looked for."""


def follow_plan(measured: FootSteps, planned: FootSteps) -> PlannedFoot:
    """Compare a foot's steps with its plan.

    A planned touchdown is matched with the nearest measured one if it is the nearest of that one,
    too, and nearer than half of a planned stride. Touchdowns nearer than that to where either is
    unknown are left out: their match may be hidden.

    Args:
        measured: the foot.
        planned: the same foot in a plan, on the same clock.
    """
    records = measured.record, planned.record
    both = timespans.intersect([record.known for record in records])
    plan, steps = planned.touchdown, measured.touchdown
    steps_ns = np.diff(plan)
    reach = int(median_of(steps_ns)) // 2 if len(steps_ns) else _LONE_NS
    match = _matches(plan, steps, reach)
    found = match >= 0
    seen = found & timespans.covers(both, plan)
    counted = timespans.hold_window(both, plan, reach, reach) | seen
    delay = (steps[match[found & counted]] - plan[found & counted]) / 1e9
    tolerance = max(ON_TIME_S, *(record.median_interval_s or 0.0 for record in records))
    alone = np.setdiff1d(np.arange(len(steps)), match[found])
    down = [timespans.intersect([record.in_contact, both]) for record in records]
    together = timespans.total(timespans.intersect(down))
    differ = sum(map(timespans.total, down)) - 2 * together
    known = timespans.total(both)
    return PlannedFoot(
        topic=planned.topic,
        touchdowns=int(counted.sum()),
        early=int((delay < -tolerance).sum()),
        late=int((delay > tolerance).sum()),
        metrics=Planned(
            delay_s=aggregate(delay),
            missed=int((counted & ~found).sum()),
            unplanned=int(timespans.hold_window(both, steps[alone], reach, reach).sum()),
            agreement=1.0 - differ / known if known else None,
        ),
    )


def _matches(plan: Ints, steps: Ints, reach: int) -> Ints:
    """(p,) measured touchdown of each planned one; -1: none."""
    if not len(plan) or not len(steps):
        return np.full(len(plan), -1, np.int64)
    nearest = nearest_rows(steps, plan)
    mutual = nearest_rows(plan, steps)[nearest] == np.arange(len(plan))
    near = np.abs(steps[nearest] - plan) <= reach
    match: Ints = np.where(mutual & near, nearest, -1)
    return match
