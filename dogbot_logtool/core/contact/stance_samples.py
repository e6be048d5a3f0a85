"""The samples of stances, as their figures are worked out from them."""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Floats, Ints, dots
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.track import FootTrack

PARTS: Final = 25
"""Equal parts of a stance in which its mean force is known. Sums over them are exact."""
AXES: Final = 3


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
    vector: Floats
    """(n, 3) N, along the world's axes; NaN where its direction is not known."""
    point: NDArray[np.complex128]
    """(n,) m, contact point in the world, x + i y; not finite where there is none."""
    single: Flags
    """(n,) whether that is one contact point, not the mean of several."""
    friction: Floats
    """(n,) tangential over normal force; NaN where not known or hardly loaded."""

    @property
    def own(self) -> Flags:
        """(n,) whether a row is in contact: neither before its stance, nor the one that ends it."""
        rows = np.arange(len(self.force))
        own: Flags = rows >= self.touchdown[self.stance]
        return own & (rows < self.end[self.stance])

    @property
    def phase(self) -> Floats:
        """(n,) share of its stance that has passed at each row."""
        return np.asarray(self.time / self.time[self.end][self.stance])


def stance_samples(
    samples: Samples, track: FootTrack, starts: Ints, ends: Ints, on_n: float
) -> StanceSamples:
    """Lay stances end to end.

    Args:
        samples: n samples of a foot that are used.
        track: their times and forces.
        starts: (k,) rows of touchdowns.
        ends: (k,) rows that end the stances.
        on_n: N, load from which friction tells something.
    """
    counts = ends - starts + 2
    behind = np.cumsum(counts)
    stance = np.repeat(np.arange(len(starts)), counts)
    rows = np.maximum(np.arange(len(stance)) + (ends + 1 - behind)[stance], 0)
    touchdown = behind - counts + 1
    force = track.force[rows]
    vector = samples.force.take(rows, axis=0).astype(np.float64, copy=False)
    point = samples.position.take(rows, axis=0).astype(np.float64, copy=False)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        pressing = dots(vector, samples.normal.take(rows, axis=0))
        friction = np.sqrt(np.maximum(force * force - pressing * pressing, 0.0)) / np.abs(pressing)
    unknown = np.isnan(track.vertical_force[rows])
    friction[unknown | (force < on_n)] = np.nan
    return StanceSamples(
        first=touchdown - (starts > 0),
        touchdown=touchdown,
        end=behind - 1,
        stance=stance,
        time=(track.time[rows] - track.time[starts][stance]) / 1e9,
        force=force,
        vector=np.where(unknown[:, None], np.nan, vector),
        point=point[:, 0] + 1j * point[:, 1],
        single=samples.points[rows] == 1,
        friction=friction,
    )


def mean_forces(samples: StanceSamples) -> Floats:
    """Return the mean force in each part of each stance, from touchdown to lift-off.

    The part before touchdown that `StanceSamples` has counts in a stance's first part, so that a
    stance's impulse is the mean of its parts times its duration.

    Returns:
        (k, AXES, PARTS) N, along x, y and z; NaN where the direction of the force is not known at
        some time of the stance.
    """
    duration = samples.time[samples.end]
    # Stances are laid end to end, so that all their edges are looked up at once.
    start = samples.time[samples.first]
    shift = np.concatenate([[0.0], np.cumsum(duration - start)[:-1]]) - start
    time = samples.time + shift[samples.stance]
    edges = shift[:, None] + duration[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
    edges[:, 0] = time[samples.first]
    means = np.empty((len(duration), AXES, PARTS))
    for axis, value in enumerate(samples.vector.T):
        area = np.zeros(len(value))
        area[1:] = np.nan_to_num((value[1:] + value[:-1]) / 2.0) * np.diff(time)
        area[samples.first] = 0.0
        impulse = np.diff(np.interp(edges, time, np.cumsum(area)), axis=1)
        means[:, axis] = impulse * (PARTS / duration)[:, None]
        means[samples.stance[np.isnan(value)], axis] = np.nan
    return means
