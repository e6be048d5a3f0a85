"""The level of an unloaded sensor that moves so far that one threshold for the log will not do.

A sensor that is re-zeroed in the middle of a log, or that warms up, may read as much in later
swings as under load before. The lightest loads of a few strides at a time show how it moves; less
that, swings and stances are found as in any log.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, median_of, percentiles_of
from dogbot_logtool.core.corrections.modes import two_modes
from dogbot_logtool.core.corrections.sensor import (
    SensorLevel,
    level_of,
    load_axis,
    run_numbers,
    without_spikes,
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
FAR: Final = 4.0
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
    if not bends and np.ptp(moves) <= FAR * limit_n:
        return level
    return replace(
        found,
        knots=_at_steps(found.knots, moves, whole[0], whole[1] @ axis, limit_n),
        # In the swing in which it was re-zeroed, a sensor seems to stray.
        wobble_n=level.wobble_n,
        raises=level.raises,
        drift_n_per_min=None if bends else found.drift_n_per_min,
        moved_n=float(np.ptp(moves)),
        lead=level.lead,
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
