"""The level that a force sensor reads without load, with its noise, drift and limits.

A simulated sensor reads exactly zero in swing. A real one reads tens of newtons of either sign,
drifts and is noisy. In a walk a foot's forces have two modes, swing and stance. The swing mode is
narrow against the distance between both and is visited once a stride, and its visits agree with
each other. Where nothing tells which is which, as where weight is shifted in a stand, the level
stays unknown.
The level is that of the swings around each moment, so that it may drift, or be re-zeroed.
"""

from dataclasses import dataclass, field, replace
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    all_finite,
    distinct,
    flagged_runs,
    interpolated,
    latched,
    median_of,
    median_of_known,
    norms,
    percentiles_of,
    quantiles,
    rows_of_runs,
    runs_of,
    sorted_runs,
)

FEWEST_VISITS: Final = 2
"""Swings that must agree on a level."""
NARROW: Final = 0.25
"""Widest swing mode, as a share of the distance between both modes."""
WIDER: Final = 3.0
"""A stance mode wider by this factor tells swing and stance apart wherever they lie."""
PLAIN_OFFSET: Final = 0.15
"""Largest offset towards the load, as a share of the distance, of modes that are equally wide."""
CONSTANT: Final = "the force never changes"
VARIES: Final = 0.01
"""Share of a load by which that of a robot varies that does not stand still in a simulator."""
"""Reason of a level that is not known since all samples are alike."""
ALTERNATE: Final = "two loads alternate, which may be weight that is shifted in a stand"
"""Reason of a level that is not known since nothing tells a light load from none."""
WIDE: Final = "no narrow unloaded mode: the foot may never be off the ground"
"""Reason of a level that is not known since the forces of swing differ by much."""
ONCE: Final = "the foot is seen unloaded fewer than twice"
"""Reason of a level that is not known since no second swing confirms it."""
_CUT_OFF: Final = 0.2
"""Part of a visit at either end that is on the way between the modes, and not used."""
MIDDLE_SHARE: Final = 1.0 - 2.0 * _CUT_OFF
_FEWEST_ROWS: Final = 3
"""Samples in a visit; shorter ones are brushes and flicker."""
_ROUNDS: Final = 5
_ENTER, _LEAVE = 0.1, 0.35
"""Shares of the way from swing to the highest loads: a visit to the swing mode begins below the
first, and ends above the second."""
SAME: Final = 1e-4
"""Share of a force by which it differs in its last digits only."""

FEWEST_SAMPLES: Final = 20
DROPOUTS: Final = 3
"""Lone zeros under load that make a sensor one that drops out."""
CLEAR: Final = 3.0
"""Lead in score from which it is told which way a load turns what a sensor reads."""
SURE: Final = 6.0
"""Lead from which that is certain, whatever the weight says."""
STEPS_UNCLEAR: Final = frozenset({ALTERNATE, WIDE})
"""Reasons of an unknown level with which a load that comes and goes is no sure contact."""
TURNED: Final = "swing and stance look alike, so that either may be the unloaded level"
AROUND: Final = 9
"""Swings around each moment whose median is the level."""
_STRAYS: Final = 98.0
"""Percentile of the unloaded forces, against the offset, that stands for the furthest."""
_DRIFT_S: Final = 30.0
"""Shortest time from the first to the last swing over which a drift is stated."""
_FEWEST_FOR_DRIFT: Final = 8
_NORMAL_SD: Final = 1.4826
"""Standard deviation over median absolute deviation, of a normal distribution."""

LIGHT: Final = 0.35
"""Share of the usual load below which a sample may be one of swing."""
MOSTLY_ZERO: Final = 0.75
"""Share of such samples that are zero where all swings are."""
PULL: Final = 0.02
"""Share of the usual load by which no ground can pull at a foot."""
PULLS: Final = 0.1
"""Share of the zeros from which so many such pulls make a sensor that does not rest at zero."""

MOVED: Final = 0.1
"""Share of the usual load by which a level that was not re-zeroed may change from swing to swing,
and by which the lightest loads of a few strides may lie off it."""
_STRIDES: Final = 4.0
"""Strides of which the lightest loads are compared with the level."""
_SWINGS_A_STRIDE: Final = 3.0
"""Strides last about so many swings."""
_LOW, _HIGH = 0.08, 0.92
"""Quantiles of such strides that are those of swing and of stance."""
STEPS: Final = "what it reads without load steps or strays in the log, as where it was re-zeroed"

