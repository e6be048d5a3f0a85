"""What findings void in tables by stride or stance, by the same patterns as in metrics."""

from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.finding import Finding

_METRICS: Final[Mapping[str, str]] = {"length_m": "stride_length_m"}
"""Metrics of a foot whose columns have another name."""


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
    path = f"feet.{foot}.{_METRICS.get(column, column)}"
    return any(fnmatchcase(path, pattern) for pattern in patterns)
