"""`info` for people and for scripts."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from rich.console import Console
from rich.text import Text

from dogbot_logtool.core.frames.transforms import (
    Edge,
    FrameEdge,
    TreeRow,
    loops,
    roots,
    second_parents,
    trees,
    walk,
)
from dogbot_logtool.io.printable import listed, printable
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.report.documents import damage_json, finding_json
from dogbot_logtool.report.tables import recorded_at
from dogbot_logtool.report.text.console import (
    NameTable,
    Row,
    human_size,
    print_damage,
    print_findings,
    print_sentence,
)
from dogbot_logtool.results import LogInfo
from dogbot_logtool.robot.frames import Frames

_DEEPER: Final = 6
"""Columns by which the second line of a frame is indented."""
_ASCII: Final = str.maketrans("│├└─", "|+`-")
_MOST_TOPICS: Final = 1000
"""Rows of the table."""


def frame_pairs(info: LogInfo) -> list[Edge]:
    """Return parent and child of every transform, the one that `convert` adds among them."""
    pairs = [(parent, child) for child, parents in info.parents.items() for parent in parents]
    return [*pairs, info.added_transform] if info.added_transform else pairs


def _print_frames(console: Console, info: LogInfo) -> None:
    """Print the tree of frames, with what all transforms say of each if all were read."""
    rows = list(walk(frame_pairs(info)))
    names = [_frame_name(console, info, row) for row in rows]
    if info.frames is None:
        console.print("frames")
        for name in names:
            print_sentence(console, "  ", name, indent=_DEEPER)
        return
    edges = {(edge.parent, edge.child): edge for edge in info.frames.edges}
    found = [edges.get((row.parent or "", row.frame)) for row in rows]
    cells = [_cells(edge) if edge else [""] * 4 for edge in found]
    sent_by = [listed(info.frames.senders(edge), 2) if edge else "" for edge in found]
    headings = ("frame", "count", "Hz", "longest", "gaps", "sent by")
    each_row = zip(names, cells, sent_by, strict=True)
    lines = [Row([name], [*numbers, printable(by)]) for name, numbers, by in each_row]
    table = NameTable(headings, lines, (5,), margin=2, gap=3, is_ruled=True)
    if table.width > console.width:
        lines = [Row(line.names, line.cells[:-1]) for line in lines]
        table = replace(table, headings=headings[:-1], rows=lines)
    console.print(table, crop=False)


def _frame_name(console: Console, info: LogInfo, row: TreeRow) -> Text:
    """Return a frame behind what leads to it in the tree."""
    guides = "".join("│   " if follows else "    " for follows in row.more[:-1])
    guides += "├── " if row.more[-1:] == (True,) else "└── " if row.more else ""
    remark = "  ..." if row.cut else "  (see above)" if row.again else ""
    if (row.parent, row.frame) == info.added_transform:
        remark += "  <- added by convert, from odometry"
    drawn = guides.translate(_ASCII) if console.options.ascii_only else guides
    return Text.assemble((drawn, "dim"), printable(row.frame), (remark, "dim"))


def _cells(edge: FrameEdge) -> list[str]:
    timing = edge.timing
    if timing is None:
        return [f"{edge.transforms:,}", "static", "", ""]
    return [
        f"{edge.transforms:,}",
        "" if timing.rate_hz is None else f"{timing.rate_hz:.1f}",
        _milliseconds(timing.interval_max_s),
        str(timing.gaps or "-"),
    ]


def _milliseconds(interval_s: float | None) -> str:
    if interval_s is None:
        return ""
    return f"{interval_s * 1e3:.3g} ms" if interval_s < 1.0 else f"{interval_s:.3g} s"


def info_json(info: LogInfo) -> dict[str, Any]:
    """Return what is known of a log as plain values."""
    return {
        "path": name_of(info.path),
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
    print_sentence(console, (printable(name_of(info.path)), "bold"))
    print_damage(console, info.damage)
    for name, value in _head(info):
        print_sentence(console, f"  {name:<11}  {printable(value)}", indent=15)
    console.print(_topics(info, console.width), crop=False)
    if (more := len(info.topics) - _MOST_TOPICS) > 0:
        print_sentence(console, f"  and {more:,} more topics; --json lists all")
    if info.frames is not None or info.parents or info.added_transform:
        _print_frames(console, info)
    print_findings(console, info.findings)


def _head(info: LogInfo) -> Iterator[tuple[str, str]]:
    profile = f", profile {info.profile}" if info.profile else ""
    codecs = ", ".join(info.compressions) or "none"
    yield "container", f"{info.container}{profile}, {human_size(info.size)}"
    yield "chunks", f"{info.chunks}, compression {codecs}"
    if info.duration_s is not None and info.start_time is not None:
        yield "duration", f"{info.duration_s:.3f} s from {recorded_at(info.start_time / 1e9)}"
    yield "messages", f"{info.messages:,}"
    yield "robot", info.robot


def _topics(info: LogInfo, width: int) -> NameTable:
    """Return the topics; where the types have no room beside them, they stand below."""
    rows, below = [], []
    for topic in info.topics[:_MOST_TOPICS]:
        senders = f" ({topic.senders} senders)" if topic.senders > 1 else ""
        name, kind = printable(topic.topic) + senders, printable(topic.type_name) or "no type"
        rate = "" if topic.rate_hz is None else f"{topic.rate_hz:.1f}"
        cells = [f"{topic.messages:,}", rate, printable(topic.use)]
        style = "" if topic.use else "dim"
        rows.append(Row([name], [kind, *cells], style))
        below.append(Row([name, f"  {kind}"], cells, style))
    headings = ("topic", "type", "count", "Hz", "used as")
    wide = NameTable(headings, rows, left=(1, 4), margin=2, gap=3, is_ruled=True)
    if wide.width <= width:
        return wide
    return replace(wide, headings=("topic", *headings[2:]), rows=below, left=(3,))


def frames_json(info: LogInfo) -> dict[str, Any]:
    """Return what is known of a log's frames as plain values; null what only all transforms tell.

    `roots`, `trees` and `loops` are those of the tree with the transform that `convert` adds.
    """
    pairs = sorted({*frame_pairs(info)})
    frames = info.frames
    second = [] if frames is None else second_parents(frames.edges)
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
        "edges": None if frames is None else [_edge(edge, frames) for edge in frames.edges],
    }


def _edge(edge: FrameEdge, frames: Frames) -> dict[str, Any]:
    timing = edge.timing
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
        "median_interval_s": timing and timing.interval_s,
        "longest_interval_s": timing and timing.interval_max_s,
        "gaps": timing and timing.gaps,
        "gaps_total_s": timing and timing.gaps_total_s,
        "repeated_stamps": timing and timing.duplicate_stamps,
        "backward_stamps": timing and timing.backward_stamps,
        "zero_stamps": timing and timing.zero_stamps,
        "not_finite": edge.not_finite,
        "zero_rotations": edge.zero_rotations,
        "not_normalised": edge.not_normalised,
    }
