"""The samples of a foot that are measured, and its stances, reduced to what is reported of them.

Impulses are running totals over every sample, so that they can be asked for between any two times.
"""

from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import (
    Flags,
    Float32s,
    Floats,
    Integral,
    Ints,
    all_finite,
    flagged_runs,
    norms,
    quantiles,
    rows_of_runs,
    runs_of,
    sorted_runs,
    trapezoids,
)
from dogbot_logtool.core.clock import TimeSource, first_at_each_tick, rows_in_time
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.quality import steady_gap_ns

POINT_RATE_HZ: Final = 100.0
"""Contact points and vertical forces are compared with the base at this rate at most."""


class FootTrack(NamedTuple):
    """The n samples of one foot that are used, and their running totals."""

    time: Ints
    """(n,) ns, strictly increasing."""
    row: NDArray[np.int32]
    """(n,) the sample of the recording that each is."""
    log_time: Ints
    """(n,) ns, when it was recorded."""
    force: Floats
    """(n,) N, |F|."""
    vertical_force: Floats | Float32s
    """(n,) N; 0 without contact, NaN where its direction is not known."""
    horizontal_force: Floats | Float32s
    """(n, 2) N, along the world's x and y where the direction is known."""
    contact_points: tuple[Ints, Floats]
    """(p,) ns and (p, 3) m: when and where in the world the foot touches, up to `POINT_RATE_HZ` a
    second."""
    gaps: Ints
    """(g, 2) ns, intervals that are too long: last sample before, first one after."""
    force_impulse: Integral
    """N s, of |F|, gaps left out; one column."""
    impulse: Integral
    """N s, of the force along the world's three axes, where that is known."""
    vertical_unknown: Ints
    """(u, 2) ns, time with a load whose direction is not known."""

    @property
    def vertical_impulse(self) -> Integral:
        """N s, of the vertical force, where that is known; one column."""
        return Integral(self.time, self.impulse.total[:, 2:])

    def without(self, spikes: Ints) -> "FootTrack":
        """Return samples of which some, by their rows, have the force of the ones before them."""
        force, vertical = self.force.copy(), self.vertical_force.copy()
        for values in (force, vertical):
            values[spikes] = values[spikes - 1]
        return self._replace(force=force, vertical_force=vertical)

    def mean_force(self, begin: Ints, end: Ints) -> Floats:
        """(m, 3) N, along the world's axes, between some times; NaN where not known."""
        added = self.impulse.added(begin, end)
        added[timespans.touches(self.vertical_unknown, begin, end)] = np.nan
        return np.asarray(added / ((end - begin) / 1e9)[:, None])


def foot_track(
    samples: Samples, clock: TimeSource, *, force_in_world: bool
) -> tuple[FootTrack, Samples, int]:
    """Integrate the samples of a foot with a finite force and a time later than all before.

    Args:
        samples: of the foot, in the order of the log.
        clock: on which is measured.
        force_in_world: whether the wrenches are in the world frame.

    Returns:
        the track, its samples, and how many of those given have no such force.
    """
    time, force = clock.of(samples), norms(samples.force)
    usable = np.isfinite(force)
    not_finite = len(usable) - int(usable.sum())
    rows = rows_in_time(samples, clock, usable)
    if len(rows) < len(usable):
        samples, time, force = samples.pick(rows), time[rows], force[rows]
    known = samples.in_world | force_in_world | (force == 0.0)
    vertical = np.where(known, samples.force[:, 2], np.nan)
    steps = np.diff(time)
    gap = steps > steady_gap_ns(steps)
    placed = np.flatnonzero(all_finite(samples.position))
    placed = placed[first_at_each_tick(time[placed], POINT_RATE_HZ)]
    # From the last known vertical force, or the start, to the next known one.
    first, behind = flagged_runs(~known).T
    first, behind = np.maximum(first - 1, 0), np.minimum(behind, len(time) - 1)
    seconds = np.where(gap, 0, steps) / 1e9
    known_s = seconds * (known[1:] & known[:-1])
    track = FootTrack(
        time=time,
        row=rows.astype(np.int32),
        log_time=samples.log_time,
        force=force,
        vertical_force=vertical,
        horizontal_force=samples.force[:, :2],
        contact_points=(time[placed], samples.position.take(placed, axis=0).astype(np.float64)),
        gaps=np.stack([time[:-1][gap], time[1:][gap]], axis=1),
        force_impulse=Integral(time, trapezoids(seconds, force[:, None])),
        impulse=Integral(time, trapezoids(known_s, samples.force)),
        vertical_unknown=np.stack([time[first], time[behind]], axis=1),
    )
    return track, samples, not_finite


