"""The two modes of a foot's forces in a walk: swing and stance.

The swing mode is narrow against the distance between both and is visited once a stride, and its
visits agree with each other. Shifting weight in a stand does not look like that.
"""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import (
    Flags,
    Floats,
    Ints,
    latched,
    median_of,
    percentiles_of,
    rows_of_runs,
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
"""Reason of a level that is not known since all samples are alike."""
ONE_MODE: Final = "the force has one mode only"
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
_BINS: Final = 128


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


def two_modes(values: Floats, runs: Ints, *, raises: bool) -> Modes:
    """Find swing and stance in the forces along the load's axis, swing being the lower.

    Args:
        values: (n,) N.
        runs: (n,) numbers; samples with the same one have no silence between them.
        raises: whether load raises what the sensor reads, if these are swing and stance.
    """
    low, peak, high = percentiles_of(values, [1.0, 95.0, 99.0])
    none = np.empty((0, 2), np.int64)
    if high <= low:
        return Modes(none, none, none, raises, reason=CONSTANT)
    enter = leave = _otsu(np.clip(values, low, high))
    for _ in range(_ROUNDS):
        below = _hysteresis(values, enter, leave)
        swings, stances = _visits(below, runs), _visits(~below, runs)
        swing, width = _mode(values, swings)
        if not len(swings) or not len(stances):
            return Modes(swings, stances, none, raises, width=width, reason=ONE_MODE)
        enter, leave = (swing + share * (peak - swing) for share in (_ENTER, _LEAVE))
    stance, _ = _mode(values, stances)
    # From the first to the last sample below `enter` that none above `leave` parts.
    low_rows = _hysteresis(values, enter, leave) & _hysteresis(values[::-1], enter, leave)[::-1]
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
    return latched(values <= enter, values > leave)


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
    if not len(visits):
        return 0.0, 0.0
    low, level, high = visit_quantiles(values, visits, 0.1, 0.5, 0.9).T
    between = float(median_of(np.abs(np.diff(level)))) if len(level) > 1 else 0.0
    # The median of the shortest interval that holds half of the visits.
    ordered = np.sort(level)
    half = len(ordered) // 2 + 1
    first = int((ordered[half - 1 :] - ordered[: len(ordered) - half + 1]).argmin())
    densest = float(median_of(ordered[first : first + half]))
    return densest, float(median_of(high - low)) + between
