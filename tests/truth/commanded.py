"""A base that follows velocity commands in closed form: after a delay, with a gain, drifting."""

from dataclasses import dataclass, field, replace

import numpy as np

from tests.truth.geometry import Floats, about_axis
from tests.truth.recording import FORCE, BaseRecording, Recording, VectorRecording, sample_times
from tests.truth.walking import Walk

Steps = tuple[tuple[float, tuple[float, float, float]], ...]
STEPS: Steps = (
    (0.0, (0.4, 0.0, 0.0)),
    (5.0, (0.0, 0.0, 0.0)),
    (10.0, (0.4, 0.0, 0.3)),
    (12.3, (0.1, 0.2, -0.3)),
    (15.1, (0.5, -0.1, 0.2)),
)
"""s from which on each command holds, and m/s forward, m/s to the left, rad/s.

Straight ahead, steps in place, and changes of all parts.
"""


@dataclass(frozen=True, slots=True)
class Commanded:
    """A base that does what is commanded, but for what is said."""

    steps: Steps = STEPS
    seconds: float = 22.0
    delay_s: float = 0.17
    gain: tuple[float, float, float] = (0.9, 0.8, 1.1)
    drift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """m/s forward and to the left, rad/s: always there."""
    period_s: float = 0.8
    sway: tuple[float, float, float] = (0.15, 0.1, 0.2)
    """How far a gait swings about the mean velocity, once a stride."""
    silences: tuple[tuple[float, float], ...] = field(default=())
    """s, from and to: nothing is published."""
    body_yaw_rad: float = 0.0
    """Of the base's axes against the way it looks."""

    def commanded(self, time: Floats) -> Floats:
        """(n, 3) the command that holds; zero before the first."""
        starts = np.array([start for start, _ in self.steps])
        values = np.array([(0.0, 0.0, 0.0), *(value for _, value in self.steps)])
        return np.asarray(values[np.searchsorted(starts, time, side="right")])

    def velocity(self, time: Floats) -> Floats:
        """(n, 3) of the base in its own axes."""
        swing = np.sin(2.0 * np.pi * time / self.period_s)[:, None] * np.array(self.sway)
        mean = self.commanded(time - self.delay_s) * np.array(self.gain) + np.array(self.drift)
        return np.asarray(mean + swing)

    def base(self, rate_hz: float = 100.0) -> BaseRecording:
        """Return poses: the velocity, added up in steps of 0.5 ms."""
        fine = np.arange(0.0, self.seconds, 0.0005)
        forward, left, turn = self.velocity(fine + 0.00025).T * 0.0005
        yaw = np.concatenate([[0.0], np.cumsum(turn)])
        middle = (yaw[1:] + yaw[:-1]) / 2.0
        x = forward * np.cos(middle) - left * np.sin(middle)
        y = forward * np.sin(middle) + left * np.cos(middle)
        place = np.concatenate([np.zeros((1, 2)), np.cumsum(np.stack([x, y], axis=1), axis=0)])
        time = sample_times(self.seconds - 0.01, rate_hz)
        rows = np.round(time / 0.0005).astype(np.int64)
        position = np.column_stack([place[rows], np.full(len(rows), 0.4)])
        attitude = about_axis(2, yaw[rows] + self.body_yaw_rad)
        return BaseRecording.sent(time, position, attitude, np.zeros_like(position))

    def commands(
        self, kind: str = "twist_stamped", rate_hz: float = 50.0, topic: str = "/cmd_vel"
    ) -> VectorRecording:
        """Return the commands, published at a steady rate."""
        time = sample_times(self.seconds, rate_hz)
        for start, end in self.silences:
            time = time[(time < start) | (time >= end)]
        return VectorRecording.sent(time, topic, kind, self.commanded(time))


def commanded_walk(robot: Commanded, *beside: VectorRecording) -> Recording:
    """Record a walk whose base does as it is commanded; its force sensors do not tell of places."""
    walk = Walk(seconds=robot.seconds, period_s=robot.period_s, speed_mps=0.4)
    recorded = FORCE(walk.recorded(200.0, 100.0))
    return replace(recorded, base=robot.base(), beside=beside)
