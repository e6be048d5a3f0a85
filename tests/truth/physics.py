"""A quadruped in a physics engine (MuJoCo): its model, what its sensors log, and the truth.

Twelve position-controlled motors follow planned angles. Motion, contact forces and torques are the
engine's.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import mujoco
import numpy as np

import dogbot_logtool as dl
from tests.oracles.mcap_file import Entry, write_mcap
from tests.truth.messages import (
    CONTACTS,
    IMU,
    JOINT_STATE,
    ODOMETRY,
    STRING,
    TF,
    TWIST,
    WRENCH,
    ros_messages,
)
from tests.truth.recording import Floats, Ints, inverse, product, turned
from tests.truth.robots import GRAVITY_MPS2

STEP_S: Final = 0.001
FEET: Final = ("FL", "FR", "RL", "RR")
NAMES: Final = ("front_left", "front_right", "back_left", "back_right")
JOINTS: Final = tuple(f"{foot}_{part}_joint" for foot in FEET for part in ("hip", "thigh", "calf"))
HALF_LENGTH, HALF_WIDTH, OFFSET, LINK, BALL = 0.18, 0.05, 0.08, 0.2, 0.02
LEGS_KG: Final = (0.5, 0.6, 0.15, 0.05)
"""Hip, thigh, calf and ball of each leg."""
HEIGHT_M: Final = 0.30
PERIOD_S, DUTY, LIFT_M = 0.5, 0.6, 0.05
SINK_M: Final = 0.01
"""The plan treads below the ground, so that feet meet it on their way down."""
PHASES: Final = {"FL": 0.0, "RR": 0.0, "FR": 0.5, "RL": 0.5}
ORIGIN_NS: Final = 50_000_000_000
_TRUNK: Final = 1
"""Number of its body; 0 is the world."""


def _corner(foot: str) -> tuple[float, float]:
    return (1.0 if foot[0] == "F" else -1.0, 1.0 if foot[1] == "L" else -1.0)


_FREE: Final = (
    '<joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>'
    '<joint name="z" type="slide" axis="0 0 1"/><joint name="yaw" type="hinge" axis="0 0 1"/>'
)
"""How the trunk may move: it is kept from leaning."""


def model_xml(gravity: str, legs_kg: tuple[float, ...] = LEGS_KG) -> str:
    """Return the robot's model.

    Args:
        gravity: m/s^2.
        legs_kg: of the parts of each leg.
    """
    hip, thigh, calf, ball = legs_kg
    legs, motors = [], []
    for foot in FEET:
        end, side = _corner(foot)
        legs.append(
            f'<body name="{foot}_hip" pos="{end * HALF_LENGTH} {side * HALF_WIDTH} 0">'
            f'<joint name="{foot}_hip_joint" axis="1 0 0" armature=".01"/>'
            f'<geom type="sphere" size=".03" mass="{hip}" contype="0" conaffinity="0"/>'
            f'<body name="{foot}_thigh" pos="0 {side * OFFSET} 0">'
            f'<joint name="{foot}_thigh_joint" axis="0 1 0" armature=".01"/>'
            f'<geom type="capsule" fromto="0 0 0 0 0 {-LINK}" size=".015" mass="{thigh}" '
            f'contype="0" conaffinity="0"/><body name="{foot}_calf" pos="0 0 {-LINK}">'
            f'<joint name="{foot}_calf_joint" axis="0 1 0" armature=".01"/>'
            f'<geom type="capsule" fromto="0 0 0 0 0 {-LINK}" size=".01" mass="{calf}" contype="0" '
            f'conaffinity="0"/><geom name="{foot}" type="sphere" size="{BALL}" '
            f'pos="0 0 {-LINK}" mass="{ball}" friction="1 .01 .001" solref=".004 1"/>'
            "</body></body></body>"
        )
    motors = [f'<position name="{joint}" joint="{joint}" kp="400" kv="6"/>' for joint in JOINTS]
    return (
        f'<mujoco><option timestep="{STEP_S}" integrator="Euler" gravity="{gravity}"/>'
        '<worldbody><geom name="floor" type="plane" size="50 50 1" friction="1 .01 .001"/>'
        f'<body name="trunk" pos="0 0 {HEIGHT_M}">{_FREE}'
        '<geom type="box" size=".2 .06 .05" mass="8" contype="0" conaffinity="0"/>'
        f"{''.join(legs)}</body></worldbody><actuator>"
        f"{''.join(motors)}</actuator></mujoco>"
    )


@dataclass(frozen=True, slots=True)
class Physics:
    """What the engine did, a row a step that was kept; (n, ...) each."""

    mass_kg: float
    time: Floats
    """s since the log's start."""
    base: Floats
    """(n, 3) m."""
    attitude: Floats
    """(n, 4) quaternion x, y, z, w of the base."""
    base_velocity: Floats
    """(n, 6) rad/s and m/s in the world."""
    position: Floats
    """(n, joints) rad; also `velocity`, rad/s, and `torque`, N m."""
    velocity: Floats
    torque: Floats
    foot: Floats
    """(n, feet, 3) m, the middles of the balls; also `foot_velocity`, m/s."""
    foot_velocity: Floats
    calf: Floats
    """(n, feet, 7) the frames of the calves in the base: m, and quaternion x, y, z, w."""
    force: Floats
    """(n, feet, 3) N on each foot, in the world."""
    point: Floats
    """(n, feet, 3) m, where it touches the ground; NaN in the air."""
    joints: tuple[str, ...] = JOINTS
    urdf: str = ""
    """Robot description; empty: `urdf()`, without masses."""

    @property
    def touching(self) -> Floats:
        """(feet,) share of time in contact, bounces of less than 60 ms filled."""
        down = self.force[:, :, 2] > 0.01 * self.mass_kg * GRAVITY_MPS2
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


