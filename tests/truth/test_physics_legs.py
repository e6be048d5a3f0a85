"""Legs of a trot that a physics engine made: clearance, touchdowns, work, curves and gaps."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import physics
from tests.truth.free_walker import HALF_WIDTH, HEAVY_KG, LEGS_KG, OFFSET, PERIOD_S, quadruped, trot
from tests.truth.geometry import Floats, product
from tests.truth.parts import urdf
from tests.truth.physics import KEPT_S, resized


@cache
def measured(**options: Any) -> dl.Walk:
    return physics.measured(trot(), **options)


def touchdowns(foot: int) -> list[int]:
    """Steps at which a foot first touches the ground after a swing of 50 ms at least."""
    touching = trot().force[:, foot, 2] > 0.0
    edges = np.flatnonzero(touching[1:] & ~touching[:-1]) + 1
    return [edge for edge in edges.tolist() if not touching[max(edge - 25, 0) : edge].any()]


def of_foot(walk: dl.Walk, foot: int, column: str) -> Floats:
    strides = walk.strides
    return np.asarray(strides[column][strides["foot"] == physics.NAMES[foot]], np.float64)


def spans(walk: dl.Walk, foot: int) -> list[tuple[int, int]]:
    """True steps of the touchdowns that begin and end the strides that were found."""
    true = np.array(touchdowns(foot))
    start = of_foot(walk, foot, "start_s")
    end = start + of_foot(walk, foot, "stance_s") + of_foot(walk, foot, "swing_s")
    found = []
    for span in zip(start, end, strict=True):
        steps = [int(true[np.abs(true - each / KEPT_S).argmin()]) for each in span]
        assert np.array(steps) == pytest.approx(np.array(span) / KEPT_S, abs=2.5)
        found.append((steps[0], steps[1]))
    assert len(found) >= 4
    return found


BOTH = pytest.mark.parametrize("by_transforms", [True, False], ids=["transforms", "joints"])


def stride(start: int, end: int, foot: int) -> dict[str, float]:
    """Return what is true of a stride."""
    truth = trot()
    height, down = truth.foot[start:end, foot, 2], truth.force[start:end, foot, 2] > 20.0
    joints = slice(3 * foot, 3 * foot + 3)
    power = truth.torque[start:end, joints] * truth.velocity[start:end, joints]
    lands = truth.foot_velocity[end - 1, foot]
    return {
        "clearance_m": height.max() - np.median(height[down]),
        "swing_length_m": truth.speed_mps * PERIOD_S,
        "touchdown_down_mps": -lands[2],
        "touchdown_along_mps": np.hypot(*lands[:2]),
        "absolute_work_j": np.abs(power).sum() * KEPT_S,
        "positive_work_j": power.clip(0.0).sum() * KEPT_S,
    }


@BOTH
def test_strides(by_transforms: Any) -> None:
    walk = measured(by_transforms=by_transforms)
    within: dict[str, dict[str, Any]] = {
        "clearance_m": {"abs": 0.002},
        "swing_length_m": {"abs": 0.004},
        "touchdown_down_mps": {"rel": 0.05},
        "touchdown_along_mps": {"abs": 0.05},
        "absolute_work_j": {"rel": 0.02},
        "positive_work_j": {"rel": 0.02},
    }
    if by_transforms:
        # The truth is of the middle of the ball.
        del within["touchdown_along_mps"]
    for foot in range(4):
        strides = [stride(*span, foot) for span in spans(walk, foot)]
        for column, allowed in within.items():
            true = [each[column] for each in strides]
            assert of_foot(walk, foot, column) == pytest.approx(true, **allowed)


def test_cost_of_transport_and_joints() -> None:
    truth, walk = trot(), measured(by_transforms=True)
    rows = slice(*spans(walk, 0)[0][:1], spans(walk, 0)[-1][1])
    power = np.abs(truth.torque[rows] * truth.velocity[rows]).sum() * KEPT_S
    way = truth.base[rows][-1, 0] - truth.base[rows][0, 0]
    cost = power / (truth.mass_kg * 9.81 * way)
    assert walk.stats["legs"]["mechanical_cost_of_transport"] == pytest.approx(cost, rel=0.03)
    for column, name in enumerate(trot().joints):
        joint = walk.stats["legs"]["joints"][name]
        assert joint["foot"] == physics.NAMES[column // 3]
        assert joint["range_of_motion"] == pytest.approx(np.ptp(truth.position[:, column]))
        assert joint["peak_effort"] == pytest.approx(np.abs(truth.torque[:, column]).max())
        rms = np.sqrt((truth.torque[:, column] ** 2).mean())
        assert joint["rms_effort"] == pytest.approx(rms, rel=0.02)


def test_curves_over_the_gait_cycle() -> None:
    truth, walk = trot(), measured()
    for column, name in enumerate(trot().joints):
        curve = walk.stats["legs"]["joints"][name]["position_over_stride"]
        phase = np.array(curve["percent"]) / 100.0
        strides = spans(walk, column // 3)
        rows = [np.rint(start + phase * (end - start)).astype(int) for start, end in strides]
        expected = np.median([truth.position[row, column] for row in rows], axis=0)
        assert curve["median"] == pytest.approx(expected, abs=0.02)
        assert (np.subtract(curve["upper"], curve["lower"]) < 0.07).all()


def test_left_and_right_are_alike() -> None:
    pairs = measured().stats["legs"]["asymmetry_percent"]
    assert len(pairs) == 6
    assert all(abs(index) < 5.0 for index in pairs.values())


def test_steps_and_rest() -> None:
    walk = measured(by_transforms=True)
    width = 2.0 * (HALF_WIDTH + OFFSET)
    for name in physics.NAMES:
        leg = walk.stats["feet"][name]
        assert leg["step_width_m"]["median"] == pytest.approx(width, abs=0.01)
        half = trot().speed_mps * PERIOD_S / 2.0
        assert leg["step_length_m"]["median"] == pytest.approx(half, abs=0.01)
        assert leg["slip_from"] == "foot_frame"
        # The middle of a ball that rolls tells none.
        assert measured().stats["feet"][name]["slip_from"] is None


def test_several_publishers_tell_the_same() -> None:
    one, three = (measured(publishers=each) for each in (1, 3))
    for column in ("clearance_m", "absolute_work_j", "touchdown_down_mps"):
        assert three.strides[column] == pytest.approx(one.strides[column], rel=1e-6, nan_ok=True)


def test_a_stride_with_a_silence_has_no_figures() -> None:
    whole = measured()
    gap = measured(silence_s=(1.30, 1.45))
    for column in ("clearance_m", "absolute_work_j"):
        for foot in range(4):
            known, expected = of_foot(gap, foot, column), of_foot(whole, foot, column)
            starts = of_foot(gap, foot, "start_s")
            ends = starts + of_foot(gap, foot, "stance_s") + of_foot(gap, foot, "swing_s")
            lost = (starts < 1.45) & (ends > 1.30)
            assert lost.any()
            assert np.isnan(known[lost]).all()
            kept = ~lost if column == "absolute_work_j" else ends < 1.0
            assert known[kept] == pytest.approx(expected[kept], rel=1e-3)


def test_swings_are_not_known_where_the_odometry_loses_its_way() -> None:
    truth = trot()
    astray = replace(truth, base=truth.base + 0.1 * truth.base[:, :1] * [0.0, 1.0, 0.0])
    walk = physics.measured(astray, by_transforms=True)
    assert np.isnan(walk.strides["clearance_m"]).all()
    assert walk.stats["null_because"]["feet.front_left.clearance_m"] == "WORLDS_DIFFER"


@pytest.mark.parametrize("speed_mps", [0.4, 0.7])
def test_a_foot_that_bounces_at_touchdown_makes_one_step(speed_mps: float) -> None:
    """Heavy legs leave the ground for up to 40 ms after each touchdown, fast ones for 20 ms."""
    legs_kg = HEAVY_KG if speed_mps < 0.5 else LEGS_KG
    truth = quadruped((speed_mps, 0.0, 0.0), 5.0, legs_kg=legs_kg)
    walk = physics.measured(truth, every=5)
    assert walk.gait.name == "trot"
    assert walk.stats["gait"]["stride_frequency_hz"] == pytest.approx(2.0, rel=0.02)
    for foot in walk.stats["feet"].values():
        assert foot["stride_length_m"]["median"] == pytest.approx(truth.speed_mps / 2.0, rel=0.05)


def test_a_base_reckoned_from_legs_is_not_compared_with_points_in_another_world() -> None:
    walk = physics.measured(
        replace(trot(), point=trot().point + np.array([5.0, 1.0, 0.0])),
        points=True,
        with_poses=False,
    )
    assert walk.stats["settings"]["base_from"] == "legs"
    assert walk.stats["base"]["forward_speed_mps"] == pytest.approx(trot().speed_mps, rel=0.06)
    assert walk.stats["stability"]["static_margin_m"] is None
    worlds = [each for each in walk.stats["findings"] if each["code"] == "WORLDS_DIFFER"]
    assert [each["severity"] for each in worlds] == ["note"]


@pytest.mark.parametrize("factor", [1e3, 0.0], ids=["millimetres", "zero"])
def test_poses_without_feet_are_compared_with_their_twist(factor: float) -> None:
    truth = replace(trot(), base=factor * trot().base)
    walk = physics.measured(truth, by_transforms=True, with_feet=False)
    assert "POSE_SCALE" in {each["code"] for each in walk.stats["findings"]}
    assert walk.stats["base"]["forward_speed_mps"] is None


def test_legs_that_are_named_tell_which_way_is_forward() -> None:
    """The robot walks to its left all the time, and its sensors tell no places of its feet."""
    truth = quadruped((0.0, 0.2, 0.0), 4.0)
    stats = physics.measured(truth).stats
    assert stats["settings"]["forward_axis"] == "+x"
    assert stats["base"]["lateral_speed_mps"] == pytest.approx(0.205, abs=0.01)
    assert stats["base"]["forward_speed_mps"] == pytest.approx(truth.speed_mps, abs=0.01)


def test_legs_whose_names_contradict_the_guessed_axis_tell_it(tmp_path: Path) -> None:
    """The base's y axis is forward, as the robot description's legs are named."""
    truth = quadruped(seconds=4.0)
    right = np.array([[0.0, 0.0, -np.sqrt(0.5), np.sqrt(0.5)]])
    aside = replace(truth, attitude=product(truth.attitude, np.repeat(right, len(truth.time), 0)))
    turn = (
        '<joint name="turn" type="fixed"><parent link="base_link"/><child link="trunk"/>'
        '<origin rpy="0 0 1.5707963267948966"/></joint></robot>'
    )
    file = tmp_path / "robot.urdf"
    text = urdf(truth.parts).replace("base_link", "trunk").replace("</robot>", turn)
    file.write_text(text.replace("</robot>", '<link name="base_link"/></robot>'))
    log = physics.write_log(tmp_path / "log.mcap", aside)
    stats = dl.measure(log, urdf=file, mass=truth.mass_kg).stats
    assert stats["settings"]["forward_axis"] == "+y"
    assert "FORWARD_AXIS" in {each["code"] for each in stats["findings"]}
    assert stats["base"]["forward_speed_mps"] == pytest.approx(truth.speed_mps, abs=0.01)


def test_clocks_are_not_compared_by_steps_too_quick_for_it() -> None:
    """A robot with legs of 6 cm makes five strides a second, and heaves ten times."""
    quick = resized(quadruped((0.7, 0.0, 0.0)), 0.15)
    walk = physics.measured(quick, by_transforms=True, every=2)
    assert walk.gait.name == "trot"
    assert walk.stats["base"]["forward_speed_mps"] == pytest.approx(quick.speed_mps, rel=0.01)
    assert "CLOCK_OFFSET" not in {each["code"] for each in walk.stats["findings"]}
