"""Velocity commands and accelerations, on one clock, and what they are compared with.

Header stamps are used where they are of the base's clock. Times of messages without such stamps are
their log times, put on the clock of the base by how far the base's stamps lie behind log time: a
delay then includes that of the recorder, and a finding says so.
"""

from typing import Final, Literal, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, picked
from dogbot_logtool.core.clock import (
    WINDOW_NS,
    OffsetTrack,
    StampCheck,
    TimeSource,
    advancing,
    check_stamps,
    clock_at,
    clock_differences,
    offset_track,
    too_far_apart,
)
from dogbot_logtool.core.metrics import Commands, Imu, Planned, Tracking, Turning
from dogbot_logtool.core.quality import steady_gap_ns
from dogbot_logtool.core.recording import VectorSamples, VectorTopic
from dogbot_logtool.core.records import Number

MOST: Final = 1e6
"""m/s, rad/s or m/s^2; no robot reaches more."""


class VectorHistory(NamedTuple):
    """Vectors of one topic that can be used."""

    topic: str
    frames: tuple[str, ...]
    """Header frame ids that were seen, sorted."""
    messages: int
    refused: int
    """Messages with a number that is not finite, or that no robot reaches; left out."""
    time: Ints
    """(n,) ns on the clock that is measured on, strictly increasing."""
    vector: Floats
    """(n, 3)"""
    turn_rate: Floats
    """(n, 3) rad/s; NaN: not recorded."""
    gap_ns: float
    """ns: a longer silence is a gap."""
    on_log_time: bool
    """Whether the times are log times, put on the clock that is measured on."""


def vector_history(
    topic: str, recorded: VectorTopic, clock: TimeSource, base: OffsetTrack | None
) -> VectorHistory:
    """Return the vectors of a topic.

    Args:
        topic: its name.
        recorded: in the order of the log.
        clock: what is measured on.
        base: how far the stamps of the base lie behind log time; None: it has none.
    """
    samples = recorded.samples
    # A number that is not finite is not below any bound.
    usable = np.asarray((np.abs(samples.vector) <= MOST).all(axis=1))
    check = check_stamps(topic, samples.stamp, samples.log_time)
    by_stamps = clock is TimeSource.HEADER and _is_stamped_like(samples, check, base)
    kept = picked(samples, usable & check.usable if by_stamps else usable)
    time = kept.stamp if by_stamps else kept.log_time
    if clock is TimeSource.HEADER and not by_stamps and base is not None and len(base[0]):
        middle = base[0] * WINDOW_NS + WINDOW_NS // 2
        time = clock_at(time, middle, middle - base[1])
    goes_on = advancing(time)
    return VectorHistory(
        topic=topic,
        frames=recorded.frames,
        messages=len(usable),
        refused=int((~usable).sum()),
        time=time[goes_on],
        vector=kept.vector[goes_on],
        turn_rate=kept.turn_rate[goes_on],
        gap_ns=steady_gap_ns(np.diff(time[goes_on])),
        on_log_time=not by_stamps,
    )


def _is_stamped_like(samples: VectorSamples, check: StampCheck, base: OffsetTrack | None) -> bool:
    """Tell whether messages have stamps, of the same clock as the base's."""
    if not check.mostly_usable:
        return False
    if base is None:
        return True
    own = offset_track(samples.log_time[check.usable], samples.stamp[check.usable])
    tracks = {check.topic: own, "": base}
    return check.topic not in too_far_apart(clock_differences(tracks, ("",)), None)


TRACKING_HZ: Final = 50.0
"""Commanded and measured velocity are compared so often."""
AXES: Final = ("forward", "lateral", "yaw")
"""The columns of velocities: m/s forward, m/s to the left, rad/s to the left."""


class CommandTrack(NamedTuple):
    """Commanded and measured velocity over time."""

    history: VectorHistory
    axes_known: bool
    """Whether it can be told which way a command's x points."""
    window_ns: int
    timeout_ns: int
    commanded_s: float
    """s with a command, of the time that is known of the base; also `no_command_s`, without."""
    no_command_s: float
    time: Ints
    """(n,) ns, times whose window is known of the base and of the command."""
    commanded: Floats
    """(n, 3) as in `AXES`; also `measured`."""
    measured: Floats
    opposed: tuple[str, ...]
    """The axes of which the base does the opposite of the command."""

    @property
    def breaks(self) -> Ints:
        """(b, 2) ns, holes between neighbouring times, over which no line leads."""
        return timespans.steps_where(self.time, np.diff(self.time) > 1.5e9 / TRACKING_HZ)

    def errors(self, axis: int) -> tuple[Number, Number, Number, Number]:
        """Return means of command and measurement, mean and rms of measured less commanded."""
        if not len(self.time) or (axis < 2 and not self.axes_known):
            return None, None, None, None
        commanded, measured = self.commanded[:, axis], self.measured[:, axis]
        error = measured - commanded
        rms = float(np.sqrt((error * error).mean()))
        return float(commanded.mean()), float(measured.mean()), float(error.mean()), rms

    def metrics(self) -> Commands:
        """Return how the base follows its commands."""
        forward, lateral, yaw = (self.errors(axis) for axis in range(3))
        return Commands(
            topic=self.history.topic,
            commanded_s=self.commanded_s,
            forward=Tracking(*forward),
            lateral=Tracking(*lateral),
            yaw=Turning(*yaw),
        )


class PlannedFoot(NamedTuple):
    """A foot's measured steps against its planned ones, in the time that is known of both."""

    topic: str
    """Topic of the plan."""
    touchdowns: int
    """Planned ones."""
    early: int
    """Matched touchdowns that are early by more than a sample and `ON_TIME_S`. Also `late`."""
    late: int
    metrics: Planned


Reading = Literal["m/s^2", "g", "without gravity", "nothing", "another scale", "unclear"]
"""The kind of readings of an accelerometer."""


class ImuComparison(NamedTuple):
    """Comparison of the acceleration by accelerometer, forces and poses."""

    metrics: Imu
    reading: Reading
    scale: float
    """Reading over expected value."""
    odd_foot: tuple[int, float] | None
    """The one foot whose factor is not that of the others, which are right, and by what its force
    must be multiplied."""
