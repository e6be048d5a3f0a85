"""One stance, reduced to the figures that are reported of it."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints

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
    """The samples of k stances, stance after stance, n in all.

    Each stance has the sample before it, its own, and the one that ends it. Where the log begins
    in the stance, its first sample stands in for the one before.
    """

    first: Ints
    """(k,) the last row before touchdown, or that of touchdown where nothing is known before it."""
    touchdown: Ints
    """(k,) the first row in contact."""
    end: Ints
    """(k,) the first row out of contact."""
    stance: Ints
    """(n,) the stance that each row belongs to."""
    time: Floats
    """(n,) s since the stance's touchdown."""
    force: Floats
    """(n,) N, magnitude; never higher before touchdown than after it."""
    vertical: Floats
    """(n,) N, vertical part; NaN where its direction is not known."""
    x: Floats
    """(n,) m, contact point in the world; NaN where there is none; also `y`."""
    y: Floats
    friction: Floats
    """(n,) tangential over normal force; NaN where not known or hardly loaded."""


class StanceFigures(NamedTuple):
    """Figures of k stances, (k,) each; NaN where one cannot be known."""

    peak_n: Floats
    """N, highest |F|."""
    mean_n: Floats
    """N, mean of |F| over the samples."""
    peak_samples: Floats
    """Number of samples that equal the peak."""
    spread_n: Floats
    """N, highest minus lowest |F|."""
    peak_vertical_n: Floats
    mean_vertical_n: Floats
    vertical_impulse_ns: Floats
    """N s, trapezoid from the last sample before touchdown to the first after lift-off."""
    loading_rate_nps: Floats
    """N/s; see `_loading_rates`."""
    impact_ratio: Floats
    """Highest |F| in the first 50 ms over the stance's median."""
    contact_travel_m: Floats
    """m, horizontal distance of the contact points at 10 % and 90 % of the stance."""
    friction_use: Floats
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
    figures: StanceFigures
    """(n,) each."""

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


@np.errstate(over="ignore", divide="ignore", invalid="ignore")
def reduce_stances(samples: StanceSamples) -> StanceFigures:
    """Reduce the samples of stances, at least one, to their figures.

    Forces may be anything finite: what overflows is infinite, and no warning.
    """
    begin, end = samples.touchdown, samples.end
    force, vertical = samples.force, samples.vertical
    ordered = _sorted(force, begin, end)
    peak = ordered[end - 1]
    peak_from = _first_where(ordered == peak[samples.stance], begin)
    impact_end = np.minimum(_first_where(samples.time > IMPACT_S, begin), end)
    impact, median = _highest(force, begin, impact_end), quantiles(ordered, begin, end, 0.5)
    return StanceFigures(
        peak_n=peak,
        mean_n=_sums(force, begin, end) / (end - begin),
        peak_samples=(end - peak_from).astype(np.float64),
        spread_n=peak - ordered[begin],
        peak_vertical_n=_highest(vertical, begin, end),
        mean_vertical_n=_sums(vertical, begin, end) / (end - begin),
        vertical_impulse_ns=trapezoids(vertical, samples.time, samples.first),
        loading_rate_nps=_loading_rates(samples, peak),
        impact_ratio=np.where(median > 0.0, impact / median, np.nan),
        contact_travel_m=_contact_travels(samples),
        friction_use=_friction_use(samples),
    )


