"""`info` for people and for scripts."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

from rich.console import Console
from rich.text import Text

from dogbot_logtool.core.frames.frame_tree import (
    FrameEdge,
    Pair,
    TreeRow,
    loops,
    roots,
    second_parents,
    trees,
    walk,
)
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.documents import damage_json, finding_json
from dogbot_logtool.report.numbers import date_of
from dogbot_logtool.report.text.console import (
    human_size,
    print_damage,
    print_findings,
    print_sentence,
)
from dogbot_logtool.report.text.text_layout import NameTable, Row
from dogbot_logtool.results import LogInfo
from dogbot_logtool.robot.frames.frames import Frames

_ADDED: Final = "added by convert, from odometry"
_ARROW: Final = f"  <- {_ADDED}"
_WIDE: Final = 100
"""Columns from which it is said who sent the transforms."""
_DEEPER: Final = 4
"""Columns by which a remark on the next line stands right of the frame's name."""
_ASCII: Final = str.maketrans("│├└─", "|+`-")
_SENDERS: Final = 20
"""Columns that the senders take at least."""


def frame_pairs(info: LogInfo) -> list[Pair]:
    """Return parent and child of every transform, the one that `convert` adds among them."""
    pairs = [(parent, child) for child, parents in info.parents.items() for parent in parents]
    return [*pairs, info.added_transform] if info.added_transform else pairs


def print_frame_names(console: Console, info: LogInfo) -> None:
    """Print the tree that a quick look shows."""
    rows = list(walk(frame_pairs(info)))
    tops = [number for number, row in enumerate(rows) if not row.more]
    console.print("frames")
    for number, row in enumerate(rows):
        added = (row.parent, row.frame) == info.added_transform
        guides = _guides(console, (number < tops[-1], *row.more))
        name = printable(row.frame) + (_ARROW if added else "") + _remark(row)
        print_sentence(console, (guides, "dim"), name, indent=len(guides) + _DEEPER)


def print_frames(console: Console, info: LogInfo, frames: Frames) -> None:
    """Print the tree with what all transforms say of each frame."""
    edges = {(edge.parent, edge.child): edge for edge in frames.recorded.edges}
    wide = console.width >= _WIDE
    rows = []
    for row in walk(frame_pairs(info)):
        pair = (row.parent or "", row.frame)
        added = not wide and pair == info.added_transform
        remark = _remark(row) + (_ARROW if added else "")
        guides = _guides(console, row.more)
        name = Text.assemble((guides, "dim"), printable(row.frame), (remark, "dim"))
        edge = edges.get(pair)
        cells = _cells(edge) if edge else [""] * 4
        rows.append(Row([name], [*cells, *([_sent_by(info, frames, edge, pair)] if wide else [])]))
    headings = ("frame", "count", "Hz", "longest", "gaps", *(["sent by"] if wide else []))
    last = _SENDERS if wide else 0
    table = NameTable(headings, rows, (5,), wraps_last=last, margin=2, gap=3, is_ruled=True)
    console.print(table, crop=False)


def _guides(console: Console, more: Sequence[bool]) -> str:
    """Draw what leads to a frame, given whether more follows it and those above it."""
    if not more:
        return ""
    above = "".join("│   " if follows else "    " for follows in more[:-1])
    guides = above + ("├── " if more[-1] else "└── ")
    return guides.translate(_ASCII) if console.options.ascii_only else guides


def _remark(row: TreeRow) -> str:
    if row.cut:
        return "  ..."
    return "  (see above)" if row.again else ""


def _cells(edge: FrameEdge) -> list[str]:
    timing = edge.timing
    if timing is None:
        return [f"{edge.transforms:,}", "static", "", ""]
    intervals = timing.interval_s or {}
    return [
        f"{edge.transforms:,}",
        "" if timing.rate_hz is None else f"{timing.rate_hz:.1f}",
        milliseconds(intervals.get("max")),
        str(timing.gaps or "-"),
    ]


def milliseconds(interval_s: float | None) -> str:
    """Return an interval as people say it."""
    if interval_s is None:
        return ""
    return f"{interval_s * 1e3:.3g} ms" if interval_s < 1.0 else f"{interval_s:.3g} s"


def _sent_by(info: LogInfo, frames: Frames, edge: FrameEdge | None, pair: Pair) -> str:
    senders = [printable(sender) for sender in frames.senders(edge)] if edge else []
    if pair == info.added_transform:
        senders.append(_ADDED)
    return ", ".join(senders)


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
