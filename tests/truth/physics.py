"""What a robot in a physics engine (MuJoCo) does, the truth about it, and what its sensors log.

Position-controlled motors follow planned angles. Motion, contact forces and torques are the
engine's.
"""

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, NamedTuple

import mujoco
import numpy as np

import dogbot_logtool as dl
from tests.oracles.walks import Entry
from tests.truth import messages
from tests.truth.geometry import Floats, inverse, product, turned
from tests.truth.parts import Part, urdf
from tests.truth.robots import GRAVITY_MPS2

STEP_S: Final = 0.001
KEPT_S: Final = 0.002
"""s between rows that are kept."""
FEET: Final = ("FL", "FR", "RL", "RR")
NAMES: Final = ("front_left", "front_right", "back_left", "back_right")
ORIGIN_NS: Final = 50_000_000_000
_TRUNK: Final = 1
"""Number of its body; 0 is the world."""


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
    """(n, feet, 3) m, the middles of the feet's shapes; also `foot_velocity`, m/s."""
    foot_velocity: Floats
    calf: Floats
    """(n, feet, 7) the frames of the calves in the base: m, and quaternion x, y, z, w."""
    force: Floats
    """(n, feet, 3) N on each foot, in the world."""
    point: Floats
    """(n, feet, 3) m, where it touches the ground; NaN in the air."""
    joints: tuple[str, ...]
    """As joint states name them."""
    parts: tuple[Part, ...]
    """Of the robot description; empty: there is none."""

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

    def telling(self, change: Callable[[Floats, Floats, Floats], tuple[Floats, ...]]) -> "Physics":
        """Return the same with other positions, velocities and efforts of the joints."""
        position, velocity, torque = change(self.position, self.velocity, self.torque)
        return replace(self, position=position, velocity=velocity, torque=torque)


def simulate(
    xml: str,
    parts: tuple[Part, ...],
    angles: Floats,
    feet: Sequence[tuple[str, str]],
    settle_s: float,
    gravity: Sequence[float] = (0.0, 0.0, -GRAVITY_MPS2),
    push_n: Floats | None = None,
) -> Physics:
    """Run the engine.

    Args:
        xml: of the model.
        parts: that it was made of.
        angles: (steps, joints) targets of the motors; the first are the angles at the start.
        feet: of each foot, the part that touches the ground, and the one to which it is fixed.
        settle_s: s that are not kept, at the start.
        gravity: m/s^2.
        push_n: (steps, 3) on the trunk, along the world's axes.
    """
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    model.opt.gravity[:] = gravity
    own = slice(-angles.shape[1], None)
    data.qpos[own] = angles[0]
    balls = [model.geom(foot).id for foot, _ in feet]
    calves = [model.body(calf).id for _, calf in feet]
    rows: list[tuple[Any, ...]] = []
    first, every = round(settle_s / STEP_S), round(KEPT_S / STEP_S)
    for step, targets in enumerate(angles):
        if push_n is not None:
            data.xfrc_applied[_TRUNK, :3] = push_n[step]
        data.ctrl[:] = targets
        state = data.qpos[own].copy(), data.qvel[own].copy()
        mujoco.mj_step(model, data)
        # What the engine derives, forces too, is of the state before the step.
        if step >= first and (step - first) % every == 0:
            derived = data.actuator_force[own], data.xpos[calves], data.xquat[calves]
            rows.append((*state, *(each.copy() for each in derived), *_row(model, data, balls)))
    columns = (np.array(column, np.float64) for column in zip(*rows, strict=True))
    position, velocity, torque, place, turn, base, attitude, *rest = columns
    base_velocity, foot, foot_velocity, force, point = rest
    # The engine's quaternions begin with w.
    attitude, turn = np.roll(attitude, -1, axis=-1), np.roll(turn, -1, axis=-1)
    back = np.repeat(inverse(attitude), len(feet), axis=0)
    away = (place - base[:, None]).reshape(-1, 3)
    calf = np.concatenate([turned(back, away), product(back, turn.reshape(-1, 4))], axis=1)
    return Physics(
        mass_kg=float(model.body_subtreemass[0]),
        time=np.arange(len(base), dtype=np.float64) * KEPT_S,
        base=base,
        attitude=attitude,
        base_velocity=base_velocity,
        position=position,
        velocity=velocity,
        torque=torque,
        foot=foot,
        foot_velocity=foot_velocity,
        calf=calf.reshape(len(base), len(feet), 7),
        force=force,
        point=point,
        joints=tuple(part.joint for part in parts if part.axis),
        parts=parts,
    )


