"""`info` for people and for scripts."""

from datetime import UTC, datetime
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from dogbot_logtool.info import LogInfo
from dogbot_logtool.printable import printable
from dogbot_logtool.report.console import human_size, print_damage, print_findings
from dogbot_logtool.report.damage import damage_json
from dogbot_logtool.report.frames_json import frames_json
from dogbot_logtool.report.frames_text import print_frame_names, print_frames
from dogbot_logtool.storage import shown

_SIMULATED_BEFORE_S = 1_000_000_000
"""Log times before this are simulation time, not dates."""
_MOST_TOPICS = 1000
"""Rows of the table; laying it out takes a millisecond each."""
_WIDE = 110
"""Columns from which types get a column of their own."""


def info_json(info: LogInfo) -> dict[str, Any]:
    """Return what is known of a log as plain values."""
    return {
        "path": shown(info.path),
        "size_bytes": info.size,
        "container": info.container,
        "profile": info.profile,
        "compressions": list(info.compressions),
        "start_time_ns": info.start_time,
        "duration_s": info.duration_s,
        "messages": info.messages,
        "chunks": info.chunks,
        "robot": info.robot,
        "topics": [
            {
                "topic": topic.topic,
                "type": topic.type_name,
                "encoding": topic.encoding,
                "messages": topic.messages,
                "rate_hz": topic.rate_hz,
                "senders": topic.senders,
                "use": topic.use or None,
            }
            for topic in info.topics
        ],
        "frames": frames_json(info),
        "findings": [
            {"code": f.code, "text": f.text, "where": f.where or None} for f in info.findings
        ],
        "damage": damage_json(info.losses),
    }


def print_info(console: Console, info: LogInfo) -> None:
    """Print what is known of a log."""
    console.print(Text(printable(shown(info.path)), style="bold"))
    console.print(_head(info))
    console.print(_topics(info, wide=console.width >= _WIDE))
    if (more := len(info.topics) - _MOST_TOPICS) > 0:
        console.print(f"  and {more:,} more topics; --json lists all")
    if info.frames is not None:
        print_frames(console, info, info.frames)
    elif info.parents or info.added_transform:
        print_frame_names(console, info)
    print_findings(console, info.findings)
    print_damage(console, info.losses)


def _head(info: LogInfo) -> Table:
    table = Table(box=None, show_header=False, padding=(0, 2, 0, 2))
    profile = f", profile {info.profile}" if info.profile else ""
    codecs = ", ".join(info.compressions) or "none"
    table.add_row("container", f"{info.container}{printable(profile)}, {human_size(info.size)}")
    table.add_row("chunks", f"{info.chunks}, compression {printable(codecs)}")
    if info.duration_s is not None and info.start_time is not None:
        table.add_row("duration", f"{info.duration_s:.3f} s from {_when(info.start_time)}")
    table.add_row("messages", f"{info.messages:,}")
    table.add_row("robot", info.robot)
    return table


def _when(time_ns: int) -> str:
    seconds = time_ns / 1e9
    if not _SIMULATED_BEFORE_S <= seconds < 1e11:
        return f"{seconds:.3f} s (simulation time)"
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S} UTC"


def _topics(info: LogInfo, *, wide: bool) -> Table:
    """Return the topics; on a narrow terminal the type stands below the topic."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("topic", overflow="fold")
    if wide:
        table.add_column("type", overflow="fold")
    table.add_column("count", justify="right", no_wrap=True)
    table.add_column("Hz", justify="right", no_wrap=True)
    table.add_column("used as", no_wrap=True)
    for topic in info.topics[:_MOST_TOPICS]:
        name = printable(topic.topic)
        if topic.senders > 1:
            name += f" ({topic.senders} senders)"
        kind = printable(topic.type_name) or "no type"
        names = [name, kind] if wide else [f"{name}\n  {kind}"]
        rate = "" if topic.rate_hz is None else f"{topic.rate_hz:.1f}"
        style = "" if topic.use else "dim"
        table.add_row(*names, f"{topic.messages:,}", rate, topic.use, style=style)
    return table
