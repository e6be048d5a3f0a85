"""`info` for people and for scripts."""

from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Any

from rich.console import Console

from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.documents.damage import damage_json
from dogbot_logtool.report.documents.frames_json import frames_json
from dogbot_logtool.report.figures.recording import finding_json
from dogbot_logtool.report.text.console import (
    human_size,
    print_damage,
    print_findings,
    print_sentence,
)
from dogbot_logtool.report.text.frames_text import print_frame_names, print_frames
from dogbot_logtool.report.text.text_layout import NameTable, Row
from dogbot_logtool.results import LogInfo

_SIMULATED_BEFORE_S = 1_000_000_000
_NEVER_S = 3e10
"""Log times before this are simulation time, not dates."""
_MOST_TOPICS = 1000
"""Rows of the table; laying it out takes a millisecond each."""


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
        "findings": [finding_json(each) for each in info.findings],
        "damage": damage_json(info.losses),
    }


def print_info(console: Console, info: LogInfo) -> None:
    """Print what is known of a log."""
    print_sentence(console, (printable(shown(info.path)), "bold"))
    for name, value in _head(info):
        print_sentence(console, f"  {name:<11}  {printable(value)}", indent=15)
    console.print(_topics(info, console.width), crop=False)
    if (more := len(info.topics) - _MOST_TOPICS) > 0:
        print_sentence(console, f"  and {more:,} more topics; --json lists all")
    if info.frames is not None:
        print_frames(console, info, info.frames)
    elif info.parents or info.added_transform:
        print_frame_names(console, info)
    print_findings(console, info.findings)
    print_damage(console, info.losses)


def _head(info: LogInfo) -> Iterator[tuple[str, str]]:
    profile = f", profile {info.profile}" if info.profile else ""
    codecs = ", ".join(info.compressions) or "none"
    yield "container", f"{info.container}{profile}, {human_size(info.size)}"
    yield "chunks", f"{info.chunks}, compression {codecs}"
    if info.duration_s is not None and info.start_time is not None:
        yield "duration", f"{info.duration_s:.3f} s from {_when(info.start_time)}"
    yield "messages", f"{info.messages:,}"
    yield "robot", info.robot


def _when(time_ns: int) -> str:
    seconds = time_ns / 1e9
    if not _SIMULATED_BEFORE_S <= seconds < _NEVER_S:
        return f"{seconds:.3f} s (simulation time)"
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S} UTC"


def _topics(info: LogInfo, width: int) -> NameTable:
    """Return the topics; where the types have no room beside them, they stand below."""
    wide = _topic_table(info, types_beside=True)
    return wide if wide.width <= width else _topic_table(info, types_beside=False)


def _topic_table(info: LogInfo, *, types_beside: bool) -> NameTable:
    rows = []
    for topic in info.topics[:_MOST_TOPICS]:
        name = printable(topic.topic)
        if topic.senders > 1:
            name += f" ({topic.senders} senders)"
        kind = printable(topic.type_name) or "no type"
        rate = "" if topic.rate_hz is None else f"{topic.rate_hz:.1f}"
        cells = [f"{topic.messages:,}", rate, printable(topic.use)]
        style = "" if topic.use else "dim"
        if types_beside:
            rows.append(Row([name], [kind, *cells], style))
        else:
            rows.append(Row([name, f"  {kind}"], cells, style))
    headings = ("topic", *(["type"] if types_beside else []), "count", "Hz", "used as")
    left = (1, 4) if types_beside else (3,)
    return NameTable(headings, rows, left=left, margin=2, gap=3, is_ruled=True)
