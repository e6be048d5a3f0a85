"""A robot in a physics engine that follows velocity commands through a known latency."""

from collections.abc import Callable
from functools import cache
from typing import Any, Final

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth import free_walker, physics
from tests.truth.recording import Floats, inverse, turned

SECONDS: Final = 16.5
HOLD_S: Final = 1.1
"""s between changes: these meet the gait at 0, 10, ... 90 % of its stride, on which it depends how
soon the legs follow; so does each of `LATENCIES`."""
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
LATENCIES: Final = (0.0, 0.3)


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., dict[str, Any]]:
    @cache
    def commands(steps: free_walker.Steps, latency_s: float, seconds: float) -> dict[str, Any]:
        robot = free_walker.walker(steps, seconds, latency_s)
        path = tmp_path_factory.mktemp("commands") / "walk.mcap"
        physics.write_log(
            path,
            by_transforms=False,
            robot=robot,
            every=round(ODOMETRY_S / free_walker.KEPT_S),
            commands=free_walker.sent(steps, seconds),
        )
        stats = dl.measure(path, mass=robot.mass_kg).stats
        return {**stats["commands"], "findings": stats["findings"]}

    return commands


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


def true_tracking(latency_s: float, axis: int) -> tuple[float, float, float, float]:
    """Delay of the least squares and gain, mean and rms error, from the engine's states."""
    robot = free_walker.walker(STEPS, SECONDS, latency_s)
    time = np.arange(0.26, SECONDS - 0.26, 0.01)
    measured = over_a_stride(true_velocity(robot, axis), time)
    fine = np.arange(-1.0, SECONDS, free_walker.KEPT_S)
    sent = free_walker.sent(STEPS, SECONDS)
    last = np.searchsorted(sent.time, fine + 1e-9, side="right") - 1
    commanded = np.where(last >= 0, sent.velocity[np.maximum(last, 0), axis], 0.0)

    def command(late_s: float, at: Floats) -> Floats:
        return over_a_stride(commanded, at - late_s + 1.0)

    later = time > 1.3
    lags = np.arange(0.0, 0.5, free_walker.KEPT_S)
    fits = [np.polyfit(command(lag, time[later]), measured[later], 1) for lag in lags]
    rests = [
        np.square(measured[later] - np.polyval(fit, command(lag, time[later]))).sum()
        for lag, fit in zip(lags, fits, strict=True)
    ]
    best = int(np.argmin(rests))
    error = measured - command(0.0, time)
    return (
        float(lags[best]),
        float(fits[best][0]),
        float(error.mean()),
        float(np.sqrt(np.square(error).mean())),
    )


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("latency_s", [*LATENCIES, 0.34])
def test_tracking_is_that_of_the_engine(
    measured: Callable[..., dict[str, Any]], latency_s: float, axis: str
) -> None:
    unit, column = AXES[axis]
    found = measured(STEPS, latency_s, SECONDS)[axis]
    delay, gain, mean, rms = true_tracking(latency_s, column)
    assert found["delay_s"] == pytest.approx(delay, abs=ODOMETRY_S / 2.0)
    assert found["gain"] == pytest.approx(gain, rel=0.01)
    assert found[f"mean_error_{unit}"] == pytest.approx(mean, abs=0.002)
    assert found[f"rms_error_{unit}"] == pytest.approx(rms, abs=0.002)


@pytest.mark.parametrize("axis", AXES)
def test_latency_is_what_a_delay_grows_by(
    measured: Callable[..., dict[str, Any]], axis: str
) -> None:
    """Without latency the delay is the robot's own."""
    none, latency_s = LATENCIES
    own = measured(STEPS, none, SECONDS)[axis]
    found = measured(STEPS, latency_s, SECONDS)[axis]
    assert 0.0 < own["delay_s"] < 0.1
    grown = found["delay_s"] - own["delay_s"]
    assert grown == pytest.approx(latency_s, abs=ODOMETRY_S)
    unsure = own["delay_uncertainty_s"] + found["delay_uncertainty_s"]
    assert grown == pytest.approx(latency_s, abs=unsure)
    assert unsure < 0.04


@pytest.mark.parametrize("ahead_mps", [0.4, 0.0], ids=["constant", "zero"])
def test_a_command_that_never_changes_tells_no_delay(
    measured: Callable[..., dict[str, Any]], ahead_mps: float
) -> None:
    steps: free_walker.Steps = ((-9.0, (ahead_mps, 0.0, 0.0)),)
    found = measured(steps, 0.1, 6.0)
    for axis, (unit, column) in AXES.items():
        figures = found[axis]
        for name in ("delay_s", "delay_uncertainty_s", "gain", "correlation"):
            assert figures[name] is None
        robot = free_walker.walker(steps, 6.0, 0.1)
        true = over_a_stride(true_velocity(robot, column), np.arange(0.3, 5.7, 0.01)).mean()
        assert figures[f"measured_{unit}"] == pytest.approx(true, abs=0.003)
    (text,) = (f["text"] for f in found["findings"] if f["code"] == "N_COMMAND_DELAY_UNKNOWN")
    assert text.endswith("forward speed, sideways speed, yaw rate: the command hardly changes")
