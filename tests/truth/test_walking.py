"""The walks themselves: their truth holds for their sensors."""

import numpy as np
import pytest

from tests.truth import gaits
from tests.truth.gaits import Gait
from tests.truth.recording import disturbed
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.sensor_faults import in_link_frame
from tests.truth.walking import Walk

WALKS = {
    "trot": Walk(),
    "gallop": Walk(gait=gaits.ROTARY_GALLOP, period_s=0.5, speed_mps=2.0),
    "slope": Walk(slope_rad=0.3, heading_rad=1.0, traction=0.0),
    "biped": Walk(gait=gaits.BIPED_WALK, robot=biped()),
    "hexapod": Walk(gait=gaits.WAVE, robot=hexapod(), shares=(0.1, 0.2, 0.1, 0.2, 0.1, 0.3)),
    "slipping": Walk(slip_m=0.03),
}


@pytest.mark.parametrize("walk", WALKS.values(), ids=WALKS)
def test_the_truth_holds_for_the_sensors(walk: Walk) -> None:
    recording, rate = walk.recorded(2000.0), 2000.0
    strides = round(5 * walk.period_s * rate)
    total = np.zeros(3)
    for foot, (sensor, true) in enumerate(zip(recording.feet, recording.truth.feet, strict=True)):
        begins = sensor.time[np.flatnonzero(np.diff(sensor.touching.astype(int)) == 1)]
        ends = sensor.time[np.flatnonzero(np.diff(sensor.touching.astype(int)) == -1)]
        assert begins == pytest.approx(true.touchdown_s, abs=1.01 / rate)
        assert ends == pytest.approx(true.liftoff_s, abs=1.01 / rate)
        assert sensor.touching.mean() == pytest.approx(true.contact_fraction, abs=2e-3)
        mean = sensor.force[:strides].mean(axis=0)
        assert mean[2] == pytest.approx(walk.share(foot) * walk.robot.weight_n, rel=1e-4)
        assert mean[2] * walk.period_s == pytest.approx(
            walk.mean_vertical_n(foot) * walk.stance_s, rel=1e-4
        )
        if true.peak_vertical_force_n is not None:
            assert sensor.force[:, 2].max() == pytest.approx(true.peak_vertical_force_n, rel=1e-4)
        assert not sensor.force[~sensor.touching].any()
        total += mean
    weight = np.array([0.0, 0.0, walk.robot.weight_n])
    assert total == pytest.approx(weight, abs=1e-4 * walk.robot.weight_n)


@pytest.mark.parametrize("walk", WALKS.values(), ids=WALKS)
def test_feet_rest_on_the_ground_and_go_with_the_body(walk: Walk) -> None:
    recording = walk.recorded(1000.0)
    up = np.array([-np.sin(walk.slope_rad), 0.0, np.cos(walk.slope_rad)])
    turn = np.array(
        [
            [np.cos(walk.heading_rad), -np.sin(walk.heading_rad), 0.0],
            [np.sin(walk.heading_rad), np.cos(walk.heading_rad), 0.0],
            [0.0, 0.0, 1.0],
        ]
    )
    for sensor, true in zip(recording.feet, recording.truth.feet, strict=True):
        assert true.stance_s is not None
        assert true.stride_length_m is not None
        height = sensor.point @ (turn @ up)
        assert height[sensor.touching] == pytest.approx(0.0, abs=1e-12)
        assert height.max() == pytest.approx(walk.step_height_m, rel=1e-3)
        assert sensor.normal @ (turn @ up) == pytest.approx(1.0)
        first = np.searchsorted(sensor.time, true.touchdown_s[:2])
        stride = np.linalg.norm(np.diff(sensor.point[first], axis=0))
        assert stride == pytest.approx(true.stride_length_m / np.cos(walk.slope_rad), abs=5e-3)
        inside = (sensor.time > true.touchdown_s[0]) & (sensor.time < true.touchdown_s[0] + 1e-3)
        assert sensor.touching[inside].all()
        stance = np.flatnonzero(
            (sensor.time >= true.touchdown_s[0])
            & (sensor.time < true.touchdown_s[0] + true.stance_s)
        )
        way = np.linalg.norm(sensor.point[stance[-1]] - sensor.point[stance[0]])
        assert way == pytest.approx(walk.slip_m, abs=1e-3)


def test_the_truth_of_braking_holds() -> None:
    walk = Walk()
    sensor, true = walk.recorded(5000.0).feet[0], walk.truth().feet[0]
    braking = (
        np.minimum(sensor.force[:, 0], 0.0)[: round(5 * walk.period_s * 5000)].sum() / 5000 / 5
    )
    assert -braking == pytest.approx(true.braking_impulse_ns, rel=1e-3)


def test_a_frame_changes_no_magnitude() -> None:
    recording = Walk(slope_rad=0.2).recorded(200.0)
    turned = disturbed(recording, in_link_frame)
    for world, link in zip(recording.feet, turned.feet, strict=True):
        assert np.linalg.norm(link.force, axis=1) == pytest.approx(
            np.linalg.norm(world.force, axis=1)
        )
        assert not np.allclose(link.force, world.force)


@pytest.mark.parametrize("gait", [gaits.WALK, gaits.CANTER, gaits.TETRAPOD], ids=lambda g: g.name)
def test_a_mirror_twice_is_the_same(gait: Gait) -> None:
    assert gait.mirrored() != gait
    assert gait.mirrored().mirrored() == gait


def test_light_robots_are_small() -> None:
    assert quadruped(0.5).height_m < 0.15 < quadruped().height_m < quadruped(80.0).height_m
