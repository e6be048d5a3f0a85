"""A robot in a physics engine that follows velocity commands through a known latency."""

from functools import cache
from typing import Any, Final

import numpy as np
import pytest

from tests.truth import free_walker, physics
from tests.truth.recording import Floats, inverse, turned

SECONDS: Final = 16.5
HOLD_S: Final = 1.1
"""s between changes: these meet the gait at 0, 10, ... 90 % of its stride, on which it depends how
soon the legs follow."""
_ORDER: Final = (1, -1, -1, -1, 1, 1, 1, 1, -1, 1, -1, 1, 1, -1, -1)
"""Alike to itself when shifted in no other way than by whole turns (maximum-length sequence)."""
STEPS: Final[free_walker.Steps] = tuple(
    (
        HOLD_S * row,
        (0.3 + 0.15 * _ORDER[row], 0.1 * _ORDER[row - 10], 0.25 * _ORDER[row - 5]),
    )
    for row in range(len(_ORDER))
)
ODOMETRY_S: Final = 0.01
"""s between poses: one sample."""
AXES: Final = {"forward": ("mps", 0), "lateral": ("mps", 1), "yaw": ("radps", 2)}


@cache
def measured(steps: free_walker.Steps, latency_s: float, seconds: float) -> dict[str, Any]:
    every = round(ODOMETRY_S / free_walker.KEPT_S)
    robot, sent = free_walker.walker(steps, seconds, latency_s), free_walker.sent(steps, seconds)
    walk = physics.measured(robot, by_transforms=False, every=every, commands=sent)
    found: dict[str, Any] = walk.stats["commands"]
    return found


def true_velocity(robot: physics.Physics, axis: int) -> Floats:
    """(n,) of the base in its own axes, as the engine has it."""
    own = turned(inverse(robot.attitude), robot.base_velocity[:, 3:])
    return np.asarray(robot.base_velocity[:, 2] if axis == 2 else own[:, axis])


def over_a_stride(values: Floats, time: Floats) -> Floats:
    """(m,) means over the gait's period that is planned, about each of some times."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    half = round(physics.PERIOD_S / free_walker.KEPT_S / 2.0)
    rows = np.rint(time / free_walker.KEPT_S).astype(np.int64)
    return np.asarray(total[rows + half] - total[rows - half]) / (2.0 * half)


def true_errors(latency_s: float, axis: int) -> tuple[float, float]:
    """Mean and rms error, from the engine's states."""
    robot = free_walker.walker(STEPS, SECONDS, latency_s)
    time = np.arange(0.26, SECONDS - 0.26, 0.01)
    measured = over_a_stride(true_velocity(robot, axis), time)
    fine = np.arange(-1.0, SECONDS, free_walker.KEPT_S)
    sent = free_walker.sent(STEPS, SECONDS)
    last = np.searchsorted(sent.time, fine + 1e-9, side="right") - 1
    commanded = np.where(last >= 0, sent.velocity[np.maximum(last, 0), axis], 0.0)
    error = measured - over_a_stride(commanded, time + 1.0)
    return float(error.mean()), float(np.sqrt(np.square(error).mean()))


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("latency_s", [0.0, 0.3])
def test_tracking_is_that_of_the_engine(latency_s: float, axis: str) -> None:
    unit, column = AXES[axis]
    found = measured(STEPS, latency_s, SECONDS)[axis]
    mean, rms = true_errors(latency_s, column)
    assert found[f"mean_error_{unit}"] == pytest.approx(mean, abs=0.002)
    assert found[f"rms_error_{unit}"] == pytest.approx(rms, abs=0.002)


@pytest.mark.parametrize("ahead_mps", [0.4, 0.0], ids=["constant", "zero"])
def test_the_mean_while_a_command_never_changes(ahead_mps: float) -> None:
    steps: free_walker.Steps = ((-9.0, (ahead_mps, 0.0, 0.0)),)
    found = measured(steps, 0.1, 6.0)
    for axis, (unit, column) in AXES.items():
        figures = found[axis]
        robot = free_walker.walker(steps, 6.0, 0.1)
        true = over_a_stride(true_velocity(robot, column), np.arange(0.3, 5.7, 0.01)).mean()
        assert figures[f"measured_{unit}"] == pytest.approx(true, abs=0.003)
