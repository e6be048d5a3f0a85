"""Forces that went through a low-pass filter of first order: its time constant, and without it.

After a lift-off such a filter lets the force fall by the same share in each moment, so that all
stances end in one exponential tail. A force that nothing filters falls to nothing in finite time.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Floats, all_finite, median_of, percentiles_of
from dogbot_logtool.core.clock import usual_interval_s
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.sensor import SAME, load_axis

HALF: Final = 0.5
"""Share of a foot's usual range below which its load falls until it rises above it."""
FEWEST_TAILS, MOST_TAILS = 3, 60
"""Tails of a foot that are averaged; of more, so many are chosen evenly."""
FEWEST_INTERVALS: Final = 1.5
"""Sampling intervals from which a time constant is told, and matters."""
FEWEST_ROWS: Final = 8
AFTER: Final = 0.2
"""Part of a tail's end that is left out: the foot may touch the ground already."""
STRAIGHT: Final = 0.02
"""Share of its fall by which a tail may miss an exponential one, beside its noise; a straight fall
to nothing misses it by twice as much."""
NOISES: Final = 1.6
"""Times the noise of the mean tail that it may miss it, too."""
UNSURE: Final = 0.5
"""Standard error of a time constant, as a share of it, with which it is none."""
CLEAN: Final = 80.0
"""Times the noise that a load's range is, if nothing need be averaged to see where it crosses
`HALF`."""
SOFT: Final = 0.015
"""Noise of the forces before the filter, as a share of the range, that is let be."""
BLUR: Final = 0.18
"""Share of a tail's length that the slope of forces may be averaged over."""
KNOWN: Final = 0.06
"""Standard error of a time constant, as a share of it, up to which the forces before the filter are
known; one of less than a sample does not matter."""
_SECOND_DIFFERENCE: Final = 0.6745 * 6.0**0.5
"""Median of |x| of second differences of unit white noise."""


class Filter(NamedTuple):
    """The low-pass filter that a foot's forces went through."""

    tau_s: float
    """s, its time constant."""
    reach: int
    """Samples before and after each that its slope is taken over, to take the filter out."""
    resolved: bool
    """Whether that tells the forces before it well enough for contact."""


_Tails = tuple[list[Floats], list[Floats], float]
"""How the loads of a foot, as shares of its usual range, fall and, backwards, how they rise; and
the standard deviation of their noise."""
_NO_TAILS: Final[_Tails] = ([], [], 0.0)


def find_filters(feet: Sequence[Samples]) -> tuple[Filter | None, ...]:
    """Find the filters that feet's forces went through; None: of none.

    Args:
        feet: samples of each whose sensor tells a force all the time.
    """
    tails = [_tails_of(samples) for samples in feet]
    interval_s = [usual_interval_s(samples.log_time) or 0.0 for samples in feet]
    alike = len(feet) > 0 and np.ptp(interval_s) < 0.1 * min(interval_s)
    if alike:
        return (_filter(tails, interval_s[0]),) * len(feet)
    return tuple(_filter([each], s) for each, s in zip(tails, interval_s, strict=True))


def _filter(feet: Sequence[_Tails], interval_s: float) -> Filter | None:
    """Return the filter whose exponential tails the loads of feet end in, if they do."""
    falls = [tail for some, _, _ in feet for tail in some]
    rises = [tail for _, some, _ in feet for tail in some]
    if min(len(falls), len(rises)) < FEWEST_TAILS:
        return None
    fall, rise = _mean(falls), _mean(rises)
    # From the lift-off on, where it falls fastest; noise may let that seem earlier.
    over = len(fall) // 8 + 1
    first = int(np.argmin(fall[over:] - fall[:-over])) + over // 2 if over < len(fall) else 0
    tail = fall[first : len(fall) - int(AFTER * (len(fall) - first))]
    if len(tail) < FEWEST_ROWS:
        return None
    tau, error, misses = _exponential(tail)
    noise = float(np.mean([each for _, _, each in feet]))
    most = np.hypot(STRAIGHT * (tail[0] - tail[-1]), NOISES * noise / np.sqrt(len(falls)))
    if tau <= FEWEST_INTERVALS or error >= UNSURE or misses >= most:
        return None
    # A filter prolongs the fall, not the rise.
    if _rows_below(tail[0], rise, fall) >= _rows_below(tail[0], fall, rise):
        return None
    # The slope of a line through m samples has a noise of 12 ** 0.5 / m ** 1.5 of theirs.
    window = (12.0**0.5 * tau * noise / SOFT) ** (2.0 / 3.0)
    reach = max(1, min(round(window / 2.0), round(tau / 2.0)))
    resolved = reach <= BLUR * len(fall) and error <= max(KNOWN, 1.0 / tau)
    return Filter(tau * interval_s, reach, resolved)


