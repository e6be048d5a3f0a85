"""Whether a force sensor reads exactly zero in swing, as simulated ones and tared ones do."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, distinct, median_of, norms

IN_RUNS: Final = 0.25
"""Share of the zeros that stand in runs of three and more in a sensor that reads zero in swing;
messages that are lost here and there make single zeros."""
LIGHT: Final = 0.05
"""Share of the usual load below which a sample counts as light."""
PULL: Final = 0.02
"""Share of the usual load by which no ground can pull at a foot."""
LIGHTLY: Final = 0.35
"""Times the usual load: a reading in swing stays below."""
PULLS: Final = 0.1
"""Share of the zeros from which so many such pulls make a sensor that does not rest at zero."""


def rests_at_zero(force: Floats) -> bool:
    """Tell whether a sensor reads exactly zero where its load is light, (n, 3) N, finite."""
    magnitude = norms(force)
    zero = magnitude == 0.0
    if in_runs(zero).sum() <= IN_RUNS * zero.sum():
        return False
    if zero.all():
        return True
    light = magnitude < LIGHT * median_of(magnitude[~zero])
    if 2 * zero.sum() < light.sum() or _pulls(force, zero):
        return False
    # A sensor that has died reads zero in one visit.
    visit = np.cumsum(light & ~np.concatenate([[False], light[:-1]]))
    visits = distinct(visit[in_runs(light)])
    return 2 * len(distinct(visit[in_runs(zero)])) >= len(visits)


def _pulls(force: Floats, zero: Flags) -> bool:
    """Tell whether a sensor that counts in steps also reads less than nothing, (n, 3) N.

    Full loads the other way are those of a sensor that turns with its link.
    """
    if zero.all():
        return False
    load, magnitude = force @ force.mean(axis=0), norms(force)
    pulled = load < -PULL * median_of(load[~zero])
    pulled &= magnitude < LIGHTLY * median_of(magnitude[~zero])
    return bool(pulled.sum() > PULLS * zero.sum())


def in_runs(flags: Flags) -> Flags:
    """(n,) whether a row is one of at least three flagged ones in a row."""
    middle = flags[2:] & flags[1:-1] & flags[:-2]
    within = np.zeros(len(flags), np.bool_)
    for shift in range(3):
        within[shift : shift + len(middle)] |= middle
    return within
