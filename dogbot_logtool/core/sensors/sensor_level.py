"""The level that a force sensor reads without load, with its noise and drift.

A simulated sensor reads exactly zero in swing. A real one reads tens of newtons of either sign,
drifts and is noisy. In a walk a foot's forces have two modes, swing and stance. The swing mode is
narrow against the distance between both and is visited once a stride, and its visits agree with
each other. Shifting weight in a stand does not look like that, and then the level stays unknown.
"""

from dataclasses import replace
from typing import Final, Literal

import numpy as np

from dogbot_logtool.core.geometry.arrays import Floats, Ints, all_finite, norms
from dogbot_logtool.core.geometry.clock import usual_interval_s
from dogbot_logtool.core.geometry.order_statistics import median_of, percentiles_of
from dogbot_logtool.core.sensors.saturation import resolution_n, saturated_limit_n
from dogbot_logtool.core.sensors.sensor_modes import (
    ALTERNATE,
    MIDDLE_SHARE,
    NOISY,
    ONCE,
    WIDE,
    Modes,
    Visits,
    judge_modes,
    two_modes,
)
from dogbot_logtool.core.sensors.zero_in_swing import rests_at_zero
from dogbot_logtool.dataclass import dataclass

Origin = Literal["option", "robot", "estimated", "default"]
"""The origin of a setting."""

FEWEST_SAMPLES: Final = 20
CLEAR_OF_NOISE: Final = 5.0
"""Least distance between both modes, in standard deviations of the noise."""
DROPOUTS: Final = 3
"""Lone zeros under load that make a sensor one that drops out."""
_LOADED: Final = 75.0
"""Percentile of the forces that stands for the usual load where swings are not told apart."""
_RANGE: Final = (3.0, 97.0)
"""The same for the lightest and for the heaviest load."""
SURE: Final = 3.0
"""Lead in score from which it is certain which way a load turns what a sensor reads."""
UNSURE: Final = 1.0
"""Lead in score up to which that is not known, unless the weight tells."""
_STRAYS: Final = 98.0
"""Percentile of the unloaded forces, against the offset, that stands for the furthest."""
_LONG_ROWS: Final = 8
"""Samples in the middle of a visit, from which its ends are surely left out."""
_KNOT_VISITS: Final = 4
_KNOT_S: Final = 15.0
"""A knot of the drift needs so many visits over so long a time."""
_DRIFT_S: Final = 30.0
"""Shortest time from the first to the last swing over which a drift is stated."""
_NORMAL_SD: Final = 1.4826
"""Standard deviation over median absolute deviation, of a normal distribution."""


