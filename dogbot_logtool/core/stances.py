"""One stance, reduced to the figures that are reported of it."""

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Floats, Ints

IMPACT_S: Final = 0.050
"""The impact is looked for in the first 50 ms of a stance."""
LONGEST_STANCE_S: Final = 10.0
"""Whoever keeps a foot down longer is standing, not stepping."""
RISE_FROM: Final = 0.2
RISE_TO: Final = 0.8
"""The loading rate is the slope between 20 % and 80 % of the rise."""
FIRST_PEAK: Final = 0.5
"""Ripples on the rise that stay below half of the stance's peak are not its first peak."""


class Cut(IntEnum):
    """Why a stance or stride is left out of the figures; `WHOLE`: it is not."""

    WHOLE = 0
    LOG_START = 1
    LOG_END = 2
    GAP = 3
    STANDING = 4
    FALL = 5


class StanceSamples(NamedTuple):
    """The samples of a stance, of the one before it, and of the one that ends it."""

    time: Floats
    """(n,) s since touchdown."""
    force: Floats
    """(n,) N, magnitude."""
    vertical: Floats
    """(n,) N, vertical part; NaN where its direction is not known."""
    x: Floats
    """(n,) m, contact point in the world; NaN where there is none; also `y`."""
    y: Floats
    friction: Floats
    """(n,) tangential over normal force; NaN where not known or hardly loaded."""


class StanceRow(NamedTuple):
    """Figures of one stance; NaN where one cannot be known."""

    peak_n: float
    """N, highest |F|."""
    mean_n: float
    """N, mean of |F| over the samples."""
    peak_samples: float
    """Number of samples that equal the peak."""
    spread_n: float
    """N, highest minus lowest |F|."""
    peak_vertical_n: float
    mean_vertical_n: float
    vertical_impulse_ns: float
    """N s, trapezoid from the last sample before touchdown to the first after lift-off."""
    loading_rate_nps: float
    """N/s; see `loading_rate`."""
    impact_ratio: float
    """Highest |F| in the first 50 ms over the stance's median."""
    contact_travel_m: float
    """m, horizontal distance of the contact points at 10 % and 90 % of the stance."""
    friction_use: float
    """95th percentile of tangential over normal force."""


@dataclass(frozen=True, slots=True)
class Stances:
    """Stances of one foot in order, whole ones and cut ones."""

    touchdown: Ints
    """(n,) ns, first sample in contact; where the stance is cut there, the first known."""
    liftoff: Ints
    """(n,) ns, first sample out of contact; where the stance is cut there, the last known."""
    cut: NDArray[np.int8]
    """(n,) `Cut`."""
    peak_n: Floats
    """(n,) as in `StanceRow`, like all that follow."""
    mean_n: Floats
    peak_samples: Floats
    spread_n: Floats
    peak_vertical_n: Floats
    mean_vertical_n: Floats
    vertical_impulse_ns: Floats
    loading_rate_nps: Floats
    impact_ratio: Floats
    contact_travel_m: Floats
    friction_use: Floats

    @property
    def whole(self) -> Flags:
        """(n,) both touchdown and lift-off were seen, and all between."""
        whole: Flags = self.cut == Cut.WHOLE
        return whole

    @property
    def duration_s(self) -> Floats:
        """(n,) s, lift-off minus touchdown."""
        duration: Floats = (self.liftoff - self.touchdown) / 1e9
        return duration


NOT_REDUCED: Final = StanceRow(*(float("nan"),) * len(StanceRow._fields))
"""A stance that is too long to be a step's."""


def stances_from_rows(touchdown: Ints, liftoff: Ints, cut: Ints, rows: Floats) -> Stances:
    """Make columns of (n, k) rows in the order of `StanceRow`."""
    names = [field.name for field in fields(Stances)][3:]
    if names != list(StanceRow._fields):
        raise TypeError("Stances and StanceRow must have the same figures")
    return Stances(touchdown, liftoff, cut.astype(np.int8), *rows.T)


