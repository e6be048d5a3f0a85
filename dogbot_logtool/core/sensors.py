"""How each foot's sensor reads with and without load: its whole column, other feet, the weight.

A sensor that is re-zeroed in the middle of a log may read as much in later swings as under load
before: what it reads without load, and with that contact, is not known then.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, all_finite, distinct, flagged_runs, norms
from dogbot_logtool.core.clock import usual_interval_s
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import (
    ANY_FORCE_N,
    DEBOUNCE_S,
    ContactRule,
    Thresholds,
)
from dogbot_logtool.core.contact.sensor import (
    CONSTANT,
    STEPS,
    STEPS_UNCLEAR,
    SURE,
    SensorLevel,
    estimate_level,
    refuted,
    varies,
    zero_level,
)
from dogbot_logtool.core.settings import FootSettings, WalkSettings

WORSE: Final = 0.05
"""By how much offsets may worsen the sum of all loads over the weight."""
FAR_WORSE: Final = 0.2
"""The same where swing and stance are told apart by far: a mass may be wrong by so much."""
Levels = tuple[SensorLevel, ...]


def with_sensors(settings: WalkSettings, feet: Sequence[Samples]) -> WalkSettings:
    """Return settings with how each foot's sensor reads, and what counts as contact.

    Args:
        settings: what is known of the feet.
        feet: the samples of each, as recorded.
    """
    known = tuple(
        # Some physics engines tell contacts with wrenches that are all zero: these are no forces.
        foot._replace(has_force=False) if _without_forces(own) else foot
        for foot, own in zip(settings.feet, feet, strict=True)
    )
    settings = replace(settings, feet=known)
    weight = settings.body_weight_n
    takes = settings.takes_offsets
    levels = tuple(_level(*each, takes=takes) for each in zip(known, feet, strict=True))
    # A mass that is only guessed from the topics tells nothing of levels.
    if weight is not None and not settings.mass_is_assumed:
        levels = fitting_levels(levels, weight)
    levels = _as_others_step(levels)
    estimated = weight_of_levels(levels) if weight is None else None
    # A robot that stands in a simulator without noise has no force that varies.
    some_vary = CONSTANT in {level.reason for level in levels} and any(
        level.reason != CONSTANT
        and (level.hides_contact or level.loaded_n)
        and varies(norms(own.force[all_finite(own.force)]))
        for level, own in zip(levels, feet, strict=True)
    )
    found = []
    for foot, level, samples in zip(settings.feet, levels, feet, strict=True):
        interval_s = usual_interval_s(samples.log_time)
        rule = contact_rule(level, weight or estimated, settings.thresholds, interval_s)
        why = _why_unusable(foot, level, rule, some_vary=some_vary)
        rule = rule._replace(by_flag=foot.has_flags, unusable=why)
        level = replace(level, limit_n=_limit_n(samples.force, level))  # noqa: PLW2901
        found.append(foot._replace(level=level, rule=rule))
    return replace(settings, feet=tuple(found), estimated_weight_n=estimated)


def _as_others_step(levels: Levels) -> Levels:
    """Believe no foot to be always down where half of all feet step, by sensors with offsets."""
    stepping = sum(not level.reason and bool(level.offset.any()) for level in levels)
    if 2 * stepping < len(levels):
        return levels
    return tuple(
        replace(level, hides_contact=True) if level.reason in STEPS_UNCLEAR else level
        for level in levels
    )


def _level(foot: FootSettings, samples: Samples, *, takes: bool) -> SensorLevel:
    """Estimate a foot's level, or take the one that is given.

    Args:
        foot: what is known of it.
        samples: as recorded.
        takes: offsets that are not given are estimated.
    """
    time, force = samples.log_time, samples.force
    if foot.offset_n is None:
        if not foot.has_force:
            return SensorLevel(zero_in_swing=True)
        if foot.lists_contacts or foot.silent_in_swing:
            level = zero_level(force[all_finite(force)])
            # Samples of contact only have no mean over strides.
            return replace(level, mean_n=None) if foot.silent_in_swing else level
        level = estimate_level(time, force)
        if takes or level.zero_in_swing:
            return refuted(STEPS) if level.reason == STEPS else level
    offset = np.array([foot.offset_n or (0.0, 0.0, 0.0)])
    rest = estimate_level(time, force - offset)
    knots = np.zeros(1, np.int64)
    known = replace(rest, reason="", hides_contact=False)
    return replace(known, knots=knots, offset=offset, origin=foot.offset_from)


def _without_forces(samples: Samples) -> bool:
    """Tell whether there are contacts, and all of them without a force."""
    touching = np.flatnonzero(samples.in_contact)
    return len(touching) > 0 and not samples.force.take(touching, axis=0).any()


def without_offset(samples: Samples, foot: FootSettings) -> Samples:
    """Return samples less their sensor's offset; below the off threshold there is no contact.

    Zeros of a sensor that drops out are no measurements, and become NaN.

    Args:
        samples: n samples of one foot.
        foot: with its sensor.
    """
    level = foot.level
    if foot.lists_contacts and not level.offset.any():
        return samples
    force = samples.force.copy()
    force -= level.offset_at(samples.log_time)
    if foot.only_presses:
        force = np.where(force < 0.0, 0.0, force)
    # A force that is not a number is below no threshold.
    force[norms(force) < foot.rule.off_n] = 0.0
    if level.drops_out:
        force[(samples.force == 0.0).all(axis=1)] = np.nan
    touches = (force != 0.0).any(axis=1)
    if foot.lists_contacts:
        touches &= samples.in_contact
    return replace(samples, force=force, in_contact=touches)


def weight_of_levels(levels: Sequence[SensorLevel]) -> float | None:
    """Return the sum of the feet's mean loads, N; None where one of them is not known."""
    known = [level.mean_n for level in levels if not level.reason and level.mean_n is not None]
    total = sum(known)
    return total if known and len(known) == len(levels) and total > 0.0 else None