class Engine:
    """The model while it runs, and what it did so far."""

    def __init__(
        self,
        xml: str,
        angles: Floats | list[float],
        joints: tuple[str, ...] = JOINTS,
        feet: tuple[str, ...] = FEET,
        calves: str = "{}_calf",
    ) -> None:
        """Set up.

        Args:
            xml: of the model.
            angles: of all joints at the start.
            joints: their names.
            feet: names of the shapes that touch the ground.
            calves: what the bodies that hold these are called.
        """
        self._model = mujoco.MjModel.from_xml_string(xml)
        self._data = mujoco.MjData(self._model)
        self._joints = joints
        self._own = slice(-len(joints), None)
        self._data.qpos[self._own] = angles
        self._calves = [self._model.body(calves.format(foot)).id for foot in feet]
        self._feet = {self._model.geom(foot).id: row for row, foot in enumerate(feet)}
        self._rows: list[tuple[Any, ...]] = []

    def step(
        self, targets: Floats | list[float], *, keep: bool, push_n: Floats | float = 0.0
    ) -> None:
        """Advance by one step.

        Args:
            targets: of all motors.
            keep: whether to keep the state before the step.
            push_n: on the trunk, along the world's axes.
        """
        data = self._data
        data.xfrc_applied[_TRUNK, :3] = push_n
        data.ctrl[:] = targets
        state = data.qpos[self._own].copy(), data.qvel[self._own].copy()
        mujoco.mj_step(self._model, data)
        # What the engine derives, forces too, is of the state before the step.
        if keep:
            self._rows.append(self._row(*state))

    def finish(self, step_s: float) -> Physics:
        """Return what was kept; step_s: s between two rows."""
        columns = [np.array(column, np.float64) for column in zip(*self._rows, strict=True)]
        base, attitude, base_velocity, *joints, foot, foot_velocity = columns[:8]
        place, turn, force, point = columns[8:]
        times: Floats = np.arange(len(base), dtype=np.float64) * step_s
        # The engine's quaternions begin with w.
        attitude, turn = np.roll(attitude, -1, axis=-1), np.roll(turn, -1, axis=-1)
        back = np.repeat(inverse(attitude), len(self._feet), axis=0)
        away = (place - base[:, None]).reshape(-1, 3)
        calf = np.concatenate([turned(back, away), product(back, turn.reshape(-1, 4))], axis=1)
        position, velocity, torque = joints
        return Physics(
            mass_kg=float(self._model.body_subtreemass[0]),
            time=times,
            base=base,
            attitude=attitude,
            base_velocity=base_velocity,
            position=position,
            velocity=velocity,
            torque=torque,
            foot=foot,
            foot_velocity=foot_velocity,
            calf=calf.reshape(len(base), len(self._feet), 7),
            force=force,
            point=point,
            joints=self._joints,
        )

    def _row(self, position: Floats, velocity: Floats) -> tuple[Any, ...]:
        data, kinds = self._data, mujoco.mjtObj
        feet = np.array([self._velocity(kinds.mjOBJ_GEOM, geom)[3:] for geom in self._feet])
        force, point = np.zeros((len(feet), 3)), np.full((len(feet), 3), np.nan)
        contacts, local = data.contact, np.zeros(6)
        pairs, frames, places = contacts.geom, contacts.frame, contacts.pos
        for number, pair in enumerate(pairs.tolist()):
            foot = next(self._feet[geom] for geom in pair if geom in self._feet)
            mujoco.mj_contactForce(self._model, data, number, local)
            away = 1.0 if pair[1] in self._feet else -1.0
            force[foot] += away * frames[number].reshape(3, 3).T @ local[:3]
            point[foot] = places[number]
        return (
            data.xpos[_TRUNK].copy(),
            data.xquat[_TRUNK].copy(),
            self._velocity(kinds.mjOBJ_BODY, _TRUNK),
            position,
            velocity,
            data.actuator_force[self._own].copy(),
            data.geom_xpos[[*self._feet]],
            feet,
            data.xpos[self._calves],
            data.xquat[self._calves],
            force,
            point,
        )

    def _velocity(self, kind: Any, number: int) -> Floats:
        """(6,) rad/s and m/s of a body or site, in the world."""
        moving = np.zeros(6)
        mujoco.mj_objectVelocity(self._model, self._data, kind, number, moving, 0)
        return moving


