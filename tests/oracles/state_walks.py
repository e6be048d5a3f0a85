"""The synthetic walk of `walks.py` in messages that tell of all feet at once."""

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any, Final

import numpy as np
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from tests.oracles import walks
from tests.oracles.walks import FORCES, LEGS, TOUCHES

_VECTORS: Final = "geometry_msgs/Point pos\ngeometry_msgs/Vector3 vel\ngeometry_msgs/Vector3 acc"
_POSE: Final = "geometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Accel accel"
_CONTACT: Final = (
    "geometry_msgs/Pose pose\ngeometry_msgs/Twist velocity\ngeometry_msgs/Wrench wrench\n"
    "geometry_msgs/Vector3 surface_normal\nfloat64 friction_coefficient"
)
_SPORT: Final = (
    "int16[4] foot_force\nfloat32[3] position\nfloat32[12] foot_position_body\n"
    "float32[12] foot_speed_body"
)
DEFINITIONS: Final = {
    "xpp_msgs/msg/StateLin3d": _VECTORS,
    "xpp_msgs/msg/State6d": _POSE,
    "xpp_msgs/msg/RobotStateCartesian": "builtin_interfaces/Duration time_from_start\n"
    "xpp_msgs/State6d base\nxpp_msgs/StateLin3d[] ee_motion\n"
    "geometry_msgs/Vector3[] ee_forces\nbool[] ee_contact",
    "old_xpp/msg/BaseState": _POSE,
    "old_xpp/msg/RobotStateCommon": "old_xpp/BaseState base\nbool[] ee_in_contact\n"
    "float64 t_global",
    "old_xpp/msg/RobotStateCartesian": "old_xpp/RobotStateCommon common\n"
    "xpp_msgs/StateLin3d[] feet\ngeometry_msgs/Vector3[] ee_forces",
    "anymal_msgs/msg/Contact": "std_msgs/Header header\nstring name\nuint8 state\n"
    "geometry_msgs/Wrench wrench\ngeometry_msgs/Point position\n"
    "geometry_msgs/Vector3 normal\nfloat64 frictionCoefficient",
    "anymal_msgs/msg/AnymalState": "std_msgs/Header header\nint8 state\n"
    "geometry_msgs/PoseStamped pose\nanymal_msgs/Contact[] contacts",
    "quad_msgs/msg/GRFArray": "std_msgs/Header header\ngeometry_msgs/Vector3[] vectors\n"
    "geometry_msgs/Point[] points\nbool[] contact_states\nuint32 traj_index",
    "whole_body_state_msgs/msg/ContactState": "string name\nuint8 type\nuint8 status\n" + _CONTACT,
    "whole_body_state_msgs/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "whole_body_state_msgs/ContactState[] contacts",
    "old_whole_body/msg/ContactState": "string name\nuint8 type\nint8 contact_state\n" + _CONTACT,
    "old_whole_body/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "old_whole_body/ContactState[] contacts",
    "dwl_msgs/msg/BaseState": "string name\nuint8 id\nfloat64 position\nfloat64 velocity",
    "dwl_msgs/msg/ContactState": "string name\ngeometry_msgs/Pose pose\n"
    "geometry_msgs/Twist velocity\ngeometry_msgs/Wrench wrench",
    "dwl_msgs/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "dwl_msgs/BaseState[] base\ndwl_msgs/ContactState[] contacts",
    "old_dwl/msg/ContactState": "string name\ngeometry_msgs/Vector3 position\n"
    "geometry_msgs/Wrench wrench",
    "old_dwl/msg/WholeBodyState": "std_msgs/Header header\nfloat64 time\n"
    "dwl_msgs/BaseState[] base\nold_dwl/ContactState[] contacts",
    "syropod_highlevel_controller/msg/TipState": "std_msgs/Header header\nstring[] name\n"
    "geometry_msgs/Wrench[] wrench\nfloat64[] proximity",
    "ocs2_msgs/msg/mpc_state": "float32[] value",
    "ocs2_msgs/msg/mpc_input": "float32[] value",
    "ocs2_msgs/msg/mpc_observation": "float64 time\nocs2_msgs/mpc_state state\n"
    "ocs2_msgs/mpc_input input\nint8 mode",
    "state_estimator_msgs/msg/ContactDetection": "std_msgs/Header header\nbool stance_lf\n"
    "bool stance_rf\nbool stance_lh\nbool stance_rh",
    "pronto_msgs/msg/QuadrupedStance": "std_msgs/Header header\nfloat32 lf\nfloat32 rf\n"
    "float32 lh\nfloat32 rh",
    "pronto_msgs/msg/QuadrupedForceTorqueSensors": "std_msgs/Header header\n"
    "geometry_msgs/Wrench lf\ngeometry_msgs/Wrench rf\ngeometry_msgs/Wrench lh\n"
    "geometry_msgs/Wrench rh",
    "quadropted_msgs/msg/RobotFootContact": "bool[4] contacts",
    "hrpsys_ros_bridge/msg/ContactState": "uint8 state\nfloat64 remaining_time",
    "hrpsys_ros_bridge/msg/ContactStateStamped": "std_msgs/Header header\n"
    "hrpsys_ros_bridge/ContactState state",
    "hrpsys_ros_bridge/msg/ContactStatesStamped": "std_msgs/Header header\n"
    "hrpsys_ros_bridge/ContactStateStamped[] states",
    "go2_interfaces/msg/Go2State": "uint32 mode\nfloat32 progress\n" + _SPORT,
    "my_driver/msg/SportModeState": "uint8 mode\n" + _SPORT,
}