def fitting_levels(levels: Levels, weight_n: float) -> Levels:
    """Refuse offsets that worsen the sum of all loads against the weight, N.

    Where swings and stances are beyond doubt, so are the offsets: the mass may be wrong then.
    """
    total = weight_of_levels(levels)
    if total is None:
        return levels
    recorded = sum(level.mean_recorded_n or level.mean_n or 0.0 for level in levels)
    worse = abs(total / weight_n - 1.0) - abs(recorded / weight_n - 1.0)
    worsens = f"taking it off would make the loads add up to {total / weight_n:.2f} of the weight"
    estimated = (each.origin == "estimated" and not each.zero_in_swing for each in levels)
    return tuple(
        refuted(worsens) if own and worse > (WORSE if level.lead < SURE else FAR_WORSE) else level
        for level, own in zip(levels, estimated, strict=True)
    )


ZERO_ON: Final = 0.05
"""Share of the weight from which a foot is in contact whose sensor reads zero in swing."""
ZERO_OFF: Final = 1e-4
"""Share of the weight below which that contact ends."""
NOISY_ON, NOISY_OFF = 0.08, 0.04
"""The same of any other sensor, where two feet carry the robot."""
FEET_THAT_CARRY: Final = 2.0
"""Feet whose usual load is the weight for those thresholds; of a foot that carries less, as one of
six does, they are shares of so many times its usual load."""
ON_NOISES, OFF_NOISES = 5.0, 3.0
"""Thresholds are at least so many standard deviations of the noise."""
ON_WOBBLES: Final = 1.25
"""Times the furthest that an unloaded sensor strays, by a leg's inertia; it ends at that itself."""
MOST_OF_LOAD: Final = 0.5
"""Largest share of the usual load that may be needed to detect contact."""
HEAVILY_FILTERED: Final = "its forces went through a low-pass filter that hides contact"
DEBOUNCE_INTERVALS: Final = 1.5
"""Shorter swings and stances are no longer than one sample."""
BRIEF: Final = 0.0625
"""Share of a usual swing below which another foot has taken the load for a moment."""


