"""What counts as contact: thresholds relative to the robot's weight and to the sensor's noise."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.core.contact.sensor_level import Origin, SensorLevel, no_offset

ZERO_ON: Final = 0.05
"""Share of the weight from which a foot is in contact whose sensor reads zero in swing."""
ZERO_OFF: Final = 1e-4
"""Share of the weight below which that contact ends."""
NOISY_ON, NOISY_OFF = 0.08, 0.04
"""The same of any other sensor."""
ON_NOISES, OFF_NOISES = 5.0, 3.0
"""Thresholds are at least so many standard deviations of the noise."""
MOST_OF_LOAD: Final = 0.5
"""Largest share of the usual load that may be needed to detect contact."""
DEBOUNCE_S: Final = 0.020
DEBOUNCE_INTERVALS: Final = 1.5
"""Shorter swings and stances are no longer than one sample."""
MOST_DEBOUNCE_S: Final = 10.0
"""No foot steps more slowly: such intervals are those of stamps gone wrong."""
ANY_FORCE_N: Final = 1e-9
"""Threshold where no force was ever seen, so that nothing tells what a load is."""
WORSE: Final = 0.05
"""By how much offsets may worsen the sum of all loads over the weight."""


@dataclass(frozen=True, slots=True)
class ContactRule:
    """What counts as contact."""

    on_n: float
    """N: |F| from which a foot is in contact."""
    off_n: float
    """N: |F| below which contact ends; it always ends at 0. 0: only there."""
    debounce_s: float
    """s: shorter swings are filled, then shorter stances dropped."""
    backdates: bool = False
    """Whether a touchdown is dated back to where the force rose above `off_n`."""
    origin: Origin = "default"
    """Where the thresholds come from."""
    by_flag: bool = False
    """Whether the message's own contact flag decides, whatever the force."""
    unusable: str = ""
    """Why the sensor cannot tell contact; empty: it can."""


@dataclass(frozen=True, slots=True)
class Thresholds:
    """What a user or the robot's file says about contact; None: not said."""

    on_n: float | None = None
    off_n: float | None = None
    debounce_s: float | None = None
    origin: Origin = "option"


@dataclass(frozen=True, slots=True)
class FootSensor:
    """How one foot's messages are read and understood."""

    level: SensorLevel
    rule: ContactRule


def contact_rule(
    level: SensorLevel, weight_n: float | None, given: Thresholds = Thresholds()
) -> ContactRule:
    """Return what counts as contact for a sensor.

    Args:
        level: how it reads with and without load.
        weight_n: N, the robot's; None: not known, then the foot's own usual load stands for it.
        given: thresholds that are not to be chosen here.
    """
    scale = weight_n or level.loaded_n or 0.0
    noise = level.noise_n or 0.0
    if level.zero_in_swing:
        on, off = ZERO_ON * scale, ZERO_OFF * scale
    else:
        on = max(NOISY_ON * scale, ON_NOISES * noise)
        off = max(NOISY_OFF * scale, OFF_NOISES * noise)
    on = given.on_n or max(on, ANY_FORCE_N)
    off = min(given.off_n or off, on)
    estimated = weight_n is None or level.origin == "estimated"
    unusable = ""
    if level.loaded_n is not None and on > MOST_OF_LOAD * level.loaded_n and given.on_n is None:
        unusable = (
            f"contact would need {on:.3g} N, more than half of the {level.loaded_n:.3g} N that "
            "the foot usually carries"
        )
    return ContactRule(
        on_n=on,
        off_n=off,
        debounce_s=_debounce_s(level, given.debounce_s),
        backdates=True,
        origin=given.origin if given.on_n else "estimated" if estimated else "default",
        unusable=unusable,
    )


def _debounce_s(level: SensorLevel, given: float | None) -> float:
    if given is not None:
        return given
    return min(max(DEBOUNCE_S, DEBOUNCE_INTERVALS * (level.interval_s or 0.0)), MOST_DEBOUNCE_S)


def weight_of_levels(levels: Sequence[SensorLevel]) -> float | None:
    """Return the sum of the feet's mean loads, N; None where one of them is not known."""
    means = [None if level.reason else level.mean_n for level in levels]
    known = [mean for mean in means if mean is not None]
    total = sum(known)
    return total if known and len(known) == len(means) and total > 0.0 else None


def checked_levels(
    levels: Sequence[SensorLevel], weight_n: float | None
) -> tuple[SensorLevel, ...]:
    """Keep estimated offsets only if they do not worsen the sum of loads over a known weight."""
    estimated = [level.origin == "estimated" and not level.zero_in_swing for level in levels]
    after = weight_of_levels(levels)
    if weight_n is None or after is None or not any(estimated):
        return tuple(levels)
    before = sum(level.mean_recorded_n or level.mean_n or 0.0 for level in levels)
    if abs(after / weight_n - 1.0) <= abs(before / weight_n - 1.0) + WORSE:
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
    )
