"""Recorded transforms, sorted by frame."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet

import numpy as np

from dogbot_logtool.core.clock import TimeSource
from dogbot_logtool.core.recorded_transforms import RecordedTransforms
from dogbot_logtool.core.transform_buffer import TransformBuffer


def static_tracks(recorded: RecordedTransforms, channels: AbstractSet[int]) -> TransformBuffer:
    """Return the transforms of channels whose transforms hold for ever."""
    buffer = TransformBuffer()
    held = np.isin(recorded.channel, list(channels))
    for (parent, child), rows in _rows_of_pairs(recorded).items():
        chosen = rows[held[rows]]
        buffer = buffer.add(
            parent,
            child,
            recorded.stamp[chosen],
            recorded.log_time[chosen],
            recorded.translation[chosen],
            recorded.rotation[chosen],
            static=True,
        )
    return buffer


def moving_tracks(
    recorded: RecordedTransforms, parents: Mapping[str, str], clock: TimeSource
) -> TransformBuffer:
    """Return the transforms of some frames.

    Args:
        recorded: transforms of any frames.
        parents: parent of each wanted frame, without leading slashes; transforms into another
            one are left out.
        clock: the clock that they are placed on.
    """
    buffer = TransformBuffer()
    time = clock.of(recorded)
    for (parent, child), rows in _rows_of_pairs(recorded).items():
        if parents.get(child) == parent:
            buffer = buffer.add(
                parent,
                child,
                time[rows],
                recorded.log_time[rows],
                recorded.translation[rows],
                recorded.rotation[rows],
            )
    return buffer


def _rows_of_pairs(
    recorded: RecordedTransforms,
) -> Mapping[tuple[str, str], np.ndarray[tuple[int], np.dtype[np.int64]]]:
    """Return the rows of each parent and child, without leading slashes."""
    pair = recorded.parent * max(len(recorded.children), 1) + recorded.child
    order = np.argsort(pair, kind="stable")
    numbers, starts = np.unique(pair[order], return_index=True)
    found: dict[tuple[str, str], list[np.ndarray[tuple[int], np.dtype[np.int64]]]] = {}
    for number, rows in zip(numbers.tolist(), np.split(order, starts[1:]), strict=False):
        parent = recorded.parents[number // len(recorded.children)].lstrip("/")
        child = recorded.children[number % len(recorded.children)].lstrip("/")
        found.setdefault((parent, child), []).append(rows)
    return {pair: np.sort(np.concatenate(rows)) for pair, rows in found.items()}
