"""Robots in a physics engine that their own legs drive, as a velocity command asks.

The trunk slides freely; it is kept from leaning, unless only its feet shall do that. A quadruped's
turns about its vertical, too, and a controller plans its gait: feet in stance sweep back under the
body at the commanded velocity, feet in swing go where the next stance shall begin. How fast the
body really moves is left to motors, friction and inertia. On a slope all is worked out along the
ground and turned into the world in the end. A biped walks straight ahead on flat feet, with six
joints a leg.
"""

from dataclasses import replace
from functools import cache
from typing import Any, Final

import numpy as np

from tests.truth.geometry import Floats, about_axis, product, turned
from tests.truth.parts import Part, model_xml
from tests.truth.physics import FEET, STEP_S, Physics, simulate

PERIOD_S, LIFT_M, HEIGHT_M = 0.5, 0.05, 0.30
HALF_LENGTH, HALF_WIDTH, OFFSET, LINK, BALL = 0.18, 0.05, 0.08, 0.2, 0.02
LEGS_KG: Final = (0.5, 0.6, 0.15, 0.05)
"""Hip, thigh, calf and ball of each leg."""
HEAVY_KG: Final = (1.2, 1.5, 0.45, 0.15)
SIDES: Final = np.array([(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)])
"""(4, 2) whether legs are at the front or the back, left or right: 1 or -1."""
_CORNERS: Final = SIDES * (HALF_LENGTH, HALF_WIDTH + OFFSET)
"""(4, 2) m, where feet stand below the body."""
GAITS: Final = {
    "trot": (np.array([0.0, 0.5, 0.5, 0.0]), 0.6, 0.01),
    "walk": (np.array([0.0, 0.5, 0.75, 0.25]), 0.75, 0.004),
    "stand": (np.zeros(4), 1.0, 0.0),
}
"""Phases of the feet, duty factor, and how far below the ground feet are to tread, m."""
PUSH_S: Final = (1.3, 0.15)
"""s from push to push, and of each."""
_PUSHES: Final = np.array([(0.0, -1.0, 0.0), (1.0, 0.0, 0.0)])


def parts(legs_kg: tuple[float, ...] = LEGS_KG) -> tuple[Part, ...]:
    """Return the links of the quadruped."""
    found = [Part("base_link", kg=8.0, shape="box", size=(0.2, 0.06, 0.05))]
    for foot, (end, side) in zip(FEET, SIDES.tolist(), strict=True):
        hip, thigh, calf, ball = (f"{foot}_{part}" for part in ("hip", "thigh", "calf", "foot"))
        shoulder, below = (end * HALF_LENGTH, side * HALF_WIDTH, 0.0), (0.0, 0.0, -LINK)
        beside, half = (0.0, side * OFFSET, 0.0), LINK / 2.0
        found += [
            Part(hip, "base_link", shoulder, "x", legs_kg[0], "sphere", (0.03,)),
            Part(thigh, hip, beside, "y", legs_kg[1], "capsule", (0.015, half), -half),
            Part(calf, thigh, below, "y", legs_kg[2], "capsule", (0.01, half), -half),
            Part(ball, calf, below, "", legs_kg[3], "sphere", (BALL,), touches=True),
        ]
    return tuple(found)


def trot(seconds: float = 3.5) -> Physics:
    """Trot straight ahead."""
    return quadruped(seconds=seconds)


@cache
def quadruped(
    command: tuple[float, float, float] = (0.4, 0.0, 0.0),
    seconds: float = 6.0,
    slope_rad: float = 0.0,
    gait: str = "trot",
    legs_kg: tuple[float, ...] = LEGS_KG,
    push_n: float = 0.0,
    *,
    leans: bool = False,
) -> Physics:
    """Run the engine.

    Args:
        command: m/s forward, m/s to the left, rad/s.
        seconds: of the log.
        slope_rad: by which the ground falls ahead.
        gait: one of `GAITS`.
        legs_kg: of the parts of each leg.
        push_n: for `PUSH_S[1]` every `PUSH_S[0]`, from the left and from behind in turn.
        leans: whether only its feet keep the trunk from leaning.
    """
    settle_s = 1.0
    steps = np.arange(-round(settle_s / STEP_S), round(seconds / STEP_S))
    time: Floats = np.asarray(steps * STEP_S, np.float64)
    turn, since = np.divmod(time, PUSH_S[0])
    push = push_n * (since < PUSH_S[1])[:, None] * _PUSHES[turn.astype(int) % 2]
    made = parts(legs_kg)
    free = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    kept = f'{free}<joint type="hinge" axis="0 0 1"/>'
    level = simulate(
        model_xml(made, "<freejoint/>" if leans else kept, HEIGHT_M, (400.0, 6.0)),
        made,
        _angles(_feet(time, np.array(command), *GAITS[gait])),
        [(f"{foot}_foot", f"{foot}_calf") for foot in FEET],
        settle_s,
        (9.81 * np.sin(slope_rad), 0.0, -9.81 * np.cos(slope_rad)),
        push,
    )
    return _tilted(level, slope_rad)