LOADED: Final = 0.5
"""Share of a stance's mean force from which its foot is loaded."""


def contact_travel(
    samples: Samples, track: FootTrack, begin: Ints, end: Ints, mean: Floats
) -> Floats:
    """Find how far contact points go, horizontally, from 10 % to 90 % of a stance.

    A round foot that rolls moves its contact point without slipping, so this is not slip yet.

    Args:
        samples: n samples of a foot.
        track: their times and forces.
        begin: (k,) rows of touchdowns.
        end: (k,) rows that end the stances.
        mean: (k,) N, mean of |F| in each stance.

    Returns:
        (2, k): m, the net travel, NaN where no samples with a contact point surround both instants;
        and the largest distance by steps between loaded neighbours, NaN where nothing is known.
    """
    found = np.full((2, len(begin)), np.nan)
    rows, stance, _ = rows_of_runs(np.maximum(begin - 1, 0), end + 1)
    x, y, _ = samples.position.take(rows, axis=0).astype(np.float64, copy=False).T
    point = np.asarray(x + 1j * y)
    known = np.isfinite(point)
    rows, stance, point = rows[known], stance[known], point[known]
    since = track.time[rows] - track.time[begin][stance]
    phase = since / (track.time[end] - track.time[begin])[stance]
    inside = (phase >= 0.1) & (phase <= 0.9)
    first, count = runs_of(stance)
    surround = (phase[first] <= 0.1) & (phase[first + count - 1] >= 0.9) & (count >= 2)
    of = stance[first[surround]]
    if len(of):
        # Stances follow each other on one axis, so that all are interpolated at once.
        axis = 4.0 * stance + np.clip(phase, -1.0, 1.0)
        origin, last = (np.interp(4.0 * of + share, axis, point) for share in (0.1, 0.9))
        found[0, of] = np.abs(last - origin)
    if inside.any():
        rows, stance, point = rows[inside], stance[inside], point[inside]
        first, count = runs_of(stance)
        step = np.diff(point, prepend=point[0])
        loaded = track.force[rows] >= (LOADED * mean)[stance]
        # A step counts between two loaded rows of one stance: a foot may tip that is hardly loaded.
        counts = loaded & np.roll(loaded, 1)
        counts[first] = False
        total = np.cumsum(np.where(counts, step, 0.0))
        away = np.abs(total - np.repeat(total[first], count))
        found[1, stance[first]] = np.maximum.reduceat(away, first)
    return found


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
SAME_PHASE: Final = 0.05
"""Share of a stance within which spikes of several stances are at the same phase."""
RECURS: Final = 0.2
"""Share of stances with a spike at the same phase from which it is an impact."""
FEWEST_IMPACTS: Final = 3
_PORTION_ROWS: Final = 65_536
"""Samples of stances that are worked on at once, to spare memory."""


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
    """m, largest horizontal distance from there, by steps between loaded samples."""
    friction_use: Floats
    """95th percentile of tangential over normal force."""


class Stances(NamedTuple):
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
    def middle(self) -> Ints:
        """(n,) ns, half-way between touchdown and lift-off."""
        return self.touchdown + (self.liftoff - self.touchdown) // 2

    @property
    def duration_s(self) -> Floats:
        """(n,) s, lift-off minus touchdown."""
        duration: Floats = (self.liftoff - self.touchdown) / 1e9
        return duration

    def pick(self, rows: Flags) -> "Stances":
        """Return the chosen stances."""
        figures = StanceFigures(*(each[rows] for each in self.figures))
        return Stances(self.touchdown[rows], self.liftoff[rows], self.cut[rows], figures)


