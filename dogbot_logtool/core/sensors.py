"""How each foot's sensor reads with and without load: its whole column, other feet, the weight.

A sensor that is re-zeroed in the middle of a log, or that warms up, may read as much in later
swings as under load before. The lightest loads of a few strides at a time show how it moves; less
that, swings and stances are found as in any log.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, median_of, norms, percentiles_of
from dogbot_logtool.core.contact.contact_rule import HEAVILY_FILTERED, contact_rule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import usual_interval_s
from dogbot_logtool.core.corrections.modes import ALTERNATE, CONSTANT, PLAIN_OFFSET, two_modes
from dogbot_logtool.core.corrections.sensor import (
    SURE,
    UNSURE,
    Candidates,
    SensorLevel,
    estimate_levels,
    level_of,
    load_axis,
    run_numbers,
    without_spikes,
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
    # A mass that is only guessed from the topics tells nothing of levels.
    trusted = None if settings.mass_is_assumed else weight

    def levels_of(plain_offset: float) -> Levels:
        pairs = zip(settings.feet, feet, strict=True)
        takes = settings.takes_offsets
        return chosen_levels([_levels(*each, plain_offset, takes=takes) for each in pairs], trusted)

    levels = levels_of(PLAIN_OFFSET)
    if trusted is not None and any(level.reason == ALTERNATE for level in levels):
        # The lower of two alternating loads is none where only so all add up to the weight.
        plain = levels_of(np.inf)
        sums = weight_of_levels(plain), _recorded_n(plain)
        miss, recorded_miss = (_miss(each, trusted) for each in sums)
        levels = plain if miss <= WORSE and recorded_miss > 2.0 * WORSE else levels
    estimated = weight_of_levels(levels) if weight is None else None
    found = []
    for foot, level in zip(settings.feet, levels, strict=True):
        rule = contact_rule(level, weight or estimated, settings.thresholds)
        if foot.has_flags:
            rule = rule._replace(by_flag=True, backdates=False, unusable="")
        elif _is_stuck(level) and any(each.loaded_n and not _is_stuck(each) for each in levels):
            rule = rule._replace(unusable="its sensor reads one constant force while others vary")
        if foot.low_pass and not foot.low_pass.resolved:
            rule = rule._replace(unusable=HEAVILY_FILTERED)
        found.append(foot._replace(level=level, rule=rule))
    return replace(settings, feet=tuple(found), estimated_weight_n=estimated)


def _is_stuck(level: SensorLevel) -> bool:
    """Tell whether a sensor reads one force throughout."""
    return level.reason == CONSTANT and bool(level.loaded_n)


def _levels(
    foot: FootSettings, samples: Samples, plain_offset: float, *, takes: bool
) -> Candidates:
    """Estimate a foot's level, or take the one that is given.

    Args:
        foot: what is known of it.
        samples: as recorded.
        plain_offset: see `estimate_levels`.
        takes: offsets that are not given are estimated.
    """
    time, force = samples.log_time, samples.force
    if foot.offset_n is None:
        zero = SensorLevel(zero_in_swing=True, interval_s=usual_interval_s(time))
        if foot.silent_in_swing:
            # Its samples are those in contact only, and their mean is no mean over strides.
            pressed = force[all_finite(force)]
            level = zero_level(time, np.concatenate([np.zeros((len(pressed) + 3, 3)), pressed]))
            return (replace(level or zero, mean_n=None),)
        if not foot.has_force:
            return (zero,)
        likely, *others = estimate_levels(time, force, plain_offset)
        if foot.lists_contacts and not likely.zero_in_swing and likely.mean_n is not None:
            # A foot that is down throughout: its messages would say if it were not.
            magnitude = norms(force)
            mean = float(median_of(magnitude[np.isfinite(magnitude)]))
            return (replace(zero, loaded_n=mean, mean_n=mean),)
        if likely.zero_in_swing or (takes and likely.reason):
            return (likely, *others)
        if takes:
            return (follow_level(time, force, likely), *others)
    offset = np.array([foot.offset_n or (0.0, 0.0, 0.0)])
    rest = estimate_levels(time, force - offset)[0]
    knots = np.zeros(1, np.int64)
    return (replace(rest, knots=knots, offset=offset, origin=foot.offset_from, reason=""),)


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
    level = foot.level
    if not len(samples.log_time):
        return samples
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
        force[norms(force) < foot.rule.off_n] = 0.0
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


def chosen_levels(feet: Sequence[Candidates], weight_n: float | None) -> Levels:
    """Decide which way loads turn what sensors read, alike on all feet, and which offsets hold.

    Offsets that are only estimated are kept if they do not worsen the sum of all loads against the
    weight. Where swings and stances are beyond doubt, so are the offsets: the mass is wrong then.

    Args:
        feet: levels of each foot, as its own samples show them.
        weight_n: N, the robot's; None: not known.
    """
    leads = [abs(each[0].fit - each[-1].fit) if len(each) > 1 else np.inf for each in feet]
    votes = [x if each[0].raises else -x for each, x in zip(feet, leads, strict=True) if x < np.inf]
    raises = sum(votes) >= 0.0
    alike = [
        _swapped(each, lead) if lead < SURE and each[0].raises is not raises else each
        for each, lead in zip(feet, leads, strict=True)
    ]
    levels = _fitting(alike, leads, weight_n)
    total, recorded_n = weight_of_levels(levels), _recorded_n(levels)
    if weight_n is None or total is None:
        return levels
    if _miss(total, weight_n) <= _miss(recorded_n, weight_n) + WORSE:
        return levels
    if total < weight_n and any(level.limit_n is not None for level in levels):
        # What a sensor cuts off is missing.
        return levels
    why = f"taking it off would make the loads add up to {total / weight_n:.2f} of the weight"
    return tuple(
        _without_offset(level, why)
        if level.origin == "estimated" and not level.zero_in_swing and lead < SURE
        else level
        for level, lead in zip(levels, leads, strict=True)
    )


def _fitting(feet: Sequence[Candidates], leads: Sequence[float], weight_n: float | None) -> Levels:
    """Choose between the levels of each foot by which add up to the weight, N.

    Args:
        feet: levels of each, the likely one first.
        leads: how much better that fits than the other.
        weight_n: N, the robot's; None: not known.
    """
    pairs = list(zip(feet, leads, strict=True))
    likely, others = (tuple(each[row] for each in feet) for row in (0, -1))
    unsure = [lead for each, lead in pairs if len(each) > 1]
    if not unsure:
        return likely
    miss, other_miss = (_miss(weight_of_levels(each), weight_n) for each in (likely, others))
    if other_miss <= WORSE and miss > (FAR if min(unsure) >= SURE else WORSE):
        return tuple(_swapped(*pair)[0] for pair in pairs)
    if miss <= WORSE < other_miss:
        return likely
    needed = SURE if miss > 2.0 * WORSE else UNSURE
    return tuple(
        _without_offset(each[0], TURNED) if len(each) > 1 and lead < needed else each[0]
        for each, lead in pairs
    )


def _swapped(levels: Candidates, lead: float) -> Candidates:
    """Turn levels round; one that is too clear for that, or not clear then, is not known."""
    if len(levels) > 1 and (levels[1].reason or lead >= SURE):
        return (_without_offset(levels[0], TURNED),)
    return levels[::-1]


def _miss(total: float | None, weight_n: float | None) -> float:
    """Return by how much of the weight a sum of loads, N, misses it.

    NaN, which is neither more nor less than anything, where that is not known.
    """
    return np.nan if total is None or weight_n is None else abs(total / weight_n - 1.0)


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
        refuted=True,
    )


STRIDES: Final = 4.0
"""Strides in a window."""
_WINDOW_S: Final = (3.0, 40.0)
"""s, shortest and longest window."""
_HOPS: Final = 4
"""Windows begin so many times in the length of one."""
_LOW_AND_HIGH: Final = (8.0, 92.0)
"""Percentiles of a window that are those of swing and of stance, if it is walked."""
_SAMPLES_A_SWING: Final = 12
"""Samples of a swing that are looked at."""
_SWINGS_A_STRIDE: Final = 3.0
"""Strides last about so many swings."""
_SWING_S: Final = 0.3
"""s, where it is not known."""
MOVED: Final = 0.05
"""Share of the usual load from which a level that moved is followed."""
MOVED_NOISES: Final = 5.0
"""The same in standard deviations of the noise."""
ALONE: Final = 0.4
"""Share of a step within which it is the level's, and that the steps beside it do not reach."""
MOVES_FAR: Final = 4.0
"""Times as far as that, a steady drift is a level that moved, too."""
FEWEST_SWINGS: Final = 4
FEWEST_MOVED: Final = 3
"""Swings in a row that lie off the level."""


