"""Legs of other kinds: one that slides, and a pantograph whose knee follows (``mimic``).

The feet go where those of a trot in a physics engine go, and its forces act on them; angles,
speeds and efforts are those of legs without mass.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from tests.truth import physics
from tests.truth.free_walker import HALF_LENGTH, HALF_WIDTH, LINK, OFFSET, PERIOD_S, SIDES, trot
from tests.truth.gaits import Gait
from tests.truth.geometry import Floats, inverse, turned
from tests.truth.outcome import outcome
from tests.truth.parts import Part
from tests.truth.physics import FEET, NAMES, Physics
from tests.truth.robots import spider
from tests.truth.walking import Walk

REACH: Final[Mapping[str, Callable[[Floats], Floats]]] = {
    "slides": lambda length: length,
    "pantograph": lambda length: np.arccos(length / (2.0 * LINK)),
}
"""The position of a leg's last joint by the leg's length, m."""
CORNERS: Final = SIDES * (HALF_LENGTH, HALF_WIDTH)


def parts(kind: str) -> Iterator[Part]:
    yield Part("base_link")
    tip = (0.0, 0.0, -LINK)
    for foot, (x, y), (_, side) in zip(FEET, CORNERS, SIDES, strict=True):
        hip, swing, reach, knee = (f"{foot}_{part}" for part in ("hip", "swing", "reach", "knee"))
        yield Part(hip, "base_link", (x, y, 0.0), "x")
        yield Part(swing, hip, (0.0, side * OFFSET, 0.0), "y")
        if kind == "slides":
            yield Part(reach, swing, axis="down", kind="prismatic")
            yield Part(f"{foot}_foot", reach)
        else:
            yield Part(reach, swing, axis="y")
            yield Part(knee, reach, tip, "y", follows=f"{reach}_joint")
            yield Part(f"{foot}_foot", knee, tip)


def leg(at: Floats, beside: float, force: Floats, kind: str) -> tuple[Floats, Floats]:
    """Return the positions of a leg's joints, and the efforts that hold a force, (n, 3) each.

    Args:
        at: (n, 3) m, of the foot from the hip.
        beside: m, from the hip to where the leg swings.
        force: (n, 3) N, of the ground on the foot.
        kind: of the leg.
    """
    # In the plane that the hip turns, the leg is `beside` from it and so far below.
    below = np.sqrt(at[:, 1] ** 2 + at[:, 2] ** 2 - beside**2)
    hip = np.arctan2(at[:, 2], at[:, 1]) - np.arctan2(-below, beside)
    swing, length = np.arctan2(-at[:, 0], below), np.hypot(at[:, 0], below)
    last = REACH[kind](length)
    longer = np.ones(len(at)) if kind == "slides" else -2.0 * LINK * np.sin(last)
    none = np.zeros(len(at))
    down = np.stack([none, np.sin(hip), -np.cos(hip)], axis=1)
    ahead = np.tile([1.0, 0.0, 0.0], (len(at), 1))
    sin, cos, far = np.sin(swing)[:, None], np.cos(swing)[:, None], length[:, None]
    ways = (
        np.cross(ahead, at),
        -far * (cos * ahead + sin * down),
        longer[:, None] * (cos * down - sin * ahead),
    )
    efforts = [-(force * way).sum(axis=1) for way in ways]
    return np.stack([hip, swing, last], axis=1), np.stack(efforts, axis=1)


@cache
def robot(kind: str) -> Physics:
    """Return the trot of `free_walker` with other legs."""
    truth = trot(6.0)
    back, legs = inverse(truth.attitude), []
    for row, ((x, y), (_, side)) in enumerate(zip(CORNERS, SIDES, strict=True)):
        at = turned(back, truth.foot[:, row] - truth.base) - [x, y, 0.0]
        legs.append(leg(at, side * OFFSET, turned(back, truth.force[:, row]), kind))
    position, effort = (np.concatenate(column, axis=1) for column in zip(*legs, strict=True))
    made = tuple(parts(kind))
    return replace(
        truth,
        position=position,
        velocity=np.gradient(position, truth.time, axis=0),
        torque=effort,
        joints=tuple(part.joint for part in made if part.axis and not part.follows),
        parts=made,
    )


KINDS = pytest.mark.parametrize("kind", REACH)


@KINDS
def test_swings_and_work_of_legs(kind: str) -> None:
    truth = robot(kind)
    walk = physics.measured(truth)
    usual = physics.measured(trot(6.0))
    for name in NAMES:
        found, other = walk.stats["feet"][name], usual.stats["feet"][name]
        for metric in ("clearance_m", "swing_length_m", "touchdown_down_mps", "step_length_m"):
            assert found[metric]["median"] == pytest.approx(other[metric]["median"], abs=1e-4)
    power = truth.torque * truth.velocity
    for metric, part in ("absolute_work_j", np.abs(power)), ("positive_work_j", power.clip(0.0)):
        done = part.sum(axis=1).mean() * PERIOD_S
        assert walk.stats["legs"][metric]["mean"] == pytest.approx(done, rel=0.02)
    for column, name in enumerate(truth.joints):
        joint = walk.stats["legs"]["joints"][name]
        assert joint["foot"] == NAMES[column // 3]
        true = np.ptp(truth.position[:, column])
        assert joint["range_of_motion"] == pytest.approx(true, rel=1e-3)


@pytest.mark.parametrize("effort", [0.0, np.nan], ids=["zero", "empty"])
def test_a_knee_that_follows_needs_no_effort(effort: float) -> None:
    truth = robot("pantograph")

    def with_knee(states: Floats, factor: float) -> Floats:
        of_legs = states.reshape(-1, 4, 3)
        return np.concatenate([of_legs, factor * of_legs[:, :, 2:]], axis=2).reshape(-1, 16)

    told = replace(
        truth,
        position=with_knee(truth.position, -2.0),
        velocity=with_knee(truth.velocity, -2.0),
        torque=with_knee(truth.torque, effort),
        joints=tuple(part.joint for part in truth.parts if part.axis),
    )
    one, other = (physics.measured(each) for each in (truth, told))
    for metric in ("absolute_work_j", "mechanical_cost_of_transport"):
        assert other.stats["legs"][metric] == pytest.approx(one.stats["legs"][metric])
    found, true = (each.strides["clearance_m"] for each in (other, one))
    assert found == pytest.approx(true, nan_ok=True)


@KINDS
@pytest.mark.parametrize("source", ["joint_torques", "kinematics"])
def test_gait_and_base_by_legs_alone(kind: str, source: str) -> None:
    truth = robot(kind)
    if source == "kinematics":
        truth = replace(truth, torque=np.full_like(truth.torque, np.nan))
    stats: Any = physics.measured(truth, **physics.BARE).stats
    assert (stats["settings"]["contact_from"], stats["gait"]["name"]) == (source, "trot")
    down = [foot["contact_fraction"] for foot in stats["feet"].values()]
    assert down == pytest.approx(truth.touching.tolist(), abs=0.06)
    assert stats["base"]["forward_speed_mps"] == pytest.approx(truth.speed_mps, rel=0.05)
    if source == "joint_torques":
        assert stats["forces"]["vertical_impulse_over_weight"] == pytest.approx(1.0, abs=0.1)
    assert "warning" not in {each["severity"] for each in stats["findings"]}


def test_legs_that_are_numbered_on_each_side_are_no_sensors_of_one_foot(tmp_path: Path) -> None:
    phases = tuple((row % 2 * 0.5 + row // 2 * 0.17) % 1.0 for row in range(8))
    gait = Gait("irregular", phases, 0.6)
    walk = Walk(gait=gait, robot=spider(), period_s=1.2, speed_mps=0.1, step_height_m=0.02)
    feet = outcome(walk.recorded(100.0), tmp_path).json["feet"]
    assert len(feet) == 8
    for foot in feet.values():
        assert foot["duty_factor"]["mean"] == pytest.approx(0.6, abs=0.03)
        assert foot["stride_length_m"]["mean"] == pytest.approx(0.12, rel=0.02)
