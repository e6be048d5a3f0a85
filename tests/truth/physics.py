"""A quadruped that trots in a physics engine (MuJoCo): what its sensors log, and the truth.

The trunk slides forward on a rail and is free to go up and down; twelve position-controlled motors
follow a planned trot by inverse kinematics. Motion, contact forces and torques are the engine's.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any, Final

import mujoco
import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

from tests.truth.messages import CONTACTS, ODOMETRY, TF, WRENCH, Messages, Template
from tests.truth.recording import Floats

STEP_S: Final = 0.001
SETTLE_S: Final = 0.5
DURATION_S: Final = 3.5
EVERY: Final = 2
"""Steps between messages."""
FEET: Final = ("FL", "FR", "RL", "RR")
NAMES: Final = ("front_left", "front_right", "back_left", "back_right")
JOINTS: Final = tuple(f"{foot}_{part}_joint" for foot in FEET for part in ("hip", "thigh", "calf"))
HALF_LENGTH, HALF_WIDTH, OFFSET, LINK, BALL = 0.18, 0.05, 0.08, 0.2, 0.02
HEIGHT_M: Final = 0.30
SPEED_MPS, PERIOD_S, DUTY, LIFT_M = 0.4, 0.5, 0.6, 0.05
SINK_M: Final = 0.01
"""The plan treads below the ground, so that feet meet it on their way down."""
PHASES: Final = {"FL": 0.0, "RR": 0.0, "FR": 0.5, "RL": 0.5}
JOINT_STATE: Final = "sensor_msgs/msg/JointState"
STRING: Final = "std_msgs/msg/String"
ORIGIN_NS: Final = 50_000_000_000


def _corner(foot: str) -> tuple[float, float]:
    return (1.0 if foot[0] == "F" else -1.0, 1.0 if foot[1] == "L" else -1.0)


def _model_xml() -> str:
    legs, motors = [], []
    for foot in FEET:
        end, side = _corner(foot)
        legs.append(
            f'<body name="{foot}_hip" pos="{end * HALF_LENGTH} {side * HALF_WIDTH} 0">'
            f'<joint name="{foot}_hip_joint" axis="1 0 0" armature=".01"/>'
            f'<geom type="sphere" size=".03" mass=".5" contype="0" conaffinity="0"/>'
            f'<body name="{foot}_thigh" pos="0 {side * OFFSET} 0">'
            f'<joint name="{foot}_thigh_joint" axis="0 1 0" armature=".01"/>'
            f'<geom type="capsule" fromto="0 0 0 0 0 {-LINK}" size=".015" mass=".6" contype="0" '
            f'conaffinity="0"/><body name="{foot}_calf" pos="0 0 {-LINK}">'
            f'<joint name="{foot}_calf_joint" axis="0 1 0" armature=".01"/>'
            f'<geom type="capsule" fromto="0 0 0 0 0 {-LINK}" size=".01" mass=".15" contype="0" '
            f'conaffinity="0"/><geom name="{foot}" type="sphere" size="{BALL}" '
            f'pos="0 0 {-LINK}" mass=".05" friction="1 .01 .001" solref=".004 1"/>'
            f'<site name="{foot}" pos="0 0 {-LINK}"/></body></body></body>'
        )
    motors = [f'<position name="{joint}" joint="{joint}" kp="400" kv="6"/>' for joint in JOINTS]
    return (
        f'<mujoco><option timestep="{STEP_S}" integrator="Euler"/>'
        '<worldbody><geom name="floor" type="plane" size="50 50 1" friction="1 .01 .001"/>'
        f'<body name="trunk" pos="0 0 {HEIGHT_M}"><joint name="along" type="slide" axis="1 0 0"/>'
        '<joint name="up" type="slide" axis="0 0 1"/>'
        '<geom type="box" size=".2 .06 .05" mass="8" contype="0" conaffinity="0"/>'
        f"{''.join(legs)}</body></worldbody><actuator>"
        f'<position joint="along" kp="20000" kv="2000"/>{"".join(motors)}</actuator></mujoco>'
    )


def _planned(time_s: float) -> list[float]:
    """Return the planned angles of all joints: each foot where the plan has it."""
    angles: list[float] = []
    for foot in FEET:
        end, _ = _corner(foot)
        cycle = time_s / PERIOD_S - PHASES[foot]
        stride = np.floor(cycle)
        share = cycle - stride
        middle = (stride + PHASES[foot] + DUTY / 2.0) * PERIOD_S
        along, above = end * HALF_LENGTH + SPEED_MPS * middle, BALL
        if share > DUTY:
            part = (share - DUTY) / (1.0 - DUTY)
            along += SPEED_MPS * PERIOD_S * part**3 * (10.0 - 15.0 * part + 6.0 * part**2)
            above += LIFT_M * 4.0 * part * (1.0 - part) - SINK_M * part**2
        else:
            above -= SINK_M * max(0.0, 1.0 - share / (0.5 * DUTY))
        x, z = along - end * HALF_LENGTH - SPEED_MPS * time_s, above - HEIGHT_M
        reach = float(np.hypot(x, z))
        knee = float(np.arccos(np.clip((reach / LINK) ** 2 / 2.0 - 1.0, -1.0, 1.0)))
        thigh = float(np.arctan2(-x, -z)) + knee / 2.0
        angles += [0.0, thigh, -knee]
    return angles


@dataclass(frozen=True, slots=True)
class Physics:
    """What the engine did, a row a step of the physics; (n, ...) each."""

    mass_kg: float
    time: Floats
    """s since the log's start."""
    base: Floats
    """(n, 3) m."""
    position: Floats
    """(n, 12) rad; also `velocity`, rad/s, and `torque`, N m."""
    velocity: Floats
    torque: Floats
    foot: Floats
    """(n, 4, 3) m, the middles of the balls; also `foot_velocity`, m/s."""
    foot_velocity: Floats
    calf: Floats
    """(n, 4, 7) the frames of the calves in the base: m, and quaternion x, y, z, w."""
    force: Floats
    """(n, 4, 3) N on each foot, in the world."""
    point: Floats
    """(n, 4, 3) m, where it touches the ground; NaN in the air."""


