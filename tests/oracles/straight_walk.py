"""A quadruped's walk straight ahead in closed form, as the core's columns."""

from dataclasses import dataclass

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from tests import analysed

MASS_KG = 20.0
WEIGHT_N = MASS_KG * 9.81
START = 1_700_000_000_000_000_000
RATE_HZ = 250.0
CORNERS = {
    "front_left": (0.3, 0.15),
    "front_right": (0.3, -0.15),
    "back_left": (-0.3, 0.15),
    "back_right": (-0.3, -0.15),
}
FEET = tuple(
    FootSettings(name, f"/{name}", (name.split("_")[0], name.split("_")[1])) for name in CORNERS
)
SETTINGS = WalkSettings(
    FEET,
    mass_kg=MASS_KG,
    foot_rolling_m=0.0,
    wrench_frame=WrenchFrame.WORLD,
    odometry_topic="/odom",
)
TROT = (0.0, 0.5, 0.5, 0.0)
WALK = (0.0, 0.5, 0.75, 0.25)


@dataclass(frozen=True)
class Walk:
    """A walk at constant speed along +x; each foot's force is a half sine over its stance."""

    phases: tuple[float, ...] = TROT
    duty: tuple[float, ...] = (0.6,) * 4
    load: tuple[float, ...] = (1.0,) * 4
    period_s: float = 0.8
    seconds: float = 12.0
    speed_mps: float = 0.5
    begins_s: float = 0.0
    """s: before, the robot stands."""

    def times(self) -> Floats:
        return np.arange(round(self.seconds * RATE_HZ) + 1, dtype=np.float64) / RATE_HZ

    def cycle(self, foot: int, time: Floats) -> Floats:
        # Touchdowns lie half a sample off the grid, so that rounding decides nothing.
        return np.asarray((time - self.begins_s - 0.002) / self.period_s - self.phases[foot])

    def force(self, foot: int, time: Floats) -> Floats:
        cycle, duty = self.cycle(foot, time), self.duty[foot]
        stance = (cycle % 1.0) / duty
        mean_n = self.load[foot] * WEIGHT_N / 4.0 / duty
        force = np.where(stance < 1.0, mean_n * np.pi / 2.0 * np.sin(np.pi * stance), 0.0)
        # Bumpers report no contact at all in swing, and something in stance.
        force = np.where((stance < 1.0) & (force < 12.0), 12.0, force)
        return np.where(time < self.begins_s, WEIGHT_N / 4.0, force)

    def touchdowns(self, foot: int) -> list[float]:
        first = self.begins_s + 0.002 + self.phases[foot] * self.period_s
        count = int((self.seconds - first) / self.period_s) + 1
        return [first + stride * self.period_s for stride in range(count)]

    def samples(self, foot: int) -> Samples:
        time = self.times()
        return foot_samples(foot, time, self.force(foot, time), self.points(foot, time))

    def points(self, foot: int, time: Floats) -> Floats:
        stride = np.floor(np.maximum(self.cycle(foot, time), 0.0))
        x, y = list(CORNERS.values())[foot]
        along = x + self.speed_mps * self.period_s * stride
        return np.stack([along, np.full_like(time, y), np.zeros_like(time)], axis=1)

    def odometry(self) -> Odometry:
        time = self.times()
        zero = np.zeros_like(time)
        x = self.speed_mps * np.maximum(time - self.begins_s, 0.0)
        stamp = START + np.round(time * 1e9).astype(np.int64)
        level = np.stack([zero, zero, zero, zero + 1.0], axis=1)
        velocity = np.stack([zero + self.speed_mps, zero, zero], axis=1)
        position = np.stack([x, zero, zero + 0.45], axis=1)
        return Odometry(stamp, stamp, position, level, velocity, np.zeros_like(position))

    def measure(self, settings: WalkSettings = SETTINGS) -> MeasuredWalk:
        return measure([self.samples(foot) for foot in range(4)], self.odometry(), settings)


def foot_samples(foot: int, time: Floats, force: Floats, point: Floats) -> Samples:
    stamp = START + np.round(time * 1e9).astype(np.int64)
    newtons = np.outer(force, (0.0, 0.0, 1.0))
    return analysed.foot_samples(foot, stamp, stamp + 700_000, force > 0.0, newtons, point)


def measure(
    feet: list[Samples], odometry: Odometry, settings: WalkSettings = SETTINGS
) -> MeasuredWalk:
    return analysed.analysed(settings, feet, odometry)


def codes(stats: MeasuredWalk) -> set[str]:
    return {remark.code for remark in findings_of(stats)}
