"""Arithmetic on time spans: what is known, in contact, common to all feet.

Spans are an (n, 2) int64 array of start and end, ns, sorted, disjoint, each half open.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, distinct, flagged_runs

ALWAYS: Final = np.array([[-(1 << 62), 1 << 62]])
"""The span of a whole log."""


def no_spans() -> Ints:
    """Return an empty table of spans."""
    return np.empty((0, 2), np.int64)


def total(spans: Ints) -> int:
    """Return the time that spans cover, ns."""
    return int((spans[:, 1] - spans[:, 0]).sum())


def covers(spans: Ints, time: Ints) -> Flags:
    """Tell which times lie in a span; a start belongs to its span, an end does not."""
    inside: Flags = (np.searchsorted(spans.ravel(), time, side="right") & 1).astype(np.bool_)
    return inside


def hold_window(spans: Ints, time: Ints, before_ns: int | Ints, after_ns: int | Ints) -> Flags:
    """Tell of which times the window about them lies in one span.

    Args:
        spans: (n, 2) ns.
        time: (m,) ns.
        before_ns: ns from a window's start to its time; (m,) or the same of all.
        after_ns: ns from there to its end, likewise.
    """
    if len(spans) == 0:
        return np.zeros(time.shape, np.bool_)
    row = np.searchsorted(spans[:, 0], time - before_ns, side="right") - 1
    held: Flags = (row >= 0) & (time + after_ns <= spans[np.maximum(row, 0), 1])
    return held


def covered(spans: Ints, edges: Ints) -> Floats:
    """Return how much of each cell between an edge and the next lies in spans.

    Args:
        spans: (n, 2) ns.
        edges: (m + 1,) ns, sorted.

    Returns:
        (m,) ns.
    """
    if len(spans) == 0:
        return np.zeros(len(edges) - 1)
    knots = spans.ravel()
    # Time covered so far, at each edge of a span and, interpolated, at each edge of a cell.
    so_far = np.zeros(len(knots), np.int64)
    so_far[1::2] = np.cumsum(spans[:, 1] - spans[:, 0])
    so_far[2::2] = so_far[1:-1:2]
    at = np.interp(edges - edges[0], knots - edges[0], so_far.astype(np.float64))
    inside: Floats = np.diff(at)
    return inside


def ticks(spans: Ints, tick: int) -> Ints:
    """(n,) ns, whole multiples of a tick that lie in spans; memory is that of the spans' time."""
    first, last = -(-spans[:, 0] // tick), -(-spans[:, 1] // tick)
    parts = [np.arange(a, b) for a, b in zip(first.tolist(), last.tolist(), strict=True)]
    inside: Ints = np.concatenate([np.empty(0, np.int64), *parts]) * tick
    return inside


def intersect(spans: Sequence[Ints]) -> Ints:
    """Return the time that lies in all of the given spans; nothing of nothing."""
    if not spans or any(len(each) == 0 for each in spans):
        return no_spans()
    edges = distinct(np.concatenate([each.ravel() for each in spans]))
    held = np.ones(max(0, len(edges) - 1), np.bool_)
    for each in spans:
        held &= covers(each, edges[:-1])
    return spans_where(edges, held)


def subtract(spans: Ints, removed: Ints) -> Ints:
    """Return the time that lies in `spans` but not in `removed`."""
    edges = distinct(np.concatenate([spans.ravel(), removed.ravel()]))
    held = covers(spans, edges[:-1]) & ~covers(removed, edges[:-1])
    return spans_where(edges, held)


def spans_where(edges: Ints, held: Flags) -> Ints:
    """Join neighbouring cells that hold into spans.

    Args:
        edges: (n + 1,) sorted, ns.
        held: (n,) for the cell between each edge and the next.
    """
    return edges[flagged_runs(held)]


def steps_where(time: Ints, held: Flags) -> Ints:
    """(k, 2) ns, the steps that hold, each by itself, of (n - 1,) from each time to the next."""
    return np.stack([time[:-1][held], time[1:][held]], axis=1)


def merge(spans: Ints) -> Ints:
    """Sort spans and join those that overlap or touch."""
    spans = spans[spans[:, 1] > spans[:, 0]]
    if len(spans) == 0:
        return no_spans()
    spans = spans[np.argsort(spans[:, 0], kind="stable")]
    reach = np.maximum.accumulate(spans[:, 1])
    first = np.concatenate([[True], spans[1:, 0] > reach[:-1]])
    last = np.concatenate([first[1:], [True]])
    return np.stack([spans[first, 0], reach[last]], axis=1)


def touches(spans: Ints, start: Ints, end: Ints) -> Flags:
    """Tell which closed spans [start, end] share time, or an instant, with any of `spans`."""
    if len(spans) == 0:
        return np.zeros(len(start), np.bool_)
    after = np.searchsorted(spans[:, 1], start, side="left")
    found: Flags = after < len(spans)
    found &= spans[np.minimum(after, len(spans) - 1), 0] < end
    return found
