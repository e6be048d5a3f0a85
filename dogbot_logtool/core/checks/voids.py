"""What findings void in tables by stride or stance, by the same patterns as in metrics."""

from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.finding import Finding

_METRICS: Final[Mapping[str, Sequence[str]]] = {
    "length_m": ("feet.{foot}.stride_length_m",),
    "absolute_work_j": ("legs.absolute_work_j",),
    "positive_work_j": ("feet.{foot}.positive_work_j", "legs.absolute_work_j"),
}
"""Metrics that void columns, where these are not the foot's of the same name."""


def void_patterns(findings: Iterable[Finding]) -> tuple[str, ...]:
    """Return all patterns of metrics that findings void."""
    return tuple(dict.fromkeys(pattern for each in findings for pattern in each.voids))


def void_columns(
    columns: Mapping[str, Floats], foot: str, patterns: Sequence[str]
) -> Mapping[str, Floats]:
    """Set to NaN what is voided of a foot's strides or stances.

    Args:
        columns: (n,) values by the column's name.
        foot: its name.
        patterns: of the metrics that are void.
    """
    return {
        name: np.full(len(values), np.nan) if _is_void(name, foot, patterns) else values
        for name, values in columns.items()
    }


def _is_void(column: str, foot: str, patterns: Sequence[str]) -> bool:
    metrics = _METRICS.get(column, ("feet.{foot}." + column,))
    paths = [metric.replace("{foot}", foot) for metric in metrics]
    return any(fnmatchcase(path, pattern) for path in paths for pattern in patterns)
