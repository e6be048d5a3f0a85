"""The force on a foot over its stances, each cut into the same number of equal parts."""

from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.stance_samples import StanceSamples

PARTS: Final = 25
"""Parts of a stance. Sums over them are exact, whatever the sampling."""
AXES: Final = 3


def mean_forces(samples: StanceSamples) -> Floats:
    """Return the mean force in each part of each stance, from touchdown to lift-off.

    The part before touchdown that `StanceSamples` has counts in a stance's first part, so that a
    stance's impulse is the mean of its parts times its duration.

    Returns:
        (k, AXES * PARTS) N, first all parts along x, then y, then z; NaN where the direction of
        the force is not known at some time of the stance.
    """
    stance, last = samples.stance, samples.end
    duration = samples.time[last]
    # Stances are laid end to end, so that all their edges are looked up at once.
    lengths = duration - samples.time[samples.first]
    shift = np.concatenate([[0.0], np.cumsum(lengths)[:-1]]) - samples.time[samples.first]
    time = samples.time + shift[stance]
    edges = shift[:, None] + duration[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
    edges[:, 0] = time[samples.first]
    columns = [
        np.diff(_running_integral(value, samples, time, edges), axis=1)
        for value in (samples.force_x, samples.force_y, samples.vertical)
    ]
    means: Floats = np.concatenate(columns, axis=1) * (PARTS / duration)[:, None]
    return means


def _running_integral(value: Floats, samples: StanceSamples, time: Floats, edges: Floats) -> Floats:
    """(k, PARTS + 1) integral of a value up to each edge; NaN in stances that have one."""
    step = np.diff(time, prepend=time[:1])
    area = np.zeros(len(value))
    area[1:] = np.nan_to_num((value[1:] + value[:-1]) / 2.0) * step[1:]
    area[samples.first] = 0.0
    integral: Floats = np.interp(edges, time, np.cumsum(area))
    unknown = np.zeros(len(edges), np.bool_)
    unknown[samples.stance[np.isnan(value)]] = True
    integral[unknown] = np.nan
    return integral
