"""Checks of velocity commands and of how the base follows them."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.core.checks.wording import counted
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding

_NAMES: Final = {"forward": "forward speed", "lateral": "sideways speed", "yaw": "yaw rate"}


def refused(stats: Stats) -> Iterator[Finding]:
    """Yield messages of commands or of the accelerometer that are left out for their numbers."""
    for each in stats.beside:
        if each.refused:
            case = "commands" if each.topic == stats.settings.command_topic else "imu"
            text = (
                f"{each.topic}: {counted(each.refused, 'message')} of {each.messages} with a "
                "number that is not finite or that no robot reaches; left out"
            )
            yield Finding("NOT_FINITE", text, each.topic, cases=(case,))


def command_axes(stats: Stats) -> Iterator[Finding]:
    """Yield that the commands' axes are not known, or that the base does the opposite."""
    track = stats.command_track
    if track is None:
        return
    if track.axes is None:
        frames = track.history.frames
        where = f" (their frame is {', '.join(frames)})" if frames else ""
        text = f"it cannot be told which axes the commands are in{where}"
        yield Finding("COMMAND_AXES", text, "commands.axes", cases=("unknown",))
    for axis in track.opposed:
        text = f"the base's {_NAMES[axis]} does the opposite of its command"
        yield Finding("COMMAND_AXES", text, f"commands.{axis}")


def on_log_time(stats: Stats) -> Iterator[Finding]:
    """Yield that commands are placed by log time."""
    track = stats.command_track
    if track and track.history.on_log_time and stats.settings.clock is TimeSource.HEADER:
        text = (
            f"{track.history.topic} is placed by log time, since its messages have no header "
            "stamps of the base's clock: errors are also the recorder's delay"
        )
        yield Finding("LOG_TIME_USED", text, "commands.on_log_time", cases=("no_header",))


def no_command(stats: Stats) -> Iterator[Finding]:
    """Yield time without a command."""
    track = stats.command_track
    if track is not None and track.no_command_s > track.timeout_ns / 1e9:
        text = (
            f"there is no command for {track.no_command_s:.1f} s of "
            f"{track.no_command_s + track.commanded_s:.1f} s: a command holds for "
            f"{track.timeout_ns / 1e9:g} s without another"
        )
        yield Finding("NO_COMMAND", text, "commands.no_command_s")