@dataclass(frozen=True, slots=True)
class SensorLevel:
    """Readings of one foot's sensor without load and under load."""

    knots: Ints
    """(k,) ns, log times at which the offset is known, ascending; between them it is linear."""
    offset: Floats
    """(k, 3) N, what the unloaded sensor reads at the knots."""
    noise_n: float | None = None
    """N, standard deviation of the unloaded sensor's noisiest component, from one sample to the
    next; None: not known."""
    wobble_n: float = 0.0
    """N, how far the unloaded sensor strays from the offset: the inertia of a leg that swings."""
    drift_n_per_min: float | None = None
    """N a minute, towards the load; None: the swings span too short a time."""
    moved_n: float = 0.0
    """N, how far the offset moves in the log, where it does not stay and was followed."""
    loaded_n: float | None = None
    """N, median force above the offset while loaded; None: not known."""
    mean_n: float | None = None
    """N, mean load over all samples. All feet are sampled over the same time, in which their sum
    is the weight."""
    mean_recorded_n: float | None = None
    """N, the same with the offset left in."""
    interval_s: float | None = None
    """s, usual sampling interval."""
    swing_s: float | None = None
    """s, about how long the sensor is unloaded in a stride; None: not known."""
    zero_in_swing: bool = False
    """Whether the sensor reads exactly zero, or lists no contact, in swing."""
    origin: Origin = "default"
    """The origin of the offset."""
    limit_n: float | None = None
    """N, where one of the sensor's axes is cut off; None: none is seen to be."""
    resolution_n: float = 0.0
    """N, the step in which its coarsest axis counts."""
    drops_out: bool = False
    """Whether single samples are zero under load, as where messages are lost on a sensor's bus."""
    reason: str = ""
    """Why the level could not be estimated; empty where it is known."""
    alternative: "SensorLevel | None" = None
    """The level if the lower of two loads were none, where that is not clear."""
    lightest_n: float | None = None
    """N, magnitude that the lightest samples stay below; only where the level is not known. Also
    `heaviest_n`, that the heaviest ones exceed."""
    heaviest_n: float | None = None
    raises: bool = True
    """Whether load raises what the sensor reads."""
    lead: float = np.inf
    """How much better that fits than that load lowers it, or the other way round."""
    opposite: "SensorLevel | None" = None
    """The level if load turned it the other way, known or not."""
    refuted: str = ""
    """Why nothing is known although swings and stances are seen; zero cannot be assumed either."""

    @property
    def offset_n(self) -> Floats:
        """(3,) N, the offset in the middle of the log."""
        middle: Floats = median_of(self.offset, axis=0)
        if self.moved_n:
            middle = self.offset_at((self.knots[:1] + self.knots[-1:]) // 2)[0]
        return middle

    def offset_at(self, log_time: Ints) -> Floats:
        """Return the offset at some log times, ns, (n,); (n, 3) N."""
        if len(self.knots) == 1:
            return np.broadcast_to(self.offset[0], (len(log_time), 3))
        since = (log_time - self.knots[0]).astype(np.float64)
        knots = (self.knots - self.knots[0]).astype(np.float64)
        return np.stack([np.interp(since, knots, part) for part in self.offset.T], axis=1)


def no_offset() -> tuple[Ints, Floats]:
    """Return the knots of an offset that is zero throughout."""
    return np.zeros(1, np.int64), np.zeros((1, 3))


def zero_reading() -> SensorLevel:
    """Return the level of a sensor that reads zero in swing, of which nothing else is known."""
    return SensorLevel(*no_offset(), zero_in_swing=True)


def estimate_level(log_time: Ints, force: Floats) -> SensorLevel:
    """Estimate offset, noise and drift of one foot's sensor from its own samples.

    Args:
        log_time: (n,) ns, ascending; there may be gaps, as in a probe spread over a log.
        force: (n, 3) N, as recorded; rows that are not finite are left out.
    """
    finite = all_finite(force)
    log_time, force = log_time[finite], force[finite]
    interval_s = usual_interval_s(log_time)
    if len(force) < FEWEST_SAMPLES:
        return _unknown("too few samples", interval_s, force)
    zero = zero_level(force, interval_s)
    if zero is not None:
        return zero
    axis = load_axis(force)
    along = without_spikes(force @ axis)
    runs = run_numbers(log_time)
    modes = [two_modes(along, runs), two_modes(-along, runs)]
    step = resolution_n(force)
    judged = (
        judge_modes(modes[0], modes[1].swing.width, raises=True, step=step),
        judge_modes(modes[1], modes[0].swing.width, raises=False, step=step),
    )
    likely, other = sorted(judged, key=lambda each: each.score, reverse=True)
    level, opposite = (
        _judged_level(each, log_time, force, axis, interval_s) for each in (likely, other)
    )
    lead = likely.fit - other.fit
    if level.reason:
        return level
    if not opposite.reason and (level.limit_n is None) != (opposite.limit_n is None):
        # What is cut off at a limit does not vary there: that says nothing of swing.
        lead -= 2.0 * likely.width_fit
    if opposite.reason and lead < (SURE if opposite.reason == ONCE else UNSURE):
        return replace(opposite, alternative=None)
    if lead < 0.0:
        level, opposite, lead = opposite, level, -lead
    return replace(level, lead=lead, opposite=replace(opposite, lead=lead))


def _judged_level(
    judged: Modes, log_time: Ints, force: Floats, axis: Floats, interval_s: float | None
) -> SensorLevel:
    """Return the level that modes stand for, or why it is not known; see `_level_of`."""
    if judged.reason not in {"", ALTERNATE, ONCE, WIDE}:
        return _unknown(judged.reason, interval_s, force)
    level = _level_of(judged, log_time, force, axis if judged.raises else -axis, interval_s)
    reason = judged.reason or (NOISY if _is_noisy(level) else "")
    if not reason:
        return level
    unknown = _unknown(reason, interval_s, force)
    if reason == ONCE:
        return replace(unknown, wobble_n=level.wobble_n)
    return replace(unknown, alternative=level)


def _is_noisy(level: SensorLevel) -> bool:
    return (level.loaded_n or 0.0) < CLEAR_OF_NOISE * (level.noise_n or 0.0)


def zero_level(force: Floats, interval_s: float | None) -> SensorLevel | None:
    """Return the level of a sensor that reads exactly zero in swing; None: it does not.

    Args:
        force: (n, 3) N, finite.
        interval_s: s, the usual sampling interval.
    """
    if not rests_at_zero(force):
        return None
    magnitude = norms(force)
    loaded = float(median_of(magnitude[magnitude > 0.0])) if magnitude.any() else None
    knots, offset = no_offset()
    return SensorLevel(
        knots,
        offset,
        noise_n=0.0,
        drift_n_per_min=0.0,
        loaded_n=loaded,
        limit_n=saturated_limit_n(force, offset[0], loaded) if loaded else None,
        resolution_n=resolution_n(force),
        mean_n=float(magnitude.mean()),
        interval_s=interval_s,
        zero_in_swing=True,
        origin="estimated",
    )


def _drops_out(force: Floats, loaded_n: float) -> bool:
    """Tell whether lone samples are zero between loaded ones, (n, 3) N as recorded."""
    magnitude = norms(force)
    high = magnitude > loaded_n / 2.0
    lone = (magnitude[1:-1] == 0.0) & high[:-2] & high[2:]
    return int(lone.sum()) >= DROPOUTS


def _unknown(reason: str, interval_s: float | None, force: Floats) -> SensorLevel:
    """Return the level of a sensor that does not show it; its noise shows between samples."""
    usual = float(percentiles_of(norms(force), _LOADED)) if len(force) else None
    noise = lightest = heaviest = None
    if len(force) >= FEWEST_SAMPLES:
        lightest, heaviest = percentiles_of(without_spikes(norms(force)), _RANGE).tolist()
        steps = np.abs(np.diff(force, axis=0))
        noise = _NORMAL_SD * float(median_of(steps, axis=0).max()) / np.sqrt(2.0)
    return SensorLevel(
        *no_offset(),
        noise_n=noise,
        loaded_n=usual,
        mean_n=usual,
        interval_s=interval_s,
        reason=reason,
        lightest_n=lightest,
        heaviest_n=heaviest,
    )


def load_axis(force: Floats) -> Floats:
    """(3,) unit vector along which the force varies most; lone spikes do not count."""
    low, high = percentiles_of(force, [1.0, 99.0], axis=0)
    _, vectors = np.linalg.eigh(np.cov(np.clip(force, low, high).T))
    axis: Floats = vectors[:, -1]
    return axis if axis[np.abs(axis).argmax()] > 0.0 else -axis


def without_spikes(values: Floats) -> Floats:
    """(n,): the median of each value and its two neighbours."""
    padded = np.concatenate([values[:1], values, values[-1:]])
    smooth: Floats = median_of(np.stack([padded[:-2], padded[1:-1], padded[2:]]), axis=0)
    return smooth


def run_numbers(log_time: Ints) -> Ints:
    """(n,): samples with the same number have no silence between them."""
    steps = np.diff(log_time, prepend=log_time[:1])
    usual = median_of(steps[1:])
    runs: Ints = np.cumsum(steps > max(5.0 * usual, 5e7))
    return runs


def _level_of(
    modes: Modes, log_time: Ints, force: Floats, axis: Floats, interval_s: float | None
) -> SensorLevel:
    """Work out the level of a sensor with two clear modes.

    Args:
        modes: swing and stance.
        log_time: (n,) ns.
        force: (n, 3) N.
        axis: (3,) unit vector towards the load.
        interval_s: s, the usual sampling interval.
    """
    visits = modes.swing.visits
    levels = visits.medians(force)
    middle = visits.middle(log_time)
    residual = visits.strays(force)
    noise = noisiest_sd(residual)
    inside = np.diff(visits.rows()) == 1
    steps = np.abs(np.diff(residual, axis=0))[inside]
    if len(steps):
        noise = min(noise, _NORMAL_SD * float(median_of(steps, axis=0).max()) / np.sqrt(2.0))
    knots, offset = _knots(middle, levels)
    level = SensorLevel(
        knots,
        offset,
        noise_n=noise,
        wobble_n=_wobble_n(modes.rest, force),
        drift_n_per_min=_drift(middle, levels @ axis),
        interval_s=interval_s,
        swing_s=visit_s(visits, log_time),
        origin="estimated",
        raises=modes.raises,
    )
    level = with_loads(level, log_time, force, axis, modes.stance.visits)
    loaded = level.loaded_n or 0.0
    return replace(
        level,
        limit_n=saturated_limit_n(force, level.offset_n, loaded),
        resolution_n=resolution_n(force),
        drops_out=_drops_out(force, loaded),
    )


def noisiest_sd(residual: Floats) -> float:
    """Return the standard deviation of the noisiest component, N, of (m, 3) N; robust."""
    return _NORMAL_SD * float(median_of(np.abs(residual), axis=0).max())


def with_loads(
    level: SensorLevel, log_time: Ints, force: Floats, axis: Floats, stances: Visits
) -> SensorLevel:
    """Return a level with the loads above it.

    Args:
        level: of the unloaded sensor.
        log_time: (n,) ns.
        force: (n, 3) N.
        axis: (3,) unit vector towards the load.
        stances: of the foot.
    """
    load = (force - level.offset_at(log_time)) @ axis
    return replace(
        level,
        loaded_n=float(median_of(stances.quantiles(load, 0.5))),
        mean_n=float(load.mean()),
        mean_recorded_n=float(np.linalg.norm(force.mean(axis=0))),
    )


def _wobble_n(swings: Visits, force: Floats) -> float:
    """Return how far forces stray in swings, N; 0 where these last too few samples to tell.

    Args:
        swings: without the rise to stance at their ends.
        force: (n, 3) N.
    """
    length = swings.end - swings.start
    long = Visits(swings.start[length >= _LONG_ROWS], swings.end[length >= _LONG_ROWS])
    if not len(long):
        return 0.0
    return float(percentiles_of(norms(long.strays(force)), _STRAYS))


def visit_s(visits: Visits, log_time: Ints) -> float:
    """Return how long a usual visit lasts, s; its ends were cut off."""
    length = (log_time[visits.end - 1] - log_time[visits.start]) / 1e9
    return float(median_of(length)) / MIDDLE_SHARE


def _knots(time: Ints, levels: Floats) -> tuple[Ints, Floats]:
    """Reduce the levels of single swings to knots that single ones cannot move.

    Args:
        time: (v,) ns.
        levels: (v, 3) N.
    """
    span_s = float(time[-1] - time[0]) / 1e9
    parts = int(max(1, min(len(time) // _KNOT_VISITS, span_s // _KNOT_S)))
    groups = np.array_split(np.arange(len(time)), parts)
    # Times since the first: the largest that there can be are none as floats.
    since = time - time[0]
    knots = time[0] + np.array([int(median_of(since[group])) for group in groups], np.int64)
    return knots, np.array([median_of(levels[group], axis=0) for group in groups])


def _drift(time: Ints, level: Floats) -> float | None:
    """Return the slope of levels, N a minute: between the median swings of both halves."""
    span_s = float(time[-1] - time[0]) / 1e9
    if span_s < _DRIFT_S or len(time) < 2 * _KNOT_VISITS:
        return None
    minutes = (time - time[0]) / 6e10
    third = len(time) // 3
    rise = median_of(level[-third:]) - median_of(level[:third])
    return float(rise / (median_of(minutes[-third:]) - median_of(minutes[:third])))
