"""`info` for people and for scripts."""

from collections.abc import Iterator
from typing import Any

from rich.console import Console

from dogbot_logtool.core.frames.frame_tree import (
    FrameEdge,
    loops,
    roots,
    second_parents,
    trees,
)
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.documents.damage import damage_json
from dogbot_logtool.report.documents.finding_json import finding_json
from dogbot_logtool.report.numbers import date_of
from dogbot_logtool.report.text.console import (
    human_size,
    print_damage,
    print_findings,
    print_sentence,
)
from dogbot_logtool.report.text.frames_text import frame_pairs, print_frame_names, print_frames
from dogbot_logtool.report.text.text_layout import NameTable, Row
from dogbot_logtool.results import LogInfo
from dogbot_logtool.robot.frames.frames import Frames

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
        "damage": damage_json(info.damage),
    }


def print_info(console: Console, info: LogInfo) -> None:
    """Print what is known of a log."""
    print_sentence(console, (printable(shown(info.path)), "bold"))
    print_damage(console, info.damage)
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
    date = date_of(time_ns / 1e9)
    return f"{date:%Y-%m-%d %H:%M:%S} UTC" if date else f"{time_ns / 1e9:.3f} s (simulation time)"


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


def frames_json(info: LogInfo) -> dict[str, Any]:
    """Return what is known of a log's frames as plain values; null what only all transforms tell.

    `roots`, `trees` and `loops` are those of the tree with the transform that `convert` adds.
    """
    pairs = sorted({*frame_pairs(info)})
    frames = info.frames
    second = [] if frames is None else second_parents(frames.recorded.edges)
    return {
        "parents": {child: sorted(parents) for child, parents in info.parents.items()},
        "added": list(info.added_transform) if info.added_transform else None,
        "chunks_seen": info.chunks_seen,
        "roots": roots(pairs),
        "trees": trees(pairs),
        "loops": loops(pairs),
        "second_parents": None
        if frames is None
        else [
            {"frame": one.child, "parents": list(one.parents), "at_once": one.at_once}
            for one in second
        ],
        "edges": None
        if frames is None
        else [_edge(edge, frames) for edge in frames.recorded.edges],
    }


def _edge(edge: FrameEdge, frames: Frames) -> dict[str, Any]:
    timing = edge.timing
    intervals = (timing and timing.interval_s) or {}
    return {
        "parent": edge.parent,
        "child": edge.child,
        "static": edge.is_static,
        "transforms": edge.transforms,
        "static_transforms": edge.static,
        "sent_by": frames.senders(edge),
        "clock": timing and timing.clock,
        "first_time_ns": timing.first if timing else edge.first_log_time,
        "last_time_ns": timing.last if timing else edge.last_log_time,
        "rate_hz": timing and timing.rate_hz,
        "median_interval_s": intervals.get("p50"),
        "longest_interval_s": intervals.get("max"),
        "gaps": timing and timing.gaps,
        "gaps_total_s": timing and timing.gaps_total_s,
        "repeated_stamps": timing and timing.duplicate_stamps,
        "backward_stamps": timing and timing.backward_stamps,
        "zero_stamps": timing and timing.zero_stamps,
        "not_finite": edge.not_finite,
        "zero_rotations": edge.zero_rotations,
        "not_normalised": edge.not_normalised,
    }
