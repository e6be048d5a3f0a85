"""Text on velocity commands and on the base's accelerometer."""

from collections.abc import Iterator, Mapping

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.metrics import Commands, Imu
from dogbot_logtool.report.numbers import decimal


def command_lines(commands: Commands, drifts: Mapping[str, Floats]) -> Iterator[tuple[str, str]]:
    """Yield a line for each part of the velocity, and for drifts: its name and what is known.

    Args:
        commands: the metrics.
        drifts: (3,) m/s forward, m/s to the left and rad/s, by when it drifts so.
    """
    for name, axis in (("forward", commands.forward), ("lateral", commands.lateral)):
        yield name, _errors(axis.rms_error_mps, axis.mean_error_mps, "m/s")
    yaw = commands.yaw
    yield "yaw", _errors(yaw.rms_error_radps, yaw.mean_error_radps, "rad/s")
    for name, drift in drifts.items():
        forward, left, turning = map(_signed, drift.tolist())
        yield name, f"{forward} m/s forward, {left} m/s to the left, {turning} rad/s"


def _errors(rms: float | None, mean: float | None, unit: str) -> str:
    if rms is None or mean is None:
        return "not known"
    return f"error {decimal(rms, 3)} {unit} rms, {_signed(mean)} {unit} mean"


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
