"""A quadruped's walk in closed form: base, feet and ground-reaction forces at any time.

Frames: *world* has z up and flat ground at z = 0; *body* has +y forward and +x right, as DogBot's
``base_link``. Times are seconds since the walk's start.

The forces are the quasi-static loads of a body whose centre of mass keeps its height and speed:
at every instant the vertical forces of the feet add up to the weight and the horizontal ones to
zero. The base's small bob, roll and pitch are decoration on the pose: they are exact in pose, twist
and joint angles, and the forces do not follow them (the bob would be 2.5 % of the weight).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from leg_kinematics import (
    Array,
    LegGeometry,
    conjugate,
    joint_angles,
    lower_leg_orientation,
    multiply,
    rotate,
    rotation_about_x,
    rotation_about_y,
    rotation_about_z,
)

BoolArray = npt.NDArray[np.bool_]

FEET = ("front_left", "front_right", "back_left", "back_right")
MASS_KG = 21.261
GRAVITY_MPS2 = 9.80665
WEIGHT_N = MASS_KG * GRAVITY_MPS2
FRICTION_COEFFICIENT = 0.6

_HIP_RIGHT_M = 0.12
_HIP_FORWARD_M = 0.24
_HIP_OFFSET_M = 0.05
_SIDE = {"front_left": -1.0, "front_right": 1.0, "back_left": -1.0, "back_right": 1.0}
_END = {"front_left": 1.0, "front_right": 1.0, "back_left": -1.0, "back_right": -1.0}

_BASE_HEIGHT_M = 0.46
_BOB_M = 0.002
_ROLL_RAD = 0.015
_PITCH_RAD = 0.01
SWING_HEIGHT_M = 0.06

RAMP_S = 0.09
_RAMP_FLOOR = 0.45
_OUTWARD_BASE, _OUTWARD_SWAY, _PROPULSION = 0.05, 0.03, 0.08

PAD_HALF_LENGTH_M = 0.015
_PAD_FRONT_SHARE, _PAD_FRONT_SHARE_GROWTH = 0.3, 0.4


@dataclass(frozen=True, slots=True)
class Gait:
    """A periodic gait at constant speed on a straight line.

    Attributes:
        gait_class: ``trot`` or ``walk``.
        sequence: Feet in the order of their touchdowns, from the front left one.
        period_s: Stride period.
        duty_factor: Stance over stride period, the same for all feet.
        phases: Touchdown of each foot in the front left foot's stride, in [0, 1).
        first_touchdown_s: A touchdown of the front left foot. It is kept off the grid of physics
            steps, so that no sample falls on an event and rounding cannot change its side.
        speed_mps: Forward speed.
        heading_rad: Yaw of the body in world: forward is world +y turned by it.

    """

    gait_class: str
    sequence: tuple[str, ...]
    period_s: float
    duty_factor: float
    phases: dict[str, float]
    first_touchdown_s: float
    speed_mps: float
    heading_rad: float

    @property
    def stance_s(self) -> float:
        """Duration of a stance."""
        return self.duty_factor * self.period_s

    def stride_index(self, foot: str, time_s: Array) -> Array:
        """Count of the foot's strides since its first touchdown (negative before it)."""
        return np.floor(self._strides(foot, time_s))

    def stance_time(self, foot: str, time_s: Array) -> Array:
        """Time since the foot's latest touchdown, in seconds; a swing goes on counting."""
        strides = self._strides(foot, time_s)
        return (strides - np.floor(strides)) * self.period_s

    def in_stance(self, foot: str, time_s: Array) -> BoolArray:
        """Whether the foot is on the ground."""
        return self.stance_time(foot, time_s) < self.stance_s

    def touchdown(self, foot: str, stride: int) -> float:
        """Time of the touchdown that starts a stride of the foot, in seconds."""
        return self.first_touchdown_s + (self.phases[foot] + stride) * self.period_s

    def events(self, foot: str, duration_s: float, delay_s: float) -> list[float]:
        """Times in [0, duration] at ``delay_s`` after the foot's touchdowns, in seconds."""
        strides = range(-2, int(duration_s / self.period_s) + 2)
        times_s = (self.touchdown(foot, stride) + delay_s for stride in strides)
        return [time_s for time_s in times_s if 0 <= time_s <= duration_s]

    def _strides(self, foot: str, time_s: Array) -> Array:
        return (time_s - self.first_touchdown_s) / self.period_s - self.phases[foot]


