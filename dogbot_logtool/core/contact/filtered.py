"""Forces that went through a low-pass filter of first order: its time constant, and without it.

After a lift-off such a filter lets the force fall by the same share in each moment, so that all
stances end in one exponential tail. A force that nothing filters falls to nothing in finite time.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, all_finite, median_of, percentiles_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrections.clock import usual_interval_s

LEVELS: Final = (0.16, 0.08, 0.04)
"""Shares of a foot's usual load, each half of the one before, between which its fall is timed."""
ALIKE: Final = 0.8
"""Least ratio of those times in an exponential fall; in a straight one it is a half."""
QUICKER: Final = 0.9
"""Most time that a filtered load takes to rise through these levels, as a share of its fall."""
FEWEST_TAILS: Final = 3
FEWEST_INTERVALS: Final = 1.5
"""Sampling intervals from which a time constant is told, and matters."""
LOAD_OVER_NOISE: Final = 20.0
"""Times the noise that the load of a foot must be for its tail to be seen."""
_ROUNDS: Final = 4
_SECOND_DIFFERENCE: Final = 0.6745 * 6.0**0.5
"""Median of |x| of second differences of unit white noise."""
_MARGIN: Final = 0.08
"""Above the highest level, where tails are put one on another."""


def time_constants_s(feet: Sequence[Samples]) -> tuple[float | None, ...]:
    """Return the time constants of the filters that feet's forces went through, s; None: of none.

    Args:
        feet: samples of each whose sensor tells a force all the time.
    """
    told = [_ends_of(samples) for samples in feet]
    common = _time_constant(*(list(chain(*each)) for each in zip(*told, strict=True)))
    interval_s = [usual_interval_s(samples.log_time) or 0.0 for samples in feet]
    if common and np.ptp(interval_s) < ALIKE * min(interval_s):
        return tuple(common * each for each in interval_s)
    alone = [_time_constant(*each) for each in told]
    known = [each for each in alone if each]
    if 2 * len(known) >= len(alone) > 0 and max(known) * ALIKE <= min(known):
        alone = [float(median_of(np.array(known)))] * len(alone)
    return tuple(each and each * seconds for each, seconds in zip(alone, interval_s, strict=True))


def _time_constant(falls: Sequence[Floats] = (), rises: Sequence[Floats] = ()) -> float | None:
    """Return the time constant in which loads fall, in samples; None where they fall otherwise.

    Args:
        falls: loads until stances end; see `_tails`.
        rises: the same of their beginnings, backwards.
    """
    if min(len(falls), len(rises)) < FEWEST_TAILS:
        return None
    fall, rise = _mean(falls), _mean(rises)
    length = len(fall)
    end = float(fall[-max(length // 5, 1) :].mean())
    rest, tau = end, np.nan
    for _ in range(_ROUNDS):
        half = 0 if np.isnan(tau) else int(tau / 6.0)
        smooth = np.convolve(np.pad(fall, half, "edge"), np.full(2 * half + 1, 1.0), "valid")
        smooth /= 2.0 * half + 1.0
        levels = [rest + level * (1.0 - rest) for level in LEVELS]
        first, second, third = (_crossing(smooth, level) for level in levels)
        if not second - first > 0.0 or not third - second >= ALIKE * (second - first):
            return None
        tau = (third - first) / (2.0 * np.log(2.0))
        # The force may not have fallen to nothing when the next stance begins.
        rest = end - LEVELS[-1] * float(np.exp((third - 0.9 * length) / tau))
    rising = _crossing(rise, levels[2]) - _crossing(rise, levels[0])
    return tau if tau > FEWEST_INTERVALS and not rising > QUICKER * (third - first) else None


def _mean(tails: Sequence[Floats]) -> Floats:
    """Return the mean of tails over their usual length."""
    usual = int(median_of(np.array([len(each) for each in tails])))
    return np.asarray(np.mean([each[:usual] for each in tails if len(each) >= usual], axis=0))


def _ends_of(samples: Samples) -> tuple[list[Floats], list[Floats]]:
    """Return how a foot's load falls and, backwards, how it rises; nothing of a noisy one."""
    force = samples.force[all_finite(samples.force)]
    if len(force) < 3:
        return [], []
    load = _along_load(force)
    low, high = percentiles_of(load, (2.0, 90.0))
    noise = float(median_of(np.abs(np.diff(load, 2)))) / _SECOND_DIFFERENCE
    if not high - low > LOAD_OVER_NOISE * noise:
        return [], []
    share = (load - low) / (high - low)
    return _tails(share), _tails(share[::-1])


def _along_load(force: Floats) -> Floats:
    """(n,) N, the force along the direction in which load changes it, larger with load."""
    about = force - median_of(force, axis=0)
    direction = np.linalg.eigh(about.T @ about)[1][:, -1]
    load: Floats = force @ direction
    ends = percentiles_of(load, (2.0, 98.0))
    return load if abs(ends[1]) > abs(ends[0]) else -load


def _tails(share: Floats) -> list[Floats]:
    """Return loads from little above the highest level until shortly before they rise again.

    Args:
        share: (n,) load as a share of the usual one.
    """
    down = np.flatnonzero((share[:-1] > 0.5) & (share[1:] <= 0.5))
    up = np.append(np.flatnonzero((share[:-1] <= 0.5) & (share[1:] > 0.5)), len(share))
    found = []
    for first, last in zip(down.tolist(), up[np.searchsorted(up, down)].tolist(), strict=True):
        tail = share[first:last]
        start = int(np.argmax(tail <= LEVELS[0] + _MARGIN))
        if start:
            around = len(tail) // 10 + 1
            smooth = np.convolve(tail, np.full(around, 1.0 / around), "valid")
            found.append(tail[start : int(np.argmin(smooth)) + around])
    return found


def _crossing(tail: Floats, level: float) -> float:
    """Return where a tail first falls below a level, in samples; NaN if it does not."""
    row = int(np.argmax(tail <= level))
    if not row:
        return np.nan
    return float(row - (level - tail[row]) / (tail[row - 1] - tail[row]))


def without_filter(samples: Samples, tau_s: float) -> Samples:
    """Return samples with the forces that a filter of a time constant was fed with.

    Args:
        samples: with filtered forces.
        tau_s: s.
    """
    interval_s = usual_interval_s(samples.log_time) or tau_s
    reach = max(1, round(tau_s / interval_s / 2.0))
    weight = np.arange(reach, -reach - 1.0, -1.0)
    weight /= (weight @ weight) * interval_s
    padded = np.pad(samples.force, ((reach, reach), (0, 0)), "edge")
    slope = np.stack([np.convolve(axis, weight, "valid") for axis in padded.T], axis=1)
    return replace(samples, force=samples.force + tau_s * slope)
