"""The bound beyond which a recorded number is no measurement, whatever robot it is of.

It is far beyond what any robot reaches, and low enough that no metric made of numbers within it
overflows.
"""

from dataclasses import replace
from typing import Any, Final

import numpy as np

from dogbot_logtool.core.arrays import AnyColumns, Flags, Floats, all_finite

LARGEST: Final = 1e9
"""m, m/s, rad/s or N: beyond the moon, faster than light, stronger than any rocket."""
_BOUNDED: Final = ("position", "linear_velocity", "angular_velocity", "force")


def _beyond(vectors: Floats) -> Flags:
    """(n,) which rows of (n, k) are finite but have a number beyond the bound."""
    if not len(vectors) or (vectors.min() >= -LARGEST and vectors.max() <= LARGEST):
        return np.zeros(len(vectors), np.bool_)
    return np.asarray((np.abs(vectors) > LARGEST).any(axis=1)) & all_finite(vectors)


def plausible(columns: AnyColumns) -> tuple[AnyColumns, int]:
    """Take poses, forces and places that no robot reaches for NaN; count the rows with one."""
    own: Any = columns
    far = {name: _beyond(getattr(own, name)) for name in _BOUNDED if hasattr(own, name)}
    changes = {
        name: np.where(rows[:, None], np.nan, getattr(own, name))
        for name, rows in far.items()
        if rows.any()
    }
    if not changes:
        return columns, 0
    return replace(own, **changes), int(np.any(list(far.values()), axis=0).sum())


def plausible_translations(translation: Floats) -> Floats:
    """Take translations that no robot reaches for NaN; (n, 3) m."""
    return np.where(_beyond(translation)[:, None], np.nan, translation)
