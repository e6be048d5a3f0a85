"""Logs of robots without foot sensors: joint states, an inertial unit and a robot description.

What robots do is a physics engine's (`free_walker`); a biped with six joints a leg is here.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import mujoco
import numpy as np

from tests.oracles.mcap_file import Entry, write_mcap
from tests.truth import free_walker, physics
from tests.truth.messages import IMU, JOINT_STATE, STRING
from tests.truth.physics import ORIGIN_NS, Physics
from tests.truth.recording import Floats, inverse, turned

HEAVY_KG: Final = (1.2, 1.5, 0.45, 0.15)
"""Of the parts of a leg."""
GRAVITY: Final = 9.81
Change = Callable[[Floats, Floats, Floats], tuple[Floats, ...]]


@dataclass(frozen=True, slots=True)
class Walk:
    """What a robot did; (n, ...) rows each."""

    urdf: str
    mass_kg: float
    joints: tuple[str, ...]
    time: Floats
    position: Floats
    """(n, k) rad; also `velocity`, rad/s, and `torque`, N m."""
    velocity: Floats
    torque: Floats
    attitude: Floats
    """(n, 4) quaternion x, y, z, w of the base."""
    base_velocity: Floats
    """(n, 6) rad/s and m/s in the world."""
    force: Floats
    """(n, feet, 3) N on each foot, in the world."""

    @property
    def touching(self) -> Floats:
        """(feet,) share of time in contact, bounces of less than 60 ms filled."""
        down = self.force[:, :, 2] > 0.01 * self.mass_kg * GRAVITY
        rows = round(0.06 / float(self.time[1] - self.time[0]))
        for column in down.T:
            change = np.flatnonzero(np.diff(column.astype(int)))
            for begin, end in itertools.pairwise(change.tolist()):
                if not column[begin + 1] and end - begin < rows:
                    column[begin + 1 : end + 1] = True
        return np.asarray(down.mean(axis=0), np.float64)

    @property
    def speed_mps(self) -> float:
        """Along the base's own x axis, seen from above."""
        ahead = turned(self.attitude, np.tile([1.0, 0.0, 0.0], (len(self.time), 1)))[:, :2]
        ahead /= np.linalg.norm(ahead, axis=1)[:, None]
        return float((ahead * self.base_velocity[:, 3:5]).sum(axis=1).mean())


def quadruped(legs_kg: tuple[float, ...] = physics.LEGS_KG, **walk: Any) -> Walk:
    """Run a quadruped; see `free_walker.walker`."""
    steps = ((-9.0, walk.pop("command", (0.4, 0.0, 0.0))),)
    did: Physics = free_walker.walker(steps, 6.0, legs_kg=legs_kg, **walk)
    return Walk(
        physics.urdf(legs_kg, did.mass_kg - 4.0 * sum(legs_kg)),
        did.mass_kg,
        physics.JOINTS,
        did.time,
        did.position,
        did.velocity,
        did.torque,
        did.attitude,
        did.base_velocity,
        did.force,
    )


def write_log(
    path: Path,
    walk: Walk,
    *,
    change: Change | None = None,
    with_imu: bool = True,
    with_urdf: bool = True,
    imu_frame: str = "base_link",
    gyro: float = 1.0,
    every: int = 5,
) -> Path:
    """Write what a robot without foot sensors and odometry records.

    Args:
        path: of the log.
        walk: what it did.
        change: takes and returns position, velocity and effort.
        with_imu: whether there is an inertial unit.
        with_urdf: whether there is a robot description.
        imu_frame: that of the base, or one that is turned by 90 degrees about its x axis.
        gyro: what a gyroscope reads for a turn rate of 1 rad/s.
        every: rows between messages.
    """
    make, rows = physics.messages(), slice(0, None, every)
    states = walk.position, walk.velocity, walk.torque
    time = ORIGIN_NS + np.rint(walk.time[rows] * 1e9).astype(np.int64)
    entries: list[Entry] = []
    if with_urdf:
        entries.append((ORIGIN_NS, "/robot_description", STRING, make.text(walk.urdf)))
    told = np.concatenate(
        [np.asarray(each)[rows] for each in (change(*states) if change else states)], axis=1
    )
    joints = make.joint_states(walk.joints).all_filled(time, told)
    entries += [
        (at, "/joint_states", JOINT_STATE, data)
        for at, data in zip(time.tolist(), joints, strict=True)
    ]
    if with_imu:
        back = inverse(walk.attitude)
        moved = np.gradient(walk.base_velocity[:, 3:], walk.time, axis=0)
        moved[:, 2] += GRAVITY
        read = [turned(back, moved), gyro * turned(back, walk.base_velocity[:, :3])]
        if imu_frame != "base_link":
            read = [each[:, [0, 2, 1]] * [1.0, 1.0, -1.0] for each in read]
        numbers = np.concatenate(read, axis=1)[rows]
        sent = make.imu(imu_frame, turns=True).all_filled(time, numbers)
        entries += [(at, "/imu", IMU, data) for at, data in zip(time.tolist(), sent, strict=True)]
    entries.sort(key=lambda entry: entry[0])
    return write_mcap(path, entries, make.definition, 1 << 18, "zstd")


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


@cache
def biped() -> Walk:
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
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.001" integrator="implicitfast"/><worldbody>'
        '<geom name="floor" type="plane" size="50 50 1" friction="1 .01 .001"/>'
        f'<body name="pelvis" pos="0 0 {STANDING_M + 0.01}">'
        '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>'
        '<geom type="box" size=".1 .1 .2" pos="0 0 .2" mass="30" contype="0" conaffinity="0"/>'
        f"{''.join(legs)}</body></worldbody><actuator>{motors}</actuator></mujoco>"
    )
    data = mujoco.MjData(model)
    feet = [model.geom(f"{side}_foot").id for side in ("left", "right")]
    data.qpos[2:] = _leg_angles(0.0, 1.0) + _leg_angles(0.0, -1.0)
    rows, local = [], np.zeros(6)
    for step in range(8000):
        time = step * 0.001
        data.ctrl[:] = _leg_angles(time, 1.0) + _leg_angles(time, -1.0)
        state = data.qpos[2:].copy(), data.qvel[2:].copy()
        mujoco.mj_step(model, data)
        force = np.zeros((2, 3))
        for number, pair in enumerate(data.contact.geom.tolist()):
            mujoco.mj_contactForce(model, data, number, local)
            foot = next(row for row, geom in enumerate(feet) if geom in pair)
            away = 1.0 if pair[1] in feet else -1.0
            force[foot] += away * data.contact.frame[number].reshape(3, 3).T @ local[:3]
        if step >= 2000 and step % 2 == 0:
            moving = np.array([0.0, 0.0, 0.0, data.qvel[0], 0.0, data.qvel[1]])
            rows.append((time - 2.0, *state, data.actuator_force.copy(), moving, force))
    columns = [np.array(each) for each in zip(*rows, strict=True)]
    seconds, position, velocity, torque, moving, force = columns
    return Walk(
        f'<robot name="biped">{"".join(links)}{"".join(joints)}</robot>',
        float(model.body_subtreemass[0]),
        tuple(names),
        seconds,
        position,
        velocity,
        torque,
        np.tile([0.0, 0.0, 0.0, 1.0], (len(seconds), 1)),
        moving,
        force,
    )
