"""Robots that do not walk, or not only: they stand, sit, roll, are carried, or fall.

A scene is a few curves over time: the base's height over the ground, its way along x and its roll,
and the part of the weight that each foot carries. Curves go straight from knot to knot.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import reduce
from typing import Any, Final, TypeVar

import numpy as np

from tests.truth.geometry import Floats, about_axis
from tests.truth.recording import (
    LOGGED_AFTER_NS,
    BaseRecording,
    FootRecording,
    Recording,
    Truth,
    nanoseconds,
    sample_times,
)
from tests.truth.robots import Robot, quadruped
from tests.truth.walking import Walk

Knots = Sequence[tuple[float, float]]
"""Times, s, and values; flat before and after them."""


def curve(knots: Knots, time: Floats) -> Floats:
    """(n,) the values at some times."""
    at, values = np.array(knots, np.float64).T
    return np.asarray(np.interp(time, at, values), np.float64)


NONE: Final = ((0.0, 0.0),)
QUARTER: Final = ((0.0, 0.25),)


@dataclass(frozen=True, slots=True)
class Scene:
    """What a robot does without a step."""

    truth: Truth
    robot: Robot = field(default_factory=quadruped)
    seconds: float = 8.0
    height: Knots = ((0.0, 0.45),)
    """m, of the base over the ground."""
    forward: Knots = NONE
    """m, of the base along x."""
    roll: Knots = NONE
    """rad."""
    loads: tuple[Knots, ...] = (QUARTER,) * 4
    """Of the weight, by foot; below a thousandth the foot is in the air."""
    rolls: bool = False
    """Whether contact points go with the base, as wheels' do."""

    def recorded(self, rate_hz: float = 250.0) -> Recording:
        """Return the messages of perfect sensors."""
        time = sample_times(self.seconds, rate_hz)
        zero = np.zeros_like(time)
        position = np.stack([curve(self.forward, time), zero, curve(self.height, time)], axis=1)
        velocity = np.gradient(position, time, axis=0)
        base = BaseRecording.sent(time, position, about_axis(0, curve(self.roll, time)), velocity)
        feet = tuple(self._foot(foot, time, position) for foot in range(len(self.robot.feet)))
        down = tuple(float(foot.touching.mean()) for foot in feet)
        truth = replace(self.truth, metrics={"contact_fraction": down, **self.truth.metrics})
        return Recording(self.robot, feet, base, truth, self.seconds)

    def _foot(self, foot: int, time: Floats, base: Floats) -> FootRecording:
        zero, up = np.zeros_like(time), np.array([0.0, 0.0, 1.0])
        load = curve(self.loads[foot], time)
        touching = load >= 1e-3
        force = np.where(touching, load, 0.0)[:, None] * self.robot.weight_n * up
        x, y = self.robot.corners_m[foot]
        # A foot in the air hangs as far below the base as it was while the robot stood.
        lifted = np.where(touching, 0.0, np.maximum(base[:, 2] - self.robot.height_m, 0.01))
        along = base[:, 0] if self.rolls else np.where(touching, 0.0, base[:, 0])
        point = np.stack([along + x, zero + y, lifted], axis=1)
        normal = np.tile(up, (len(time), 1))
        return FootRecording.sent(time, touching, force, point, normal, about_axis(1, zero))


_NEVER: Final = ((),) * 4
STILL: Final = Truth(
    "stand",
    _NEVER,
    _NEVER,
    {
        "forward_speed_mps": 0.0,
        "path_length_m": 0.0,
        "height_m": 0.45,
        "slope_rad": 0.0,
        "impulse_over_weight": 1.0,
        "static_margin_m": 0.15,
        "energy_margin_m": float(np.hypot(0.45, 0.15) - 0.45),
    },
)
MOVING: Final = STILL.but(energy_margin_m=None)
"""The same at a height that changes."""
RISING: Final = MOVING.but(height_m=None)


def standing() -> Scene:
    """Stand still."""
    return Scene(STILL)


def shifting_weight() -> Scene:
    """Stand, and shift the weight from side to side and back, no foot below a tenth."""

    part = [(each / 50.0, 0.15 * np.sin(2.0 * np.pi * each / 150.0)) for each in range(401)]
    left, right = (tuple((at, 0.25 + sign * more) for at, more in part) for sign in (1.0, -1.0))
    return Scene(STILL, loads=(left, right) * 2)


def crouching() -> Scene:
    """Stand, crouch with all the weight on the feet, and rise again."""
    height = ((2.0, 0.45), (3.0, 0.2), (5.0, 0.2), (6.0, 0.45))
    return Scene(RISING, height=height)


def sitting_down() -> Scene:
    """Stand, then sit down slowly: the belly takes most of the weight from the feet."""
    height = ((3.0, 0.45), (5.0, 0.14))
    load = ((4.5, 0.25), (5.2, 0.05))
    return Scene(RISING.but(impulse_over_weight=None), height=height, loads=(load,) * 4)


def sitting() -> Scene:
    """Sit on the belly, no foot loaded."""
    truth = RISING.but(contact_fraction=None, static_margin_m=None, impulse_over_weight=None)
    return Scene(replace(truth, gait_class=None), height=((0.0, 0.14),), loads=(NONE,) * 4)


def standing_up() -> Scene:
    """Lie on the belly, then stand up."""
    height = ((3.0, 0.14), (5.0, 0.45))
    load = ((2.8, 0.05), (3.5, 0.25))
    return Scene(RISING.but(impulse_over_weight=None), height=height, loads=(load,) * 4)