@cache
def trot() -> Physics:
    """Run the engine."""
    model = mujoco.MjModel.from_xml_string(_model_xml())
    data = mujoco.MjData(model)
    data.qpos[2:] = _planned(0.0)
    sites = [model.site(foot).id for foot in FEET]
    calves = [model.body(f"{foot}_calf").id for foot in FEET]
    balls = {model.geom(foot).id: row for row, foot in enumerate(FEET)}
    rows: list[tuple[Any, ...]] = []
    for step in range(round((SETTLE_S + DURATION_S) / STEP_S)):
        time = step * STEP_S
        data.ctrl[0] = SPEED_MPS * time
        data.ctrl[1:] = _planned(time)
        state = data.qpos.copy(), data.qvel.copy()
        mujoco.mj_step(model, data)
        # What the engine derives, forces too, is of the state before the step.
        if step >= round(SETTLE_S / STEP_S):
            rows.append(_row(model, data, state, (sites, calves, balls)))
    columns = [np.array(column, np.float64) for column in zip(*rows, strict=True)]
    times: Floats = np.arange(len(rows), dtype=np.float64) * STEP_S
    return Physics(float(model.body_subtreemass[0]), times, *columns)


def _row(
    model: Any,
    data: Any,
    state: tuple[Floats, Floats],
    numbers: tuple[list[int], list[int], dict[int, int]],
) -> tuple[Any, ...]:
    position, velocity = state
    sites, calves, balls = numbers
    base = np.array([position[0], 0.0, HEIGHT_M + position[1]])
    moving = np.zeros((len(FEET), 6))
    for row, site in enumerate(sites):
        mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, site, moving[row], 0)
    force, point = np.zeros((len(FEET), 3)), np.full((len(FEET), 3), np.nan)
    for number in range(data.ncon):
        contact, local = data.contact[number], np.zeros(6)
        foot = next(balls[geom] for geom in (contact.geom1, contact.geom2) if geom in balls)
        mujoco.mj_contactForce(model, data, number, local)
        away = 1.0 if contact.geom2 in balls else -1.0
        force[foot] += away * contact.frame.reshape(3, 3).T @ local[:3]
        point[foot] = contact.pos
    w, x, y, z = data.xquat[calves].T
    calf = np.column_stack([data.xpos[calves] - base, x, y, z, w])
    return (
        base,
        position[2:],
        velocity[2:],
        data.actuator_force[1:].copy(),
        data.site_xpos[sites].copy(),
        moving[:, 3:].copy(),
        calf,
        force,
        point,
    )


def urdf() -> str:
    """Return the robot description of the model."""
    parts = []
    for foot in FEET:
        end, side = _corner(foot)
        limit = '<limit lower="-3" upper="3" effort="40" velocity="30"/>'
        chain = (
            ("hip", "base_link", f"{foot}_hip", (end * HALF_LENGTH, side * HALF_WIDTH, 0), "1 0 0"),
            ("thigh", f"{foot}_hip", f"{foot}_thigh", (0, side * OFFSET, 0), "0 1 0"),
            ("calf", f"{foot}_thigh", f"{foot}_calf", (0, 0, -LINK), "0 1 0"),
        )
        for part, parent, child, xyz, axis in chain:
            parts.append(
                f'<joint name="{foot}_{part}_joint" type="revolute"><parent link="{parent}"/>'
                f'<child link="{child}"/><origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}"/>'
                f'<axis xyz="{axis}"/>{limit}</joint>'
            )
        parts.append(
            f'<joint name="{foot}_foot_fixed" type="fixed"><parent link="{foot}_calf"/>'
            f'<child link="{foot}_foot"/><origin xyz="0 0 {-LINK}"/></joint>'
        )
    links = ["base_link", *(f"{f}_{p}" for f, p in product(FEET, ("hip", "thigh", "calf", "foot")))]
    named = "".join(f'<link name="{name}"/>' for name in links)
    return f'<robot name="physics">{named}{"".join(parts)}</robot>'


