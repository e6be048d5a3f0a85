"""The frame tree for people: a line a frame, as deep as it hangs."""

from typing import Final

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text
from rich.tree import Tree

from dogbot_logtool.core.frame_edges import FrameEdge
from dogbot_logtool.core.frame_tree import Pair, TreeRow, walk
from dogbot_logtool.frames import Frames
from dogbot_logtool.info import LogInfo
from dogbot_logtool.printable import printable

_ADDED: Final = "added by convert, from odometry"
_ARROW: Final = f"  <- {_ADDED}"
_WIDE: Final = 100
"""Columns from which it is said who sent the transforms."""
_NUMBERS: Final = 36
"""Columns that the numbers take."""
_SENDERS: Final = 20
"""Columns that the senders take at least."""


def frame_pairs(info: LogInfo) -> list[Pair]:
    """Return parent and child of every transform, the one that `convert` adds among them."""
    pairs = [(parent, child) for child, parents in info.parents.items() for parent in parents]
    return [*pairs, info.added_transform] if info.added_transform else pairs


def print_frame_names(console: Console, info: LogInfo) -> None:
    """Print the tree that a quick look shows."""
    tree = Tree("frames", guide_style="dim")
    branches = [tree]
    for row in walk(frame_pairs(info)):
        label = printable(row.frame)
        if (row.parent, row.frame) == info.added_transform:
            label += _ARROW
        del branches[len(row.more) + 1 :]
        branches.append(branches[-1].add(label + _remark(row)))
    console.print(tree)


def print_frames(console: Console, info: LogInfo, frames: Frames) -> None:
    """Print the tree with what all transforms say of each frame."""
    edges = {(edge.parent, edge.child): edge for edge in frames.recorded.edges}
    wide = console.width >= _WIDE
    rows = list(walk(frame_pairs(info)))
    names = []
    for row in rows:
        added = not wide and (row.parent, row.frame) == info.added_transform
        remark = _remark(row) + (_ARROW if added else "")
        names.append(Text.assemble((_guides(row), "dim"), printable(row.frame), (remark, "dim")))
    longest = max((name.cell_len for name in names), default=0)
    room = console.width - _NUMBERS - (_SENDERS if wide else 0)
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1))
    table.add_column("frame", overflow="fold", min_width=max(min(longest, room), 5))
    for heading in ("count", "Hz", "longest", "gaps"):
        table.add_column(heading, justify="right", no_wrap=True)
    if wide:
        table.add_column("sent by", overflow="fold")
    for row, name in zip(rows, names, strict=True):
        pair = (row.parent or "", row.frame)
        edge = edges.get(pair)
        cells = _cells(edge) if edge else [""] * 4
        table.add_row(name, *cells, *([_sent_by(info, frames, edge, pair)] if wide else []))
    console.print(table)


def _guides(row: TreeRow) -> str:
    if not row.more:
        return ""
    above = "".join("│   " if more else "    " for more in row.more[:-1])
    return above + ("├── " if row.more[-1] else "└── ")


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
