"""Checks of velocity commands and of how the base follows them."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.core.checks.wording import refused_messages
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

_NAMES: Final = {"forward": "forward speed", "lateral": "sideways speed", "yaw": "yaw rate"}


def refused(stats: Stats) -> Iterator[Finding]:
    """Yield commands that no robot can mean."""
    for each in stats.beside:
        if each.refused and each.topic == stats.settings.command_topic:
            text = refused_messages(each.topic, each.refused, each.messages)
            yield Finding("NOT_FINITE", text, each.topic, cases=("commands",))


def axes_unknown(stats: Stats) -> Iterator[Finding]:
    """Yield that the axes of the commands are not known."""
    track = stats.command_track
    if track is None or stats.commands is None or track.axes is not None:
        return
    frames = f" (their frame is {', '.join(track.history.frames)})" if track.history.frames else ""
    text = f"it cannot be told which axes the commands are in{frames}"
    yield Finding("COMMAND_AXES", text, "commands.axes", cases=("unknown",))


def opposed(stats: Stats) -> Iterator[Finding]:
    """Yield the axes of which the base does the opposite of the command."""
    for key, name in _NAMES.items():
        axis = getattr(stats.commands, key, None)
        if axis is not None and axis.is_opposed:
            text = f"the base's {name} does the opposite of its command"
            yield Finding("COMMAND_AXES", text, f"commands.{key}")


def on_log_time(stats: Stats) -> Iterator[Finding]:
    """Yield that commands are placed by log time."""
    track = stats.command_track
    if track is None or not track.history.on_log_time or stats.commands is None:
        return
    if stats.settings.clock is TimeSource.HEADER:
        text = (
            f"{track.history.topic} is placed by log time, since its messages have no header "
            "stamps of the base's clock: errors are also the recorder's delay"
        )
        yield Finding("LOG_TIME_USED", text, "commands.on_log_time", cases=("no_header",))


def no_command(stats: Stats) -> Iterator[Finding]:
    """Yield time without a command."""
    track, found = stats.command_track, stats.commands
    if track is None or found is None:
        return
    timeout_s = track.held.timeout_ns / 1e9
    if found.no_command_s > timeout_s:
        text = (
            f"there is no command for {found.no_command_s:.1f} s of "
            f"{found.no_command_s + found.commanded_s:.1f} s: a command holds for "
            f"{timeout_s:g} s without another"
        )
        yield Finding("NO_COMMAND", text, "commands.no_command_s")
