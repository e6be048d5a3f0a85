"""Logs of robots without foot sensors: joint states, an inertial unit and a robot description.

What robots do is a physics engine's (`free_walker`); a biped with six joints a leg is here.
"""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from tests.truth import free_walker, physics
from tests.truth.physics import Engine, Physics
from tests.truth.recording import inverse, turned
from tests.truth.robots import GRAVITY_MPS2

HEAVY_KG: Final = (1.2, 1.5, 0.45, 0.15)
"""Of the parts of a leg."""


def quadruped(legs_kg: tuple[float, ...] = physics.LEGS_KG, **walk: Any) -> Physics:
    """Run a quadruped; see `free_walker.walker`."""
    steps = ((-9.0, walk.pop("command", (0.4, 0.0, 0.0))),)
    did: Physics = free_walker.walker(steps, 6.0, legs_kg=legs_kg, **walk)
    return replace(did, urdf=physics.urdf(legs_kg, did.mass_kg - 4.0 * sum(legs_kg)))


def resized(walk: Physics, size: float) -> Physics:
    """Return what a robot of the same kind does whose lengths are so many times as large."""
    pace = float(np.sqrt(size))

    def lengths(match: re.Match[str]) -> str:
        return match[1] + " ".join(f"{float(each) * size:.9g}" for each in match[2].split()) + '"'

    return replace(
        walk,
        mass_kg=walk.mass_kg * size**3,
        time=walk.time * pace,
        base=walk.base * size,
        base_velocity=walk.base_velocity * np.repeat([1.0 / pace, pace], 3),
        velocity=walk.velocity / pace,
        torque=walk.torque * size**4,
        foot=walk.foot * size,
        foot_velocity=walk.foot_velocity * pace,
        calf=walk.calf * np.repeat([size, 1.0], (3, 4)),
        force=walk.force * size**3,
        point=walk.point * size,
        urdf=re.sub(
            r'(<mass value=")([^"]*)"',
            lambda match: f'{match[1]}{float(match[2]) * size**3:.9g}"',
            re.sub(r'(<origin xyz="|radius=")([^"]*)"', lengths, walk.urdf),
        ),
    )


def write_log(
    path: Path,
    walk: Physics,
    *,
    with_imu: bool = True,
    with_urdf: bool = True,
    imu_frame: str = "base_link",
    gyro: float = 1.0,
    every: int = 5,
    change: Any = None,
) -> Path:
    """Write what a robot without foot sensors and odometry records.

    Args:
        path: of the log.
        walk: what it did.
        with_imu: whether there is an inertial unit.
        with_urdf: whether there is a robot description.
        imu_frame: that of the base, or one that is turned by 90 degrees about its x axis.
        gyro: what a gyroscope reads for a turn rate of 1 rad/s.
        every: rows of the walk, 500 a second, between messages.
        change: takes and returns position, velocity and effort.
    """
    back = inverse(walk.attitude)
    moved = np.gradient(walk.base_velocity[:, 3:], walk.time, axis=0)
    moved[:, 2] += GRAVITY_MPS2
    read = [turned(back, moved), gyro * turned(back, walk.base_velocity[:, :3])]
    if imu_frame != "base_link":
        read = [each[:, [0, 2, 1]] * [1.0, 1.0, -1.0] for each in read]
    return physics.write_log(
        path,
        walk,
        by_transforms=False,
        every=every,
        described=with_urdf,
        with_feet=False,
        with_poses=False,
        imu=(imu_frame, np.concatenate(read, axis=1)) if with_imu else None,
        change=change,
    )


THIGH, SHANK, SOLE, HIP_M = 0.4, 0.4, 0.06, 0.1
LEG_KG: Final = {"hip": 1.0, "roll": 0.5, "thigh": 3.0, "shank": 2.0, "ankle": 0.3, "foot": 0.7}
AXES: Final = {"hip": "z", "roll": "x", "thigh": "y", "shank": "y", "ankle": "y", "foot": "x"}
"""Parts of a leg, and the axis of the joint before each."""
BELOW: Final = {"thigh": 0.0, "shank": -THIGH, "ankle": -SHANK}
PERIOD_S, DUTY, STEP_MPS, STANDING_M = 0.8, 0.62, 0.5, 0.84
_VECTORS: Final = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}