def _row(model: Any, data: Any, balls: list[int]) -> tuple[Any, ...]:
    """Return place, attitude and velocity of the trunk; place, velocity, force, point of feet."""
    kinds = mujoco.mjtObj
    moving = np.array([_velocity(model, data, kinds.mjOBJ_GEOM, ball)[3:] for ball in balls])
    force, point = np.zeros((len(balls), 3)), np.full((len(balls), 3), np.nan)
    contacts, local = data.contact, np.zeros(6)
    frames, places = contacts.frame, contacts.pos
    for number, pair in enumerate(contacts.geom.tolist()):
        foot = next(balls.index(geom) for geom in pair if geom in balls)
        mujoco.mj_contactForce(model, data, number, local)
        away = 1.0 if pair[1] in balls else -1.0
        force[foot] += away * frames[number].reshape(3, 3).T @ local[:3]
        point[foot] = places[number]
    trunk = data.xpos[_TRUNK].copy(), data.xquat[_TRUNK].copy()
    base_velocity = _velocity(model, data, kinds.mjOBJ_BODY, _TRUNK)
    return *trunk, base_velocity, data.geom_xpos[balls].copy(), moving, force, point


def _velocity(model: Any, data: Any, kind: Any, number: int) -> Floats:
    """(6,) rad/s and m/s of a body or shape, in the world."""
    moving = np.zeros(6)
    mujoco.mj_objectVelocity(model, data, kind, number, moving, 0)
    return moving


class Imu(NamedTuple):
    """An inertial unit."""

    frame: str = "base_link"
    """That of the base, or one that is turned by 90 degrees about its x axis."""
    gyro: float = 1.0
    """What a gyroscope reads for a turn rate of 1 rad/s."""
    late_s: float = 0.0
    """How far its clock is ahead."""

    def read(self, robot: Physics) -> list[Floats]:
        """(n, 3) m/s^2 and rad/s."""
        back = inverse(robot.attitude)
        moved = np.gradient(robot.base_velocity[:, 3:], robot.time, axis=0)
        moved[:, 2] += GRAVITY_MPS2
        read = [turned(back, moved), self.gyro * turned(back, robot.base_velocity[:, :3])]
        if self.frame == "base_link":
            return read
        return [each[:, [0, 2, 1]] * [1.0, 1.0, -1.0] for each in read]


BARE: Final[Mapping[str, Any]] = {
    "every": 5, "with_feet": False, "with_poses": False, "imu": Imu(),
}  # fmt: skip
"""How a robot without foot sensors and odometry is recorded."""


