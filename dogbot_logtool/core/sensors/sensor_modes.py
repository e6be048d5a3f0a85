"""The two modes of a foot's forces in a walk: swing and stance.

The swing mode is narrow against the distance between both and is visited once a stride, and its
visits agree with each other. Shifting weight in a stand does not look like that.
"""

from typing import Final

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints
from dogbot_logtool.core.geometry.order_statistics import median_of, percentiles_of
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
ALTERNATE: Final = "two loads alternate, which may be weight that is shifted in a stand"
"""Reason of a level that is not known since nothing tells a light load from none."""
WIDE: Final = "no narrow unloaded mode: the foot may never be off the ground"
"""Reason of a level that is not known since the forces of swing differ by much."""
ONCE: Final = "the foot is seen unloaded fewer than twice"
"""Reason of a level that is not known since no second swing confirms it."""
_MIDDLE: Final = (0.2, 0.8)
"""Part of a visit that is used: its ends are on the way between the modes."""
MIDDLE_SHARE: Final = _MIDDLE[1] - _MIDDLE[0]
NOISY: Final = "swing and stance differ by little more than the noise"
"""Reason of a level that is not known since both modes are as wide as they are apart."""
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
        behind = np.cumsum(length)
        first = np.repeat(self.start - (behind - length), length)
        rows: Ints = np.arange(len(first)) + first
        return rows

    def middle(self, log_time: Ints) -> Ints:
        """(v,) ns, the time in the middle of each visit, of the samples' (n,) times."""
        found: Ints = log_time[(self.start + self.end - 1) // 2]
        return found

    def strays(self, values: Floats) -> Floats:
        """(m, k): how far each sample, of (n, k), is from the median of its visit."""
        usual = np.repeat(self.medians(values), self.end - self.start, axis=0)
        return np.asarray(values[self.rows()] - usual)

    def quantiles(self, values: Floats, *shares: float) -> Floats:
        """(v, len(shares)): quantiles of each visit's values, (n,); the nearest sample."""
        length = self.end - self.start
        first = np.cumsum(length) - length
        rows = self.rows()
        ordered = values[rows][np.lexsort((values[rows], np.repeat(first, length)))]
        within = np.round((length[:, None] - 1) * np.array(shares)).astype(np.int64)
        found: Floats = ordered[first[:, None] + within]
        return found

    def medians(self, values: Floats) -> Floats:
        """(v, k): median of each visit's values, (n, k)."""
        return np.column_stack([self.quantiles(part, 0.5) for part in values.T])


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode that is visited again and again."""

    visits: Visits
    level: float
    width: float
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
    reason: str = ""
    """Why they are not clear; empty: they are."""
    raises: bool = True
    """Whether load raises what the sensor reads."""
    width_fit: float = 0.0
    """The part of the fit that rests on how much narrower swing is than stance."""

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
        runs: (n,) see `run_numbers`.
    """
    low, peak, high = percentiles_of(values, [1.0, 95.0, 99.0])
    none = Mode(Visits(np.empty(0, np.int64), np.empty(0, np.int64)), 0.0, 0.0)
    if high - low <= 0.0:
        return Modes(none, none, none.visits, reason=CONSTANT)
    limit = _otsu(np.clip(values, low, high))
    enter = leave = limit
    for _ in range(_ROUNDS):
        below = _hysteresis(values, enter, leave)
        swing, stance = _mode(values, _visits(below, runs)), _mode(values, _visits(~below, runs))
        if not len(swing.visits) or not len(stance.visits):
            return Modes(swing, stance, none.visits, reason="the force has one mode only")
        enter, leave = (swing.level + share * (peak - swing.level) for share in (_ENTER, _LEAVE))
    return Modes(swing, stance, rest=_visits(_low(values, enter, leave), runs))


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
    swing, stance = modes.swing, modes.stance
    distance = stance.level - swing.level
    floor = max(1e-3 * distance, _ROUNDED * step)
    wider = (other_width + floor) / (swing.width + floor)
    # Sensors are usually mounted so that a load raises their value, and offsets are smaller
    # than loads; both are habits. A foot that swings may feel its inertia, which widens swing.
    nearer_zero = abs(stance.level) / max(abs(swing.level), floor)
    width_fit = float(np.clip(np.log2(wider), -4.0, 4.0))
    fit = width_fit + float(np.clip(np.log2(max(nearer_zero, 1e-9)), -3.0, 3.0))
    fit += 0.5 if raises else 0.0
    reason = ""
    # Weight cannot pull, so that a level on the other side of zero than the load is unloaded.
    pulls = swing.level < -swing.width and stance.level > 0.0
    plain = swing.level <= PLAIN_OFFSET * distance and (raises or stance.level > 0.0)
    if len(swing.visits) < FEWEST_VISITS and not pulls:
        reason = ONCE
    elif swing.width > NARROW * distance:
        reason = WIDE
    elif wider < WIDER and not plain:
        reason = ALTERNATE
    return Modes(swing, stance, modes.rest, fit, reason, raises, width_fit)


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


def _low(values: Floats, enter: float, leave: float) -> Flags:
    """(n,): from the first to the last sample below `enter` that none above `leave` parts.

    The rise from one to the other at either end is no part of it.
    """
    low: Flags = _hysteresis(values, enter, leave) & _hysteresis(values[::-1], enter, leave)[::-1]
    return low


def _hysteresis(values: Floats, enter: float, leave: float) -> Flags:
    """(n,): below from `enter` down, until above `leave`."""
    below = values <= enter
    says = below | (values > leave)
    last = np.maximum.accumulate(np.where(says, np.arange(len(values)), -1))
    flags: Flags = np.where(last >= 0, below[last], values <= (enter + leave) / 2.0)
    return flags


def _visits(flags: Flags, runs: Ints) -> Visits:
    """Return the middles of the runs of flagged samples."""
    key = np.where(flags, runs + 1, 0)
    edges = np.flatnonzero(np.diff(key, prepend=0, append=0))
    start, end = edges[:-1], edges[1:]
    flagged = key[start] > 0 if len(edges) else np.empty(0, np.bool_)
    start, end = start[flagged], end[flagged]
    length = end - start
    if (length >= _FEWEST_ROWS).any():
        start, end, length = (rows[length >= _FEWEST_ROWS] for rows in (start, end, length))
    first = start + (length * _MIDDLE[0]).astype(np.int64)
    last = end - (length * (1.0 - _MIDDLE[1])).astype(np.int64)
    return Visits(first, np.maximum(last, first + 1))


def _mode(values: Floats, visits: Visits) -> Mode:
    """Reduce visits to a mode; each counts once, however long it lasts."""
    if not len(visits):
        return Mode(visits, 0.0, 0.0)
    low, level, high = visits.quantiles(values, 0.1, 0.5, 0.9).T
    steps = np.abs(np.diff(level))
    between = float(median_of(steps)) if len(steps) else 0.0
    return Mode(visits, _densest(level), float(median_of(high - low)) + between)


def _densest(values: Floats) -> float:
    """Return the median of the shortest interval that holds half of the values."""
    ordered = np.sort(values)
    half = len(ordered) // 2 + 1
    first = int((ordered[half - 1 :] - ordered[: len(ordered) - half + 1]).argmin())
    return float(median_of(ordered[first : first + half]))