Origin = Literal["option", "robot", "estimated", "default"]
"""The origin of a setting."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SensorLevel:
    """Readings of one foot's sensor without load and under load."""

    knots: Ints = field(default_factory=lambda: np.zeros(1, np.int64))
    """(k,) ns, log times at which the offset is known, ascending; between them it is linear."""
    offset: Floats = field(default_factory=lambda: np.zeros((1, 3)))
    """(k, 3) N, what the unloaded sensor reads at the knots."""
    noise_n: float | None = None
    """N, standard deviation of the unloaded sensor's noisiest component, from one sample to the
    next; None: not known."""
    wobble_n: float = 0.0
    """N, how far the unloaded sensor strays from the offset: the inertia of a leg that swings."""
    drift_n_per_min: float | None = None
    """N a minute, towards the load; None: the swings span too short a time."""
    loaded_n: float | None = None
    """N, median force above the offset while loaded; None: not known."""
    mean_n: float | None = None
    """N, mean load over all samples. All feet are sampled over the same time, in which their sum
    is the weight."""
    mean_recorded_n: float | None = None
    """N, the same with the offset left in."""
    swing_s: float | None = None
    """s, about how long the sensor is unloaded in a stride; None: not known."""
    zero_in_swing: bool = False
    """Whether the sensor reads exactly zero, or lists no contact, in swing."""
    origin: Origin = "default"
    """The origin of the offset."""
    limit_n: float | None = None
    """N, where one of the sensor's axes is cut off; None: none is seen to be."""
    drops_out: bool = False
    """Whether single samples are zero under load, as where messages are lost on a sensor's bus."""
    reason: str = ""
    """Why the level could not be estimated; empty where it is known."""
    lead: float = 0.0
    """How much better swing and stance fit than if load changed readings the other way."""
    hides_contact: bool = False
    """Whether zero cannot be assumed where the level is not known, since load comes and goes."""

    @property
    def offset_n(self) -> Floats:
        """(3,) N, the usual offset."""
        return np.asarray(median_of(self.offset, axis=0))

    def offset_at(self, log_time: Ints) -> Floats:
        """Return the offset at some log times, ns, (n,); (n, 3) N."""
        return interpolated(log_time, self.knots, self.offset)


class Modes(NamedTuple):
    """Swing and stance of a foot, if the lower values are those of swing.

    A visit is a run of samples near one mode, without its ends: first row, and row after the last.
    """

    swings: Ints
    """(v, 2) visits to the lower mode."""
    stances: Ints
    """(w, 2) visits to the higher one."""
    rest: Ints
    """(r, 2) swings without the rise to stance at their ends."""
    raises: bool
    """Whether load raises what the sensor reads, for swing to be the lower mode."""
    swing: float = 0.0
    """N, level of the lower mode; also `stance`, of the higher one."""
    stance: float = 0.0
    width: float = 0.0
    """N, usual range of 80 % of the samples in a swing, and between one swing and the next."""
    fit: float = -np.inf
    """How well it fits that these are swing and stance."""
    reason: str = ""
    """Why they are not clear; empty: they are."""


def estimate_level(
    log_time: Ints, force: Floats, plain_offset: float = PLAIN_OFFSET
) -> SensorLevel:
    """Estimate offset, noise and drift of one foot's sensor from its own samples.

    Args:
        log_time: (n,) ns, ascending; there may be gaps.
        force: (n, 3) N, as recorded; rows that are not finite are left out.
        plain_offset: see `both_ways`.
    """
    finite = all_finite(force)
    log_time, force = log_time[finite], force[finite]
    if _rests_at_zero(force):
        return zero_level(force)
    if len(force) < FEWEST_SAMPLES:
        return _unknown("too few samples", force)
    axis = load_axis(force)
    both = both_ways(without_spikes(force @ axis), run_numbers(log_time), plain_offset)
    first, second = sorted(both, key=lambda modes: modes.fit, reverse=True)
    lead = first.fit - second.fit
    if not first.reason and lead >= CLEAR:
        level = replace(level_of(first, log_time, force, axis), lead=lead)
        load = (force - level.offset_at(log_time)) @ axis
        steady = _is_steady(level, log_time, load)
        return level if steady else replace(level, reason=STEPS, hides_contact=True)
    for modes in (first, second):
        if modes.reason == ONCE:
            # The one swing tells how far the unloaded sensor strays.
            wobble_n = level_of(modes, log_time, force, axis).wobble_n
            return replace(_unknown(ONCE, force), wobble_n=wobble_n)
    if first.reason and second.reason:
        return _unknown(first.reason, force)
    return refuted(TURNED)


