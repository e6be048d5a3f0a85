"""The frame tree for people: a line a frame, as deep as it hangs."""

from collections.abc import Sequence
from typing import Final

from rich.console import Console
from rich.text import Text

from dogbot_logtool.core.frames.frame_tree import FrameEdge, Pair, TreeRow, walk
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.text.console import print_sentence
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