Fields = dict[str, Any]
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
UNITREE: Final = ("front_right", "front_left", "back_right", "back_left")
"""The order of feet of Unitree's robots, and of others."""


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
        self.store = walks.own_store(_known(ros))

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        fields = _joints if kind == "sensor_msgs/msg/JointState" else _FIELDS.get(kind)
        if fields is None:
            yield from super().contacts(kind, sample)
        else:
            yield "/feet", self.make(kind, **fields(self, kind, sample))

    def forces(self, sample: int, legs: Any = LEGS) -> list[Any]:
        return [FORCES[leg][sample] for leg in legs]

    def flags(self, sample: int, legs: Any = LEGS) -> Any:
        return np.array([TOUCHES[leg][sample] for leg in legs], np.bool_)

    def stamped(self, sample: int, frame: str) -> Fields:
        """A header, as a field."""
        return {"header": self.header(sample, frame)}


def _points(sample: int, legs: Any = LEGS) -> list[Any]:
    return [foot_position(leg, sample) for leg in legs]


def _pose(position: Any) -> Fields:
    return {"position": position}


def _base(sample: int) -> Fields:
    return {"pose": _pose(base_position(sample))}


def _joints(walk: StateWalk, _kind: str, sample: int) -> Fields:
    """Twelve joints, then FL FR RL RR; the planned contacts disagree with the forces."""
    counts = [round(force[2] / walks.NEWTONS_PER_COUNT) for force in walk.forces(sample)]
    offsets = [walks.COUNTS_OFFSET[leg] for leg in LEGS]
    return {
        **walk.stamped(sample, ""),
        "name": [f"joint_{number}" for number in range(12)] + [f"{leg}_foot" for leg in LEGS],
        "position": np.zeros(16),
        "velocity": np.concatenate([np.zeros(12), np.ones(4)]),
        "effort": np.concatenate([np.full(12, 3.0), np.add(counts, offsets)]),
    }


def _xpp(walk: StateWalk, _kind: str, sample: int) -> Fields:
    return {
        "time_from_start": (0, sample),
        "base": _base(sample),
        "ee_motion": [[point] for point in _points(sample)],
        "ee_forces": walk.forces(sample),
        "ee_contact": walk.flags(sample),
    }


