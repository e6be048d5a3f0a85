"""Readings of a sensor without load, by the robot's weight and its other feet."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.corrections.sensor import SURE, UNSURE, SensorLevel

WORSE: Final = 0.05
"""By how much offsets may worsen the sum of all loads over the weight."""
FAR: Final = 0.3
"""By how much of the weight loads may miss it for a mass that is wrong, rather than a level."""
TURNED: Final = "swing and stance look alike, so that either may be the unloaded level"

Levels = tuple[SensorLevel, ...]


def weight_of_levels(levels: Sequence[SensorLevel]) -> float | None:
    """Return the sum of the feet's mean loads, N; None where one of them is not known."""
    known = [level.mean_n for level in levels if not level.reason and level.mean_n is not None]
    total = sum(known)
    return total if known and len(known) == len(levels) and total > 0.0 else None


def turned_levels(levels: Sequence[SensorLevel], weight_n: float | None) -> Levels:
    """Decide which way loads turn what sensors read: alike on all feet, and to the weight.

    Args:
        levels: of all feet, each as its own samples show it.
        weight_n: N, the robot's; None: not known.
    """
    raises = sum(x.lead if x.raises else -x.lead for x in levels if x.opposite) >= 0.0
    likely = tuple(
        _opposite(level) if level.raises is not raises and level.lead < SURE else level
        for level in levels
    )
    if all(level.opposite is None for level in likely):
        return likely
    others = (level.opposite and (level.opposite.alternative or level.opposite) for level in likely)
    turned = tuple(other or level for other, level in zip(others, likely, strict=True))
    miss, other_miss = (_miss(weight_of_levels(each), weight_n) for each in (likely, turned))
    sure = all(level.lead >= SURE for level in likely if level.opposite)
    if other_miss <= WORSE and miss > (FAR if sure else WORSE):
        return tuple(_opposite(level) for level in likely)
    if miss <= WORSE < other_miss:
        return likely
    needed = SURE if miss > 2.0 * WORSE else UNSURE
    return tuple(
        _without_offset(level, TURNED) if level.opposite and level.lead < needed else level
        for level in likely
    )


def _opposite(level: SensorLevel) -> SensorLevel:
    """Turn a level; one that is too clear for that, or not clear then, is not known."""
    other = level.opposite
    if other is None:
        return level
    if other.reason or level.lead >= SURE:
        return _without_offset(level, TURNED)
    return replace(other, opposite=replace(level, opposite=None))


def _miss(total: float | None, weight_n: float | None) -> float:
    """Return by how much of the weight a sum of loads, N, misses it.

    NaN, which is neither more nor less than anything, where that is not known.
    """
    return np.nan if total is None or weight_n is None else abs(total / weight_n - 1.0)


def weighed_levels(levels: Levels, weight_n: float | None) -> Levels:
    """Take the lower of two alternating loads for none where only so all add up to the weight.

    Offsets that are only estimated are kept if they do not worsen that sum. Where swings and
    stances are beyond doubt, so are the offsets: the mass is wrong then.
    """
    if weight_n is None:
        return levels
    others = tuple(level.alternative or level for level in levels)
    if any(level.alternative for level in levels):
        after = _miss(weight_of_levels(others), weight_n)
        if after <= WORSE and _miss(_recorded_n(others), weight_n) > 2.0 * WORSE:
            levels = others
    estimated = [
        level.origin == "estimated" and not level.zero_in_swing and level.lead < SURE
        for level in levels
    ]
    total = weight_of_levels(levels)
    if total is None or _miss(total, weight_n) <= _miss(_recorded_n(levels), weight_n) + WORSE:
        return levels
    if total < weight_n and any(level.limit_n is not None for level in levels):
        # What a sensor cuts off is missing.
        return levels
    why = f"taking it off would make the loads add up to {total / weight_n:.2f} of the weight"
    return tuple(
        _without_offset(level, why) if one else level
        for level, one in zip(levels, estimated, strict=True)
    )


def _recorded_n(levels: Levels) -> float:
    """Return the sum of the feet's mean loads with the offsets left in, N."""
    return sum(level.mean_recorded_n or level.mean_n or 0.0 for level in levels)


def _without_offset(level: SensorLevel, why: str) -> SensorLevel:
    """Return what is left of a level that cannot be right."""
    unknown = SensorLevel()
    return replace(
        level,
        knots=unknown.knots,
        offset=unknown.offset,
        noise_n=None,
        drift_n_per_min=None,
        loaded_n=None,
        origin="default",
        reason=why,
        refuted=why,
        opposite=None,
    )
