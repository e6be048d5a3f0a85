"""The frame tree for scripts."""

from typing import Any

from dogbot_logtool.core.frames.frame_edges import FrameEdge
from dogbot_logtool.core.frames.frame_tree import loops, roots, second_parents, trees
from dogbot_logtool.pipeline.frames.frames import Frames
from dogbot_logtool.report.text.frames_text import frame_pairs
from dogbot_logtool.results import LogInfo


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
