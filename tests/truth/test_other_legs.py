"""Legs of other kinds: one that slides, and a pantograph whose knee follows (``mimic``).

The feet go where those of a trot in a physics engine go, and its forces act on them; angles,
speeds and efforts are those of legs without mass.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import free_walker, physics, without_sensors
from tests.truth.gaits import Gait
from tests.truth.outcome import outcome
from tests.truth.physics import FEET, HALF_LENGTH, HALF_WIDTH, LINK, NAMES, OFFSET, Physics
from tests.truth.recording import Floats, inverse, turned
from tests.truth.robots import spider
from tests.truth.walking import Walk

LIMIT: Final = '<limit lower="-3" upper="3" effort="400" velocity="30"/>'
PARTS: Final = ("hip", "swing", "reach")
REACH: Final[Mapping[str, Callable[[Floats], Floats]]] = {
    "slides": lambda length: length,
    "pantograph": lambda length: np.arccos(length / (2.0 * LINK)),
}
"""The position of a leg's last joint by the leg's length, m."""


def _joint(name: str, kind: str, links: tuple[str, str], origin: str, axis: str, more: str) -> str:
    parent, child = links
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{origin}"/><axis xyz="{axis}"/>{more}</joint>'
    )


def _below(foot: str, kind: str) -> list[str]:
    """Return the joints below the one that swings a leg."""
    swing, thigh, calf, end = (f"{foot}_{part}" for part in ("swing", "thigh", "calf", "foot"))
    if kind == "slides":
        links = (swing, end)
        return [_joint(f"{foot}_reach_joint", "prismatic", links, "0 0 0", "0 0 -1", LIMIT)]
    follows, tip = f'<mimic joint="{foot}_reach_joint" multiplier="-2"/>', f"0 0 {-LINK}"
    return [
        _joint(f"{foot}_reach_joint", "revolute", (swing, thigh), "0 0 0", "0 1 0", LIMIT),
        _joint(f"{foot}_knee_joint", "revolute", (thigh, calf), tip, "0 1 0", LIMIT + follows),
        _joint(f"{foot}_foot_fixed", "fixed", (calf, end), tip, "0 1 0", ""),
    ]


def _hip(foot: str) -> tuple[float, float, float]:
    """Return where a leg hangs on the base, and how far beside the hip it swings, m."""
    end, side = (1.0 if foot[0] == "F" else -1.0), (1.0 if foot[1] == "L" else -1.0)
    return end * HALF_LENGTH, side * HALF_WIDTH, side * OFFSET


def _urdf(kind: str) -> str:
    joints, last = [], ("thigh", "calf") if kind == "pantograph" else ()
    for foot in FEET:
        x, y, beside = _hip(foot)
        hip, swing = f"{foot}_hip", f"{foot}_swing"
        links, at = ("base_link", hip), f"{x} {y} 0"
        joints.append(_joint(f"{hip}_joint", "revolute", links, at, "1 0 0", LIMIT))
        links, at = (hip, swing), f"0 {beside} 0"
        joints.append(_joint(f"{swing}_joint", "revolute", links, at, "0 1 0", LIMIT))
        joints += _below(foot, kind)
    parts = [f"{foot}_{part}" for foot in FEET for part in ("hip", "swing", *last, "foot")]
    named = "".join(f'<link name="{link}"/>' for link in ("base_link", *parts))
    return f'<robot name="{kind}">{named}{"".join(joints)}</robot>'


def _leg(at: Floats, beside: float, force: Floats, kind: str) -> tuple[Floats, Floats]:
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
    truth: Physics = free_walker.trot(6.0)
    back, legs = inverse(truth.attitude), []
    for row, foot in enumerate(FEET):
        x, y, beside = _hip(foot)
        at = turned(back, truth.foot[:, row] - truth.base) - [x, y, 0.0]
        legs.append(_leg(at, beside, turned(back, truth.force[:, row]), kind))
    position, effort = (np.concatenate(column, axis=1) for column in zip(*legs, strict=True))
    return replace(
        truth,
        position=position,
        velocity=np.gradient(position, truth.time, axis=0),
        torque=effort,
        joints=tuple(f"{foot}_{part}_joint" for foot in FEET for part in PARTS),
        urdf=_urdf(kind),
    )


KINDS = pytest.mark.parametrize("kind", REACH)


@KINDS
def test_swings_and_work_of_legs(kind: str) -> None:
    truth = robot(kind)
    walk = physics.measured(truth, by_transforms=False)
    usual = physics.measured(free_walker.trot(6.0), by_transforms=False)
    for name in NAMES:
        leg, other = walk.stats["feet"][name], usual.stats["feet"][name]
        for metric in ("clearance_m", "swing_length_m", "touchdown_down_mps", "step_length_m"):
            assert leg[metric]["median"] == pytest.approx(other[metric]["median"], abs=1e-4)
    power = truth.torque * truth.velocity
    for metric, part in ("absolute_work_j", np.abs(power)), ("positive_work_j", power.clip(0.0)):
        done = part.sum(axis=1).mean() * physics.PERIOD_S
        assert walk.stats["legs"][metric]["mean"] == pytest.approx(done, rel=0.02)
    for column, name in enumerate(truth.joints):
        joint = walk.stats["legs"]["joints"][name]
        assert joint["foot"] == NAMES[column // 3]
        assert joint["range_of_motion"] == pytest.approx(
            np.ptp(truth.position[:, column]), rel=1e-3
        )
    assert walk.stats["legs"]["asymmetry_percent"].keys() >= {
        "front_reach_joint",
        "back_reach_joint",
    }


@pytest.mark.parametrize("effort", [0.0, np.nan], ids=["zero", "empty"])
def test_a_knee_that_follows_needs_no_effort(effort: float) -> None:
    truth = robot("pantograph")

    def with_knee(states: Floats, knee: Floats) -> Floats:
        of_legs = np.concatenate([states.reshape(-1, 4, 3), knee[:, :, None]], axis=2)
        return of_legs.reshape(len(states), -1)

    reach = (each[:, 2::3] for each in (truth.position, truth.velocity))
    position, velocity = (-2.0 * each for each in reach)
    told = replace(
        truth,
        position=with_knee(truth.position, position),
        velocity=with_knee(truth.velocity, velocity),
        torque=with_knee(truth.torque, np.full_like(position, effort)),
        joints=tuple(f"{foot}_{part}_joint" for foot in FEET for part in (*PARTS, "knee")),
    )
    one, other = (physics.measured(each, by_transforms=False) for each in (truth, told))
    for metric in ("absolute_work_j", "mechanical_cost_of_transport"):
        assert other.stats["legs"][metric] == pytest.approx(one.stats["legs"][metric])
    for column in ("absolute_work_j", "clearance_m"):
        assert other.strides[column] == pytest.approx(one.strides[column], nan_ok=True)
    assert "JOINT_VALUES" not in {each["code"] for each in other.stats["findings"]}


def no_efforts(position: Floats, velocity: Floats, effort: Floats) -> tuple[Floats, ...]:
    return position, velocity, np.full_like(effort, np.nan)


@KINDS
@pytest.mark.parametrize("source", ["joint_torques", "kinematics"])
def test_gait_and_base_by_legs_alone(kind: str, source: str, tmp_path: Path) -> None:
    truth = robot(kind)
    change: Any = None if source == "joint_torques" else no_efforts
    log = without_sensors.write_log(tmp_path / "log.mcap", truth, change=change)
    stats = dl.measure(log, mass=truth.mass_kg).stats
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
