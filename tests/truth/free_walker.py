"""A quadruped in a physics engine (MuJoCo) that its own legs drive, as a velocity command asks.

The trunk slides freely and turns about its vertical; it is kept from leaning. A controller plans a
trot for the command that it received some time ago: feet in stance sweep back under the body at the
commanded velocity, feet in swing go where the next stance shall begin. How fast the body really
moves is left to motors, friction and inertia. On a slope all is worked out along the ground and
turned into the world in the end.
"""

from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np

from tests.truth import physics
from tests.truth.physics import FEET, Commands, Physics
from tests.truth.recording import Floats, about_axis, product, turned

Steps = tuple[tuple[float, tuple[float, float, float]], ...]
"""s from which on each command holds, and m/s forward, m/s to the left, rad/s."""
COMMAND_S: Final = 0.02
"""s between commands."""
SETTLE_S: Final = 1.0
KEPT_S: Final = 0.002
"""s between rows that are kept."""
GAITS: Final = {
    "trot": (np.array([physics.PHASES[foot] for foot in FEET]), physics.DUTY, physics.SINK_M),
    "walk": (np.array([0.0, 0.5, 0.75, 0.25]), 0.75, 0.004),
    "stand": (np.zeros(4), 1.0, 0.0),
}
"""Phases of the feet, duty factor, and how far below the ground feet are to tread, m."""
PUSH_S: Final = (1.3, 0.15)
"""s from push to push, and of each."""
_SIDES: Final = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0)])
_CORNERS: Final = np.array(
    [
        (
            (1.0 if foot[0] == "F" else -1.0) * physics.HALF_LENGTH,
            (1.0 if foot[1] == "L" else -1.0) * (physics.HALF_WIDTH + physics.OFFSET),
        )
        for foot in FEET
    ]
)
"""(4, 2) m, where feet stand below the body."""


def sent(steps: Steps, seconds: float) -> Commands:
    """Return the commands that are published from the log's start on."""
    time: Floats = np.arange(round(seconds / COMMAND_S), dtype=np.float64) * COMMAND_S
    return Commands(time, _held(steps, time))


def _held(steps: Steps, time: Floats) -> Floats:
    """(n, 3) the command of the last step; zero before the first."""
    starts = np.array([start for start, _ in steps])
    values = np.array([(0.0, 0.0, 0.0), *(value for _, value in steps)])
    return np.asarray(values[np.searchsorted(starts, time + 1e-9, side="right")])


def trot(seconds: float = 3.5) -> Physics:
    """Trot straight ahead."""
    return walker(((-9.0, (0.4, 0.0, 0.0)),), seconds)


@cache
def walker(
    steps: Steps,
    seconds: float,
    latency_s: float = 0.0,
    slope_rad: float = 0.0,
    gait: str = "trot",
    legs_kg: tuple[float, ...] = physics.LEGS_KG,
    push_n: float = 0.0,
) -> Physics:
    """Run the engine.

    Args:
        steps: of the command.
        seconds: of the log.
        latency_s: s from a command's publication until the controller uses it.
        slope_rad: by which the ground falls ahead.
        gait: one of `GAITS`.
        legs_kg: of the parts of each leg.
        push_n: for `PUSH_S[1]` every `PUSH_S[0]`, from the left and from behind in turn.
    """
    steps_of = (round(each / physics.STEP_S) for each in (-SETTLE_S, seconds))
    time: Floats = np.arange(*steps_of, dtype=np.float64) * physics.STEP_S
    received = np.floor((time - latency_s) / COMMAND_S + 1e-6) * COMMAND_S
    angles = _angles(_feet(time, _held(steps, received), *GAITS[gait]))
    pull = 9.81 * np.array([np.sin(slope_rad), 0.0, -np.cos(slope_rad)])
    gravity = " ".join(map(str, pull.tolist()))
    engine = physics.Engine(physics.model_xml(gravity, legs_kg), angles[0])
    every = round(KEPT_S / physics.STEP_S)
    for row, targets in enumerate(angles):
        turn, since = divmod(time[row], PUSH_S[0])
        push = push_n * (since < PUSH_S[1]) * _SIDES[int(turn) % 2]
        engine.step(targets, keep=time[row] >= -1e-9 and row % every == 0, push_n=push)
    return _tilted(engine.finish(KEPT_S), slope_rad)


def _feet(time: Floats, wanted: Floats, phases: Floats, duty: float, sink_m: float) -> Floats:
    """(n, 4, 3) m, where the plan has each foot, from the base; wanted: (n, 3) velocity."""
    cycle = time[:, None] / physics.PERIOD_S - phases
    share = cycle - np.floor(cycle)
    swings = share > duty
    part = np.where(swings, (share - duty) / max(1.0 - duty, 1e-9), 0.0)
    smooth = part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
    stance_s = duty * physics.PERIOD_S
    place = np.empty((len(time), len(FEET), 3))
    own, lifted = _CORNERS.copy(), _CORNERS.copy()
    across = np.array([(0.0, 1.0), (-1.0, 0.0)])
    for row, (ahead, left, turn) in enumerate(wanted.tolist()):
        swing = swings[row, :, None]
        back = np.array((ahead, left)) + turn * own @ across
        lifted = np.where(swing, lifted, own)
        target = _CORNERS + (np.array((ahead, left)) + turn * _CORNERS @ across) * stance_s / 2.0
        own = np.where(
            swing,
            lifted + (target - lifted) * smooth[row, :, None],
            own - back * physics.STEP_S,
        )
        place[row, :, :2] = own
    lift = physics.LIFT_M * 4.0 * part * (1.0 - part) - sink_m * part**2
    sunk = -sink_m * np.maximum(0.0, 1.0 - share / (0.5 * duty))
    place[:, :, 2] = physics.BALL - physics.HEIGHT_M + np.where(swings, lift, sunk)
    return place


def _angles(place: Floats) -> Floats:
    """(n, 12) rad, of all joints that have the feet there: hip, thigh and calf of each."""
    side = np.sign(_CORNERS[:, 1])
    x = place[:, :, 0] - np.sign(_CORNERS[:, 0]) * physics.HALF_LENGTH
    y = place[:, :, 1] - side * physics.HALF_WIDTH
    down = np.sqrt(y**2 + place[:, :, 2] ** 2 - physics.OFFSET**2)
    hip = np.arctan2(place[:, :, 2], y) - np.arctan2(-down, side * physics.OFFSET)
    reach = np.hypot(x, down)
    knee = np.arccos(np.clip((reach / physics.LINK) ** 2 / 2.0 - 1.0, -1.0, 1.0))
    thigh = np.arctan2(-x, down) + knee / 2.0
    return np.stack([hip, thigh, -knee], axis=2).reshape(len(place), -1)


def _tilted(level: Physics, slope_rad: float) -> Physics:
    """Turn what happens along the ground into the world."""
    if slope_rad == 0.0:
        return level

    def world(vectors: Floats) -> Floats:
        flat = vectors.reshape(-1, 3)
        turn = about_axis(1, np.full(len(flat), slope_rad))
        return turned(turn, flat).reshape(vectors.shape)

    return replace(
        level,
        base=world(level.base),
        attitude=product(about_axis(1, np.full(len(level.time), slope_rad)), level.attitude),
        base_velocity=world(level.base_velocity.reshape(-1, 2, 3)).reshape(-1, 6),
        foot=world(level.foot),
        foot_velocity=world(level.foot_velocity),
        force=world(level.force),
        point=world(level.point),
    )