def _old_xpp(walk: StateWalk, _kind: str, sample: int) -> Fields:
    """LH LF RH RF."""
    legs = ("back_left", "front_left", "back_right", "front_right")
    common = {
        "base": _base(sample),
        "ee_in_contact": walk.flags(sample, legs),
        "t_global": 0.01 * sample,
    }
    feet = [[point] for point in _points(sample, legs)]
    return {"common": common, "feet": feet, "ee_forces": walk.forces(sample, legs)}


def _anymal(walk: StateWalk, _kind: str, sample: int) -> Fields:
    """Make contacts whose order changes, and one of a gripper; a slipping foot is in contact."""
    order = LEGS if sample % 2 else LEGS[::-1]
    in_air, odom = np.array([0.0, 0.0, 3.0]), walk.stamped(sample, "odom")
    contacts = [
        {
            **odom,
            "name": LABELS[leg],
            "state": (1 + sample % 2) if TOUCHES[leg][sample] else 0,
            # What the sensor reads in the air is no contact.
            "wrench": [FORCES[leg][sample] + in_air * (not TOUCHES[leg][sample])],
            "position": foot_position(leg, sample),
            "normal": (0.0, 0.0, 1.0),
            "frictionCoefficient": 0.8,
        }
        for leg in order
    ]
    contacts.append({**contacts[0], "name": "ARM_GRIPPER", "state": 1})
    return {**odom, "pose": {**odom, **_base(sample)}, "contacts": contacts}


def _quad(walk: StateWalk, _kind: str, sample: int) -> Fields:
    """FL BL FR BR; points are 0 in the air."""
    legs = ("front_left", "back_left", "front_right", "back_right")
    return {
        **walk.stamped(sample, "map"),
        "vectors": walk.forces(sample, legs),
        "points": [foot_position(leg, sample) * TOUCHES[leg][sample] for leg in legs],
        "contact_states": walk.flags(sample, legs),
    }


def _whole_body(walk: StateWalk, kind: str, sample: int) -> Fields:
    name, in_contact = ("contact_state", 0) if kind.startswith("old") else ("status", 2)
    contacts = [
        {
            "name": LABELS[leg],
            name: in_contact if TOUCHES[leg][sample] else 1,
            "pose": _pose(foot_position(leg, sample)),
            "wrench": [FORCES[leg][sample]],
            "surface_normal": (0.0, 0.0, 1.0),
            "friction_coefficient": 0.8,
        }
        for leg in sorted(LEGS, key=lambda each: LABELS[each])
    ]
    return {**walk.stamped(sample, "world"), "time": 0.01 * sample, "contacts": contacts}


def _dwl(walk: StateWalk, kind: str, sample: int) -> Fields:
    """Contacts are in the base's frame, and the base is six joints in any order."""
    base = base_position(sample)
    joints = dict(zip((5, 4, 3, 0, 1, 2), (*base[::-1], 0.0, 0.0, 0.0), strict=True))
    contacts = []
    for leg in LEGS[:: -1 if sample % 2 else 1]:
        at = foot_position(leg, sample) - base
        placed = {"position": at} if kind.startswith("old") else {"pose": _pose(at)}
        contacts.append({"name": LABELS[leg], "wrench": [FORCES[leg][sample]], **placed})
    return {
        **walk.stamped(sample, "world"),
        "time": 0.01 * sample,
        "base": [{"id": number, "position": float(at)} for number, at in joints.items()],
        "contacts": contacts,
    }


def _syropod(walk: StateWalk, _kind: str, sample: int) -> Fields:
    wrenches = [[force] for force in walk.forces(sample)]
    return {**walk.stamped(sample, ""), "name": [*TIPS.values()], "wrench": wrenches}


def _ocs2(walk: StateWalk, _kind: str, sample: int) -> Fields:
    state = np.zeros(24)
    state[6:9] = base_position(sample)
    return {
        "time": 0.01 * sample,
        "state": [state],
        "input": [np.concatenate([*walk.forces(sample), np.zeros(12)])],
        "mode": int(walk.flags(sample) @ (8, 4, 2, 1)),
    }


