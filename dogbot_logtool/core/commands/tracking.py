"""How the base follows its velocity commands: error and drift.

All velocities are means over one stride: a robot's gait swings about its speed once or twice a
stride, which is no error. Commands are averaged alike, so that this delays nothing.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, added_within
from dogbot_logtool.core.base.motion import FORWARD_ANGLES
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.commands.held_command import HeldCommand, held_command
from dogbot_logtool.core.recorded.vectors import VectorHistory
from dogbot_logtool.core.rotations import along_heading
from dogbot_logtool.dataclass import dataclass

TRACKING_HZ: Final = 50.0
"""Commanded and measured velocity are compared so often."""
USUAL_WINDOW_S: Final = 0.5
"""s, what velocities are averaged over in a log without strides."""
OPPOSED: Final = -0.7
"""Correlation up to which the base does the opposite of its command."""
_DELAYS_NS: Final = (0, 200_000_000, 400_000_000)
"""ns, by which the base may follow later: it does the opposite only if it does with each."""
_LEAST_CHANGE: Final = 0.03
"""m/s or rad/s, standard deviation from which a correlation means something."""
_FEWEST_WINDOWS: Final = 4
"""Times the window; a correlation over less time means nothing."""
ZERO: Final = 0.01
"""m/s or rad/s; commands up to it stand for none."""
STRAIGHT_MPS: Final = 0.05
"""m/s; a forward command from which a robot walks."""
SETTLED_S: Final = 1.0
"""s after a change of the command before a drift is measured."""
_LEAST_DRIFT_S: Final = 1.0
_WORLD_FRAMES: Final = frozenset({"world", "odom", "map", "earth"})
_CLEARLY: Final = 0.7
"""The better of two readings of the axes has at most this share of the other's error."""

SPARSE_NS: Final = 1_000_000_000
"""ns; poses further apart than this tell no speed."""


@dataclass(frozen=True, slots=True)
class Odometer:
    """How far a robot has gone along axes that turn with it.

    Its difference over a time is the mean velocity in the robot's own frame, however it turns.
    """

    origin: int
    """ns."""
    seconds: Floats
    """(n,) s since the origin."""
    way: Floats
    """(n, 3) m forward, m to the left, rad turned to the left; since the first row."""
    known: Ints
    """(k, 2) ns, time without gaps and jumps."""

    def mean_rate(self, time: Ints, window_ns: int) -> Floats:
        """(m, 3) m/s and rad/s, means over a window about each time."""
        since = (time - self.origin) / 1e9
        half = window_ns / 2e9
        return added_within(self.way, self.seconds, since, half) / (2.0 * half)


def base_odometer(base: BaseHistory, forward_axis: str, jumps: Ints) -> Odometer | None:
    """Add up the steps from pose to pose in the robot's own frame (yaw only).

    Args:
        base: poses without jumps.
        forward_axis: the body's axis that points forward.
        jumps: (j, 2) ns, spans that nothing is measured across.

    Returns:
        None without two poses.
    """
    if len(base.time) < 2:
        return None
    yaw = base.angles[:, 2]
    heading = (yaw[1:] + yaw[:-1]) / 2.0 + FORWARD_ANGLES[forward_axis]
    forward, left = along_heading(np.diff(base.position[:, :2], axis=0), heading)
    steps = np.stack([forward, left, np.diff(yaw)], axis=1)
    sparse = np.flatnonzero(np.diff(base.time) > SPARSE_NS)
    broken = np.stack([base.time[sparse], base.time[sparse + 1]], axis=1)
    origin = int(base.time[0])
    return Odometer(
        origin=origin,
        seconds=(base.time - origin) / 1e9,
        way=np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)]),
        known=timespans.subtract(base.known, timespans.merge(np.concatenate([jumps, broken]))),
    )


@dataclass(frozen=True, slots=True)
class AxisTracking:
    """One part of the velocity, in m/s or rad/s, while there is a command."""

    commanded_mean: float
    measured_mean: float
    mean_error: float
    """Measured minus commanded."""
    rms_error: float
    is_opposed: bool
    """Whether the base does the opposite of the command."""