def write_log(
    path: Path,
    robot: Physics,
    *,
    by_transforms: bool = False,
    points: bool | None = None,
    every: int = 1,
    publishers: int = 1,
    silence_s: tuple[float, float] = (9.0, 9.0),
    with_feet: bool = True,
    with_poses: bool = True,
    imu: Imu | None = None,
) -> Path:
    """Write a walk as an MCAP of ROS 2 messages.

    Args:
        path: of the log.
        robot: what it did.
        by_transforms: legs by transforms; else by joint states with a robot description.
        points: feet by contacts with points and forces in the world; else by force sensors, that
            tell the size. None: as `by_transforms`.
        every: rows of it between messages.
        publishers: topics that the joints are shared out on.
        silence_s: time in which no joint states are sent.
        with_feet: whether feet are recorded; `with_poses`, whether odometry is.
        imu: an inertial unit on the base.
    """
    rows = slice(0, None, every)
    seconds = robot.time[rows]
    entries: list[Entry] = []

    def add(topic: str, kind: str, time: Floats, **fields: Any) -> None:
        stamp = ORIGIN_NS + np.rint(time * 1e9).astype(np.int64)
        entries.extend(messages.messages(topic, kind, stamp, stamp, **fields))

    if robot.parts and not by_transforms:
        add("/robot_description", "std_msgs/msg/String", np.zeros(1), data=urdf(robot.parts))
    if imu is not None:
        felt, turns = (each[rows] for each in imu.read(robot))
        read = {"linear_acceleration": felt, "angular_velocity": turns}
        add("/imu", messages.IMU, seconds + imu.late_s, header=messages.header(imu.frame), **read)
    heard = (seconds < silence_s[0]) | (seconds >= silence_s[1])
    states = {"position": robot.position, "velocity": robot.velocity, "effort": robot.torque}
    for number, share in enumerate(np.array_split(np.arange(len(robot.joints)), publishers)):
        topic = f"/joint_states_{number}" if number else "/joint_states"
        told = {name: each[rows][heard][:, share] for name, each in states.items()}
        names = [robot.joints[joint] for joint in share]
        kind = "sensor_msgs/msg/JointState"
        add(topic, kind, seconds[heard], header=messages.header(), name=names, **told)
    if by_transforms:
        calves = [
            messages.transform(
                "base_link", f"{foot}_calf", *np.split(robot.calf[rows, number], [3], axis=1)
            )
            for number, foot in enumerate(FEET)
        ]
        add("/tf", messages.TF, seconds, transforms=calves)
    if with_poses:
        speed = turned(inverse(robot.attitude), robot.base_velocity[:, 3:])[rows]
        pose = [[robot.base[rows], robot.attitude[rows]]]
        world = {"header": messages.header("world"), "child_frame_id": "base_link"}
        add("/odom", messages.ODOMETRY, seconds, **world, pose=pose, twist=[[speed]])
    for number, foot in enumerate(FEET if with_feet else ()):
        topic = f"/{NAMES[number]}_foot_contact"
        force, point = robot.force[rows, number], robot.point[rows, number]
        if not (by_transforms if points is None else points):
            size = np.linalg.norm(force, axis=1)[:, None] * [0.0, 0.0, 1.0]
            add(
                topic,
                messages.WRENCH,
                seconds,
                header=messages.header(f"{foot}_foot"),
                wrench=[size],
            )
            continue
        down = ~np.isnan(point).any(axis=1)
        name = f"robot::{foot}_calf::{foot}_collision"
        state = messages.contact_state(name, force[down], point[down], (0, 0, 1))
        for rows_of, states_of in ((~down, []), (down, [state])):
            bumper = {"header": messages.header(f"{foot}_calf"), "states": states_of}
            add(topic, messages.CONTACTS, seconds[rows_of], **bumper)
    return messages.write(path, entries)


def measured(robot: Physics, **options: Any) -> dl.Walk:
    """Measure the log of a walk; see `write_log` for the options."""
    with TemporaryDirectory() as folder:
        return dl.measure(
            write_log(Path(folder) / "walk.mcap", robot, **options), mass=robot.mass_kg
        )


def resized(walk: Physics, size: float) -> Physics:
    """Return what a robot of the same kind does whose lengths are so many times as large."""
    pace = float(np.sqrt(size))

    def part(of: Part) -> Part:
        x, y, z = (size * each for each in of.at)
        sizes = tuple(size * each for each in of.size)
        heavy, centre_m = of.kg * size**3, of.centre_m * size
        return replace(of, at=(x, y, z), size=sizes, kg=heavy, centre_m=centre_m)

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
        parts=tuple(map(part, walk.parts)),
    )
