"""A walk at constant speed in closed form, on any number of feet.

Each foot's vertical force over a stance is Alexander and Jayes' (1978) curve
``A (sin(pi s) + q sin(3 pi s))``, s from 0 at touchdown to 1 at lift-off, with A such that over a
whole stride the foot carries its share of the weight. So the vertical impulse of all feet over
whole strides is the weight times the time, exactly. Along the slope it brakes and then propels:
``-B sin(2 pi s)``, which adds up to nothing. A stance's foot stands where its corner of the body
is in mid-stance.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tests.truth.gaits import TROT, Gait
from tests.truth.geometry import Floats, about_axis, margins, product, turned
from tests.truth.recording import BaseRecording, FootRecording, Recording, Truth, sample_times
from tests.truth.robots import GRAVITY_MPS2, Robot, quadruped

MARGIN_HZ = 50.0
"""The margin is looked at so often; `stats` does so 25 times a second."""
_MOMENTS, _HARMONICS = 1024, 32


@dataclass(frozen=True, slots=True)
class Walk:
    """A robot that walks along its forward axis from before the recording until after it."""

    gait: Gait = TROT
    robot: Robot = field(default_factory=quadruped)
    period_s: float = 0.8
    speed_mps: float = 0.5
    seconds: float = 8.0
    slope_rad: float = 0.0
    """Of the ground, upwards along the walk."""
    heading_rad: float = 0.0
    body_yaw_rad: float = 0.0
    """Of the base's axes against the way it walks."""
    turn_radps: float = 0.0
    """To the left, as it walks; each foot stands where its corner is in mid-stance."""
    step_height_m: float = 0.05
    slip_m: float = 0.0
    """Way of each foot on the ground over a stance, forward, at constant speed."""
    shares: tuple[float, ...] | None = None
    """Of the weight, by foot; None: equal ones."""
    hump: float = 0.2
    """q of the force curve."""
    ramp: float | None = None
    """Share of a stance in which a force that is flat on top rises, and falls; None: the curve."""
    traction: float = 0.1
    """B over the mean vertical force of a stance."""
    heaves: bool = False
    """Whether the base rises and falls as the feet's forces move its mass; on level ground."""
    link_swing_rad: float = 0.4
    """How far a foot's link tilts forward and back against the base in a stride."""
    link_lean_rad: float = 0.0
    """How far it leans on average."""
    begin: float = 0.137
    """Phase of the reference foot at time 0: events lie off the grid of samples."""

    @property
    def stance_s(self) -> float:
        """Duration of each stance."""
        return self.gait.duty * self.period_s

    @property
    def _level(self) -> float:
        """Horizontal part of a way along the slope."""
        return float(np.cos(self.slope_rad))

    def share(self, foot: int) -> float:
        """Part of the weight that a foot carries over a stride."""
        return self.shares[foot] if self.shares else 1.0 / len(self.robot.feet)

    def mean_vertical_n(self, foot: int) -> float:
        """Mean vertical force of a foot over its stance."""
        return self.share(foot) * self.robot.weight_n / self.gait.duty

    def peak_vertical_n(self, foot: int) -> float:
        """Highest vertical force of a foot on level ground."""
        return float(self.force(foot, self._stride)[:, 2].max())

    @property
    def _stride(self) -> Floats:
        """(n,) s, moments of a stride."""
        return np.arange(_MOMENTS) / _MOMENTS * self.period_s

    def cycles(self, foot: int, time: Floats) -> Floats:
        """Strides since the foot's touchdown number 0."""
        return np.asarray(time / self.period_s + self.begin - self.gait.phases[foot])

    def touchdowns(self, foot: int) -> Floats:
        """Times of the foot's touchdowns in the recording, s."""
        return self._times(foot, 0.0)

    def lift_offs(self, foot: int) -> Floats:
        """Times of the foot's lift-offs in the recording, s."""
        return self._times(foot, self.gait.duty)

    def _times(self, foot: int, cycle: float) -> Floats:
        first = int(np.floor(self.cycles(foot, np.zeros(1))[0])) - 1
        count = int(self.seconds / self.period_s) + 4
        strides = np.arange(first, first + count) + cycle
        times = (strides - self.begin + self.gait.phases[foot]) * self.period_s
        return np.asarray(times[(times >= 0.0) & (times <= self.seconds)])

    def force(self, foot: int, time: Floats) -> Floats:
        """(n, 3) N on the foot, in the world."""
        stance = (self.cycles(foot, time) % 1.0) / self.gait.duty
        s = np.where(stance < 1.0, stance, 0.0)
        mean = self.mean_vertical_n(foot)
        curve = np.sin(np.pi * s) + self.hump * np.sin(3.0 * np.pi * s)
        vertical = mean * np.pi / (2.0 + 2.0 * self.hump / 3.0) * curve
        if self.ramp is not None:
            risen = np.clip(np.minimum(s, 1.0 - s) / self.ramp, 0.0, 1.0)
            vertical = mean / (1.0 - self.ramp) * risen
        along = -self.traction * mean * np.sin(2.0 * np.pi * s)
        up = np.array([0.0, 0.0, 1.0])
        return np.asarray(vertical[:, None] * up + along[:, None] * self._forward(time))

    def sole(self, foot: int, time: Floats) -> Floats:
        """(n, 3) m, the foot's sole in the world."""
        cycles = self.cycles(foot, time)
        stride = np.floor(cycles)
        stance = (cycles - stride) / self.gait.duty
        progress = np.clip((cycles - stride - self.gait.duty) / (1.0 - self.gait.duty), 0.0, 1.0)
        eased = progress**3 * (10.0 - 15.0 * progress + 6.0 * progress**2)
        slid = self.slip_m * (np.clip(stance, 0.0, 1.0) - 0.5 - eased)
        corner_x, corner_y = self.robot.corners_m[foot]
        mid_stance = (
            stride + eased - self.begin + self.gait.phases[foot]
        ) * self.period_s + self.stance_s / 2.0
        ahead, left = self._turned(mid_stance, corner_x + slid, corner_y)
        x, y = self._way(mid_stance)
        height = self.step_height_m * np.sin(np.pi * progress) ** 2
        return self._in_world(x + ahead, y + left, height)

    def base(self, time: Floats) -> Floats:
        """(n, 3) m, the base in the world: `height_m` off the ground, along its normal."""
        heave = self._heave(time) if self.heaves else np.zeros_like(time)
        return self._in_world(*self._way(time), self.robot.height_m + heave)

    def _heave(self, time: Floats) -> Floats:
        """(n,) m: each harmonic of the force on a mass moves it by its share over w squared."""
        force = sum(self.force(foot, self._stride)[:, 2] for foot in range(len(self.robot.feet)))
        shares = np.fft.rfft(force)[1 : _HARMONICS + 1] * 2.0 / _MOMENTS / self.robot.mass_kg
        w = 2.0 * np.pi / self.period_s * np.arange(1, _HARMONICS + 1)
        return np.asarray((np.exp(1j * w * time[:, None]) @ (-shares / w**2)).real)

    def attitude(self, time: Floats) -> Floats:
        """(n, 4) the base's orientation: parallel to the ground."""
        return product(self._ground(time), about_axis(2, self.turn_radps * time))

    def _way(self, time: Floats) -> tuple[Floats, Floats]:
        """(n,) m ahead and to the left of where the walk began, along the ground: an arc."""
        half = self.turn_radps * time / 2.0
        chord = self.speed_mps * time * np.sinc(half / np.pi)
        return chord * np.cos(half), chord * np.sin(half)

    def _turned(
        self, time: Floats, ahead: Floats | float, left: Floats | float
    ) -> tuple[Floats, Floats]:
        """(n,) m, what is ahead and to the left of the base, in the directions of the start."""
        cos, sin = np.cos(self.turn_radps * time), np.sin(self.turn_radps * time)
        return cos * ahead - sin * left, sin * ahead + cos * left

    def _forward(self, time: Floats) -> Floats:
        """(n, 3) the way that the base looks."""
        return self._in_world(*self._turned(time, 1.0, 0.0), np.zeros_like(time))

    def _ground(self, time: Floats) -> Floats:
        """(n, 4) the turn of the ground."""
        heading = about_axis(2, np.full_like(time, self.heading_rad))
        return product(heading, about_axis(1, np.full_like(time, -self.slope_rad)))

    def _in_world(self, along: Floats, left: Floats, above: Floats) -> Floats:
        return turned(self._ground(above), np.stack([along, left, above], axis=1))

    def link(self, foot: int, time: Floats) -> Floats:
        """(n, 4) orientation of the foot's link in the base."""
        angle = self.link_lean_rad + self.link_swing_rad * np.cos(
            2.0 * np.pi * self.cycles(foot, time)
        )
        return about_axis(1, angle)

    def recorded(self, rate_hz: float = 250.0, odometry_hz: float | None = None) -> Recording:
        """Return the messages of perfect sensors."""
        time = sample_times(self.seconds, rate_hz)
        base_time = time if odometry_hz is None else sample_times(self.seconds, odometry_hz)
        # Constant, as the velocity commands of a robot that turns.
        velocity = np.tile(self.speed_mps * self._forward(np.zeros(1)), (len(base_time), 1))
        body = about_axis(2, np.full_like(base_time, self.body_yaw_rad))
        attitude = product(self.attitude(base_time), body)
        base = BaseRecording.sent(base_time, self.base(base_time), attitude, velocity)
        feet = tuple(self._foot(foot, time) for foot in range(len(self.robot.feet)))
        return Recording(self.robot, feet, base, self.truth(), self.seconds)

    def _foot(self, foot: int, time: Floats) -> FootRecording:
        touching = self.cycles(foot, time) % 1.0 < self.gait.duty
        zero = np.zeros_like(time)
        return FootRecording.sent(
            time,
            touching,
            self.force(foot, time),
            self.sole(foot, time),
            self._in_world(zero, zero, zero + 1.0),
            self.link(foot, time),
        )

    def truth(self) -> Truth:
        """Return what is true of the walk."""
        feet = range(len(self.robot.feet))
        return Truth(
            self.gait.name,
            tuple(tuple(self.touchdowns(foot).tolist()) for foot in feet),
            tuple(tuple(self.lift_offs(foot).tolist()) for foot in feet),
            {**self._truth_of_feet(), **self._truth_of_base(), **self._truth_of_support()},
            self.gait.sequence,
        )

    def _truth_of_feet(self) -> dict[str, Any]:
        def each(of: Callable[[int], Any]) -> tuple[float, ...]:
            return tuple(float(of(foot)) for foot in range(len(self.robot.feet)))

        def size(foot: int) -> Floats:
            return np.asarray(np.linalg.norm(self.force(foot, self._stride), axis=1))

        whole = np.linspace(0.0, self.seconds, _MOMENTS)
        braked = self._level * self.traction * self.stance_s / np.pi
        slid = 0.8 * self.slip_m * self._level  # from 10 % to 90 % of a stance
        shares = each(self.share)
        pairs = (sum(shares[:2]), sum(shares[::2])) if len(shares) == 4 else (None, None)
        return {
            "contact_fraction": each(self._contact_fraction),
            "duty_factor": self.gait.duty,
            "stance_s": self.stance_s,
            "swing_s": self.period_s - self.stance_s,
            "stride_period_s": self.period_s,
            "stride_frequency_hz": 1.0 / self.period_s,
            "stride_length_m": each(self._stride_length_m),
            "peak_force_n": each(lambda foot: size(foot).max()),
            "mean_force_n": each(lambda foot: size(foot).mean() / self.gait.duty),
            "peak_vertical_force_n": None if self.slope_rad else each(self.peak_vertical_n),
            "mean_vertical_force_n": each(self.mean_vertical_n),
            "vertical_impulse_ns": each(
                lambda foot: self.force(foot, whole)[:, 2].mean() * self.seconds
            ),
            "braking_impulse_ns": each(lambda foot: braked * self.mean_vertical_n(foot)),
            "propulsive_impulse_ns": each(lambda foot: braked * self.mean_vertical_n(foot)),
            **dict.fromkeys(("slip_m", "slip_largest_m", "contact_travel_m"), slid),
            **self._truth_of_forces(),
            "load_share": shares,
            "load_share_fore": pairs[0],
            "load_share_left": pairs[1],
            "phase": each(lambda foot: self.gait.phases[foot] - self.gait.phases[0]),
        }

    def _truth_of_forces(self) -> dict[str, Any]:
        """Return what the curve of the force tells of touchdowns and of friction."""
        found: dict[str, list[float]] = {
            "loading_rate_nps": [],
            "impact_ratio": [],
            "friction_use": [],
        }
        stance = np.arange(1, _MOMENTS) / _MOMENTS * self.stance_s
        zero = np.zeros_like(stance)
        normal = self._in_world(zero, zero, zero + 1.0)
        for foot in range(len(self.robot.feet)):
            start = self.gait.phases[foot] - self.begin
            force = self.force(foot, start * self.period_s + stance)
            size, pressing = np.linalg.norm(force, axis=1), np.abs((force * normal).sum(axis=1))
            first = np.argmax((size[:-1] >= size[1:]) & (size[:-1] > size.max() / 2.0))
            low, high = (np.argmax(size >= share * size[first]) for share in (0.2, 0.8))
            rise_s = stance[high] - stance[low]
            found["loading_rate_nps"].append(0.6 * size[first] / rise_s)
            found["impact_ratio"].append(size[stance <= 0.05].max() / np.median(size))
            use = np.sqrt(np.maximum(size**2 - pressing**2, 0.0)) / pressing
            loaded = size >= 0.05 * self.robot.weight_n
            found["friction_use"].append(float(np.percentile(use[loaded], 95.0)))
        return {name: tuple(each) for name, each in found.items()}

    def _truth_of_base(self) -> dict[str, Any]:
        x, y = self._way(np.array([self.seconds]))
        level, height, speed_mps = self._level, self.robot.height_m, self.speed_mps
        return {
            "forward_speed_mps": level * speed_mps,
            "yaw_rate_radps": self.turn_radps or None,
            "yaw_change_rad": self.turn_radps * self.seconds or None,
            "path_length_m": level * abs(speed_mps) * self.seconds,
            "net_displacement_m": level * float(np.hypot(x[0], y[0])),
            "height_m": height / level,
            "slope_rad": abs(self.slope_rad),
            "froude": (level * speed_mps) ** 2 * level / (GRAVITY_MPS2 * height),
            "pitch_rad": -self.slope_rad,
            "climb_m": speed_mps * self.seconds * float(np.sin(self.slope_rad)),
        }

    def _truth_of_support(self) -> dict[str, Any]:
        found, height = self._margins_m(), self.robot.height_m
        instants = len(sample_times(self.seconds, MARGIN_HZ))
        rises = [float(np.hypot(each, height)) - height for each in found if each >= 0.0]
        support, is_level = self.gait.support(), not self.slope_rad
        forward, left = self._pressure_m() if is_level else (None, None)
        return {
            "impulse_over_weight": 1.0,
            "support": support,
            "flight_fraction": support[0],
            "static_margin_m": float(np.mean(found)) if found else None,
            "unstable_fraction": sum(each < 0.0 for each in found) / instants if found else None,
            "undefined_fraction": 1.0 - len(found) / instants,
            "unknown_fraction": 0.0,
            "energy_margin_m": float(np.mean(rises)) if rises and is_level else None,
            "pressure_forward_m": forward,
            "pressure_left_m": left,
        }

    def _pressure_m(self) -> tuple[float, float]:
        """Return the mean centre of pressure ahead of the base and to its left."""
        time = sample_times(self.seconds, MARGIN_HZ)
        load = np.stack([self.force(foot, time)[:, 2] for foot in range(len(self.robot.feet))])
        time, load = time[load.sum(axis=0) > 0.0], load[:, load.sum(axis=0) > 0.0]
        soles = np.stack([self.sole(foot, time) for foot in range(len(load))])
        away = (load[:, :, None] * soles).sum(axis=0) / load.sum(axis=0)[:, None] - self.base(time)
        ahead = self._forward(time)
        left = ahead[:, 0] * away[:, 1] - ahead[:, 1] * away[:, 0]
        return float((ahead[:, :2] * away[:, :2]).sum(axis=1).mean()), float(left.mean())

    def _margins_m(self) -> list[float]:
        """Return the margins of the base's ground projection."""
        time = sample_times(self.seconds, MARGIN_HZ)
        feet = range(len(self.robot.feet))
        soles = np.stack([self.sole(foot, time)[:, :2] for foot in feet], axis=1)
        down = np.stack([self.cycles(foot, time) % 1.0 < self.gait.duty for foot in feet], axis=1)
        return margins(soles, down, self.base(time)[:, :2])

    def _stride_length_m(self, foot: int) -> float:
        """Return the chord of the foot's own circle, or of a straight way."""
        x, y = self.robot.corners_m[foot]
        speed = np.hypot(self.speed_mps - self.turn_radps * y, self.turn_radps * x)
        turn = self.turn_radps * self.period_s / 2.0
        return float(self._level * speed * self.period_s * abs(np.sinc(turn / np.pi)))

    def _contact_fraction(self, foot: int) -> float:
        """Share of the recording in which a foot is down."""
        time = np.linspace(0.0, self.seconds, 10_001)
        return float((self.cycles(foot, time) % 1.0 < self.gait.duty).mean())