@np.errstate(over="ignore")
def lone_spikes(track: FootTrack, begin: Ints, end: Ints) -> Ints:
    """Find the samples that are a fault of the sensor: each stands alone, far above its stance.

    It is at least `SPIKE` times its neighbours, and as much above every sample of the stance that
    does not stand out of its neighbours so. The first sample is the foot's impact, whatever it is;
    so is what recurs at the same phase of many stances, while a fault comes at random, and what
    stands soon after touchdown beside the highest of all others: an impact has flanks.

    Args:
        track: of a foot.
        begin: (k,) rows of touchdowns.
        end: (k,) rows that end the stances.

    Returns:
        (s,) rows.
    """
    if not len(begin):
        return begin
    own, others = track.force[1:-1], track.force.copy()
    rows = 1 + np.flatnonzero((own > SPIKE * track.force[:-2]) & (own > SPIKE * track.force[2:]))
    stance = np.searchsorted(begin, rows) - 1
    inside = (stance >= 0) & (rows < end[stance])
    rows, stance = rows[inside], stance[inside]
    others[rows] = 0.0
    most = np.maximum.reduceat(others, np.stack([begin, end], axis=1).ravel())[::2]
    duration = track.time[end] - track.time[begin]
    can_tell = (end - begin >= FEWEST_FOR_SPIKES) & (duration <= LONGEST_STANCE_S * 1e9)
    spikes = can_tell[stance] & (track.force[rows] > SPIKE * most[stance])
    flank = np.maximum(track.force[rows - 1], track.force[rows + 1])
    early = track.time[rows] - track.time[begin[stance]] <= IMPACT_S * 1e9
    spikes &= ~(early & (flank >= most[stance]))
    rows, stance = rows[spikes], stance[spikes]
    # The highest of each stance may recur.
    highest, phase = np.argsort(track.force[rows]), np.full(len(begin), np.nan)
    since = track.time[rows] - track.time[begin[stance]]
    phase[stance[highest]] = (since / duration[stance])[highest]
    ordered = np.sort(phase)
    near = np.searchsorted(ordered, phase + SAME_PHASE, side="right")
    near -= np.searchsorted(ordered, phase - SAME_PHASE)
    return rows[near[stance] < max(FEWEST_IMPACTS, RECURS * len(begin))]


def stance_figures(
    samples: Samples, track: FootTrack, begin: Ints, end: Ints, on_n: float
) -> StanceFigures:
    """Reduce stances that are short enough to be a step's; figures of the others are NaN.

    Forces may be anything finite: what overflows is infinite, and no warning.

    Args:
        samples: n samples of a foot that are used.
        track: their times and forces.
        begin: (k,) rows of touchdowns.
        end: (k,) rows that end the stances.
        on_n: N, load from which friction tells something.
    """
    figures = np.full((len(StanceFigures._fields), len(begin)), np.nan)
    duration = track.time[end] - track.time[begin]
    steps = np.flatnonzero((duration > 0) & (duration <= LONGEST_STANCE_S * 1e9))
    portion = np.cumsum((end - begin)[steps]) // _PORTION_ROWS
    for part in np.split(steps, np.flatnonzero(np.diff(portion)) + 1):
        if len(part):
            with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
                figures[:, part] = _reduced(samples, track, begin[part], end[part], on_n)
    return StanceFigures(*figures)