class _Messages(Messages):
    def joint_states(self, names: tuple[str, ...]) -> Template:
        """Fill with positions, velocities and efforts: 3 numbers a joint."""
        blank = (np.arange(3 * len(names)) + 1.0) * 1.0e200
        position, velocity, effort = np.split(blank, 3)
        message = self._make(
            JOINT_STATE,
            header=self._header(""),
            name=list(names),
            position=position,
            velocity=velocity,
            effort=effort,
        )
        return self._template(JOINT_STATE, message, len(blank))

    def description(self) -> bytes:
        return bytes(self.store.serialize_cdr(self._make(STRING, data=urdf()), STRING))


def write_log(
    path: Path,
    *,
    by_transforms: bool,
    publishers: int = 1,
    silence_s: tuple[float, float] = (9.0, 9.0),
    change: Any = None,
    drift: float = 0.0,
) -> Path:
    """Write the trot as an MCAP of ROS 2 messages.

    Args:
        path: of the log.
        by_transforms: legs by transforms, feet by contacts with points; else legs by joint states
            with a robot description, feet by force sensors.
        publishers: topics that the joints are shared out on.
        silence_s: time in which no joint states are sent.
        change: takes and returns position, velocity and effort, (n, 12) each.
        drift: metres by which the odometry goes astray, to the left, a metre of the way.
    """
    physics, make = trot(), _Messages(2)
    rows = range(0, len(physics.time), EVERY)
    states = (physics.position, physics.velocity, physics.torque)
    told = [np.asarray(each) for each in (change(*states) if change else states)]
    entries: list[tuple[int, str, str, bytes]] = []
    odometry = make.odometry("world", "base_link")
    shares = np.array_split(np.arange(len(JOINTS)), publishers)
    joints = [make.joint_states(tuple(JOINTS[j] for j in share)) for share in shares]
    calves = make.transforms("base_link", [f"{foot}_calf" for foot in FEET])
    wrench = [make.wrench_stamped(f"{foot}_foot") for foot in FEET]
    none = [make.no_contact(f"{foot}_calf") for foot in FEET]
    bump = [make.contact(f"{foot}_calf", f"robot::{foot}_calf::{foot}_collision") for foot in FEET]
    if not by_transforms:
        entries.append((ORIGIN_NS, "/robot_description", STRING, make.description()))
    for row in rows:
        time = ORIGIN_NS + round(physics.time[row] * 1e9)
        x, y, z = physics.base[row].tolist()
        pose = (x, y + drift * x, z, 0.0, 0.0, 0.0, 1.0, SPEED_MPS, 0.0, 0.0)
        entries.append((time, "/odom", ODOMETRY, odometry.filled(time, pose)))
        for number, share in enumerate(shares):
            numbers = np.concatenate([each[row, share] for each in told])
            topic = f"/joint_states_{number}" if number else "/joint_states"
            if not silence_s[0] <= physics.time[row] < silence_s[1]:
                data = joints[number].filled(time, numbers.tolist())
                entries.append((time, topic, JOINT_STATE, data))
        if by_transforms:
            data = calves.filled(time, physics.calf[row].ravel().tolist())
            entries.append((time, "/tf", TF, data))
        for foot in range(len(FEET)):
            force, point = physics.force[row, foot], physics.point[row, foot]
            if not by_transforms:
                size = (0.0, 0.0, float(np.linalg.norm(force)))
                data, kind = wrench[foot].filled(time, size), WRENCH
            elif np.isnan(point).any():
                data, kind = none[foot].filled(time, ()), CONTACTS
            else:
                numbers = np.concatenate([force, force, point, (0.0, 0.0, 1.0)])
                data, kind = bump[foot].filled(time, numbers.tolist()), CONTACTS
            entries.append((time, f"/{NAMES[foot]}_foot_contact", kind, data))
    _write(path, make, entries)
    return path


def _write(path: Path, make: Messages, entries: list[tuple[int, str, str, bytes]]) -> None:
    with path.open("wb") as stream:
        writer = McapWriter(stream, 1 << 18, CompressionType.ZSTD)
        writer.start(profile="ros2")
        channels: dict[str, int] = {}
        for time, topic, kind, data in entries:
            if topic not in channels:
                schema = writer.register_schema(kind, "ros2msg", make.definition(kind).encode())
                channels[topic] = writer.register_channel(topic, "cdr", schema)
            writer.add_message(channels[topic], time, data, time)
        writer.finish()