def carried() -> Scene:
    """Stand, be lifted, carried by 2 m, and put down."""
    height = ((2.0, 0.45), (3.0, 1.0), (5.0, 1.0), (6.0, 0.45))
    forward = ((3.0, 0.0), (5.0, 2.0))
    load = ((1.98, 0.25), (2.02, 0.0), (5.98, 0.0), (6.02, 0.25))
    truth = RISING.but(
        path_length_m=2.0,
        forward_speed_mps=0.25,
        impulse_over_weight=None,
        static_margin_m=None,
    )
    lands, leaves = ((6.0,),) * 4, ((2.0,),) * 4
    truth = replace(truth, gait_class=None, touchdown_s=lands, lift_off_s=leaves)
    # While it stands again, its feet are where it was put down.
    return Scene(truth, height=height, forward=forward, loads=(load,) * 4, rolls=True)


def falling() -> Scene:
    """Stand, then fall over to the side within half a second and lie."""
    height = ((4.0, 0.45), (4.5, 0.1))
    roll = ((4.0, 0.0), (4.5, 1.4))
    sides = ((4.0, 0.25), (4.5, 0.08)), ((4.0, 0.25), (4.4, 0.0))
    truth = replace(RISING.but(impulse_over_weight=None, static_margin_m=None), falls_s=(4.0,))
    return Scene(truth, height=height, roll=roll, loads=(sides[1], sides[0]) * 2)


def tipping() -> Scene:
    """Stand, then tip over a side; the recording ends on the way down."""
    roll = ((7.0, 0.0), (8.0, 0.35))
    left, right = ((7.0, 0.25), (7.8, 0.0)), ((7.0, 0.25), (7.8, 0.5))
    return Scene(MOVING.but(static_margin_m=None), roll=roll, loads=(left, right) * 2)


def rolling() -> Scene:
    """Drive on wheels, all of them loaded."""
    truth = STILL.but(forward_speed_mps=0.5, path_length_m=4.0)
    return Scene(replace(truth, gait_class=None), forward=((0.0, 0.0), (8.0, 4.0)), rolls=True)


@dataclass(frozen=True, slots=True)
class OneAfterAnother:
    """Walks and scenes, one after another."""

    parts: tuple[Scene | Walk, ...]
    segments: tuple[str, ...] = ()

    def recorded(self, rate_hz: float) -> Recording:
        """Return the messages of perfect sensors."""
        recording = reduce(then, (each.recorded(rate_hz) for each in self.parts))
        truth = replace(recording.truth, segments=self.segments)
        return replace(recording, truth=truth)


def then(first: Recording, second: Recording) -> Recording:
    """Let a recording follow another of the same robot, from where the base is.

    Both must be undisturbed. What is true of the first's gait stays true of the whole, and of the
    second its events; a foot that is down in one and up in the other lands or leaves between them.
    """
    later = float(first.seconds + first.base.time[1] - first.base.time[0])
    moved = (first.base.position[-1] - second.base.position[0]) * [1.0, 1.0, 0.0]
    pairs = zip(first.feet, second.feet, strict=True)
    return replace(
        first,
        feet=tuple(_joined(*pair, later, moved) for pair in pairs),
        base=_joined(first.base, second.base, later, moved),
        truth=_joined_truth(first, second, later),
        seconds=later + second.seconds,
    )


_Columns = TypeVar("_Columns", FootRecording, BaseRecording)


def _joined(first: _Columns, second: _Columns, later: float, moved: Floats) -> _Columns:
    """Let messages follow others, later and elsewhere."""
    stamp = nanoseconds(second.time + later)
    changed = {
        "time": second.time + later,
        "stamp": stamp,
        "log_time": stamp + LOGGED_AFTER_NS,
        "point": getattr(second, "point", 0.0) + moved,
        "position": getattr(second, "position", 0.0) + moved,
    }
    columns = {
        name: np.concatenate([getattr(first, name), changed.get(name, getattr(second, name))])
        for name in (each.name for each in fields(first))
    }
    return replace(first, **columns)


_ANEW: Final = (
    "vertical_impulse_ns", "net_displacement_m", "undefined_fraction", "unknown_fraction",
    "energy_margin_m", "pressure_forward_m", "pressure_left_m", "height_m", "impulse_over_weight",
    "support", "flight_fraction", "froude", "climb_m",
)  # fmt: skip
"""Metrics that are those of neither part."""


def _joined_truth(first: Recording, second: Recording, later: float) -> Truth:
    truths, whole_s = (first.truth, second.truth), first.seconds + second.seconds
    lands, leaves = [], []
    for row, (one, other) in enumerate(zip(first.feet, second.feet, strict=True)):
        was, is_now = one.touching[-1], other.touching[0]
        landed = (0.0,) * bool(is_now and not was) + truths[1].touchdown_s[row]
        left = (0.0,) * bool(was and not is_now) + truths[1].lift_off_s[row]
        lands.append((*truths[0].touchdown_s[row], *(each + later for each in landed)))
        leaves.append((*truths[0].lift_off_s[row], *(each + later for each in left)))

    def added(name: str) -> Any:
        parts = zip(truths, (first.seconds, second.seconds), strict=True)
        return sum(np.multiply(truth.metrics[name], seconds) for truth, seconds in parts)

    ways = [truth.metrics["path_length_m"] for truth in truths]
    found = first.truth.but(
        **dict.fromkeys(_ANEW),
        path_length_m=sum(ways),
        contact_fraction=tuple(np.broadcast_to(added("contact_fraction"), 4) / whole_s),
        forward_speed_mps=float(added("forward_speed_mps") / (later + second.seconds)),
    )
    return replace(
        found,
        touchdown_s=tuple(lands),
        lift_off_s=tuple(leaves),
        falls_s=first.truth.falls_s + tuple(each + later for each in second.truth.falls_s),
        seams_s=(*first.truth.seams_s, later),
    )
