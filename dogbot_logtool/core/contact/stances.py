"""One stance, reduced to the figures that are reported of it."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    first_where,
    highest,
    quantiles,
    sorted_runs,
    sums,
    trapezoids,
)
from dogbot_logtool.core.contact.contact_way import contact_ways, ways_under_load
from dogbot_logtool.core.contact.stance_samples import StanceSamples

IMPACT_S: Final = 0.050
"""The impact is looked for in the first 50 ms of a stance."""
LONGEST_STANCE_S: Final = 10.0
"""Longer stances are not reduced to figures of loads."""
RISE_FROM: Final = 0.2
RISE_TO: Final = 0.8
"""The loading rate is the slope between 20 % and 80 % of the rise."""
FIRST_PEAK: Final = 0.5
"""Ripples on the rise that stay below half of the stance's peak are not its first peak."""


SPIKE: Final = 2.0
"""Times its neighbours and the rest of its stance that a lone spike is at least."""
FEWEST_FOR_SPIKES: Final = 5
"""Samples of a stance from which one of them can stand out."""


class Cut(IntEnum):
    """Why a stance or stride is left out of the metrics; `WHOLE`: it is not."""

    WHOLE = 0
    LOG_START = 1
    LOG_END = 2
    GAP = 3
    STANDING = 4
    FALL = 5


class StanceFigures(NamedTuple):
    """Figures of k stances, (k,) each; NaN where one cannot be known."""

    peak_force_n: Floats
    """N, highest |F|."""
    mean_force_n: Floats
    """N, mean of |F| over the samples."""
    spikes: Floats
    """Number of samples that stand alone, far above all others of the stance; see `_spikes`."""
    spike_phase: Floats
    """Share of the stance before the highest of them; NaN without any."""
    calm_peak_n: Floats
    """N, highest |F| of the other samples; also `calm_peak_vertical_n`, of the vertical force."""
    calm_peak_vertical_n: Floats
    peak_vertical_force_n: Floats
    mean_vertical_force_n: Floats
    vertical_impulse_ns: Floats
    """N s, trapezoid from the last sample before touchdown to the first after lift-off."""
    loading_rate_nps: Floats
    """N/s; see `_loading_rates`."""
    impact_ratio: Floats
    """Highest |F| in the first 50 ms over the stance's median."""
    contact_travel_m: Floats
    """m, horizontal distance of the contact points at 10 % and 90 % of the stance."""
    contact_reach_m: Floats
    """m, largest horizontal distance from the contact point at 10 %, up to 90 % of the stance."""
    friction_use: Floats
    """95th percentile of tangential over normal force."""
    loaded_reach_m: Floats
    """m, the same reach, of steps between loaded samples only: a hardly loaded foot may tip."""
    reach_begins_s: Floats
    """s after touchdown, the last time before half of that reach with at most a tenth of it."""
    reach_ends_s: Floats
    """s after touchdown, the first time with at least nine tenths of it."""
    quick_way_m: Floats
    """m, furthest that a single contact point of the loaded foot goes in `QUICK_S`."""
    quick_begins_s: Floats
    """s after touchdown, when it does so; also `quick_ends_s`."""
    quick_ends_s: Floats


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

    def pick(self, rows: Flags) -> "Stances":
        """Return the chosen stances."""
        figures = StanceFigures(*(each[rows] for each in self.figures))
        return Stances(self.touchdown[rows], self.liftoff[rows], self.cut[rows], figures)

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
    force, vertical = samples.force, samples.vector[:, 2]
    ordered = sorted_runs(force, begin, end)
    peak, median = ordered[end - 1], quantiles(ordered, begin, end, 0.5)
    mean = sums(force, begin, end) / (end - begin)
    travel, reach = contact_ways(samples)
    loaded, quick = ways_under_load(samples, mean)
    spike = _spikes(samples)
    spikes = np.flatnonzero(spike)
    spikes = spikes[np.argsort(force[spikes], kind="stable")]
    phase = np.full(len(begin), np.nan)
    phase[samples.stance[spikes]] = samples.phase[spikes]
    impact_end = np.minimum(first_where(samples.time > IMPACT_S, begin), end)
    impact = highest(force, begin, impact_end)
    return StanceFigures(
        peak_force_n=peak,
        mean_force_n=mean,
        spikes=np.bincount(samples.stance[spikes], minlength=len(begin)).astype(np.float64),
        spike_phase=phase,
        calm_peak_n=highest(np.where(spike, -np.inf, force), begin, end),
        calm_peak_vertical_n=highest(np.where(spike, -np.inf, vertical), begin, end),
        peak_vertical_force_n=highest(vertical, begin, end),
        mean_vertical_force_n=sums(vertical, begin, end) / (end - begin),
        vertical_impulse_ns=trapezoids(vertical, samples.time, samples.first),
        loading_rate_nps=_loading_rates(samples, peak),
        impact_ratio=np.where(median > 0.0, impact / median, np.nan),
        contact_travel_m=travel,
        contact_reach_m=reach,
        friction_use=_friction_use(samples),
        loaded_reach_m=loaded.metres,
        reach_begins_s=loaded.begins_s,
        reach_ends_s=loaded.ends_s,
        quick_way_m=quick.metres,
        quick_begins_s=quick.begins_s,
        quick_ends_s=quick.ends_s,
    )


def _spikes(samples: StanceSamples) -> Flags:
    """(n,) whether a sample stands alone, far above all others of its stance.

    It is at least `SPIKE` times its neighbours, and as much above every sample of the stance that
    does not stand out of its neighbours so. The first sample is the foot's impact, whatever it is.
    """
    force, own = samples.force, samples.own
    own[samples.touchdown] = False
    before, after = np.roll(force, 1), np.roll(force, -1)
    alone = own & (force > SPIKE * before) & (force > SPIKE * after)
    others = highest(np.where(alone, 0.0, force), samples.touchdown, samples.end)
    enough = samples.end - samples.touchdown >= FEWEST_FOR_SPIKES
    high: Flags = force > SPIKE * others[samples.stance]
    return alone & high & enough[samples.stance]


def _friction_use(samples: StanceSamples) -> Floats:
    """(k,) 95th percentile of the friction that is known, NaN where none is."""
    rows = np.flatnonzero(np.isfinite(samples.friction))
    begin, end = np.searchsorted(rows, samples.touchdown), np.searchsorted(rows, samples.end)
    use = np.full(len(begin), np.nan)
    known = end > begin
    ordered = sorted_runs(samples.friction[rows], begin, end)
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
    top = np.minimum(first_where(higher, first + 1), last)
    low, high = RISE_FROM * force[top], RISE_TO * force[top]
    above_low = first_where(force >= low[samples.stance], first)
    above_high = first_where(force >= high[samples.stance], first)
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