def _sorted(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(n,) with the values of each run in ascending order."""
    ordered = values.copy()
    for first, last in zip(begin.tolist(), end.tolist(), strict=True):
        ordered[first:last].sort()
    return ordered


def _first_where(flags: Flags, start: Ints) -> Ints:
    """(k,) the first row that is flagged, at or after each start; n: there is none."""
    rows = np.append(np.flatnonzero(flags), len(flags))
    found: Ints = rows[np.searchsorted(rows, start)]
    return found


def _highest(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(k,) maxima of runs, each of which ends before the last row; NaN where one is."""
    highest: Floats = np.maximum.reduceat(values, np.stack([begin, end], axis=1).ravel())[::2]
    return highest


def _sums(values: Floats, begin: Ints, end: Ints) -> Floats:
    """(k,) sums of runs that have a row before and after them.

    numpy adds up pairwise what follows a run's first row: a zero there makes that the whole run,
    as if it stood alone.
    """
    led = values.copy()
    led[begin - 1] = 0.0
    sums: Floats = np.add.reduceat(led, np.stack([begin - 1, end], axis=1).ravel())[::2]
    return sums


def trapezoids(values: Floats, time: Floats, first: Ints) -> Floats:
    """Integrate over real sample times: sums of (v[i] + v[i+1]) / 2 * (t[i+1] - t[i]).

    Args:
        values: (n,) any unit.
        time: (n,) s.
        first: (k,) the first row of each run; it ends before the next one's.

    Returns:
        (k,) unit of the values times s.
    """
    area = np.zeros(len(values))
    area[1:] = (values[1:] + values[:-1]) * np.diff(time)
    area[first] = 0.0
    integrals: Floats = np.add.reduceat(area, first) / 2.0
    return integrals


def quantiles(ordered: Floats, begin: Ints, end: Ints, share: float) -> Floats:
    """Quantile of each run of sorted values, interpolated linearly between neighbours.

    Args:
        ordered: (n,) any unit, each run in ascending order.
        begin: (k,) first row of each run.
        end: (k,) row after its last.
        share: 0.5 for the median.
    """
    place = share * (end - begin - 1)
    below = begin + place.astype(np.int64)
    above = np.minimum(below + 1, end - 1)
    between: Floats = ordered[below] + (ordered[above] - ordered[below]) * (place - (below - begin))
    return between


def _friction_use(samples: StanceSamples) -> Floats:
    """(k,) 95th percentile of the friction that is known, NaN where none is."""
    rows = np.flatnonzero(np.isfinite(samples.friction))
    begin, end = np.searchsorted(rows, samples.touchdown), np.searchsorted(rows, samples.end)
    use = np.full(len(begin), np.nan)
    known = end > begin
    ordered = _sorted(samples.friction[rows], begin, end)
    use[known] = quantiles(ordered, begin[known], end[known], 0.95)
    return use


def _loading_rates(samples: StanceSamples, peak: Floats) -> Floats:
    """Return how fast the load rises, N/s: the slope between 20 % and 80 % of the first peak.

    The first peak is the first local maximum of |F| of at least half the stance's peak. The rise
    runs from the sample before touchdown; where it crosses 20 % and 80 % is interpolated. A rise
    within one sampling interval is not resolved: then the slope is NaN, since the interval and
    not the foot would set it. Source: the 20-80 % method of running research (Milner et al.
    2006, Med. Sci. Sports Exerc. 38:323).

    Args:
        samples: of k stances.
        peak: (k,) N, the highest |F| of each.
    """
    force, first, last = samples.force, samples.first, samples.end - 1
    higher = force >= (FIRST_PEAK * peak)[samples.stance]
    higher[:-1] &= force[:-1] >= force[1:]
    top = np.minimum(_first_where(higher, first + 1), last)
    low, high = RISE_FROM * force[top], RISE_TO * force[top]
    above_low = _first_where(force >= low[samples.stance], first)
    above_high = _first_where(force >= high[samples.stance], first)
    known = (last - first >= 2) & (above_low > first) & (above_low < above_high)
    rise_s = _crossings(samples, above_high[known], high[known])
    rise_s -= _crossings(samples, above_low[known], low[known])
    rate = np.full(len(first), np.nan)
    rate[known] = (high - low)[known] / rise_s
    return rate


def _crossings(samples: StanceSamples, after: Ints, level: Floats) -> Floats:
    """Times at which the force reaches a level between a sample and the one before it."""
    time, force, before = samples.time, samples.force, after - 1
    share = (level - force[before]) / (force[after] - force[before])
    crossing: Floats = time[before] + share * (time[after] - time[before])
    return crossing


def _contact_travels(samples: StanceSamples) -> Floats:
    """Return the net horizontal travel of the contact point, m, from 10 % to 90 % of a stance.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.
    NaN when no samples with a contact point surround both instants.
    """
    rows = np.flatnonzero(np.isfinite(samples.x) & np.isfinite(samples.y))
    begin, end = np.searchsorted(rows, samples.touchdown), np.searchsorted(rows, samples.end)
    duration = samples.time[samples.end]
    tenth, nine_tenths = 0.1 * duration, 0.9 * duration
    known = end - begin >= 2
    known[known] = samples.time[rows[begin[known]]] <= tenth[known]
    known[known] = samples.time[rows[end[known] - 1]] >= nine_tenths[known]

    time, stance = samples.time[rows], samples.stance[rows]
    x, y = samples.x[rows], samples.y[rows]
    places = []
    for at in (tenth, nine_tenths):
        later = _first_where(time > at[stance], begin)[known]
        around = later - 1, np.minimum(later, end[known] - 1)
        places.append([_interpolated(at[known], time, values, around) for values in (x, y)])
    (x_early, y_early), (x_late, y_late) = places
    travel = np.full(len(begin), np.nan)
    travel[known] = np.hypot(x_late - x_early, y_late - y_early)
    return travel


def _interpolated(at: Floats, time: Floats, values: Floats, around: tuple[Ints, Ints]) -> Floats:
    """(k,) values at times between two rows each, or at the time of the first of them."""
    before, after = around
    since = at - time[before]
    slope = (values[after] - values[before]) / (time[after] - time[before])
    return np.where(since == 0.0, values[before], slope * since + values[before])
