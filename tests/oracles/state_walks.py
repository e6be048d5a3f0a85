"""The synthetic walk of `walks.py` in messages that tell of all feet at once."""

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any, Final

import numpy as np
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from tests.oracles import walks
from tests.oracles.state_definitions import DEFINITIONS
from tests.oracles.walks import FORCES, LEGS, TOUCHES

LABELS: Final = {
    "front_left": "LF_FOOT",
    "front_right": "RF_FOOT",
    "back_left": "LH_FOOT",
    "back_right": "RH_FOOT",
}
TIPS: Final = {leg: label.replace("FOOT", "tip") for leg, label in LABELS.items()}
SENSORS: Final = {"front_left": "lfsensor", "front_right": "rfsensor"}
"""Feet of a biped, by the leg that they walk like."""
PLACES: Final = {
    "front_left": (0.3, 0.2),
    "front_right": (0.3, -0.2),
    "back_left": (-0.3, 0.2),
    "back_right": (-0.3, -0.2),
}
KINDS: Final = (
    "xpp_msgs/msg/RobotStateCartesian",
    "old_xpp/msg/RobotStateCartesian",
    "anymal_msgs/msg/AnymalState",
    "quad_msgs/msg/GRFArray",
    "whole_body_state_msgs/msg/WholeBodyState",
    "old_whole_body/msg/WholeBodyState",
    "ocs2_msgs/msg/mpc_observation",
    "state_estimator_msgs/msg/ContactDetection",
    "pronto_msgs/msg/QuadrupedStance",
    "pronto_msgs/msg/QuadrupedForceTorqueSensors",
    "hrpsys_ros_bridge/msg/ContactStatesStamped",
    "go2_interfaces/msg/Go2State",
    "my_driver/msg/SportModeState",
    "dwl_msgs/msg/WholeBodyState",
    "old_dwl/msg/WholeBodyState",
    "syropod_highlevel_controller/msg/TipState",
)
RAW: Final = ("go2_interfaces/msg/Go2State", "my_driver/msg/SportModeState")
FLAGS_ONLY: Final = (
    "state_estimator_msgs/msg/ContactDetection",
    "pronto_msgs/msg/QuadrupedStance",
    "hrpsys_ros_bridge/msg/ContactStatesStamped",
)
WITH_FORCE: Final = tuple(kind for kind in KINDS if kind not in FLAGS_ONLY)
WITH_POINTS: Final = (*KINDS[:6], *RAW, *KINDS[-3:-1])
IN_WORLD: Final = tuple(kind for kind in KINDS[:7] if not kind.startswith("anymal"))
PLANNED: Final = (KINDS[0], KINDS[1], "ocs2_msgs/msg/mpc_observation")


def base_position(sample: int) -> Any:
    """(3,) m, as `Walk.odometry` has it."""
    return np.array([0.003 * sample, 0.0, 0.4])


def foot_position(leg: str, sample: int) -> Any:
    """(3,) m in the world: still while the foot stands, 0.1 m above the ground in swing."""
    down = sample
    while down > 0 and TOUCHES[leg][sample] and TOUCHES[leg][down - 1]:
        down -= 1
    x, y = PLACES[leg]
    return np.array([base_position(down)[0] + x, y, 0.0 if TOUCHES[leg][sample] else 0.1])


@cache
def _known(ros: int) -> Typestore:
    store = walks.Walk(ros).store
    # A duration has the parts of a time.
    theirs, ours = "builtin_interfaces/Duration", "builtin_interfaces/Time"
    known: dict[str, Any] = {}
    for name, text in DEFINITIONS.items():
        known.update(get_types_from_msg(text.replace(theirs, ours), name))
    store.register(known)
    return store


@cache
def messages(kind: str) -> list[walks.Entry]:
    """Return the walk of ROS 2 in a kind of message."""
    return list(StateWalk(2).messages(kind))


