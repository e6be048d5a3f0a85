"""How each foot's sensor reads with and without load: its whole column, other feet, the weight."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import all_finite, median_of, norms
from dogbot_logtool.core.contact.contact_rule import HEAVILY_FILTERED, FootSensor, contact_rule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import usual_interval_s
from dogbot_logtool.core.corrections.modes import CONSTANT
from dogbot_logtool.core.corrections.moving_level import follow_level
from dogbot_logtool.core.corrections.sensor import (
    SURE,
    UNSURE,
    SensorLevel,
    estimate_level,
    zero_level,
)
from dogbot_logtool.core.settings import FootSettings, WalkSettings

WORSE: Final = 0.05
"""By how much offsets may worsen the sum of all loads over the weight."""
FAR: Final = 0.3
"""By how much of the weight loads may miss it for a mass that is wrong, rather than a level."""
TURNED: Final = "swing and stance look alike, so that either may be the unloaded level"

Levels = tuple[SensorLevel, ...]


def with_sensors(settings: WalkSettings, feet: Sequence[Samples]) -> WalkSettings:
    """Return settings with how each foot's sensor reads, and what counts as contact.

    Nothing is learnt where that is known of all feet.

    Args:
        settings: what is known of the feet.
        feet: the samples of each, as recorded.
    """
    known = tuple(
        # Some physics engines tell contacts with wrenches that are all zero: these are no forces.
        replace(foot, has_force=False) if _without_forces(own) else foot
        for foot, own in zip(settings.feet, feet, strict=True)
    )
    settings = replace(settings, feet=known)
    if all(foot.sensor is not None for foot in known):
        return settings
    weight = settings.body_weight_n
    # A mass that is only guessed from the topics tells nothing of levels.
    trusted = None if settings.mass_is_assumed else weight
    pairs = zip(settings.feet, feet, strict=True)
    alone = [_level(foot, samples, takes=settings.takes_offsets) for foot, samples in pairs]
    levels = weighed_levels(turned_levels(alone, trusted), trusted)
    estimated = weight_of_levels(levels) if weight is None else None
    found = []
    for foot, level in zip(settings.feet, levels, strict=True):
        rule = contact_rule(level, weight or estimated, settings.thresholds)
        if foot.has_flags:
            rule = replace(rule, by_flag=True, backdates=False, unusable="")
        elif _is_stuck(level) and any(each.loaded_n and not _is_stuck(each) for each in levels):
            rule = replace(rule, unusable="its sensor reads one constant force while others vary")
        if foot.low_pass and not foot.low_pass.resolved:
            rule = replace(rule, unusable=HEAVILY_FILTERED)
        found.append(replace(foot, sensor=FootSensor(level, rule)))
    return replace(settings, feet=tuple(found), estimated_weight_n=estimated)


def _is_stuck(level: SensorLevel) -> bool:
    """Tell whether a sensor reads one force throughout."""
    return level.reason == CONSTANT and bool(level.loaded_n)


def _level(foot: FootSettings, samples: Samples, *, takes: bool) -> SensorLevel:
    """Estimate a foot's level, or take the one that is given.

    Args:
        foot: what is known of it.
        samples: as recorded.
        takes: offsets that are not given are estimated.
    """
    if foot.offset_n is None and (level := _zero(foot, samples)) is not None:
        return level
    if foot.offset_n is None and takes:
        level = estimate_level(samples.log_time, samples.force)
        if level.zero_in_swing or level.reason:
            return level
        return follow_level(samples.log_time, samples.force, level)
    offset = np.array([foot.offset_n or (0.0, 0.0, 0.0)])
    rest = estimate_level(samples.log_time, samples.force - offset)
    knots = np.zeros(1, np.int64)
    return replace(rest, knots=knots, offset=offset, origin=foot.offset_from, reason="")


def _zero(foot: FootSettings, samples: Samples) -> SensorLevel | None:
    """Return the level of a foot whose sensor reads zero in swing; None: it does not."""
    force = samples.force[all_finite(samples.force)]
    interval_s = usual_interval_s(samples.log_time)
    zero = SensorLevel(zero_in_swing=True)
    if foot.silent_in_swing:
        # Its samples are those in contact only, and their mean is no mean over strides.
        level = zero_level(np.concatenate([np.zeros((len(force) + 3, 3)), force]), interval_s)
        return replace(level or zero, mean_n=None)
    if not foot.has_force:
        return replace(zero, interval_s=interval_s)
    if not len(force):
        return None
    level = zero_level(force, interval_s)
    if level is None and foot.lists_contacts:
        # A foot that is down throughout: its messages would say if it were not.
        mean = float(median_of(norms(force)))
        return replace(zero, loaded_n=mean, mean_n=mean, interval_s=interval_s)
    return level


def _without_forces(samples: Samples) -> bool:
    """Tell whether there are contacts, and all of them without a force."""
    return bool(samples.in_contact.any() and not samples.force[samples.in_contact].any())


def without_offset(samples: Samples, foot: FootSettings) -> Samples:
    """Return samples less their sensor's offset; below the off threshold there is no contact.

    Zeros of a sensor that drops out are no measurements, and become NaN.

    Args:
        samples: n samples of one foot.
        foot: with its sensor.
    """
    sensor = foot.sensor
    if sensor is None or not len(samples.log_time):
        return samples
    level = sensor.level
    reads_offset = bool(level.offset.any()) or not foot.lists_contacts
    if not (reads_offset or level.drops_out):
        return samples
    force = samples.force.copy()
    recorded_zero = (force == 0.0).all(axis=1)
    if reads_offset:
        force -= level.offset_at(samples.log_time)
        if foot.only_presses:
            force = np.where(force < 0.0, 0.0, force)
        # A force that is not a number is below no threshold.
        force[norms(force) < sensor.rule.off_n] = 0.0
    if level.drops_out:
        force[recorded_zero] = np.nan
    touches = (force != 0.0).any(axis=1)
    if foot.lists_contacts:
        touches &= samples.in_contact
    return replace(samples, force=force, in_contact=touches)


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
