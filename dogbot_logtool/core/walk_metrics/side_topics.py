"""Metrics of what is recorded beside feet and base: velocity commands and the accelerometer."""

from dataclasses import replace
from typing import TYPE_CHECKING

from dogbot_logtool.core.metrics import Commands, Imu, Tracking, Turning
from dogbot_logtool.core.records import unknown
from dogbot_logtool.core.statistics import Stats

if TYPE_CHECKING:
    from dogbot_logtool.core.commands.tracking import AxisTracking


def commands_metrics(stats: Stats) -> Commands:
    """Return how the base follows its velocity commands over the whole log."""
    track, found = stats.command_track, stats.commands
    if track is None or found is None:
        return replace(unknown(Commands), topic=stats.settings.command_topic or None)
    return Commands(
        topic=track.history.topic,
        commanded_s=found.commanded_s,
        forward=_tracking(found.forward),
        lateral=_tracking(found.lateral),
        yaw=_turning(found.yaw),
    )


def _tracking(axis: "AxisTracking | None") -> Tracking:
    if axis is None:
        return unknown(Tracking)
    return Tracking(
        commanded_mps=axis.commanded_mean,
        measured_mps=axis.measured_mean,
        mean_error_mps=axis.mean_error,
        rms_error_mps=axis.rms_error,
    )


def _turning(axis: "AxisTracking | None") -> Turning:
    if axis is None:
        return unknown(Turning)
    return Turning(
        commanded_radps=axis.commanded_mean,
        measured_radps=axis.measured_mean,
        mean_error_radps=axis.mean_error,
        rms_error_radps=axis.rms_error,
    )


def imu_metrics(stats: Stats) -> Imu:
    """Return what the accelerometer says of forces and poses."""
    imu = stats.imu
    if imu is None:
        return unknown(Imu)
    return Imu(
        topic=imu.sensed.topic,
        known_s=imu.known_s,
        accelerometer_mps2=imu.imu_mps2,
        tilt_rad=imu.mounting.tilt_rad,
        forces_over_accelerometer=None if imu.forces is None else imu.forces.ratio,
    )