def _feet(time: Floats, command: Floats, phases: Floats, duty: float, sink_m: float) -> Floats:
    """(n, 4, 3) m, where the plan has each foot, from the base."""
    cycle = time[:, None] / PERIOD_S - phases
    share = cycle - np.floor(cycle)
    swings = share > duty
    part = np.where(swings, (share - duty) / max(1.0 - duty, 1e-9), 0.0)
    smooth = part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
    place = np.empty((len(time), len(FEET), 3))
    across = np.array([(0.0, 1.0), (-1.0, 0.0)])
    target = _CORNERS + (command[:2] + command[2] * _CORNERS @ across) * duty * PERIOD_S / 2.0
    own, lifted = _CORNERS.copy(), _CORNERS.copy()
    for row, swing in enumerate(swings[:, :, None]):
        lifted = np.where(swing, lifted, own)
        swung = lifted + (target - lifted) * smooth[row, :, None]
        swept = own - (command[:2] + command[2] * own @ across) * STEP_S
        place[row, :, :2] = own = np.where(swing, swung, swept)
    lift = LIFT_M * 4.0 * part * (1.0 - part) - sink_m * part**2
    sunk = -sink_m * np.maximum(0.0, 1.0 - share / (0.5 * duty))
    place[:, :, 2] = BALL - HEIGHT_M + np.where(swings, lift, sunk)
    return place


def _angles(place: Floats) -> Floats:
    """(n, 12) rad, of all joints that have the feet there: hip, thigh and calf of each."""
    x = place[:, :, 0] - SIDES[:, 0] * HALF_LENGTH
    y = place[:, :, 1] - SIDES[:, 1] * HALF_WIDTH
    down = np.sqrt(y**2 + place[:, :, 2] ** 2 - OFFSET**2)
    hip = np.arctan2(place[:, :, 2], y) - np.arctan2(-down, SIDES[:, 1] * OFFSET)
    reach = np.hypot(x, down)
    knee = np.arccos(np.clip((reach / LINK) ** 2 / 2.0 - 1.0, -1.0, 1.0))
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

    vectors = ("base", "base_velocity", "foot", "foot_velocity", "force", "point")
    attitude = product(about_axis(1, np.full(len(level.time), slope_rad)), level.attitude)
    in_world: dict[str, Any] = {name: world(getattr(level, name)) for name in vectors}
    return replace(level, attitude=attitude, **in_world)


THIGH, SHANK, SOLE, HIP_M = 0.4, 0.4, 0.06, 0.1
BIPED_PERIOD_S, DUTY, SPEED_MPS, STANDING_M = 0.8, 0.62, 0.5, 0.84
_LEG: Final = (
    ("hip", "z", 1.0, 0.0),
    ("roll", "x", 0.5, 0.0),
    ("thigh", "y", 3.0, 0.0),
    ("shank", "y", 2.0, -THIGH),
    ("ankle", "y", 0.3, -SHANK),
    ("foot", "x", 0.7, 0.0),
)
"""Links of a leg, the axes of their joints, kg, and m over the link before."""


@cache
def biped() -> Physics:
    """Run a biped with six joints a leg and flat feet, whose trunk is kept upright."""
    made = [Part("pelvis", kg=30.0, shape="box", size=(0.1, 0.1, 0.2), centre_m=0.2)]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        parent = "pelvis"
        for name, axis, kg, above_m in _LEG:
            link, at = f"{side}_{name}", (0.0, sign * HIP_M * (name == "hip"), above_m)
            small, centre_m = (0.02, 0.02, 0.02), -THIGH / 2.0 if axis == "y" else 0.0
            made.append(Part(link, parent, at, axis, kg, "box", small, centre_m))
            parent = link
        sole = replace(made[-1], size=(0.1, 0.04, 0.01), centre_m=-SOLE, touches=True)
        made[-1] = sole
        made.append(Part(f"{side}_sole", parent, (0.0, 0.0, -SOLE - 0.01)))
    time = np.arange(0.0, 8.0, STEP_S, dtype=np.float64)
    angles = np.concatenate([_leg_angles(time), _leg_angles(time + BIPED_PERIOD_S / 2.0)], axis=1)
    free = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
    xml = model_xml(made, free, STANDING_M + 0.01, (1500.0, 40.0), "implicitfast")
    return simulate(xml, tuple(made), angles, [(f"{s}_foot",) * 2 for s in ("left", "right")], 2.0)


def _leg_angles(time: Floats) -> Floats:
    """(n, 6) rad, of a leg whose foot stays level where the plan has it."""
    share = time / BIPED_PERIOD_S % 1.0
    half = SPEED_MPS * DUTY * BIPED_PERIOD_S / 2.0
    part = np.clip((share - DUTY) / (1.0 - DUTY), 0.0, 1.0)
    smooth = part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
    x = half * np.where(share < DUTY, 1.0 - 2.0 * share / DUTY, 2.0 * smooth - 1.0)
    down = STANDING_M - SOLE - 0.24 * part * (1.0 - part)
    knee = np.pi - np.arccos(np.clip(1.0 - (x**2 + down**2) / (2.0 * THIGH**2), -1.0, 1.0))
    thigh = -np.arctan2(x, down) - knee / 2.0
    none = np.zeros_like(time)
    return np.stack([none, none, thigh, knee, -(thigh + knee), none], axis=1)