def contact_rule(
    level: SensorLevel,
    weight_n: float | None,
    given: Thresholds,
    interval_s: float | None,
) -> ContactRule:
    """Return what counts as contact for a sensor.

    Args:
        level: how it reads with and without load.
        weight_n: N, the robot's; None: not known, then the foot's own usual load stands for it.
        given: thresholds that are not to be chosen here.
        interval_s: s, usual sampling interval; None: not known.
    """
    scale = weight_n or level.loaded_n or 0.0
    noise = level.noise_n or 0.0
    if level.zero_in_swing:
        on, off = ZERO_ON * scale, ZERO_OFF * scale
    else:
        carried = min(scale, FEET_THAT_CARRY * (level.loaded_n or scale))
        on = max(NOISY_ON * carried, ON_NOISES * noise, ON_WOBBLES * level.wobble_n)
        off = max(NOISY_OFF * carried, OFF_NOISES * noise, level.wobble_n)
    on = given.on_n or max(on, ANY_FORCE_N)
    off = min(given.off_n or off, on)
    usual_s = max(DEBOUNCE_S, DEBOUNCE_INTERVALS * (interval_s or 0.0))
    estimated = weight_n is None or level.origin == "estimated"
    return ContactRule(
        on_n=on,
        off_n=off,
        brief_s=BRIEF * (level.swing_s or 0.0) if given.debounce_s is None else None,
        debounce_s=usual_s if given.debounce_s is None else given.debounce_s,
        origin=given.origin if given.on_n else "estimated" if estimated else "default",
    )


def _why_unusable(
    foot: FootSettings, level: SensorLevel, rule: ContactRule, *, some_vary: bool
) -> str:
    """Say why a sensor cannot tell contact; empty where it can."""
    if foot.low_pass and not foot.low_pass.resolved:
        return HEAVILY_FILTERED
    if some_vary and level.reason == CONSTANT and level.loaded_n and not foot.has_flags:
        return "its sensor reads one constant force while others vary"
    if foot.has_flags or rule.origin in {"option", "robot"}:
        return ""
    if level.hides_contact:
        return f"what it reads without load is not known: {level.reason}"
    if rule.on_n > MOST_OF_LOAD * (level.loaded_n or np.inf):
        return (
            f"contact would need {rule.on_n:.3g} N, more than half of the {level.loaded_n:.3g} N "
            "that the foot usually carries"
        )
    return ""


SATURATED_SAMPLES: Final = 3
"""Samples in a row at the very same highest force that make a flat top."""
STEEP: Final = 10.0
"""Steps of the sensor's resolution beyond which the rise to its limit is steep. The round top of a
force that is recorded in steps is flat for m samples and at most 8 steps lower m samples before."""
SATURATED_STANCES: Final = 3
"""Stances with the same flat top that make a saturated sensor."""
FAR_FROM_SWING: Final = 0.5
"""Share of the usual load that a limit is from the unloaded level; else it is that of swing."""


def _limit_n(force: Floats, level: SensorLevel) -> float | None:
    """Return the value at which an axis of a sensor is cut off, N; None: none is.

    Args:
        force: (n, 3) N, as recorded.
        level: of the sensor.
    """
    if level.reason or level.loaded_n is None:
        return None
    force = force.take(np.flatnonzero(all_finite(force)), axis=0)
    for values, offset in zip(force.T, level.offset_n.tolist(), strict=True):
        for sign, limit in ((1.0, float(values.max())), (-1.0, float(values.min()))):
            is_far = sign * (limit - offset) > FAR_FROM_SWING * level.loaded_n
            if is_far and _flat_tops(sign * values, sign * limit) >= SATURATED_STANCES:
                return limit
    return None


def _flat_tops(values: Floats, limit: float) -> int:
    """Return how often values rise steeply to a limit, and stay there."""
    tops = flagged_runs(values == limit)
    start, length = tops[:, 0], tops[:, 1] - tops[:, 0]
    flat = length >= SATURATED_SAMPLES
    if flat.sum() < SATURATED_STANCES:
        return 0
    start, length = start[flat], length[flat]
    rise = limit - values[np.maximum(start - length, 0)]
    return int((rise > STEEP * np.diff(distinct(values)).min()).sum())