def reduce_stance(samples: StanceSamples) -> StanceRow:
    """Reduce the samples of one stance to its figures.

    Args:
        samples: the last sample is the first out of contact; the first one is the last before
            touchdown if its time is below 0.
    """
    first = int(samples.time[0] < 0.0)
    stance = slice(first, -1)
    time, force, vertical = samples.time[stance], samples.force[stance], samples.vertical[stance]
    ordered = np.sort(force)
    peak = float(ordered[-1])
    median = quantile(ordered, 0.5)
    impact = float(force[time <= IMPACT_S].max())
    friction = samples.friction[stance]
    friction = np.sort(friction[np.isfinite(friction)])
    return StanceRow(
        peak_n=peak,
        mean_n=float(force.mean()),
        peak_samples=float((force == peak).sum()),
        spread_n=peak - float(ordered[0]),
        peak_vertical_n=float(vertical.max()),
        mean_vertical_n=float(vertical.mean()),
        vertical_impulse_ns=trapezoid(samples.vertical, samples.time),
        loading_rate_nps=loading_rate(samples.time[:-1], samples.force[:-1]),
        impact_ratio=impact / median if median > 0.0 else float("nan"),
        contact_travel_m=contact_travel(
            time, samples.x[stance], samples.y[stance], float(samples.time[-1])
        ),
        friction_use=quantile(friction, 0.95) if len(friction) else float("nan"),
    )


def trapezoid(values: Floats, time: Floats) -> float:
    """Integrate over real sample times: sum of (v[i] + v[i+1]) / 2 * (t[i+1] - t[i])."""
    return float(((values[1:] + values[:-1]) * np.diff(time)).sum() / 2.0)


def quantile(ordered: Floats, share: float) -> float:
    """Quantile of sorted values, interpolated linearly between neighbours."""
    place = share * (len(ordered) - 1)
    below = int(place)
    above = min(below + 1, len(ordered) - 1)
    return float(ordered[below] + (ordered[above] - ordered[below]) * (place - below))


def loading_rate(time: Floats, force: Floats) -> float:
    """Return how fast the load rises, N/s: the slope between 20 % and 80 % of the first peak.

    The first peak is the first local maximum of |F| of at least half the stance's peak. The rise
    runs from the sample before touchdown; where it crosses 20 % and 80 % is interpolated. A rise
    within one sampling interval is not resolved: then the slope is NaN, since the interval and
    not the foot would set it. Source: the 20-80 % method of running research (Milner et al.
    2006, Med. Sci. Sports Exerc. 38:323).

    Args:
        time: (n,) s.
        force: (n,) N, from the last sample before touchdown to the last in contact.
    """
    if len(force) < 3:
        return float("nan")
    higher = (force[1:-1] >= FIRST_PEAK * force.max()) & (force[1:-1] >= force[2:])
    top = int(np.argmax(higher)) + 1 if higher.any() else len(force) - 1
    low, high = RISE_FROM * force[top], RISE_TO * force[top]
    above_low = int(np.argmax(force[: top + 1] >= low))
    above_high = int(np.argmax(force[: top + 1] >= high))
    if above_low in (0, above_high):
        return float("nan")
    rise_s = _crossing(time, force, above_high, high) - _crossing(time, force, above_low, low)
    return float((high - low) / rise_s)


def _crossing(time: Floats, force: Floats, after: int, level: float) -> float:
    """Time at which the force reaches a level between a sample and the one before it."""
    rise = force[after] - force[after - 1]
    share = (level - force[after - 1]) / rise
    return float(time[after - 1] + share * (time[after] - time[after - 1]))


def contact_travel(time: Floats, x: Floats, y: Floats, duration: float) -> float:
    """Return the net horizontal travel of the contact point, m, from 10 % to 90 % of a stance.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.
    NaN when no samples with a contact point surround both instants.

    Args:
        time: (n,) s since touchdown.
        x: (n,) m, NaN where there is no contact point; also `y`.
        y: (n,) m.
        duration: s, of the stance.
    """
    known = np.isfinite(x) & np.isfinite(y)
    at = np.array([0.1, 0.9]) * duration
    time = time[known]
    if len(time) < 2 or time[0] > at[0] or time[-1] < at[1]:
        return float("nan")
    along_x, along_y = np.interp(at, time, x[known]), np.interp(at, time, y[known])
    return float(np.hypot(along_x[1] - along_x[0], along_y[1] - along_y[0]))
