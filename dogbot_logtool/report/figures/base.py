"""Figures of the motion of the base."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.core.base.base_motion import BaseMotion
from dogbot_logtool.report.figures.figure import Column, Figure, Kind, TableName

_SUMMARY, _INDEX, _LOG_ROWS = TableName.SUMMARY, TableName.INDEX, TableName.LOG_ROWS
_NO_TIME: Final = "no time lies between the poses"
_LOST: Final = "the base drifts among the contact points by more than 2 % of its way"

BASE: Final[Sequence[Figure[BaseMotion]]] = (
    Figure(
        "duration_s", Kind.NUMBER, lambda base: base.duration_s, "first to last pose, gaps left out"
    ),
    Figure(
        "path_length_m",
        Kind.NUMBER,
        lambda base: base.path_length_m,
        "horizontal way of the base above the noise of its poses, without gaps, jumps and stands",
        null=_LOST,
        columns=(
            Column(_INDEX, "distance m", 2, rank=40),
            Column(_LOG_ROWS, "path_length_m", rank=60),
        ),
    ),
    Figure(
        "net_displacement_m",
        Kind.NUMBER,
        lambda base: base.net_displacement_m,
        "horizontal distance of the last pose from the first",
        null=_LOST,
    ),
    Figure(
        "mean_speed_mps",
        Kind.NUMBER,
        lambda base: base.mean_speed_mps,
        "path length / duration",
        null=f"{_NO_TIME}; {_LOST}",
    ),
    Figure(
        "forward_speed_mps",
        Kind.NUMBER,
        lambda base: base.forward_speed_mps,
        "mean rate of displacement along the body's forward axis, turned by yaw only",
        null=f"{_NO_TIME}; {_LOST}",
        columns=(
            Column(_SUMMARY, "m/s", 3, rank=40),
            Column(_INDEX, "m/s forward", 3, rank=50),
            Column(_LOG_ROWS, "forward_speed_mps", rank=50),
        ),
    ),
    Figure(
        "lateral_speed_mps",
        Kind.NUMBER,
        lambda base: base.lateral_speed_mps,
        "the same to the left of the forward axis",
        null=f"{_NO_TIME}; {_LOST}",
    ),
    Figure(
        "yaw_change_rad",
        Kind.NUMBER,
        lambda base: base.yaw_change_rad,
        "last yaw minus first, unwrapped, jumps left out",
    ),
    Figure(
        "yaw_rate_radps",
        Kind.NUMBER,
        lambda base: base.yaw_rate_radps,
        "mean rate of turning to the left",
        null=f"{_NO_TIME}; {_LOST}",
    ),
    Figure(
        "height_m",
        Kind.AGGREGATE,
        lambda base: base.height_m,
        "height of the base over the latest contact points of the feet",
        null="no contact points in the world of the odometry, or the base rises or sinks steadily "
        "against them",
    ),
    Figure(
        "climb_m",
        Kind.NUMBER,
        lambda base: base.climb_m,
        "z of the last pose minus z of the first",
        null="the base rises or sinks steadily against the contact points",
    ),
    Figure(
        "slope_rad",
        Kind.NUMBER,
        lambda base: base.slope_rad,
        "angle between the plane through the contact points and the horizontal",
        null="too few contact points, or they lie on a line",
    ),
    Figure(
        "roll_rad",
        Kind.AGGREGATE,
        lambda base: base.roll_rad,
        "roll of the base about its forward axis",
        null="no pose is finite",
    ),
    Figure(
        "pitch_rad",
        Kind.AGGREGATE,
        lambda base: base.pitch_rad,
        "pitch of the base about the axis to the left of its forward axis",
        null="no pose is finite",
    ),
    Figure(
        "froude",
        Kind.NUMBER,
        lambda base: base.froude,
        "v^2 / (g h), v the mean forward speed, h the mean height over the feet (Alexander 1984)",
        null=f"{_NO_TIME}; the height is not known or below 1 mm",
    ),
)
"""Figures of the motion of the base: from poses, never from the recorded twist."""