def _exponential(tail: Floats) -> tuple[float, float, float]:
    """Fit an exponential fall to any level to a tail, by its integral over time.

    Returns:
        its time constant in samples, the standard error of that as a share of it, and the root of
        the mean squared rest.
    """
    row = np.arange(len(tail), dtype=np.float64)
    total = np.concatenate([[0.0], np.cumsum((tail[1:] + tail[:-1]) / 2.0)])
    # From f' = (level - f) / tau: f = f0 + level / tau * t - integral of f / tau.
    parts = np.stack([-total, row, np.ones_like(row)], axis=1)
    inverse = np.linalg.pinv(parts.T @ parts)
    factors = inverse @ parts.T @ tail
    rest = tail - parts @ factors
    variance = float(rest @ rest) / (len(tail) - 3)
    if not factors[0] > 0.0:
        return np.inf, np.inf, np.inf
    error = float(np.sqrt(variance * inverse[0, 0]) / factors[0])
    return 1.0 / float(factors[0]), error, float(np.sqrt(variance))


def _rows_below(level: float, tail: Floats, other: Floats) -> float:
    """Return the mean time, in samples, that a tail takes for the fall that two have in common."""
    end = max(float(each[-(len(each) // 10 + 1) :].mean()) for each in (tail, other))
    below = tail[int(np.argmax(tail < level)) :]
    return float(np.sum(below - end) / (level - end))


def _mean(tails: Sequence[Floats]) -> Floats:
    """Return the mean of tails over their usual length; noise about `HALF` makes short ones."""
    rows = np.array([len(each) for each in tails])
    usual = int(median_of(rows[rows >= rows.max() / 4]))
    return np.asarray(np.mean([each[:usual] for each in tails if len(each) >= usual], axis=0))


def _tails_of(samples: Samples) -> _Tails:
    """Return how a foot's load falls and rises."""
    force = samples.force[all_finite(samples.force)]
    if len(force) < FEWEST_ROWS:
        return _NO_TAILS
    load = _along_load(force)
    low, high = percentiles_of(load, (2.0, 90.0))
    if high - low <= SAME * max(abs(low), abs(high)):
        return _NO_TAILS
    noise = float(median_of(np.abs(np.diff(load, 2)))) / _SECOND_DIFFERENCE / (high - low)
    share, over = (load - low) / (high - low), int((CLEAN * noise) ** 2) + 1
    if over >= len(share):
        return _NO_TAILS
    smooth = np.convolve(share, np.full(over, 1.0 / over), "same")
    return _tails(share, smooth), _tails(share[::-1], smooth[::-1]), noise


def _along_load(force: Floats) -> Floats:
    """(n,) N, the force along the direction in which load changes it, larger with load."""
    load: Floats = force @ load_axis(force)
    ends = percentiles_of(load, (2.0, 98.0))
    return load if abs(ends[1]) > abs(ends[0]) else -load


def _tails(share: Floats, smooth: Floats) -> list[Floats]:
    """Return loads from where they fall below half until shortly before they rise again.

    Args:
        share: (n,) load as a share of the usual one.
        smooth: (n,) the same with less noise.
    """
    high = smooth > HALF
    down = np.flatnonzero(high[:-1] & ~high[1:]) + 1
    up = np.append(np.flatnonzero(~high[:-1] & high[1:]), len(share) - 1) + 1
    down = down[:: len(down) // MOST_TAILS + 1]
    found = []
    for first, last in zip(down.tolist(), up[np.searchsorted(up, down)].tolist(), strict=True):
        tail = share[first:last]
        around = len(tail) // 10 + 1
        lowest = np.convolve(tail, np.full(around, 1.0 / around), "valid")
        found.append(tail[: int(np.argmin(lowest)) + around])
    return found


def without_filter(samples: Samples, through: Filter) -> Samples:
    """Return samples with the forces that a filter was fed with."""
    interval_s = usual_interval_s(samples.log_time) or through.tau_s
    reach = through.reach
    weight = np.arange(reach, -reach - 1.0, -1.0)
    weight /= (weight @ weight) * interval_s
    padded = np.pad(samples.force, ((reach, reach), (0, 0)), "reflect", reflect_type="odd")
    slope = np.stack([np.convolve(axis, weight, "valid") for axis in padded.T], axis=1)
    return replace(samples, force=samples.force + through.tau_s * slope)
