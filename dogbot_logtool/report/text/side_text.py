"""Text on velocity commands and on the base's accelerometer."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.report.figures.figure import Json
from dogbot_logtool.report.numbers import decimal

_AXES: Final = (("forward", "mps", "m/s"), ("lateral", "mps", "m/s"), ("yaw", "radps", "rad/s"))


def command_lines(commands: Json) -> Iterator[tuple[str, str]]:
    """Yield a line for each part of the velocity, and for drifts: its name and what is known.

    Args:
        commands: the figures of `commands`.
    """
    for key, end, unit in _AXES:
        axis = commands[key]
        if axis is None:
            yield key, "not known"
            continue
        words = [f"error {decimal(axis[f'rms_error_{end}'], 3)} {unit} rms"]
        words.append(f"{_signed(axis[f'mean_error_{end}'])} {unit} mean")
        yield key, ", ".join(words)
    for key, name in (("straight", "straight"), ("in_place", "in place")):
        drift = commands[key]
        if drift is not None:
            yield name, _drift(drift)


def _drift(drift: Json) -> str:
    return (
        f"{_signed(drift['forward_speed_mps'])} m/s forward, "
        f"{_signed(drift['lateral_speed_mps'])} m/s to the left, "
        f"{_signed(drift['yaw_rate_radps'])} rad/s"
    )


def _signed(value: float) -> str:
    """Return a number with its sign; no minus before zero."""
    return f"{round(value, 3) + 0.0:+.3f}"


def imu_lines(imu: Json) -> Iterator[tuple[str, str]]:
    """Yield a line on what the accelerometer reads, and one on the forces.

    Args:
        imu: the figures of `imu`.
    """
    tilt = imu["tilt_rad"]
    yield (
        "accelerometer",
        f"{decimal(imu['accelerometer_mps2'], 3)} over strides"
        + ("" if tilt is None else f", tilt {tilt:.3f} rad"),
    )
    forces = imu["forces"]
    if forces is not None:
        yield "forces over it", f"{forces['over_accelerometer']:.3f}  (1 is right)"