class StateWalk(walks.Walk):
    """Messages that tell of all feet."""

    def __init__(self, ros: int) -> None:
        super().__init__(ros)
        self.store = walks.SharedStore(_known(ros))

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        maker = getattr(self, f"_{kind.split('/', maxsplit=1)[0]}", None)
        if maker is None:
            yield from super().contacts(kind, sample)
        else:
            yield "/feet", maker(kind, sample)

    def _sensor_msgs(self, kind: str, sample: int) -> Any:
        """Twelve joints, then FL FR RL RR; the planned contacts disagree with the forces."""
        counts = [round(FORCES[leg][sample][2] / walks.NEWTONS_PER_COUNT) for leg in LEGS]
        offsets = [walks.COUNTS_OFFSET[leg] for leg in LEGS]
        efforts = np.concatenate([np.full(12, 3.0), np.add(counts, offsets)])
        return self.make(
            kind,
            header=self.header(sample, ""),
            name=[f"joint_{number}" for number in range(12)] + [f"{leg}_foot" for leg in LEGS],
            position=np.zeros(16),
            velocity=np.concatenate([np.zeros(12), np.ones(4)]),
            effort=efforts,
        )

    def _points(self, sample: int, legs: Any = LEGS) -> list[Any]:
        return [self._point(foot_position(leg, sample)) for leg in legs]

    def _point(self, values: Any) -> Any:
        return self.vector(values, "geometry_msgs/Point")

    def _pose(self, position: Any) -> Any:
        turn = self.make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        return self.make("geometry_msgs/Pose", position=self._point(position), orientation=turn)

    def _twist(self, kind: str = "geometry_msgs/Twist") -> Any:
        zero = self.vector((0, 0, 0))
        return self.make(kind, linear=zero, angular=zero)

    def _xpp_base(self, kind: str, sample: int) -> Any:
        return self.make(
            kind,
            pose=self._pose(base_position(sample)),
            twist=self._twist(),
            accel=self._twist("geometry_msgs/Accel"),
        )

    def _motion(self, sample: int, legs: Any) -> list[Any]:
        zero = self.vector((0, 0, 0))
        return [
            self.make("xpp_msgs/StateLin3d", pos=point, vel=zero, acc=zero)
            for point in self._points(sample, legs)
        ]

    def _forces(self, sample: int, legs: Any = LEGS) -> list[Any]:
        return [self.vector(FORCES[leg][sample]) for leg in legs]

    def _flags(self, sample: int, legs: Any = LEGS) -> Any:
        return np.array([TOUCHES[leg][sample] for leg in legs], np.bool_)

    def _xpp_msgs(self, kind: str, sample: int) -> Any:
        return self.make(
            kind,
            time_from_start=self.make("builtin_interfaces/Time", sec=0, nanosec=sample),
            base=self._xpp_base("xpp_msgs/State6d", sample),
            ee_motion=self._motion(sample, LEGS),
            ee_forces=self._forces(sample),
            ee_contact=self._flags(sample),
        )

    def _old_xpp(self, kind: str, sample: int) -> Any:
        """LH LF RH RF."""
        legs = ("back_left", "front_left", "back_right", "front_right")
        common = self.make(
            "old_xpp/RobotStateCommon",
            base=self._xpp_base("old_xpp/BaseState", sample),
            ee_in_contact=self._flags(sample, legs),
            t_global=0.01 * sample,
        )
        feet, forces = self._motion(sample, legs), self._forces(sample, legs)
        return self.make(kind, common=common, feet=feet, ee_forces=forces)

    def _anymal_msgs(self, kind: str, sample: int) -> Any:
        """Make contacts whose order changes; a slipping foot is in contact."""
        order = LEGS if sample % 2 else LEGS[::-1]
        in_air = np.array([0.0, 0.0, 3.0])
        pose = self.make(
            "geometry_msgs/PoseStamped",
            header=self.header(sample, "odom"),
            pose=self._pose(base_position(sample)),
        )
        contacts = [
            self.make(
                "anymal_msgs/Contact",
                header=self.header(sample, "odom"),
                name=LABELS[leg],
                state=(1 + sample % 2) if TOUCHES[leg][sample] else 0,
                # What the sensor reads in the air is no contact.
                wrench=self.wrench(FORCES[leg][sample] + in_air * (not TOUCHES[leg][sample])),
                position=self._point(foot_position(leg, sample)),
                normal=self.vector((0.0, 0.0, 1.0)),
                frictionCoefficient=0.8,
            )
            for leg in order
        ]
        header = self.header(sample, "odom")
        return self.make(kind, header=header, state=0, pose=pose, contacts=contacts)

    def _quad_msgs(self, kind: str, sample: int) -> Any:
        """FL BL FR BR; points are 0 in the air."""
        legs = ("front_left", "back_left", "front_right", "back_right")
        points = [self._point(foot_position(leg, sample) * TOUCHES[leg][sample]) for leg in legs]
        return self.make(
            kind,
            header=self.header(sample, "map"),
            vectors=self._forces(sample, legs),
            points=points,
            contact_states=self._flags(sample, legs),
            traj_index=0,
        )

    def _whole_body_state_msgs(self, kind: str, sample: int) -> Any:
        status = {leg: {"status": 2 if TOUCHES[leg][sample] else 1} for leg in LEGS}
        return self._whole_body(kind, sample, status)

    def _old_whole_body(self, kind: str, sample: int) -> Any:
        status = {leg: {"contact_state": 0 if TOUCHES[leg][sample] else 1} for leg in LEGS}
        return self._whole_body(kind, sample, status)

    def _whole_body(self, kind: str, sample: int, status: Any) -> Any:
        contacts = [
            self.make(
                f"{kind.split('/', maxsplit=1)[0]}/ContactState",
                name=LABELS[leg],
                type=0,
                **status[leg],
                pose=self._pose(foot_position(leg, sample)),
                velocity=self._twist(),
                wrench=self.wrench(FORCES[leg][sample]),
                surface_normal=self.vector((0.0, 0.0, 1.0)),
                friction_coefficient=0.8,
            )
            for leg in sorted(LEGS, key=lambda each: LABELS[each])
        ]
        header = self.header(sample, "world")
        return self.make(kind, header=header, time=0.01 * sample, contacts=contacts)

    def _dwl_msgs(self, kind: str, sample: int) -> Any:
        """Contacts are in the base's frame, and the base is six joints in any order."""
        return self._dwl(
            kind, sample, lambda at: {"pose": self._pose(at), "velocity": self._twist()}
        )

    def _old_dwl(self, kind: str, sample: int) -> Any:
        return self._dwl(kind, sample, lambda at: {"position": self.vector(at)})

    def _dwl(self, kind: str, sample: int, placed: Callable[[Any], dict[str, Any]]) -> Any:
        base = base_position(sample)
        joints = dict(zip((5, 4, 3, 0, 1, 2), (*base[::-1], 0.0, 0.0, 0.0), strict=True))
        contacts = [
            self.make(
                f"{kind.split('/', maxsplit=1)[0]}/ContactState",
                name=LABELS[leg],
                wrench=self.wrench(FORCES[leg][sample]),
                **placed(foot_position(leg, sample) - base),
            )
            for leg in LEGS[:: -1 if sample % 2 else 1]
        ]
        joint = "dwl_msgs/BaseState"
        return self.make(
            kind,
            header=self.header(sample, "world"),
            time=0.01 * sample,
            base=[
                self.make(joint, name="", id=number, position=float(position), velocity=0.0)
                for number, position in joints.items()
            ],
            contacts=contacts,
        )

    def _syropod_highlevel_controller(self, kind: str, sample: int) -> Any:
        return self.make(
            kind,
            header=self.header(sample, ""),
            name=[TIPS[leg] for leg in LEGS],
            wrench=[self.wrench(FORCES[leg][sample]) for leg in LEGS],
            proximity=np.zeros(0),
        )

    def _ocs2_msgs(self, kind: str, sample: int) -> Any:
        bits = dict(zip(LEGS, (8, 4, 2, 1), strict=True))
        forces = np.concatenate([FORCES[leg][sample] for leg in LEGS])
        state = np.zeros(24, np.float32)
        state[6:9] = base_position(sample)
        return self.make(
            kind,
            time=0.01 * sample,
            state=self.make("ocs2_msgs/mpc_state", value=state),
            input=self.make(
                "ocs2_msgs/mpc_input",
                value=np.concatenate([forces, np.zeros(12)]).astype(np.float32),
            ),
            mode=sum(bits[leg] for leg in LEGS if TOUCHES[leg][sample]),
        )

    def _state_estimator_msgs(self, kind: str, sample: int) -> Any:
        names = ("stance_lf", "stance_rf", "stance_lh", "stance_rh")
        flags = dict(zip(names, map(bool, self._flags(sample)), strict=True))
        return self.make(kind, header=self.header(sample, ""), **flags)

    def _pronto_msgs(self, kind: str, sample: int) -> Any:
        names = ("lf", "rf", "lh", "rh")
        if kind.endswith("Stance"):
            plotted = np.array([0.4, 0.3, 0.2, 0.1]) * self._flags(sample)
            values: list[Any] = plotted.tolist()
        else:
            values = [self.wrench(FORCES[leg][sample]) for leg in LEGS]
        header = self.header(sample, "")
        return self.make(kind, header=header, **dict(zip(names, values, strict=True)))

    def _hrpsys_ros_bridge(self, kind: str, sample: int) -> Any:
        """Two feet and a hand that touches something."""
        states = {sensor: int(TOUCHES[leg][sample]) for leg, sensor in SENSORS.items()}
        stamped = [
            self.make(
                "hrpsys_ros_bridge/ContactStateStamped",
                header=self.header(sample, sensor),
                state=self.make("hrpsys_ros_bridge/ContactState", state=state, remaining_time=0.0),
            )
            for sensor, state in {**states, "lhsensor": 1}.items()
        ]
        return self.make(kind, header=self.header(sample, ""), states=stamped)

    def _go2_interfaces(self, kind: str, sample: int) -> Any:
        return self.make(kind, mode=1, progress=0.0, **self._sport(sample))

    def _my_driver(self, kind: str, sample: int) -> Any:
        return self.make(kind, mode=1, **self._sport(sample))

    def _sport(self, sample: int) -> dict[str, Any]:
        """FR FL RR RL, in the base's frame."""
        legs = ("front_right", "front_left", "back_right", "back_left")
        feet = [foot_position(leg, sample) - base_position(sample) for leg in legs]
        return {
            "foot_force": self.counts({leg: FORCES[leg][sample] for leg in LEGS}),
            "position": base_position(sample).astype(np.float32),
            "foot_position_body": np.concatenate(feet).astype(np.float32),
            "foot_speed_body": np.zeros(12, np.float32),
        }
