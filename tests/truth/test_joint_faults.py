"""Joint states with other units, signs, names and rates, of a robot in a physics engine."""

from collections.abc import Callable
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import free_walker, physics
from tests.truth.recording import Floats

SECONDS: Final = 4.0
States = tuple[Floats, Floats, Floats]
CALF: Final = 2
"""The first leg's."""


def measure(**options: Any) -> dl.Walk:
    return physics.measured(free_walker.trot(SECONDS), **{"by_transforms": True, **options})


def only(column: int, faulty: Floats, values: Floats) -> Floats:
    """Return values of which one joint's are faulty."""
    return np.where(np.arange(values.shape[1]) == column, faulty, values)


CHANGES: Final[dict[str, Callable[[Floats, Floats, Floats], States]]] = {
    "degrees": lambda q, v, e: (np.degrees(q), np.degrees(v), e),
    "velocities in degrees": lambda q, v, e: (q, np.degrees(v), e),
    "of the motor": lambda q, v, e: (q, v, e / 8.0),
    "milliamperes": lambda q, v, e: (q, v, 1e3 * e),
    "velocities turned": lambda q, v, e: (q, -v, e),
    "one velocity turned": lambda q, v, e: (q, only(CALF, -v, v), e),
    "other velocities": lambda q, v, e: (q, np.random.default_rng(1).normal(size=v.shape), e),
    "same efforts": lambda q, v, e: (q, v, np.full_like(e, 1.5)),
    "one same effort": lambda q, v, e: (q, v, only(CALF, np.full_like(e, 1.5), e)),
    "no efforts": lambda q, v, e: (q, v, np.full_like(e, np.nan)),
}
RENAMED: Final = ("knee_1", *physics.JOINTS[1:])
TWICE: Final = (physics.JOINTS[0], physics.JOINTS[0], *physics.JOINTS[2:])


@pytest.mark.parametrize(
    ("change", "options", "code", "cause"),
    [
        ("degrees", {}, "JOINT_VALUES", "half of the legs' joints move by 21"),
        ("velocities in degrees", {}, "JOINT_VALUES", "times those of their positions"),
        ("of the motor", {}, "JOINT_VALUES", "times that of the forces on the feet"),
        ("milliamperes", {}, "JOINT_VALUES", "which is no torque in N m"),
        ("velocities turned", {}, "JOINT_VALUES", "are -1 times those of their pos"),
        ("one velocity turned", {}, "JOINT_VALUES", "positions: FL_calf_joint (-1 t"),
        ("other velocities", {}, "JOINT_VALUES", "times those of their positions"),
        ("same efforts", {}, "JOINT_VALUES", "efforts are constant"),
        ("one same effort", {}, "JOINT_VALUES", "tell no effort: FL_calf_joint"),
        ("no efforts", {}, "JOINT_VALUES", "efforts are empty"),
        ("", {"names": RENAMED}, "JOINT_VALUES",
         "fewer joints of front_left (2) than of front_right"),
        ("", {"names": TWICE}, "JOINT_VALUES",
         "fewer joints of front_left (1) than of front_right"),
        ("", {"names": RENAMED, "by_transforms": False}, "JOINT_VALUES",
         "joint states do not tell of FL_hip_joint"),
        ("", {"every": 25}, "SAMPLED_SLOWLY", "joint states come 10.1 times in a stride of 0.50 s"),
    ],
)  # fmt: skip
def test_work_is_null_and_the_cause_is_named(
    change: str, options: dict[str, Any], code: str, cause: str
) -> None:
    walk = measure(change=CHANGES.get(change), **options)
    found = [f["text"] for f in walk.stats["findings"] if f["code"] == code and cause in f["text"]]
    assert len(found) == 1
    assert found[0].startswith("no work is known: ")
    legs = walk.stats["legs"]
    for name in ("positive_work_j", "absolute_work_j", "mechanical_cost_of_transport"):
        assert legs[name] is None
    assert np.isnan(walk.strides["absolute_work_j"]).all()
    if change and "effort" not in change:
        for joint in legs["joints"].values():
            assert joint["absolute_work_j"] is None


@pytest.mark.parametrize("told", [1.0, 0.0], ids=["velocities", "none"])
def test_positions_that_wrap_change_nothing(told: float) -> None:
    """As of continuous joints that swing about +-pi: a turn less above the middle."""

    def right(position: Floats, velocity: Floats, effort: Floats) -> States:
        return position, told * velocity, effort

    def wrapped(position: Floats, velocity: Floats, effort: Floats) -> States:
        above = position > position.mean(axis=0)
        return position - 2.0 * np.pi * above, told * velocity, effort

    expected = measure(change=right, by_transforms=False)
    found = measure(change=wrapped, by_transforms=False)
    for column in ("clearance_m", "swing_length_m", "absolute_work_j", "positive_work_j"):
        known = found.strides[column]
        assert np.isfinite(known).any()
        assert known == pytest.approx(expected.strides[column], rel=1e-3, nan_ok=True)
    for name, joint in found.stats["legs"]["joints"].items():
        true = expected.stats["legs"]["joints"][name]
        # Joints are kept in float32, which near pi tells 2.4e-7 rad apart; speeds every 2 ms.
        assert joint["range_of_motion"] == pytest.approx(true["range_of_motion"], abs=1e-6)
        assert joint["peak_speed"] == pytest.approx(true["peak_speed"], abs=5e-4)


def test_names_of_another_robot_do_not_place_its_feet() -> None:
    names = tuple(f"robot_{joint}" for joint in physics.JOINTS)
    walk = measure(names=names, by_transforms=False)
    because = walk.stats["null_because"]["feet.front_left.clearance_m"]
    assert because == "no transforms or joints of the legs"
    assert np.isnan(walk.strides["clearance_m"]).all()
    # Which leg each is of, their names still tell.
    assert np.isfinite(walk.strides["absolute_work_j"]).any()