def _leg_angles(time: float, side: float) -> list[float]:
    """Return the angles of a leg: its foot stays level where the plan has it."""
    share = (time / PERIOD_S + (0.0 if side > 0.0 else 0.5)) % 1.0
    half = STEP_MPS * DUTY * PERIOD_S / 2.0
    if share < DUTY:
        x, lift = half * (1.0 - 2.0 * share / DUTY), 0.0
    else:
        part = (share - DUTY) / (1.0 - DUTY)
        smooth = part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
        x, lift = half * (2.0 * smooth - 1.0), 0.06 * 4.0 * part * (1.0 - part)
    reach = float(np.hypot(x, STANDING_M - SOLE - lift))
    bend = float(np.arccos(np.clip(1.0 - reach**2 / (2.0 * THIGH**2), -1.0, 1.0)))
    knee = np.pi - bend
    thigh = -float(np.arctan2(x, STANDING_M - SOLE - lift)) - knee / 2.0
    return [0.0, 0.0, thigh, knee, -(thigh + knee), 0.0]


def _angles(time: float) -> list[float]:
    return _leg_angles(time, 1.0) + _leg_angles(time, -1.0)


@cache
def biped() -> Physics:
    """Run a biped with six joints a leg and flat feet, whose trunk is kept upright."""
    names = [f"{side}_{part}" for side in ("left", "right") for part in LEG_KG]
    legs, joints = [], []
    links = ['<link name="pelvis"><inertial><mass value="30"/></inertial></link>']
    for side, sign in (("left", 1.0), ("right", -1.0)):
        bodies, parent = "", "pelvis"
        for part, mass in LEG_KG.items():
            name = f"{side}_{part}"
            at = f"0 {sign * HIP_M if part == 'hip' else 0} {BELOW.get(part, 0)}"
            centre = f"0 0 {-SOLE if part == 'foot' else -THIGH / 2 if part in BELOW else 0}"
            size = "0.1 0.04 0.01" if part == "foot" else "0.02 0.02 0.02"
            touches = "" if part == "foot" else 'contype="0" conaffinity="0"'
            axis = _VECTORS[AXES[part]]
            bodies += (
                f'<body name="{name}" pos="{at}"><joint name="{name}" axis="{axis}" '
                f'armature=".02"/><geom name="{name}" type="box" size="{size}" pos="{centre}" '
                f'mass="{mass}" friction="1 .01 .001" {touches}/>'
            )
            links.append(
                f'<link name="{name}"><inertial><origin xyz="{centre}"/><mass value="{mass}"/>'
                "</inertial></link>"
            )
            joints.append(
                f'<joint name="{name}" type="revolute"><parent link="{parent}"/>'
                f'<child link="{name}"/><origin xyz="{at}"/><axis xyz="{axis}"/>'
                '<limit lower="-3" upper="3" effort="300" velocity="20"/></joint>'
            )
            parent = name
        joints.append(
            f'<joint name="{side}_sole_joint" type="fixed"><parent link="{parent}"/>'
            f'<child link="{side}_sole"/><origin xyz="0 0 {-SOLE - 0.01}"/></joint>'
        )
        links.append(f'<link name="{side}_sole"/>')
        legs.append(bodies + "</body>" * len(LEG_KG))
    motors = "".join(f'<position joint="{name}" kp="1500" kv="40"/>' for name in names)
    xml = (
        '<mujoco><option timestep="0.001" integrator="implicitfast"/><worldbody>'
        '<geom name="floor" type="plane" size="50 50 1" friction="1 .01 .001"/>'
        f'<body name="pelvis" pos="0 0 {STANDING_M + 0.01}">'
        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        '<geom type="box" size=".1 .1 .2" pos="0 0 .2" mass="30" contype="0" conaffinity="0"/>'
        f"{''.join(legs)}</body></worldbody><actuator>{motors}</actuator></mujoco>"
    )
    engine = Engine(xml, _angles(0.0), tuple(names), ("left_foot", "right_foot"), "{}")
    for step in range(8000):
        engine.step(_angles(step * 0.001), keep=step >= 2000 and step % 2 == 0)
    description = f'<robot name="biped">{"".join(links)}{"".join(joints)}</robot>'
    return replace(engine.finish(0.002), urdf=description)