def zero_level(force: Floats) -> SensorLevel:
    """Return the level of a sensor that reads exactly zero, or lists no contact, in swing.

    Args:
        force: (n, 3) N, finite.
    """
    magnitude = norms(force)
    level = SensorLevel(
        zero_in_swing=True,
        loaded_n=float(median_of(magnitude[magnitude > 0.0])) if magnitude.any() else None,
        mean_n=float(magnitude.mean()) if len(magnitude) else None,
    )
    if magnitude.all():
        # The foot is never seen in the air.
        return level
    return replace(level, noise_n=0.0, drift_n_per_min=0.0, origin="estimated")


def _rests_at_zero(force: Floats) -> bool:
    """Tell whether a sensor reads exactly zero in most of its swings.

    One that has died does so once, and one that sticks until its first stance.

    Args:
        force: (n, 3) N, finite.
    """
    magnitude = norms(force)
    zero = magnitude == 0.0
    if zero.all():
        return len(zero) > 0
    usual = median_of(magnitude[~zero])
    light = magnitude < LIGHT * usual
    # One that counts in steps may also read less than nothing. Full loads the other way are those
    # of a sensor that turns with its link.
    load = force @ force.mean(axis=0)
    pulled = (load < -PULL * median_of(load[~zero])) & light
    if pulled.sum() > PULLS * zero.sum():
        return False
    runs = map(flagged_runs, (light, zero))
    visits, at_zero = (each[np.diff(each)[:, 0] >= _FEWEST_ROWS] for each in runs)
    seen = distinct(np.searchsorted(visits[:, 0], at_zero[:, 0], side="right"))
    # A foot that is lightly loaded in stances, too, has more light visits than swings.
    mostly = np.diff(at_zero).sum() >= MOSTLY_ZERO * light.sum()
    return 0 < len(visits) <= (4 if mostly else 2) * len(seen)


def refuted(why: str) -> SensorLevel:
    """Return what is left of a level that cannot be right."""
    return SensorLevel(reason=why, hides_contact=True)


def _is_steady(level: SensorLevel, log_time: Ints, load: Floats) -> bool:
    """Tell whether a level makes no step, and the lightest loads lie at it throughout.

    Args:
        level: of the sensor, known.
        log_time: (n,) ns.
        load: (n,) N, along the axis of the load, without the offset.
    """
    loaded = level.loaded_n or 0.0
    limit = max(MOVED * loaded, level.wobble_n)
    if (norms(np.diff(level.offset, axis=0)) > limit).any():
        return False
    window_ns = max(round(_STRIDES * _SWINGS_A_STRIDE * (level.swing_s or 0.0) * 1e9), 1)
    window = (log_time - log_time[0]) // window_ns
    # What is left at the end may be less than a stride.
    first, count = runs_of(np.minimum(window, max(int(window[-1]) - 1, 0)))
    ordered = sorted_runs(without_spikes(load), first)
    low, high = (quantiles(ordered, first, first + count, share) for share in (_LOW, _HIGH))
    strays = np.minimum(np.abs(low), np.abs(high)) > limit
    return not (strays & (high - low > limit + loaded / 2.0)).any()


def _unknown(reason: str, force: Floats) -> SensorLevel:
    """Return the level of a sensor that does not show it; its noise shows between samples."""
    if not len(force):
        return SensorLevel(reason=reason)
    usual = float(percentiles_of(norms(force), 75.0))
    level = SensorLevel(loaded_n=usual, reason=reason)
    if len(force) < FEWEST_SAMPLES:
        return level
    noise = _noisiest_sd(np.diff(force, axis=0)) / np.sqrt(2.0)
    lightest = float(percentiles_of(without_spikes(norms(force)), 3.0))
    comes_and_goes = lightest < 3.0 * noise
    return replace(level, noise_n=noise, hides_contact=comes_and_goes and reason in STEPS_UNCLEAR)


