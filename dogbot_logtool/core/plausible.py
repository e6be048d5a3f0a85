"""Bounds beyond which a recorded number is no measurement, whatever robot it is of.

They are far beyond what any robot reaches, and low enough that no metric made of numbers within
them overflows.
"""

from dataclasses import replace
from typing import Any, Final, TypeVar

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, all_finite
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples

FARTHEST_M: Final = 1e9
"""Beyond the moon."""
FASTEST: Final = 1e9
"""m/s and rad/s; more than the speed of light."""
IMPLAUSIBLE: Final = (
    "poses or contacts with numbers that no robot reaches (beyond 1e9 m, m/s or N), which are "
    "not used"
)
"""The name of their number."""
STRONGEST_N: Final = 1e9
"""A hundred times the thrust of the largest rockets."""
Columns = TypeVar("Columns", bound=Any)


def beyond(vectors: Floats, limit: float) -> Flags:
    """(n,) which rows are finite but have a number beyond a limit.

    Args:
        vectors: (n, k).
        limit: the largest magnitude that is plausible.
    """
    if not len(vectors) or (vectors.min() >= -limit and vectors.max() <= limit):
        return np.zeros(len(vectors), np.bool_)
    outside = np.asarray((np.abs(vectors) > limit).any(axis=1))
    return outside & all_finite(vectors)


def plausible_odometry(odometry: Odometry) -> tuple[Odometry, int]:
    """Take poses and velocities that no robot reaches for NaN; count the messages with one."""
    fastest = {"linear_velocity": FASTEST, "angular_velocity": FASTEST}
    return _plausible(odometry, {"position": FARTHEST_M} | fastest)


def plausible_samples(samples: Samples) -> tuple[Samples, int]:
    """Take forces and contact points that no robot reaches for NaN; count the samples with one."""
    return _plausible(samples, {"force": STRONGEST_N, "position": FARTHEST_M})


def plausible_translations(translation: Floats) -> Floats:
    """Take translations that no robot reaches for NaN; (n, 3) m."""
    return np.where(beyond(translation, FARTHEST_M)[:, None], np.nan, translation)


def _plausible(columns: Columns, limits: dict[str, float]) -> tuple[Columns, int]:
    """Take the rows of columns, by their names, that are beyond a limit for NaN; count them."""
    far = {name: beyond(getattr(columns, name), limit) for name, limit in limits.items()}
    changed = {
        name: np.where(rows[:, None], np.nan, getattr(columns, name))
        for name, rows in far.items()
        if rows.any()
    }
    if not changed:
        return columns, 0
    return replace(columns, **changed), int(np.any(list(far.values()), axis=0).sum())