def urdf(legs_kg: tuple[float, ...] = (), trunk_kg: float = 8.0) -> str:
    """Return the robot description of the model; with masses where some are given."""
    parts, kilograms = [], {"base_link": (trunk_kg, 0.0)}
    for foot in FEET:
        parts_kg = zip(("hip", "thigh", "calf", "foot"), legs_kg, strict=False)
        for part, mass in parts_kg:
            kilograms[f"{foot}_{part}"] = mass, -LINK / 2.0 if part in {"thigh", "calf"} else 0.0
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
    links = [
        "base_link",
        *(f"{f}_{p}" for f, p in itertools.product(FEET, ("hip", "thigh", "calf", "foot"))),
    ]
    named = "".join(f'<link name="{name}"/>' for name in links)
    if legs_kg:
        named = "".join(
            f'<link name="{name}"><inertial><origin xyz="0 0 {kilograms[name][1]}"/>'
            f'<mass value="{kilograms[name][0]}"/></inertial>{_ball(name)}</link>'
            for name in links
        )
    return f'<robot name="physics">{named}{"".join(parts)}</robot>'


def _ball(link: str) -> str:
    """Return the shape of a link that is a foot."""
    shape = f'<collision><geometry><sphere radius="{BALL}"/></geometry></collision>'
    return shape if link.endswith("foot") else ""


@dataclass(frozen=True, slots=True)
class Commands:
    """Velocity commands: what was sent, and when."""

    time: Floats
    """(c,) s."""
    velocity: Floats
    """(c, 3) m/s forward and to the left, rad/s."""