@dataclass(frozen=True, slots=True)
class Drift:
    """The base's mean velocity while the command asks for none of some of it."""

    duration_s: float
    forward: float
    """m/s"""
    lateral: float
    """m/s, to the left."""
    yaw_rate: float
    """rad/s, to the left."""


@dataclass(frozen=True, slots=True)
class Tracking:
    """How the base follows the commands, in a log or in a part of it."""

    commanded_s: float
    """s with a command, of the time that is known of the base."""
    no_command_s: float
    """s without one."""
    forward: AxisTracking | None
    """None: too little time, or the commands' axes are not known; also `lateral`."""
    lateral: AxisTracking | None
    yaw: AxisTracking | None
    straight: Drift | None
    """While straight ahead is commanded; None: not for long enough."""
    in_place: Drift | None
    """While the robot steps and no motion is commanded."""


@dataclass(frozen=True, slots=True)
class CommandTrack:
    """Commanded and measured velocity over time."""

    history: VectorHistory
    axes: str | None
    """``forward``: a command's x is the robot's forward direction; ``body``: x of the base's frame.
    None: cannot be told."""
    window_ns: int
    held: HeldCommand
    odometer: Odometer
    time: Ints
    """(n,) ns, times whose window is known of the base and of the command."""
    commanded: Floats
    """(n, 3) m/s forward, m/s to the left, rad/s to the left."""
    measured: Floats
    """(n, 3) the same."""
    stepping: Ints
    """(s, 2) ns, time in which the robot steps."""

    @property
    def half_ns(self) -> int:
        """ns, half of the window."""
        return self.window_ns // 2

    @property
    def breaks(self) -> Ints:
        """(b, 2) ns, holes between neighbouring times, over which no line leads."""
        rows = np.flatnonzero(np.diff(self.time) > 1.5e9 / TRACKING_HZ)
        return np.stack([self.time[rows], self.time[rows + 1]], axis=1)


def follow_commands(
    history: VectorHistory,
    base: BaseHistory,
    jumps: Ints,
    forward_axis: str,
    stepping: Ints,
    period_s: float | None,
) -> CommandTrack | None:
    """Compare commands with the base's velocity over time.

    Args:
        history: commands: linear x and y, angular z.
        base: poses without jumps.
        jumps: (j, 2) ns.
        forward_axis: the body's axis that points forward.
        stepping: (s, 2) ns, time in which the robot steps.
        period_s: s, the usual stride; None: there are none.

    Returns:
        None without commands or poses.
    """
    odometer = base_odometer(base, forward_axis, jumps)
    if odometer is None or len(history.time) == 0:
        return None
    window = round((period_s or USUAL_WINDOW_S) * 1e9)
    held = held_command(history, 0.0)
    time = timespans.ticks(odometer.known, round(1e9 / TRACKING_HZ))
    half = window // 2
    for known in (odometer.known, held.known):
        time = time[timespans.hold_window(known, time, half, half)]
    track = CommandTrack(
        history=history,
        axes="forward",
        window_ns=window,
        held=held,
        odometer=odometer,
        time=time,
        commanded=held.mean(time, window),
        measured=odometer.mean_rate(time, window),
        stepping=stepping,
    )
    if not _WORLD_FRAMES.isdisjoint(name.strip("/") for name in history.frames):
        return replace(track, axes=None)
    return _with_axes(track, FORWARD_ANGLES[forward_axis])


def _with_axes(track: CommandTrack, turn_rad: float) -> CommandTrack:
    """Tell by the smaller error whose axes the commands are in, where that makes a difference."""
    if turn_rad == 0.0:
        return track
    held = held_command(track.history, turn_rad)
    turned = replace(
        track, axes="body", held=held, commanded=held.mean(track.time, track.window_ns)
    )
    errors = [_horizontal_error(each) for each in (track, turned)]
    better, worse = (track, turned) if errors[0] <= errors[1] else (turned, track)
    told = min(errors) <= _CLEARLY * max(errors)
    return better if told or not np.any(worse.commanded[:, :2]) else replace(better, axes=None)


