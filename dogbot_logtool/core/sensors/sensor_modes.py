"""The two modes of a foot's forces in a walk: swing and stance.

The swing mode is narrow against the distance between both and is visited once a stride, and its
visits agree with each other. Shifting weight in a stand does not look like that.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, percentiles_of
from dogbot_logtool.dataclass import dataclass

FEWEST_VISITS: Final = 2
"""Swings that must agree on a level."""
NARROW: Final = 0.25
"""Widest swing mode, as a share of the distance between both modes."""
WIDER: Final = 3.0
"""A stance mode wider by this factor tells swing and stance apart wherever they lie."""
PLAIN_OFFSET: Final = 0.15
"""Largest offset towards the load, as a share of the distance, of modes that are equally wide."""
CONSTANT: Final = "the force never changes"
"""Reason of a level that is not known since all samples are alike."""
ONE_MODE: Final = "the force has one mode only"
ALTERNATE: Final = "two loads alternate, which may be weight that is shifted in a stand"
"""Reason of a level that is not known since nothing tells a light load from none."""
WIDE: Final = "no narrow unloaded mode: the foot may never be off the ground"
"""Reason of a level that is not known since the forces of swing differ by much."""
ONCE: Final = "the foot is seen unloaded fewer than twice"
"""Reason of a level that is not known since no second swing confirms it."""
NOISY: Final = "swing and stance differ by little more than the noise"
"""Reason of a level that is not known since both modes are as wide as they are apart."""
_CUT_OFF: Final = 0.2
"""Part of a visit at either end that is on the way between the modes, and not used."""
MIDDLE_SHARE: Final = 1.0 - 2.0 * _CUT_OFF
_UNCLEAR: Final = 100.0
"""Subtracted from the score of modes that are not clear, so that clear ones win."""
_FEWEST_ROWS: Final = 3
"""Samples in a visit; shorter ones are brushes and flicker."""
_ROUNDED: Final = 4.0
"""Steps of a sensor below which widths of modes tell nothing."""
_ROUNDS: Final = 5
_ENTER, _LEAVE = 0.1, 0.35
"""Shares of the way from swing to the highest loads: a visit to the swing mode begins below the
first, and ends above the second."""
_BINS: Final = 128


@dataclass(frozen=True, slots=True)
class Visits:
    """Runs of consecutive samples near one mode; v of them, without their ends."""

    start: Ints
    """(v,) first row; also `end`, the row after the last."""
    end: Ints

    def __len__(self) -> int:
        return len(self.start)

    def rows(self) -> Ints:
        """(m,) rows of all visits."""
        length = self.end - self.start
        shift = self.start - (np.cumsum(length) - length)
        rows: Ints = np.arange(int(length.sum())) + np.repeat(shift, length)
        return rows

    def middle(self, time: Ints) -> Ints:
        """(v,) ns, the time in the middle of each visit, of the samples' (n,) times."""
        return np.asarray(time[(self.start + self.end - 1) // 2])

    def strays(self, values: Floats) -> Floats:
        """(m, k): how far each sample, of (n, k), is from the median of its visit."""
        usual = np.repeat(self.medians(values), self.end - self.start, axis=0)
        return np.asarray(values[self.rows()] - usual)

    def quantiles(self, values: Floats, *shares: float) -> Floats:
        """(v, len(shares)): quantiles of each visit's values, (n,); the nearest sample."""
        length = self.end - self.start
        first = np.cumsum(length) - length
        own = values[self.rows()]
        ordered = own[np.lexsort((own, np.repeat(first, length)))]
        within = np.round((length[:, None] - 1) * np.array(shares)).astype(np.int64)
        return np.asarray(ordered[first[:, None] + within])

    def medians(self, values: Floats) -> Floats:
        """(v, k): median of each visit's values, (n, k)."""
        return np.column_stack([self.quantiles(part, 0.5) for part in values.T])


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode that is visited again and again."""

    visits: Visits
    level: float = 0.0
    width: float = 0.0
    """Usual range of 80 % of the samples within a visit, and between one visit and the next."""


@dataclass(frozen=True, slots=True)
class Modes:
    """Swing and stance of a foot, if the lower values are those of swing."""

    swing: Mode
    stance: Mode
    rest: Visits
    """Swings without the rise to stance at their ends."""
    fit: float = -np.inf
    """How well it fits that these are swing and stance."""
    width_fit: float = 0.0
    """The part of the fit that rests on how much narrower swing is than stance."""
    reason: str = ""
    """Why they are not clear; empty: they are."""

    @property
    def distance(self) -> float:
        """How far stance is from swing, N."""
        return self.stance.level - self.swing.level

    @property
    def score(self) -> float:
        """The fit, less for modes that are not clear.

        The only swing of a log may be one, so that it competes with what else may be.
        """
        return self.fit - (_UNCLEAR if self.reason not in {"", ONCE} else 0.0)


def two_modes(values: Floats, runs: Ints) -> Modes:
    """Find swing and stance in the forces along the load's axis, swing being the lower.

    Args:
        values: (n,) N.
        runs: (n,) numbers; samples with the same one have no silence between them.
    """
    low, peak, high = percentiles_of(values, [1.0, 95.0, 99.0])
    none = Visits(np.empty(0, np.int64), np.empty(0, np.int64))
    if high <= low:
        return Modes(Mode(none), Mode(none), none, reason=CONSTANT)
    enter = leave = _otsu(np.clip(values, low, high))
    for _ in range(_ROUNDS):
        below = _hysteresis(values, enter, leave)
        swing, stance = _mode(values, _visits(below, runs)), _mode(values, _visits(~below, runs))
        if not len(swing.visits) or not len(stance.visits):
            return Modes(swing, stance, none, reason=ONE_MODE)
        enter, leave = (swing.level + share * (peak - swing.level) for share in (_ENTER, _LEAVE))
    # From the first to the last sample below `enter` that none above `leave` parts.
    low_rows = _hysteresis(values, enter, leave) & _hysteresis(values[::-1], enter, leave)[::-1]
    return Modes(swing, stance, _visits(low_rows, runs))


def judge_modes(modes: Modes, other_width: float, *, raises: bool, step: float) -> Modes:
    """Decide whether two modes are swing and stance, and how well they look like it.

    Args:
        modes: what may be swing and stance.
        other_width: N, of the narrow mode if swing were stance and stance were swing.
        raises: whether load would raise what the sensor reads.
        step: N, in which it counts: by so much either mode may be narrower by chance.
    """
    if modes.reason:
        return modes
    swing, stance, distance = modes.swing, modes.stance, modes.distance
    floor = max(1e-3 * distance, _ROUNDED * step)
    wider = (other_width + floor) / (swing.width + floor)
    # Sensors are usually mounted so that a load raises their value, and offsets are smaller
    # than loads; both are habits. A foot that swings may feel its inertia, which widens swing.
    nearer_zero = max(abs(stance.level) / max(abs(swing.level), floor), 1e-9)
    width_fit = float(np.clip(np.log2(wider), -4.0, 4.0))
    fit = width_fit + float(np.clip(np.log2(nearer_zero), -3.0, 3.0)) + 0.5 * raises
    # Weight cannot pull, so that a level on the other side of zero than the load is unloaded.
    pulls = swing.level < -swing.width and stance.level > 0.0
    plain = swing.level <= PLAIN_OFFSET * distance and (raises or stance.level > 0.0)
    reason = ""
    if len(swing.visits) < FEWEST_VISITS and not pulls:
        reason = ONCE
    elif swing.width > NARROW * distance:
        reason = WIDE
    elif wider < WIDER and not plain:
        reason = ALTERNATE
    return replace(modes, fit=fit, width_fit=width_fit, reason=reason)


def _otsu(values: Floats) -> float:
    """Return the value that parts two classes best (Otsu 1979, IEEE Trans. SMC 9:62)."""
    counts, edges = np.histogram(values, _BINS)
    middles = (edges[:-1] + edges[1:]) / 2.0
    below = np.cumsum(counts)[:-1]
    above = len(values) - below
    sum_below = np.cumsum(counts * middles)[:-1]
    mean_below = sum_below / np.maximum(below, 1)
    mean_above = ((counts * middles).sum() - sum_below) / np.maximum(above, 1)
    between = below * above * (mean_above - mean_below) ** 2
    best = np.flatnonzero(between >= between.max() * (1.0 - 1e-9))
    return float(edges[1:][best].mean())


def _hysteresis(values: Floats, enter: float, leave: float) -> Flags:
    """(n,): below from `enter` down, until above `leave`."""
    below = values <= enter
    says = below | (values > leave)
    last = np.maximum.accumulate(np.where(says, np.arange(len(values)), -1))
    return np.where(last >= 0, below[last], values <= (enter + leave) / 2.0)


def _visits(flags: Flags, runs: Ints) -> Visits:
    """Return the middles of the runs of flagged samples."""
    key = np.where(flags, runs + 1, 0)
    edges = np.flatnonzero(np.diff(key, prepend=0, append=0))
    flagged = np.flatnonzero(key[edges[:-1]] > 0)
    start, end = edges[flagged], edges[flagged + 1]
    long = end - start >= _FEWEST_ROWS
    if long.any():
        start, end = start[long], end[long]
    cut = ((end - start) * _CUT_OFF).astype(np.int64)
    return Visits(start + cut, np.maximum(end - cut, start + cut + 1))


def _mode(values: Floats, visits: Visits) -> Mode:
    """Reduce visits to a mode; each counts once, however long it lasts."""
    if not len(visits):
        return Mode(visits)
    low, level, high = visits.quantiles(values, 0.1, 0.5, 0.9).T
    between = float(median_of(np.abs(np.diff(level)))) if len(level) > 1 else 0.0
    # The median of the shortest interval that holds half of the visits.
    ordered = np.sort(level)
    half = len(ordered) // 2 + 1
    first = int((ordered[half - 1 :] - ordered[: len(ordered) - half + 1]).argmin())
    densest = float(median_of(ordered[first : first + half]))
    return Mode(visits, densest, float(median_of(high - low)) + between)