def write_log(
    path: Path,
    robot: Physics,
    *,
    by_transforms: bool,
    points: bool | None = None,
    every: int = 1,
    commands: Commands | None = None,
    publishers: int = 1,
    silence_s: tuple[float, float] = (9.0, 9.0),
    change: Any = None,
    names: tuple[str, ...] = (),
    drift: float = 0.0,
    described: bool = True,
    with_feet: bool = True,
    with_poses: bool = True,
    imu: tuple[str, Floats] | None = None,
) -> Path:
    """Write a walk as an MCAP of ROS 2 messages.

    Args:
        path: of the log.
        robot: what it did.
        by_transforms: legs by transforms; else by joint states with a robot description.
        points: feet by contacts with points and forces in the world; else by force sensors, that
            tell the size. None: as `by_transforms`.
        every: rows of it between messages.
        commands: velocity commands, without stamps; None: none are recorded.
        publishers: topics that the joints are shared out on.
        silence_s: time in which no joint states are sent.
        change: takes and returns position, velocity and effort, (n, 12) each.
        names: of the joints in their states; empty: their own.
        drift: metres by which the odometry goes astray, to the left, a metre of the way.
        described: whether a robot description is in it, where legs are by joint states.
        with_feet: whether feet are recorded; `with_poses`, whether odometry is.
        imu: frame and readings, (n, 6) m/s^2 and rad/s, of an inertial unit.
    """
    make = ros_messages()
    rows = slice(0, None, every)
    states = (robot.position, robot.velocity, robot.torque)
    told = [np.asarray(each)[rows] for each in (change(*states) if change else states)]
    seconds = robot.time[rows]
    time = ORIGIN_NS + np.rint(seconds * 1e9).astype(np.int64)
    entries: list[Entry] = []

    def add(topic: str, kind: str, time: Ints, data: Sequence[bytes]) -> None:
        entries.extend(
            Entry(topic, kind, at, each) for at, each in zip(time.tolist(), data, strict=True)
        )

    if described and not by_transforms:
        described_as = make.text(robot.urdf or urdf())
        entries.append(Entry("/robot_description", STRING, ORIGIN_NS, described_as))
    if commands is not None:
        sent = ORIGIN_NS + np.rint(commands.time * 1e9).astype(np.int64)
        add("/cmd_vel", TWIST, sent, make.twist().all_filled(sent, commands.velocity))
    if imu is not None:
        add("/imu", IMU, time, make.imu(imu[0], turns=True).all_filled(time, imu[1][rows]))
    heard = (seconds < silence_s[0]) | (seconds >= silence_s[1])
    for number, share in enumerate(np.array_split(np.arange(len(robot.joints)), publishers)):
        numbers = np.concatenate([each[heard][:, share] for each in told], axis=1)
        joints = make.joint_states(tuple((names or robot.joints)[joint] for joint in share))
        topic = f"/joint_states_{number}" if number else "/joint_states"
        add(topic, JOINT_STATE, time[heard], joints.all_filled(time[heard], numbers))
    if by_transforms:
        calves = make.transforms("base_link", [f"{foot}_calf" for foot in FEET])
        add("/tf", TF, time, calves.all_filled(time, robot.calf[rows].reshape(len(time), -1)))
    if with_poses:
        speed = turned(inverse(robot.attitude), robot.base_velocity[:, 3:])
        place = robot.base + drift * robot.base[:, :1] * [0.0, 1.0, 0.0]
        poses = np.concatenate([place, robot.attitude, speed], axis=1)[rows]
        add("/odom", ODOMETRY, time, make.odometry("world", "base_link").all_filled(time, poses))
    for number, foot in enumerate(FEET if with_feet else ()):
        topic = f"/{NAMES[number]}_foot_contact"
        force, point = robot.force[rows, number], robot.point[rows, number]
        if not (by_transforms if points is None else points):
            size = np.linalg.norm(force, axis=1)[:, None] * [0.0, 0.0, 1.0]
            add(topic, WRENCH, time, make.wrench_stamped(f"{foot}_foot").all_filled(time, size))
            continue
        down = ~np.isnan(point).any(axis=1)
        none, nothing = make.no_contact(f"{foot}_calf"), np.empty((int((~down).sum()), 0))
        add(topic, CONTACTS, time[~down], none.all_filled(time[~down], nothing))
        bump = make.contact(f"{foot}_calf", f"robot::{foot}_calf::{foot}_collision")
        up = np.tile([0.0, 0.0, 1.0], (len(time), 1))
        numbers = np.concatenate([force, force, point, up], axis=1)[down]
        add(topic, CONTACTS, time[down], bump.all_filled(time[down], numbers))
    entries.sort(key=lambda entry: entry.log_time)
    return write_mcap(path, entries, make.definition, 1 << 18, "zstd")


def measured(robot: Physics, **options: Any) -> dl.Walk:
    """Measure the log of a walk; see `write_log` for the options."""
    with TemporaryDirectory() as folder:
        return dl.measure(
            write_log(Path(folder) / "walk.mcap", robot, **options), mass=robot.mass_kg
        )
