"""Transforms of many frames, as a log recorded them."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, distinct
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class RecordedTransforms:
    """Transforms as recorded: one row each, in log order."""

    channel: Ints
    """(n,) channel id."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    parent: Ints
    """(n,) index into `parents`; also `child` into `children`."""
    parents: tuple[str, ...]
    """Frame ids as recorded."""
    child: Ints
    children: tuple[str, ...]
    translation: Floats
    """(n, 3) m."""
    rotation: Floats
    """(n, 4) quaternion x, y, z, w."""

    def pairs(self) -> set[tuple[str, str]]:
        """Return the different (parent, child) pairs of frames, as recorded."""
        count = max(len(self.children), 1)
        pairs = distinct(self.parent * count + self.child).tolist()
        return {(self.parents[pair // count], self.children[pair % count]) for pair in pairs}


def no_transforms() -> RecordedTransforms:
    """Return none."""
    rows: Ints = np.empty(0, np.int64)
    places, turns = np.empty((0, 3)), np.empty((0, 4))
    return RecordedTransforms(rows, rows, rows, rows, (), rows, (), places, turns)


def concatenate_transforms(parts: Sequence[RecordedTransforms]) -> RecordedTransforms:
    """Join transforms of several kinds of messages, in the order of their log times.

    Args:
        parts: at least one.
    """
    if len(parts) == 1:
        return parts[0]
    parent, parents = _one_code([(part.parent, part.parents) for part in parts])
    child, children = _one_code([(part.child, part.children) for part in parts])
    log_time = np.concatenate([part.log_time for part in parts])
    order = np.argsort(log_time, kind="stable")
    return RecordedTransforms(
        channel=np.concatenate([part.channel for part in parts])[order],
        log_time=log_time[order],
        stamp=np.concatenate([part.stamp for part in parts])[order],
        parent=parent[order],
        parents=parents,
        child=child[order],
        children=children,
        translation=np.concatenate([part.translation for part in parts])[order],
        rotation=np.concatenate([part.rotation for part in parts])[order],
    )


def _one_code(coded: Sequence[tuple[Ints, tuple[str, ...]]]) -> tuple[Ints, tuple[str, ...]]:
    """Join columns of coded names into one with a common code."""
    columns_of: dict[str, int] = {}
    columns = []
    for code, names in coded:
        common = [columns_of.setdefault(name, len(columns_of)) for name in names]
        columns.append(np.array(common, np.int64)[code])
    return np.concatenate(columns), tuple(columns_of)