def _state_estimator(walk: StateWalk, _kind: str, sample: int) -> Fields:
    names = ("stance_lf", "stance_rf", "stance_lh", "stance_rh")
    flags = map(bool, walk.flags(sample))
    return {**walk.stamped(sample, ""), **dict(zip(names, flags, strict=True))}


def _pronto(walk: StateWalk, kind: str, sample: int) -> Fields:
    plotted = (np.array([0.4, 0.3, 0.2, 0.1]) * walk.flags(sample)).tolist()
    wrenches = [[force] for force in walk.forces(sample)]
    values = plotted if kind.endswith("Stance") else wrenches
    return {
        **walk.stamped(sample, ""),
        **dict(zip(("lf", "rf", "lh", "rh"), values, strict=True)),
    }


def _hrpsys(walk: StateWalk, _kind: str, sample: int) -> Fields:
    """Two feet and a hand that touches something."""
    states = {sensor: int(TOUCHES[leg][sample]) for leg, sensor in SENSORS.items()}
    stamped = [
        {**walk.stamped(sample, sensor), "state": [state]}
        for sensor, state in {**states, "lhsensor": 1}.items()
    ]
    return {**walk.stamped(sample, ""), "states": stamped}


def _quadropted(walk: StateWalk, _kind: str, sample: int) -> Fields:
    return {"contacts": walk.flags(sample, UNITREE)}


def _sport(walk: StateWalk, _kind: str, sample: int) -> Fields:
    """FR FL RR RL, in the base's frame."""
    feet = [foot_position(leg, sample) - base_position(sample) for leg in UNITREE]
    return {
        "mode": 1,
        "foot_force": walk.counts({leg: FORCES[leg][sample] for leg in LEGS}),
        "position": base_position(sample),
        "foot_position_body": np.concatenate(feet),
    }


_FIELDS: Final[Mapping[str, Callable[[StateWalk, str, int], Fields]]] = {
    "xpp_msgs/msg/RobotStateCartesian": _xpp,
    "old_xpp/msg/RobotStateCartesian": _old_xpp,
    "anymal_msgs/msg/AnymalState": _anymal,
    "quad_msgs/msg/GRFArray": _quad,
    "whole_body_state_msgs/msg/WholeBodyState": _whole_body,
    "old_whole_body/msg/WholeBodyState": _whole_body,
    "ocs2_msgs/msg/mpc_observation": _ocs2,
    "state_estimator_msgs/msg/ContactDetection": _state_estimator,
    "pronto_msgs/msg/QuadrupedStance": _pronto,
    "pronto_msgs/msg/QuadrupedForceTorqueSensors": _pronto,
    "hrpsys_ros_bridge/msg/ContactStatesStamped": _hrpsys,
    "quadropted_msgs/msg/RobotFootContact": _quadropted,
    "go2_interfaces/msg/Go2State": _sport,
    "my_driver/msg/SportModeState": _sport,
    "dwl_msgs/msg/WholeBodyState": _dwl,
    "old_dwl/msg/WholeBodyState": _dwl,
    "syropod_highlevel_controller/msg/TipState": _syropod,
}
KINDS: Final = tuple(_FIELDS)
RAW: Final = ("go2_interfaces/msg/Go2State", "my_driver/msg/SportModeState")
FLAGS_ONLY: Final = (
    "state_estimator_msgs/msg/ContactDetection",
    "pronto_msgs/msg/QuadrupedStance",
    "hrpsys_ros_bridge/msg/ContactStatesStamped",
    "quadropted_msgs/msg/RobotFootContact",
)
WITH_POINTS: Final = (*KINDS[:6], *RAW, *KINDS[-3:-1])
PLANNED: Final = (KINDS[0], KINDS[1], "ocs2_msgs/msg/mpc_observation")