def follow_level(log_time: Ints, force: Floats, level: SensorLevel) -> SensorLevel:
    """Return the level of a sensor as its swings have it, where it does not stay what it is.

    Args:
        log_time: (n,) ns, ascending.
        force: (n, 3) N, as recorded; rows that are not finite are left out.
        level: what all samples together show; it is known, and not zero.
    """
    finite = all_finite(force)
    whole = log_time, force = log_time[finite], force[finite]
    swing_s = level.swing_s or _SWING_S
    every = max(int(swing_s / _SAMPLES_A_SWING / (level.interval_s or np.inf)), 1)
    log_time, force = log_time[::every], force[::every]
    axis = load_axis(force) if level.raises else -load_axis(force)
    along = without_spikes(force @ axis)
    limit_n = max(MOVED_NOISES * (level.noise_n or 0.0), MOVED * (level.loaded_n or 0.0))
    window_s = float(np.clip(STRIDES * _SWINGS_A_STRIDE * swing_s, *_WINDOW_S))
    rows = int(window_s * 1e9 / max(float(median_of(np.diff(log_time))), 1.0))
    lightest = _lightest(along, rows, limit_n + (level.loaded_n or 0.0) / 2.0)
    if lightest is None:
        return level
    found = level
    if (np.abs(lightest - level.offset_at(log_time) @ axis) > limit_n).any():
        modes = two_modes(along - lightest, run_numbers(log_time), raises=True)
        if len(modes.swings) < FEWEST_SWINGS:
            return level
        found = level_of(modes, log_time, force, axis)
    moves, bends = found.offset @ axis, False
    if len(moves) >= FEWEST_SWINGS:
        since = (found.knots - found.knots[0]) / 1e9
        off = np.abs(moves - np.polyval(np.polyfit(since, moves, 1), since)) > limit_n
        bends = bool(np.convolve(off, np.ones(FEWEST_MOVED)).max() >= FEWEST_MOVED)
    if not bends and np.ptp(moves) <= MOVES_FAR * limit_n:
        return level
    return replace(
        found,
        knots=_at_steps(found.knots, moves, whole[0], whole[1] @ axis, limit_n),
        # In the swing in which it was re-zeroed, a sensor seems to stray.
        wobble_n=level.wobble_n,
        raises=level.raises,
        drift_n_per_min=None if bends else found.drift_n_per_min,
        moved_n=float(np.ptp(moves)),
        fit=level.fit,
    )