@dataclass(frozen=True, slots=True)
class BaseMotion:
    """The base at ``n`` instants, everything in world.

    Attributes:
        position_m: Shape ``(n, 3)``.
        orientation: Body to world, shape ``(n, 4)``.
        linear_velocity_mps: Shape ``(n, 3)``.
        angular_velocity_radps: Shape ``(n, 3)``.
        linear_acceleration_mps2: Shape ``(n, 3)``, without gravity.

    """

    position_m: Array
    orientation: Array
    linear_velocity_mps: Array
    angular_velocity_radps: Array
    linear_acceleration_mps2: Array


def leg_geometry(foot: str) -> LegGeometry:
    """Return the geometry of the leg that carries the foot."""
    hip_m = (_SIDE[foot] * _HIP_RIGHT_M, _END[foot] * _HIP_FORWARD_M, 0.0)
    return LegGeometry(hip_m, _SIDE[foot] * _HIP_OFFSET_M)


def base_motion(gait: Gait, time_s: Array) -> BaseMotion:
    """Constant speed along the heading, with a bob, a roll and a pitch once or twice a stride."""
    rate_radps = 2 * np.pi / gait.period_s
    cycle_rad = rate_radps * time_s
    zero = np.zeros_like(time_s)
    heading = rotation_about_z(gait.heading_rad)
    height_m = _BASE_HEIGHT_M + _BOB_M * np.cos(2 * cycle_rad)
    climb_mps = -2 * rate_radps * _BOB_M * np.sin(2 * cycle_rad)
    climb_mps2 = -4 * rate_radps**2 * _BOB_M * np.cos(2 * cycle_rad)
    roll_rad = _ROLL_RAD * np.sin(cycle_rad)
    pitch_rad = _PITCH_RAD * np.sin(2 * cycle_rad)
    pitched = multiply(heading, rotation_about_x(pitch_rad))
    pitch_rate_radps = 2 * rate_radps * _PITCH_RAD * np.cos(2 * cycle_rad)
    roll_rate_radps = rate_radps * _ROLL_RAD * np.cos(cycle_rad)
    return BaseMotion(
        position_m=rotate(heading, np.stack([zero, gait.speed_mps * time_s, height_m], axis=-1)),
        orientation=multiply(pitched, rotation_about_y(roll_rad)),
        linear_velocity_mps=rotate(
            heading, np.stack([zero, zero + gait.speed_mps, climb_mps], axis=-1)
        ),
        angular_velocity_radps=(
            rotate(heading, np.stack([pitch_rate_radps, zero, zero], axis=-1))
            + rotate(pitched, np.stack([zero, roll_rate_radps, zero], axis=-1))
        ),
        linear_acceleration_mps2=np.stack([zero, zero, climb_mps2], axis=-1),
    )


def _foothold(gait: Gait, foot: str, stride: Array) -> Array:
    """Place a stride's sole on the ground, under the leg at mid-stance: ``(n, 3)``, world."""
    mid_stance_s = (
        gait.first_touchdown_s + (gait.phases[foot] + stride) * gait.period_s + gait.stance_s / 2
    )
    right_m = np.full_like(mid_stance_s, _SIDE[foot] * (_HIP_RIGHT_M + _HIP_OFFSET_M))
    forward_m = gait.speed_mps * mid_stance_s + _END[foot] * _HIP_FORWARD_M
    along_heading_m = np.stack([right_m, forward_m, np.zeros_like(right_m)], axis=-1)
    return rotate(rotation_about_z(gait.heading_rad), along_heading_m)


def sole_position(gait: Gait, foot: str, time_s: Array) -> Array:
    """Position of the lower leg's end in world, shape ``(n, 3)``, in metres.

    It rests in stance. In swing it moves to the next foothold on a minimum-jerk profile, and up and
    down again as a squared sine.
    """
    stride = gait.stride_index(foot, time_s)
    swing_s = gait.period_s - gait.stance_s
    progress = np.clip((gait.stance_time(foot, time_s) - gait.stance_s) / swing_s, 0, 1)
    travelled = progress**3 * (10 - 15 * progress + 6 * progress**2)
    start_m = _foothold(gait, foot, stride)
    sole_m = start_m + travelled[:, None] * (_foothold(gait, foot, stride + 1) - start_m)
    sole_m[:, 2] = SWING_HEIGHT_M * np.sin(np.pi * progress) ** 2
    return sole_m


