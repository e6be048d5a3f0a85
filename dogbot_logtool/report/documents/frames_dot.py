"""The frame tree as a graph for Graphviz, as view_frames drew it."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.core.frames.frame_edges import FrameEdge
from dogbot_logtool.core.frames.frame_tree import Pair, loops, second_parents
from dogbot_logtool.io.printable import printable
from dogbot_logtool.pipeline.frames.frames import Frames
from dogbot_logtool.report.text.frames_text import frame_pairs, milliseconds
from dogbot_logtool.results import LogInfo

_BROKEN: Final = "#d55e00"
_ADDED: Final = "#0072b2"
_HEAD: Final = """\
  rankdir=LR;
  fontname="Helvetica";
  node [shape=box, style=rounded, fontname="Helvetica"];
  edge [fontname="Helvetica", fontsize=10];
"""


def frames_dot(info: LogInfo, frames: Frames) -> str:
    """Return the graph of a log's frames in the DOT language.

    Static transforms are dashed, the one that `convert` adds is blue, and what breaks the tree
    is red: loops, and several parents at once.
    """
    edges = {(edge.parent, edge.child): edge for edge in frames.recorded.edges}
    pairs = sorted({*frame_pairs(info)})
    nodes = {
        name: f"n{number}" for number, name in enumerate(sorted({n for p in pairs for n in p}))
    }
    broken = _broken(pairs, frames.recorded.edges)
    lines = [f"  {node} [label={_quoted(name)}];" for name, node in nodes.items()]
    for pair in pairs:
        attributes = _attributes(info, frames, edges.get(pair), pair)
        if pair in broken:
            attributes |= {"color": f'"{_BROKEN}"', "penwidth": "2"}
        listed = ", ".join(f"{name}={value}" for name, value in attributes.items())
        lines.append(f"  {nodes[pair[0]]} -> {nodes[pair[1]]} [{listed}];")
    title = _quoted(info.path.name)
    return f"digraph {title} {{\n{_HEAD}  label={title};\n" + "\n".join(lines) + "\n}\n"


def _broken(pairs: Sequence[Pair], edges: Sequence[FrameEdge]) -> set[Pair]:
    broken = {
        pair for loop in loops(pairs) for pair in zip(loop, [*loop[1:], loop[0]], strict=True)
    }
    for second in second_parents(edges):
        if second.at_once:
            broken |= {(parent, second.child) for parent in second.parents}
    return broken


def _attributes(
    info: LogInfo, frames: Frames, edge: FrameEdge | None, pair: Pair
) -> dict[str, str]:
    lines: list[str] = []
    attributes: dict[str, str] = {}
    if edge is not None:
        lines += [*_timing(edge), *frames.senders(edge)]
        if edge.is_static:
            attributes["style"] = "dashed"
    if pair == info.added_transform:
        lines.append("added by convert, from odometry")
        attributes |= {"color": f'"{_ADDED}"', "fontcolor": f'"{_ADDED}"'}
    return {"label": _quoted(*lines), **attributes}


def _timing(edge: FrameEdge) -> list[str]:
    timing = edge.timing
    if timing is None:
        return ["static"]
    count = f"{edge.transforms:,} transform{'s' if edge.transforms > 1 else ''}"
    lines = [count if timing.rate_hz is None else f"{timing.rate_hz:.1f} Hz, {count}"]
    if timing.gaps and timing.interval_s:
        longest = milliseconds(timing.interval_s["max"])
        lines.append(f"{timing.gaps} gap{'s' if timing.gaps > 1 else ''}, longest {longest}")
    return lines


def _quoted(*lines: str) -> str:
    """Return lines as a string of DOT that Graphviz shows as they are.

    In it a backslash begins an escape and an ampersand an HTML entity; a name from a log must be
    neither.
    """
    escaped = [
        printable(line).replace("\\", "\\\\").replace("&", "&amp;").replace('"', '\\"')
        for line in lines
    ]
    return '"' + "\\n".join(escaped) + '"'
