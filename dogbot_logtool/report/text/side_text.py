"""Text on velocity commands and on the base's accelerometer."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from dogbot_logtool.core.metrics import Commands, Imu
from dogbot_logtool.report.numbers import decimal

if TYPE_CHECKING:
    from dogbot_logtool.core.commands.tracking import Drift
    from dogbot_logtool.core.commands.tracking import Tracking as CommandTracking


def command_lines(
    commands: Commands, tracking: "CommandTracking | None"
) -> Iterator[tuple[str, str]]:
    """Yield a line for each part of the velocity, and for drifts: its name and what is known.

    Args:
        commands: the metrics.
        tracking: what drifts are taken from.
    """
    for name, axis in (("forward", commands.forward), ("lateral", commands.lateral)):
        yield name, _errors(axis.rms_error_mps, axis.mean_error_mps, "m/s")
    yaw = commands.yaw
    yield "yaw", _errors(yaw.rms_error_radps, yaw.mean_error_radps, "rad/s")
    if tracking is None:
        return
    for drift, name in ((tracking.straight, "straight"), (tracking.in_place, "in place")):
        if drift is not None:
            yield name, _drift(drift)


def _errors(rms: float | None, mean: float | None, unit: str) -> str:
    if rms is None or mean is None:
        return "not known"
    return f"error {decimal(rms, 3)} {unit} rms, {_signed(mean)} {unit} mean"


def _drift(drift: "Drift") -> str:
    return (
        f"{_signed(drift.forward)} m/s forward, "
        f"{_signed(drift.lateral)} m/s to the left, "
        f"{_signed(drift.yaw_rate)} rad/s"
    )


def _signed(value: float) -> str:
    """Return a number with its sign; no minus before zero."""
    return f"{round(value, 3) + 0.0:+.3f}"


def imu_lines(imu: Imu) -> Iterator[tuple[str, str]]:
    """Yield a line on what the accelerometer reads, and one on the forces."""
    tilt = imu.tilt_rad
    yield (
        "accelerometer",
        f"{decimal(imu.accelerometer_mps2, 3)} over strides"
        + ("" if tilt is None else f", tilt {tilt:.3f} rad"),
    )
    if imu.forces_over_accelerometer is not None:
        yield "forces over it", f"{imu.forces_over_accelerometer:.3f}  (1 is right)"
