"""Bounds beyond which a recorded number is no measurement, whatever robot it is of.

They are far beyond what any robot reaches, and low enough that no figure made of numbers within
them overflows.
"""

from dataclasses import replace
from typing import Final

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
    far = beyond(odometry.position, FARTHEST_M)
    fast = beyond(odometry.linear_velocity, FASTEST) | beyond(odometry.angular_velocity, FASTEST)
    implausible = far | fast
    if not implausible.any():
        return odometry, 0
    plausible = replace(
        odometry,
        position=_without(odometry.position, far),
        linear_velocity=_without(odometry.linear_velocity, fast),
        angular_velocity=_without(odometry.angular_velocity, fast),
    )
    return plausible, int(implausible.sum())


def plausible_samples(samples: Samples) -> tuple[Samples, int]:
    """Take forces and contact points that no robot reaches for NaN; count the samples with one."""
    strong = beyond(samples.force, STRONGEST_N)
    far = beyond(samples.position, FARTHEST_M)
    implausible = strong | far
    if not implausible.any():
        return samples, 0
    plausible = replace(
        samples,
        force=_without(samples.force, strong),
        position=_without(samples.position, far),
    )
    return plausible, int(implausible.sum())


def plausible_translations(translation: Floats) -> Floats:
    """Take translations that no robot reaches for NaN; (n, 3) m."""
    return _without(translation, beyond(translation, FARTHEST_M))


def _without(vectors: Floats, rows: Flags) -> Floats:
    return np.where(rows[:, None], np.nan, vectors)
