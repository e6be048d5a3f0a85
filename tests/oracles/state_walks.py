"""The synthetic walk of `walks.py` in messages that tell of all feet at once."""

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

import numpy as np

from tests.oracles import walks
from tests.oracles.walks import FORCES, LEGS, TOUCHES

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


class StateWalk(walks.Walk):
    """Messages that tell of all feet."""

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


def _base(sample: int) -> Fields:
    return {"pose": {"position": base_position(sample)}}


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
            "pose": {"position": foot_position(leg, sample)},
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
        placed = {"position": at} if kind.startswith("old") else {"pose": {"position": at}}
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
