"""Checks of velocity commands and of how the base follows them."""

from collections.abc import Iterator
from typing import Final

from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, found

_NAMES: Final = {"forward": "forward speed", "lateral": "sideways speed", "yaw": "yaw rate"}


def refused(walk: Walk) -> Iterator[Finding]:
    """Yield messages of commands or of the accelerometer that are left out for their numbers."""
    for each in walk.beside:
        if each.refused:
            case = "commands" if each.topic == walk.settings.command_topic else "imu"
            topic, count, of = each.topic, each.refused, each.messages
            yield found("NOT_FINITE", case, say="beside", topic=topic, refused=count, messages=of)


def followed(walk: Walk) -> Iterator[Finding]:
    """Yield what is odd in the commands' axes and times, and where the base does the opposite."""
    track = walk.command_track
    if track is None:
        return
    if track.axes is None:
        names = ", ".join(track.history.frames)
        frames = f" (their frame is {names})" if names else ""
        yield found("COMMAND_AXES", "unknown", where="commands.axes", frames=frames)
    for axis in track.opposed:
        yield found("COMMAND_AXES", where=f"commands.{axis}", axis=_NAMES[axis])
    if track.history.on_log_time and walk.settings.clock is TimeSource.HEADER:
        where, topic = "commands.on_log_time", track.history.topic
        yield found("LOG_TIME_USED", "no_header", where=where, topic=topic)
    without, timeout = track.no_command_s, track.timeout_ns / 1e9
    if without > timeout:
        seconds = without + track.commanded_s
        where = "commands.no_command_s"
        yield found("NO_COMMAND", where=where, without=without, seconds=seconds, timeout=timeout)