def leg_angles(gait: Gait, foot: str, time_s: Array) -> Array:
    """Angles of hip, upper leg and lower leg, shape ``(n, 3)``, in radians."""
    base = base_motion(gait, time_s)
    from_base_m = sole_position(gait, foot, time_s) - base.position_m
    return joint_angles(leg_geometry(foot), rotate(conjugate(base.orientation), from_base_m))


def lower_leg_in_world(gait: Gait, foot: str, time_s: Array) -> Array:
    """Orientation of the foot's lower leg in world, shape ``(n, 4)``."""
    in_body = lower_leg_orientation(leg_angles(gait, foot, time_s))
    return multiply(base_motion(gait, time_s).orientation, in_body)


def _smooth_step(fraction: Array) -> Array:
    clipped = np.clip(fraction, 0, 1)
    return clipped**2 * (3 - 2 * clipped)


def _load_weight(gait: Gait, foot: str, time_s: Array) -> Array:
    """Weight of the foot in the sharing of the load; 0 in swing.

    A window steps from 0 to a floor at touchdown and rises to 1 within the ramp time; at lift-off
    it falls likewise. Within a stance the load moves from the hind foot to the fore foot, inversely
    to their distances from the centre of mass: so a diagonal pair of a trot balances the moments
    about the lateral axis exactly. A walk does so within 15 N m.
    """
    since_s = gait.stance_time(foot, time_s)
    loading = _smooth_step(since_s / RAMP_S) * _smooth_step((gait.stance_s - since_s) / RAMP_S)
    window = _RAMP_FLOOR + (1 - _RAMP_FLOOR) * loading
    passed_m = gait.speed_mps * (since_s - gait.stance_s / 2)
    lever = (_HIP_FORWARD_M + _END[foot] * passed_m) / (2 * _HIP_FORWARD_M)
    return np.where(gait.in_stance(foot, time_s), window * lever, 0.0)


def _traction(gait: Gait, foot: str, time_s: Array) -> Array:
    """Horizontal over vertical force that a foot strives for: right, forward, up (0), ``(n, 3)``.

    Outward all the time, backward (braking) after touchdown and forward before lift-off.
    """
    stance_fraction = gait.stance_time(foot, time_s) / gait.stance_s
    outward = _OUTWARD_BASE + _OUTWARD_SWAY * np.cos(2 * np.pi * stance_fraction)
    propulsion = -_PROPULSION * np.cos(np.pi * stance_fraction)
    return np.stack([_SIDE[foot] * outward, propulsion, np.zeros_like(outward)], axis=-1)


def ground_forces(gait: Gait, time_s: Array) -> dict[str, Array]:
    """Ground-reaction force on each foot in world, shape ``(n, 3)``, in newtons.

    The vertical forces add up to the weight. The horizontal ones follow each foot's traction less
    the mean of all feet, weighted by their loads, so they add up to zero.
    """
    weights = {foot: _load_weight(gait, foot, time_s) for foot in FEET}
    vertical_n = {
        foot: (WEIGHT_N * weights[foot] / np.sum(list(weights.values()), axis=0))[:, None]
        for foot in FEET
    }
    tractions = {foot: _traction(gait, foot, time_s) for foot in FEET}
    mean_traction = np.sum([vertical_n[foot] * tractions[foot] for foot in FEET], axis=0) / WEIGHT_N
    heading = rotation_about_z(gait.heading_rad)
    up = np.array([0.0, 0.0, 1.0])
    return {
        foot: rotate(heading, vertical_n[foot] * (tractions[foot] - mean_traction + up))
        for foot in FEET
    }


def pad_front_share(gait: Gait, foot: str, time_s: Array) -> Array:
    """Share of the load on the front end of a foot's pad: it grows linearly during stance.

    The pad lies flat along the heading, with its middle at the sole and its ends half a length
    away; so the force-weighted mean of its two contact points travels forward.
    """
    stance_fraction = gait.stance_time(foot, time_s) / gait.stance_s
    return _PAD_FRONT_SHARE + _PAD_FRONT_SHARE_GROWTH * stance_fraction


def pad_travel(stance_fraction: float) -> float:
    """Travel of the force-weighted contact point over a fraction of the stance, in metres."""
    return 2 * PAD_HALF_LENGTH_M * _PAD_FRONT_SHARE_GROWTH * stance_fraction
