"""The samples of stances, as their figures are worked out from them."""

from typing import NamedTuple

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, dots
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class FootSignal:
    """The n samples of one foot that are used."""

    samples: Samples
    time: Ints
    """(n,) ns, strictly increasing."""
    force: Floats
    """(n,) N, |F|."""
    vertical: Floats
    """(n,) N, vertical force; 0 without contact, NaN where its direction is not known."""


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
    vertical: Floats
    """(n,) N, vertical part; NaN where its direction is not known."""
    force_x: Floats
    """(n,) N, horizontal parts along the world's axes, also `force_y`; NaN like `vertical`."""
    force_y: Floats
    x: Floats
    """(n,) m, contact point in the world; NaN where there is none; also `y`."""
    y: Floats
    single: Flags
    """(n,) whether that is one contact point, not the mean of several."""
    friction: Floats
    """(n,) tangential over normal force; NaN where not known or hardly loaded."""


def own_rows(samples: StanceSamples) -> Flags:
    """(n,) whether a row is in contact: not the one before a stance, nor the one that ends it."""
    rows = np.arange(len(samples.force))
    own: Flags = rows >= samples.touchdown[samples.stance]
    return own & (rows < samples.end[samples.stance])


def stance_samples(signal: FootSignal, starts: Ints, ends: Ints, on_n: float) -> StanceSamples:
    """Lay stances end to end.

    Args:
        signal: samples of a foot.
        starts: (k,) rows of touchdowns.
        ends: (k,) rows that end the stances.
        on_n: N, load from which friction tells something.
    """
    counts = ends - starts + 2
    behind = np.cumsum(counts)
    stance = np.repeat(np.arange(len(starts)), counts)
    rows = np.arange(len(stance)) + (ends + 1 - behind)[stance]
    np.maximum(rows, 0, out=rows)
    touchdown = behind - counts + 1
    force, vertical = signal.force[rows], signal.vertical[rows]
    vector = signal.samples.force.take(rows, axis=0).astype(np.float64, copy=False)
    known = ~np.isnan(vertical)
    friction = _friction(force, vector, signal.samples.normal.take(rows, axis=0))
    point = signal.samples.position.take(rows, axis=0).astype(np.float64, copy=False)
    return StanceSamples(
        first=touchdown - (starts > 0),
        touchdown=touchdown,
        end=behind - 1,
        stance=stance,
        time=(signal.time[rows] - signal.time[starts][stance]) / 1e9,
        force=force,
        vertical=vertical,
        force_x=np.where(known, vector[:, 0], np.nan),
        force_y=np.where(known, vector[:, 1], np.nan),
        x=np.where(np.isfinite(point[:, 0]), point[:, 0], np.nan),
        y=np.where(np.isfinite(point[:, 1]), point[:, 1], np.nan),
        single=signal.samples.points[rows] == 1,
        friction=np.where(known & (force >= on_n), friction, np.nan),
    )


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def _friction(force: Floats, vector: Floats, normal: Floats) -> Floats:
    """(n,) tangential over normal force, of |F|, (n,) N, F, (n, 3) N, and (n, 3) unit normals."""
    pressing = dots(vector, normal)
    tangential = np.sqrt(np.maximum(force * force - pressing * pressing, 0.0))
    friction: Floats = tangential / np.abs(pressing)
    return friction
