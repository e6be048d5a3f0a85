"""Figures of how the base follows its velocity commands."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.report.figures.figure import Figure, Kind, Member, Scope, inside

# Loaded for logs with commands.
if TYPE_CHECKING:
    from dogbot_logtool.core.commands.tracking import AxisTracking, CommandTrack, Drift

_NO_AXIS: Final = (
    "no window of one stride is known of both command and base; of the horizontal parts also where "
    "the commands' axes cannot be told, or the odometry drifts among the contact points"
)


def _axis(unit: str, end: str) -> "Sequence[Figure[AxisTracking]]":
    """Return the figures of one part of the velocity."""
    return (
        Figure(
            f"commanded_{end}",
            Kind.NUMBER,
            lambda axis: axis.commanded_mean,
            "mean command, each held until the next, averaged over a stride like the measured",
            unit=unit,
        ),
        Figure(
            f"measured_{end}",
            Kind.NUMBER,
            lambda axis: axis.measured_mean,
            "mean velocity of the base in its own axes (yaw only), from poses, over the same time",
            unit=unit,
        ),
        Figure(
            f"mean_error_{end}",
            Kind.NUMBER,
            lambda axis: axis.mean_error,
            "mean of measured minus commanded velocity, both means over a stride, delays and all",
            unit=unit,
        ),
        Figure(
            f"rms_error_{end}",
            Kind.AMOUNT,
            lambda axis: axis.rms_error,
            "root mean square of the same",
            unit=unit,
        ),
    )


_DRIFT: "Final[Sequence[Figure[Drift]]]" = (
    Figure("duration_s", Kind.AMOUNT, lambda drift: drift.duration_s, "time that it is over"),
    Figure("forward_speed_mps", Kind.NUMBER, lambda drift: drift.forward, "mean velocity forward"),
    Figure(
        "lateral_speed_mps", Kind.NUMBER, lambda drift: drift.lateral, "mean velocity to the left"
    ),
    Figure(
        "yaw_rate_radps", Kind.NUMBER, lambda drift: drift.yaw_rate, "mean yaw rate, to the left"
    ),
)
_LASTING: Final = "has held for 1 s and a window, for 1 s in all"
_NO_DRIFT: Final = "the odometry drifts among the contact points"
COMMANDS_OF_SEGMENT: Final[Sequence[Member]] = (
    Figure(
        "commanded_s",
        Kind.AMOUNT,
        lambda tracking: tracking.commanded_s,
        "time with a command, of that known of the base",
    ),
    Figure(
        "no_command_s",
        Kind.AMOUNT,
        lambda tracking: tracking.no_command_s,
        "time without: before the first, and where commands are silent for longer than the "
        "time-out",
    ),
    Scope(
        "forward",
        _axis("m/s", "mps"),
        lambda tracking: tracking.forward,
        "velocity forward",
        null=_NO_AXIS,
    ),
    Scope(
        "lateral",
        _axis("m/s", "mps"),
        lambda tracking: tracking.lateral,
        "velocity to the left",
        null=_NO_AXIS,
    ),
    Scope(
        "yaw",
        _axis("rad/s", "radps"),
        lambda tracking: tracking.yaw,
        "yaw rate, to the left",
        null=_NO_AXIS,
    ),
    Scope(
        "straight",
        _DRIFT,
        lambda tracking: tracking.straight,
        "drift while straight ahead is commanded (0.05 m/s and more, and nothing else)",
        null=f"no such command {_LASTING}; {_NO_DRIFT}",
    ),
    Scope(
        "in_place",
        _DRIFT,
        lambda tracking: tracking.in_place,
        "drift while the robot steps and no motion is commanded",
        null=f"no such command {_LASTING}, while the robot steps; {_NO_DRIFT}",
    ),
)
"""Figures of a `Tracking`."""


_TRACK: "Final[Sequence[Figure[CommandTrack]]]" = (
    Figure("topic", Kind.TEXT, lambda track: track.history.topic, "topic of the commands"),
    Figure(
        "axes",
        Kind.TEXT,
        lambda track: track.axes,
        "what a command's x is: the robot's forward direction, or x of the base's frame; of two "
        "readings that with the smaller error",
        null="both readings are about as wrong; the commands are in a frame that stands still",
        choices=("forward", "body"),
    ),
    Figure(
        "window_s",
        Kind.AMOUNT,
        lambda track: track.window_ns / 1e9,
        "what velocities are averaged over: the usual stride period, 0.5 s without strides",
    ),
    Figure(
        "timeout_s",
        Kind.AMOUNT,
        lambda track: track.held.timeout_ns / 1e9,
        "a command holds for so long without another: 0.5 s, or five usual intervals",
    ),
    Figure(
        "on_log_time",
        Kind.FLAG,
        lambda track: track.history.on_log_time,
        "whether times of commands are log times, so that errors are also the recorder's delay",
    ),
    Figure(
        "refused",
        Kind.COUNT,
        lambda track: track.history.refused,
        "commands with a number that is not finite or beyond 1e6, left out",
    ),
)
COMMANDS: Final[Sequence[Member]] = (
    *inside(_TRACK, lambda stats: stats.command_track),
    *inside(COMMANDS_OF_SEGMENT, lambda stats: stats.commands),
)
"""Figures of `Stats` with commands."""


def with_commands(stats: Stats) -> Stats | None:
    """Return the figures of a log with commands; None for one without."""
    return stats if stats.command_track is not None else None
