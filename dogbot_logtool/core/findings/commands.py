"""Findings about velocity commands and how the base follows them."""

from collections.abc import Iterator

from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

_NAMES = {"forward": "forward speed", "lateral": "sideways speed", "yaw": "yaw rate"}
DRIFTS_MPS = 0.02
"""m/s; a robot that steps in place and moves faster drifts."""


def command_findings(stats: Stats) -> Iterator[Finding]:
    """Yield what is missing or doubtful in the figures of commands."""
    track, found = stats.command_track, stats.commands
    if track is None or found is None:
        return
    topic = track.history.topic
    if track.axes is None:
        frames = f" (their frame is {', '.join(track.history.frames)})"
        text = (
            "it cannot be told which axes the commands are in"
            f"{frames if track.history.frames else ''}: no figures of forward and sideways tracking"
        )
        yield Finding("W_COMMAND_AXES", text, "commands.axes")
    if track.history.on_log_time and stats.settings.clock is TimeSource.HEADER:
        text = (
            f"{topic} is placed by log time, since its messages have no header stamps of the "
            "base's clock: errors are also the recorder's delay"
        )
        yield Finding("N_COMMAND_LOG_TIME", text, "commands.on_log_time")
    if found.no_command_s > track.held.timeout_ns / 1e9:
        text = (
            f"there is no command for {found.no_command_s:.1f} s of "
            f"{found.no_command_s + found.commanded_s:.1f} s: a command holds for "
            f"{track.held.timeout_ns / 1e9:g} s without another"
        )
        yield Finding("N_NO_COMMAND", text, "commands.no_command_s")
    yield from _axes(stats)
    drift = found.in_place
    if drift is not None and (drift.forward**2 + drift.lateral**2) ** 0.5 > DRIFTS_MPS:
        text = (
            "the robot steps in place, as is commanded, and drifts: "
            f"{drift.forward:+.3f} m/s forward, {drift.lateral:+.3f} m/s to the left, "
            f"{drift.yaw_rate:+.3f} rad/s"
        )
        yield Finding("N_DRIFTS_IN_PLACE", text, "commands.in_place")


def _axes(stats: Stats) -> Iterator[Finding]:
    """Yield the axes of which the base does the opposite of the command."""
    for key, name in _NAMES.items():
        axis = getattr(stats.commands, key)
        if axis is not None and axis.is_opposed:
            text = f"the base's {name} does the opposite of its command"
            yield Finding("W_COMMAND_OPPOSED", text, f"commands.{key}")