def _at_steps(knots: Ints, level: Floats, time: Ints, values: Floats, limit_n: float) -> Ints:
    """Return knots moved to both sides of where the sensor was re-zeroed, ns.

    That is a step between two samples, by what the level changes, with no such step beside it.

    Args:
        knots: (k,) ns.
        level: (k,) N, at the knots, along the load's axis.
        time: (n,) ns.
        values: (n,) N, along that axis.
        limit_n: N, by which a level changes that is re-zeroed.
    """
    moved, steps = knots.copy(), np.diff(values)
    for row in np.flatnonzero(np.abs(np.diff(level)) > limit_n).tolist():
        size = level[row + 1] - level[row]
        first, last = np.searchsorted(time, knots[row : row + 2]).tolist()
        inside = np.arange(max(first, 1), min(last, len(steps) - 1))
        off = np.abs(np.stack([steps[inside] - size, steps[inside - 1], steps[inside + 1]]))
        alone = inside[off.max(axis=0) < ALONE * abs(size)]
        if len(alone) == 1:
            moved[row : row + 2] = time[alone[0] : alone[0] + 2]
    return moved


def _lightest(values: Floats, rows: int, walks_n: float) -> Floats | None:
    """(n,) N, the lightest loads of the walking window about each sample where they are highest.

    So a step up or down is where it happens, to a part of a window.

    Args:
        values: (n,) N, along the load's axis.
        rows: of a window.
        walks_n: N between the lightest and the heaviest loads of a window that is walked.

    Returns:
        None where no window is walked.
    """
    hop = max(rows // _HOPS, 1)
    parts = values[: len(values) // hop * hop].reshape(-1, hop)
    if len(parts) < 2 * _HOPS:
        return None
    windows = sliding_window_view(parts, _HOPS, axis=0).reshape(len(parts) - _HOPS + 1, -1)
    low, high = percentiles_of(windows, _LOW_AND_HIGH, axis=1)
    low = np.where(high - low > walks_n, low, -np.inf)
    padded = np.pad(low, _HOPS - 1, constant_values=-np.inf)
    of_part = sliding_window_view(padded, _HOPS).max(axis=1)
    known = np.flatnonzero(np.isfinite(of_part))
    if not len(known):
        return None
    filled = np.interp(np.arange(len(parts)), known, of_part[known])
    part = np.minimum(np.arange(len(values)) // hop, len(parts) - 1)
    return np.asarray(filled[part])
