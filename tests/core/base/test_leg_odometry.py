"""Leg odometry against a robot that goes in a circle, in closed form."""

import numpy as np
import pytest
from numpy.typing import NDArray

from dogbot_logtool.core.base.leg_odometry import dead_reckoned, leg_odometry
from tests.truth.walking import Walk

SPEED_MPS, TURN_RADPS = 0.5, 0.5
Floats = NDArray[np.float64]


def _pose(time: Floats) -> tuple[Floats, Floats]:
    yaw = TURN_RADPS * time
    radius = SPEED_MPS / TURN_RADPS
    return np.stack([radius * np.sin(yaw), radius * (1.0 - np.cos(yaw))], axis=1), yaw


def _in_axes(vector: Floats, yaw: Floats) -> Floats:
    x, y = vector.T
    return np.stack([np.cos(yaw) * x + np.sin(yaw) * y, np.cos(yaw) * y - np.sin(yaw) * x], axis=1)


@pytest.mark.parametrize("has_gyroscope", [True, False])
def test_circle(has_gyroscope: bool) -> None:  # noqa: FBT001 - a case
    walk, time = Walk(), np.arange(0.0, 8.0, 0.01)
    base, yaw = _pose(time)
    places, standing = [], []
    for foot, corner in enumerate(walk.robot.corners_m):
        cycles = walk.cycles(foot, time)
        middle, turned = _pose(
            (np.floor(cycles) - walk.begin + walk.gait.phases[foot]) * walk.period_s
        )
        point = middle + _in_axes(np.tile(corner, (len(time), 1)), -turned)
        places.append(np.column_stack([_in_axes(point - base, yaw), np.full(len(time), -0.4)]))
        standing.append(cycles % 1.0 < walk.gait.duty)
    gyroscope = np.tile([0.0, 0.0, TURN_RADPS], (len(time), 1)) if has_gyroscope else None
    legs = leg_odometry(
        np.round(time * 1e9).astype(np.int64),
        np.stack(places, axis=1),
        np.stack(standing, axis=1),
        gyroscope,
    )
    assert np.nanmedian(legs.velocity, axis=0) == pytest.approx([SPEED_MPS, 0.0, 0.0], abs=1e-3)
    assert np.nanmedian(legs.turn_rate[:, 2]) == pytest.approx(TURN_RADPS, abs=1e-3)
    assert legs.noise_mps == pytest.approx(0.0, abs=1e-3)
    poses = dead_reckoned(legs)
    assert poses.position[-1, :2] == pytest.approx(base[-1], abs=0.01)
    assert poses.angles[-1, 2] == pytest.approx(yaw[-1], abs=0.01)
    assert not len(poses.gaps)