def _reduced(samples: Samples, track: FootTrack, begin: Ints, end: Ints, on_n: float) -> Floats:
    """(figures, k) of stances that have samples; arguments as for `stance_figures`."""
    rows, stance, first = rows_of_runs(begin, end)
    force, vertical = track.force[rows], track.vertical_force[rows].astype(np.float64)
    time = (track.time[rows] - track.time[begin][stance]) / 1e9
    count = end - begin
    peak, mean, total_vertical = (
        np.maximum.reduceat(force, first),
        np.add.reduceat(force, first) / count,
        np.add.reduceat(vertical, first),
    )
    median = quantiles(sorted_runs(force, first), first, first + count, 0.5)
    impact = np.maximum.reduceat(np.where(time <= IMPACT_S, force, -np.inf), first)
    impulse = track.impulse.total[:, 2]
    travel, reach = contact_travel(samples, track, begin, end, mean)
    found = StanceFigures(
        peak_force_n=peak,
        mean_force_n=mean,
        peak_vertical_force_n=np.maximum.reduceat(vertical, first),
        mean_vertical_force_n=total_vertical / count,
        vertical_impulse_ns=impulse[end] - impulse[np.maximum(begin - 1, 0)] + 0.0 * total_vertical,
        loading_rate_nps=_loading_rates(track, begin, end, peak),
        impact_ratio=np.where(median > 0.0, impact / median, np.nan),
        contact_travel_m=travel,
        contact_reach_m=reach,
        friction_use=_friction_use(samples, track, rows, stance, on_n),
    )
    return np.stack(found)


def _friction_use(
    samples: Samples, track: FootTrack, rows: Ints, stance: Ints, on_n: float
) -> Floats:
    """(k,) 95th percentile of the friction that is known, NaN where none is."""
    force = track.force[rows]
    vectors = samples.force.take(rows, axis=0).astype(np.float64)
    pressing = np.abs(np.einsum("ij,ij->i", vectors, samples.normal.take(rows, axis=0)))
    friction = np.sqrt(np.maximum(force * force - pressing * pressing, 0.0)) / pressing
    known = np.isfinite(friction) & ~np.isnan(track.vertical_force[rows]) & (force >= on_n)
    friction, of = friction[known], stance[known]
    use, (first, count) = np.full(stance[-1] + 1, np.nan), runs_of(of)
    use[of[first]] = quantiles(sorted_runs(friction, first), first, first + count, 0.95)
    return use


def _loading_rates(track: FootTrack, begin: Ints, end: Ints, peak: Floats) -> Floats:
    """Return how fast the load rises, N/s: the slope between 20 % and 80 % of the first peak.

    The first peak is the first local maximum of |F| of at least half the stance's peak. The rise
    runs from the sample before touchdown; where it crosses 20 % and 80 % is interpolated. A rise
    within one sampling interval is not resolved: then the slope is NaN, since the interval and
    not the foot would set it. Source: the 20-80 % method of running research (Milner et al.
    2006, Med. Sci. Sports Exerc. 38:323).

    Args:
        track: of the foot.
        begin: (k,) rows of touchdowns.
        end: (k,) rows that end the stances.
        peak: (k,) N, the highest |F| of each.
    """
    time, force, last = track.time, track.force, end - 1
    first = np.maximum(begin - 1, 0)
    rows, stance, start = rows_of_runs(first, end)
    own, after = force[rows], force[np.minimum(rows + 1, len(force) - 1)]

    def first_of(flags: Flags) -> Ints:
        """(k,) first flagged row of each stance, or its last one."""
        found: Ints = np.minimum.reduceat(np.where(flags, rows, last[stance]), start)
        return found

    rises_no_more = (own >= FIRST_PEAK * peak[stance]) & ((own >= after) | (rows == last[stance]))
    top = force[first_of(rises_no_more & (rows > first[stance]))]
    low, high = (first_of(own >= (share * top)[stance]) for share in (RISE_FROM, RISE_TO))
    known = (low > first) & (low < high)

    def crossed_s(row: Ints, level: Floats) -> Floats:
        """(k,) s, when the force reaches a level before a row."""
        share = (level - force[row - 1]) / (force[row] - force[row - 1])
        crossed: Floats = (time[row - 1] - time[first] + share * (time[row] - time[row - 1])) / 1e9
        return crossed

    rise_s = crossed_s(high, RISE_TO * top) - crossed_s(low, RISE_FROM * top)
    return np.where(known, (RISE_TO - RISE_FROM) * top / rise_s, np.nan)