def level_of(modes: Modes, log_time: Ints, force: Floats, axis: Floats) -> SensorLevel:
    """Work out the level of a sensor with two clear modes.

    Args:
        modes: swing and stance.
        log_time: (n,) ns.
        force: (n, 3) N.
        axis: (3,) unit vector along which the force varies.
    """
    swings, towards = modes.swings, axis if modes.raises else -axis
    first, last = swings[:, 0], swings[:, 1] - 1
    levels, middle = visit_medians(force, swings), log_time[(first + last) // 2]
    stray, rows = strays(force, swings)
    noise, steps = _noisiest_sd(stray), np.diff(stray, axis=0)[np.diff(rows) == 1]
    if len(steps):
        noise = min(noise, _noisiest_sd(steps) / np.sqrt(2.0))
    rest = norms(strays(force, modes.rest)[0])
    wobble = percentiles_of(rest, _STRAYS) if len(rest) else 0.0
    swing_s = median_of(log_time[last] - log_time[first]) / (MIDDLE_SHARE * 1e9)
    level = SensorLevel(middle, _rolling_median(levels, AROUND))
    load = (force - level.offset_at(log_time)) @ towards
    loaded = float(median_of(visit_quantiles(load, modes.stances, 0.5)))
    # Messages that are lost read zero between loaded ones.
    magnitude = norms(force)
    high = magnitude > loaded / 2.0
    lost = (magnitude[1:-1] == 0.0) & high[:-2] & high[2:]
    return replace(
        level,
        noise_n=noise,
        wobble_n=float(wobble),
        drift_n_per_min=_drift(middle, levels @ towards),
        swing_s=float(swing_s),
        origin="estimated",
        loaded_n=loaded,
        mean_n=float(load.mean()),
        mean_recorded_n=float(np.linalg.norm(force.mean(axis=0))),
        drops_out=int(lost.sum()) >= DROPOUTS,
    )


def _drift(time: Ints, level: Floats) -> float | None:
    """Return the slope of levels, N a minute, from their first third to their last."""
    if time[-1] - time[0] < _DRIFT_S * 1e9 or len(time) < _FEWEST_FOR_DRIFT:
        return None
    third = len(time) // 3
    minutes = (time - time[0]) / 6e10
    rise, run = (median_of(each[-third:]) - median_of(each[:third]) for each in (level, minutes))
    return float(rise / run)


def load_axis(force: Floats) -> Floats:
    """(3,) unit vector along which the force varies most; lone spikes do not count."""
    low, high = percentiles_of(force, [1.0, 99.0], axis=0)
    axis: Floats = np.linalg.eigh(np.cov(np.clip(force, low, high).T))[1][:, -1]
    return axis if axis[np.abs(axis).argmax()] > 0.0 else -axis


def without_spikes(values: Floats) -> Floats:
    """(n,): the median of each value and its two neighbours."""
    padded = np.concatenate([values[:1], values, values[-1:]])
    return np.asarray(median_of(np.stack([padded[:-2], padded[1:-1], padded[2:]]), axis=0))


def run_numbers(log_time: Ints) -> Ints:
    """(n,): samples with the same number have no silence between them."""
    steps = np.diff(log_time, prepend=log_time[:1])
    return np.cumsum(steps > max(5.0 * median_of(steps[1:]), 5e7))


def _rolling_median(values: Floats, width: int) -> Floats:
    """(v, k): the median of each row and its neighbours, fewer at the ends."""
    half = min(width, len(values)) // 2
    padded = np.pad(values, ((half, half), (0, 0)), constant_values=np.nan)
    return np.asarray(median_of_known(sliding_window_view(padded, 2 * half + 1, axis=0), axis=2))


def _noisiest_sd(residual: Floats) -> float:
    """Return the standard deviation of the noisiest component, N, of (m, 3) N; robust."""
    return _NORMAL_SD * float(median_of(np.abs(residual), axis=0).max())


def varies(force: Floats) -> bool:
    """Tell whether loads, (n,) N, are those of a robot that moves, or of a sensor with noise."""
    if not len(force):
        return False
    low, high = percentiles_of(force, [1.0, 99.0])
    return bool(high - low > VARIES * abs(high))


def two_modes(values: Floats, runs: Ints, *, raises: bool) -> Modes:
    """Find swing and stance in the forces along the load's axis, swing being the lower.

    Args:
        values: (n,) N.
        runs: (n,) numbers; samples with the same one have no silence between them.
        raises: whether load raises what the sensor reads, if these are swing and stance.
    """
    low, peak, high = percentiles_of(values, [1.0, 95.0, 99.0])
    none = np.empty((0, 2), np.int64)
    if high - low <= SAME * abs(peak):
        return Modes(none, none, none, raises, reason=CONSTANT)
    enter = leave = (low + high) / 2.0
    for _ in range(_ROUNDS):
        below = latched(values <= enter, values > leave)
        swings, stances = _visits(below, runs), _visits(~below, runs)
        swing, width = _mode(values, swings)
        enter, leave = (swing + share * (peak - swing) for share in (_ENTER, _LEAVE))
    stance, _ = _mode(values, stances)
    # From the first to the last sample below `enter` that none above `leave` parts.
    low_rows = latched(values <= enter, values > leave)
    low_rows &= latched(values[::-1] <= enter, values[::-1] > leave)[::-1]
    return Modes(swings, stances, _visits(low_rows, runs), raises, swing, stance, width)


def both_ways(
    values: Floats, runs: Ints, plain_offset: float = PLAIN_OFFSET
) -> tuple[Modes, Modes]:
    """Find swing and stance if load raises the forces along its axis, and if it lowers them.

    Args:
        values: (n,) N.
        runs: (n,) numbers; samples with the same one have no silence between them.
        plain_offset: offset up to which modes that are equally wide are clear, as `PLAIN_OFFSET`.
    """
    up, down = (two_modes(sign * values, runs, raises=sign > 0.0) for sign in (1.0, -1.0))
    return _judged(up, down.width, plain_offset), _judged(down, up.width, plain_offset)


def _judged(modes: Modes, other_width: float, plain_offset: float) -> Modes:
    """Decide whether two modes are swing and stance, and how well they look like it.

    Args:
        modes: what may be swing and stance.
        other_width: N, of the narrow mode if swing were stance and stance were swing.
        plain_offset: as in `both_ways`.
    """
    if modes.reason:
        return modes
    swing, stance, distance = modes.swing, modes.stance, modes.stance - modes.swing
    floor = 1e-3 * distance
    wider = (other_width + floor) / (modes.width + floor)
    # Sensors are usually mounted so that a load raises their value, and offsets are smaller
    # than loads; both are habits. A foot that swings may feel its inertia, which widens swing.
    nearer_zero = max(abs(stance) / max(abs(swing), floor), 1e-9)
    fit = float(np.clip(np.log2(wider), -4.0, 4.0) + np.clip(np.log2(nearer_zero), -3.0, 3.0))
    fit += 0.5 * modes.raises
    # Weight cannot pull, so that a level on the other side of zero than the load is unloaded.
    pulls = swing < -modes.width and stance > 0.0
    plain = swing <= plain_offset * distance and (modes.raises or stance > 0.0)
    reason = ""
    if len(modes.swings) < FEWEST_VISITS and not pulls:
        reason = ONCE
    elif modes.width > NARROW * distance:
        reason = WIDE
    elif wider < WIDER and not plain:
        reason = ALTERNATE
    return modes._replace(fit=fit, reason=reason)


def visit_quantiles(values: Floats, visits: Ints, *shares: float) -> Floats:
    """(v, len(shares)): quantiles of each visit's values, (n,); the nearest sample."""
    rows, _, first = rows_of_runs(*visits.T)
    ordered = sorted_runs(values[rows], first)
    within = np.round((np.diff(visits) - 1) * np.array(shares)).astype(np.int64)
    return np.asarray(ordered[first[:, None] + within])


def visit_medians(values: Floats, visits: Ints) -> Floats:
    """(v, k): median of each visit's values, (n, k)."""
    return np.column_stack([visit_quantiles(part, visits, 0.5) for part in values.T])


def strays(values: Floats, visits: Ints) -> tuple[Floats, Ints]:
    """(m, k) how far each sample, of (n, k), is from the median of its visit; (m,) its row."""
    rows, run, _ = rows_of_runs(*visits.T)
    return np.asarray(values[rows] - visit_medians(values, visits)[run]), rows


def _visits(flags: Flags, runs: Ints) -> Ints:
    """(v, 2) rows of the middles of the runs of flagged samples."""
    key = np.where(flags, runs + 1, 0)
    edges = np.flatnonzero(np.diff(key, prepend=0, append=0))
    flagged = np.flatnonzero(key[edges[:-1]] > 0)
    start, end = edges[flagged], edges[flagged + 1]
    long = end - start >= _FEWEST_ROWS
    if long.any():
        start, end = start[long], end[long]
    cut = ((end - start) * _CUT_OFF).astype(np.int64)
    return np.stack([start + cut, np.maximum(end - cut, start + cut + 1)], axis=1)


def _mode(values: Floats, visits: Ints) -> tuple[float, float]:
    """Return level and width, N, of the mode of some visits; each counts once, however long."""
    low, level, high = visit_quantiles(values, visits, 0.1, 0.5, 0.9).T
    between = float(median_of(np.abs(np.diff(level)))) if len(level) > 1 else 0.0
    return float(median_of(level)), float(median_of(high - low)) + between