def _horizontal_error(track: CommandTrack) -> float:
    error = (track.measured - track.commanded)[:, :2]
    return float(np.sqrt((error * error).sum(axis=1).mean())) if len(error) else 0.0


def tracking(track: CommandTrack, within: Ints | None = None) -> Tracking:
    """Measure how the base follows the commands.

    Args:
        track: commanded and measured velocity.
        within: (w, 2) ns, a part of the log; None: all of it.
    """
    limits = [] if within is None else [within]
    known = timespans.intersect([track.odometer.known, *limits])
    commanded = timespans.intersect([known, track.held.known])
    rows = np.ones(len(track.time), np.bool_)
    if within is not None:
        rows = timespans.hold_window(within, track.time, track.half_ns, track.half_ns)
    axes = [_axis(track, axis, rows) for axis in range(3)]
    forward, lateral = axes[:2] if track.axes else (None, None)
    return Tracking(
        commanded_s=timespans.total(commanded) / 1e9,
        no_command_s=(timespans.total(known) - timespans.total(commanded)) / 1e9,
        forward=forward,
        lateral=lateral,
        yaw=axes[2],
        straight=_drift(track, rows, _goes_straight(track.held)) if track.axes else None,
        in_place=_drift(track, rows, _asks_nothing(track.held), track.stepping),
    )


def _axis(track: CommandTrack, axis: int, rows: Flags) -> AxisTracking | None:
    if not rows.any():
        return None
    commanded, measured = track.commanded[rows, axis], track.measured[rows, axis]
    error = measured - commanded
    return AxisTracking(
        commanded_mean=float(commanded.mean()),
        measured_mean=float(measured.mean()),
        mean_error=float(error.mean()),
        rms_error=float(np.sqrt((error * error).mean())),
        is_opposed=_is_opposed(track, axis, rows),
    )


def _is_opposed(track: CommandTrack, axis: int, rows: Flags) -> bool:
    """Tell whether the base does the opposite of the command, however late it follows."""
    longest = track.half_ns + max(_DELAYS_NS)
    chosen = rows & timespans.hold_window(track.held.known, track.time, longest, track.half_ns)
    if chosen.sum() / TRACKING_HZ < _FEWEST_WINDOWS * track.window_ns / 1e9:
        return False
    time, measured = track.time[chosen], track.measured[chosen, axis]
    for delay in _DELAYS_NS:
        commanded = track.held.mean(time, track.window_ns, delay)[:, axis]
        if min(measured.std(), commanded.std()) < _LEAST_CHANGE:
            return False
        if float(np.corrcoef(measured, commanded)[0, 1]) > OPPOSED:
            return False
    return True


def _asks_nothing(held: HeldCommand) -> Flags:
    return np.asarray((np.abs(held.velocity) <= ZERO).all(axis=1))


def _goes_straight(held: HeldCommand) -> Flags:
    ahead: Flags = np.abs(held.velocity[:, 0]) >= STRAIGHT_MPS
    return ahead & (np.abs(held.velocity[:, 1:]) <= ZERO).all(axis=1)


def _drift(
    track: CommandTrack, rows: Flags, holds: Flags, within: Ints | None = None
) -> Drift | None:
    """Return the mean velocity while one of some commands has held for some time."""
    spans = track.held.where(holds)
    half = track.half_ns
    settled = half + round(SETTLED_S * 1e9)
    chosen = rows & timespans.hold_window(spans, track.time, settled, half)
    if within is not None:
        chosen &= timespans.hold_window(within, track.time, half, half)
    duration = int(chosen.sum()) / TRACKING_HZ
    if duration < _LEAST_DRIFT_S:
        return None
    forward, lateral, yaw_rate = track.measured[chosen].mean(axis=0).tolist()
    return Drift(duration, forward, lateral, yaw_rate)
