"""Readings of a sensor without load, by the robot's weight and its other feet."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.sensors.sensor_level import SURE, UNSURE, SensorLevel, no_offset

WORSE: Final = 0.05
"""By how much offsets may worsen the sum of all loads over the weight."""
FAR: Final = 0.3
"""By how much of the weight loads may miss it for a mass that is wrong, rather than a level."""
TURNED: Final = "swing and stance look alike, so that either may be the unloaded level"


def weight_of_levels(levels: Sequence[SensorLevel]) -> float | None:
    """Return the sum of the feet's mean loads, N; None where one of them is not known."""
    means = [None if level.reason else level.mean_n for level in levels]
    known = [mean for mean in means if mean is not None]
    total = sum(known)
    return total if known and len(known) == len(means) and total > 0.0 else None


def turned_levels(levels: Sequence[SensorLevel], weight_n: float | None) -> tuple[SensorLevel, ...]:
    """Decide which way loads turn what sensors read: alike on all feet, and to the weight.

    Args:
        levels: of all feet, each as its own samples show it.
        weight_n: N, the robot's; None: not known.
    """
    lead = sum(level.lead if level.raises else -level.lead for level in levels if level.opposite)
    likely = _all_turned(levels, raises=lead >= 0.0)
    if all(level.opposite is None for level in likely):
        return likely
    miss, other_miss = (_miss(each, weight_n) for each in (likely, _all_opposite(likely)))
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


def _all_turned(levels: Sequence[SensorLevel], *, raises: bool) -> tuple[SensorLevel, ...]:
    """Turn the levels that may be the other way round to that of the other feet."""
    return tuple(
        _opposite(level) if level.raises is not raises and level.lead < SURE else level
        for level in levels
    )


def _all_opposite(levels: Sequence[SensorLevel]) -> tuple[SensorLevel, ...]:
    """Return what the levels of all feet would be if loads turned them the other way."""
    return tuple(
        level if level.opposite is None else level.opposite.alternative or level.opposite
        for level in levels
    )


def _opposite(level: SensorLevel) -> SensorLevel:
    """Turn a level; one that is too clear for that, or not clear then, is not known."""
    other = level.opposite
    if other is None:
        return level
    if other.reason or level.lead >= SURE:
        return _without_offset(level, TURNED)
    return replace(other, opposite=replace(level, opposite=None))


def _miss(levels: Sequence[SensorLevel], weight_n: float | None) -> float:
    """Return by how much of the weight the sum of the feet's mean loads misses it.

    NaN, which is neither more nor less than anything, where that is not known.
    """
    total = weight_of_levels(levels)
    return np.nan if total is None or weight_n is None else abs(total / weight_n - 1.0)


def checked_levels(
    levels: Sequence[SensorLevel], weight_n: float | None
) -> tuple[SensorLevel, ...]:
    """Keep estimated offsets only if they do not worsen the sum of loads over a known weight.

    Where swings and stances are beyond doubt, so are the offsets: the mass is wrong then.
    """
    estimated = [
        level.origin == "estimated" and not level.zero_in_swing and level.lead < SURE
        for level in levels
    ]
    after = weight_of_levels(levels)
    if weight_n is None or after is None or not any(estimated):
        return tuple(levels)
    before = sum(level.mean_recorded_n or level.mean_n or 0.0 for level in levels)
    if abs(after / weight_n - 1.0) <= abs(before / weight_n - 1.0) + WORSE:
        return tuple(levels)
    if after < weight_n and any(level.limit_n is not None for level in levels):
        # What a sensor cuts off is missing.
        return tuple(levels)
    why = f"taking it off would make the loads add up to {after / weight_n:.2f} of the weight"
    return tuple(
        _without_offset(level, why) if one else level
        for level, one in zip(levels, estimated, strict=True)
    )


def weighed_levels(
    levels: Sequence[SensorLevel], weight_n: float | None
) -> tuple[SensorLevel, ...]:
    """Take the lower of two alternating loads for none where only so all add up to the weight."""
    if weight_n is None or not any(level.alternative for level in levels):
        return tuple(levels)
    others = tuple(level.alternative or level for level in levels)
    after = weight_of_levels(others)
    before = sum(level.mean_recorded_n or level.mean_n or 0.0 for level in others)
    if after is None or abs(after / weight_n - 1.0) > WORSE:
        return tuple(levels)
    return others if abs(before / weight_n - 1.0) > 2.0 * WORSE else tuple(levels)


def _without_offset(level: SensorLevel, why: str) -> SensorLevel:
    knots, offset = no_offset()
    return replace(
        level,
        knots=knots,
        offset=offset,
        noise_n=None,
        drift_n_per_min=None,
        loaded_n=None,
        origin="default",
        reason=why,
        refuted=why,
        opposite=None,
    )
