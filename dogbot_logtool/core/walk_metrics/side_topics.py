"""Metrics of what is recorded beside feet and base: velocity commands and the accelerometer."""

from dataclasses import replace

from dogbot_logtool.core.metrics import Commands, Imu
from dogbot_logtool.core.records import unknown
from dogbot_logtool.core.statistics import Stats


def commands_metrics(stats: Stats) -> Commands:
    """Return how the base follows its velocity commands over the whole log."""
    if stats.command_track is None:
        return replace(unknown(Commands), topic=stats.settings.command_topic or None)
    return stats.command_track.metrics()


def imu_metrics(stats: Stats) -> Imu:
    """Return what the accelerometer says of forces and poses."""
    return unknown(Imu) if stats.imu is None else stats.imu.metrics()
