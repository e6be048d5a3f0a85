"""A walk in a circle, or a turn on the spot, at constant speed and turn rate, in closed form."""

from dataclasses import dataclass, replace

import numpy as np

from tests.truth.recording import Floats, FootTruth, Truth, about_axis
from tests.truth.walking import Walk


@dataclass(frozen=True, slots=True)
class CurvedWalk(Walk):
    """A robot that turns to the left as it walks; each foot stands where its corner is in
    mid-stance."""

    turn_radps: float = 0.4

    def base(self, time: Floats) -> Floats:
        """(n, 3) m, the base in the world."""
        radius, yaw = self.speed_mps / self.turn_radps, self.turn_radps * time
        ahead, left = radius * np.sin(yaw), radius * (1.0 - np.cos(yaw))
        return self._in_world(ahead, left, np.full_like(time, self.robot.height_m))

    def attitude(self, time: Floats) -> Floats:
        """(n, 4) the base's orientation."""
        return about_axis(2, self.heading_rad + self.turn_radps * time)

    def _in_world(self, along: Floats, left: Floats, above: Floats) -> Floats:
        cos, sin = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.stack([cos * along - sin * left, sin * along + cos * left, above], axis=1)

    def sole(self, foot: int, time: Floats) -> Floats:
        """(n, 3) m, the foot's sole in the world."""
        cycles = self.cycles(foot, time)
        stride = np.floor(cycles)
        progress = np.clip((cycles - stride - self.gait.duty) / (1.0 - self.gait.duty), 0.0, 1.0)
        eased = progress**3 * (10.0 - 15.0 * progress + 6.0 * progress**2)
        middle = (
            stride + eased - self.begin + self.gait.phases[foot]
        ) * self.period_s + self.stance_s / 2.0
        x, y = self.robot.corners_m[foot]
        yaw = self.heading_rad + self.turn_radps * middle
        place = self.base(middle)
        place[:, 0] += np.cos(yaw) * x - np.sin(yaw) * y
        place[:, 1] += np.sin(yaw) * x + np.cos(yaw) * y
        place[:, 2] = self.step_height_m * np.sin(np.pi * progress) ** 2
        return place

    def force(self, foot: int, time: Floats) -> Floats:
        """(n, 3) N on the foot, in the world; it brakes and propels along the heading."""
        straight = replace(Walk(), **{n: getattr(self, n) for n in Walk.__slots__})
        force = Walk.force(replace(straight, heading_rad=0.0), foot, time)
        yaw = self.heading_rad + self.turn_radps * time
        along = force[:, 0]
        return np.stack([along * np.cos(yaw), along * np.sin(yaw), force[:, 2]], axis=1)

    def truth(self) -> Truth:
        """Return what is true of the walk."""
        truth = Walk.truth(self)
        feet = tuple(self._turning(foot, each) for foot, each in enumerate(truth.feet))
        return replace(truth, feet=feet, yaw_rate_radps=self.turn_radps)

    def _turning(self, foot: int, truth: FootTruth) -> FootTruth:
        """Return the truth of a foot, whose stride is a chord of its own circle."""
        x, y = self.robot.corners_m[foot]
        radius = float(np.hypot(x, self.speed_mps / self.turn_radps - y))
        chord = 2.0 * radius * np.sin(self.turn_radps * self.period_s / 2.0)
        return replace(truth, stride_length_m=float(abs(chord)))
