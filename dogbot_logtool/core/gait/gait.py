"""Which gait? Phases of the feet against a reference foot, and the class that fits them.

Phases say how the feet are coordinated; the duty factor is a separate finding (a trot whose feet
are down for more than half of the stride is a trot all the same).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, permutations
from typing import Final

import numpy as np

from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.geometry.aggregates import wrapped
from dogbot_logtool.core.geometry.arrays import Floats, Ints

TOLERANCE: Final = 0.1
"""Cycles by which phases may differ from those of a class."""
CONSISTENT: Final = 0.8
"""R that the phases of every foot must exceed."""
STAND: Final = "stand"
IRREGULAR: Final = "irregular"
CLASSES: Final = ("pronk", "trot", "pace", "bound", "walk", "gallop")
"""Classes told apart by phases."""

QUADRUPED: Final = 4
"""Feet of the robots whose gaits have names."""


def phases_in(reference: Strides, touchdown: Ints) -> Floats:
    """Return the phase of each touchdown that lies inside a reference stride.

    phase = (TD - TD_ref(k)) / T_ref(k), cycles in [0, 1). Source: Hildebrand 1965, Science
    150:701.

    Args:
        reference: strides of the reference foot.
        touchdown: (n,) ns, of another foot, in order.

    Returns:
        (m,) phases.
    """
    stride = np.searchsorted(reference.touchdown, touchdown, side="right") - 1
    inside = stride >= 0
    inside[inside] = touchdown[inside] < reference.end[stride[inside]]
    stride = stride[inside]
    since = touchdown[inside] - reference.touchdown[stride]
    phases: Floats = since / (reference.end[stride] - reference.touchdown[stride])
    return phases


def phases_by_stride(reference: Strides, touchdown: Ints) -> Floats:
    """Return one phase of a foot for each reference stride, on the circle.

    A foot that moves with the reference foot touches down now just before it, now just after, so
    that a stride may hold two of its touchdowns or none. So the phases of all touchdowns from
    half a period before the stride to half a period after it are averaged on the circle.

    Args:
        reference: n strides.
        touchdown: (m,) ns, of another foot, in order.

    Returns:
        (n,) cycles in [0, 1); NaN where the foot did not touch down.
    """
    period = reference.end - reference.touchdown
    row = np.searchsorted(touchdown, reference.touchdown - period // 2)
    last = np.searchsorted(touchdown, reference.end + period // 2)
    total = np.zeros(len(period), np.complex128)
    while (more := row < last).any():
        since = touchdown[row[more]] - reference.touchdown[more]
        total[more] += np.exp(2j * np.pi * since / period[more])
        row = row + 1
    phase: Floats = np.where(total == 0.0, np.nan, np.angle(total) / (2.0 * np.pi) % 1.0)
    return phase


def class_distances(phases: Floats) -> dict[str, Floats]:
    """Return how far phases are from those of each class.

    The distance is the largest deviation, in cycles, from what defines the class; a class fits
    where it is at most `TOLERANCE`:

    - pronk: all feet together;
    - trot: diagonal pairs together, half a cycle between them;
    - pace: pairs of a side together, half a cycle between them;
    - bound: fore pair together, hind pair together, a lag of more than the tolerance between;
    - walk: touchdowns a quarter of a cycle apart, in any order, and separate: more than the
      tolerance between any two;
    - gallop: fore pair and hind pair each split by more than the tolerance and less than a
      quarter of a cycle.

    Sources: Hildebrand 1965 and 1976; Alexander 1984.

    Args:
        phases: (n, 4) cycles, of front left, front right, back left, back right.

    Returns:
        (n,) distance for each of `CLASSES`; NaN where a phase is not known.
    """
    front_left, front_right, back_left, back_right = phases.T
    fore, hind = apart(front_left, front_right), apart(back_left, back_right)
    lag = apart(_between(front_left, front_right), _between(back_left, back_right))
    gallop = np.maximum(_outside_gallop(fore), _outside_gallop(hind))
    return {
        "pronk": np.max([apart(phases[:, 0], phase) for phase in phases.T], axis=0),
        "trot": _two_pairs(front_left, back_right, front_right, back_left),
        "pace": _two_pairs(front_left, back_left, front_right, back_right),
        "bound": np.max([fore, hind, np.clip(2.0 * TOLERANCE - lag, 0.0, None)], axis=0),
        "walk": _walk(phases),
        "gallop": gallop,
    }


_LATERAL: Final = (0.0, 0.5, 0.75, 0.25)
"""Phases of a walk in which each hind foot is followed by the fore foot of its side."""
_DIAGONAL: Final = (0.0, 0.5, 0.25, 0.75)
"""The same with the fore foot of the other side."""
_QUARTERS: Final = tuple((0.0, *order) for order in permutations((0.25, 0.5, 0.75)))


def apart(first: Floats, second: Floats) -> Floats:
    """Distance of phases on the circle, cycles in [0, 0.5]."""
    distance: Floats = np.abs(wrapped(first - second))
    return distance


def _between(first: Floats, second: Floats) -> Floats:
    """Phase half-way between two, along the shorter arc."""
    middle: Floats = first + wrapped(second - first) / 2.0
    return middle


def _two_pairs(one: Floats, its_mate: Floats, other: Floats, its_other: Floats) -> Floats:
    """Deviation from two pairs, each together, half a cycle apart."""
    between = apart(_between(one, its_mate), _between(other, its_other))
    deviations = [apart(one, its_mate), apart(other, its_other), 0.5 - between]
    distance: Floats = np.max(deviations, axis=0)
    return distance


def _walk(phases: Floats) -> Floats:
    pattern = np.min([_from_pattern(phases, order) for order in _QUARTERS], axis=0)
    pairs = combinations(phases.T, 2)
    closest = np.min([apart(first, second) for first, second in pairs], axis=0)
    distance: Floats = np.maximum(pattern, 2.0 * TOLERANCE - closest)
    return distance


def _from_pattern(phases: Floats, pattern: tuple[float, ...]) -> Floats:
    """Largest deviation from a pattern of phases that may be shifted as a whole."""
    deviation = wrapped(phases - np.array(pattern))
    deviation = wrapped(deviation - deviation[:, :1])
    spread = deviation.max(axis=1) - deviation.min(axis=1)
    return np.asarray(spread / 2.0)


def _outside_gallop(split: Floats) -> Floats:
    """`TOLERANCE` more than the distance of a split from (tolerance, quarter); 0 inside."""
    outside = np.maximum(TOLERANCE - split, split - 0.25)
    split_enough: Floats = np.where(outside < 0.0, 0.0, TOLERANCE + outside + 1e-9)
    return np.where(np.isnan(split), np.nan, split_enough)


@dataclass(frozen=True, slots=True)
class GaitClass:
    """The class of a gait, and how well it fits."""

    name: str | None
    """One of `CLASSES`, ``irregular``, ``stand``; None where it cannot be known."""
    sequence: str | None
    """Walk: ``lateral`` or ``diagonal``, None for an order that is neither (both fore feet in
    succession). Gallop: ``rotary`` or ``transverse``."""
    nearest: str | None
    """The class that fits best, whether it fits or not; None where phases are missing."""
    distance: float | None
    """Cycles, of the nearest class."""


UNKNOWN_GAIT: Final = GaitClass(None, None, None, None)


def classify(phases: Sequence[float], consistency: Sequence[float]) -> GaitClass:
    """Name the gait of mean phases.

    Args:
        phases: cycles, of front left, front right, back left, back right.
        consistency: R of each.
    """
    table = np.array([phases], np.float64)
    if not np.isfinite(table).all():
        return UNKNOWN_GAIT
    distances = {name: float(value[0]) for name, value in class_distances(table).items()}
    nearest = min(distances, key=distances.__getitem__)
    distance = distances[nearest]
    fits = distance <= TOLERANCE and all(each > CONSISTENT for each in consistency)
    name = nearest if fits else IRREGULAR
    return GaitClass(name, _sequence(name, table[0]), nearest, distance)


def _sequence(name: str, phases: Floats) -> str | None:
    """Order of the feet, where the class leaves it open."""
    if name == "walk":
        table = phases[None, :]
        for sequence, pattern in (("lateral", _LATERAL), ("diagonal", _DIAGONAL)):
            if _from_pattern(table, pattern)[0] <= TOLERANCE:
                return sequence
    if name == "gallop":
        fore = wrapped(phases[1:2] - phases[0:1])[0]
        hind = wrapped(phases[3:4] - phases[2:3])[0]
        return "transverse" if fore * hind > 0 else "rotary"
    return None


def diagonality(phases: Sequence[float]) -> float | None:
    """Return the share of the stride by which a hind footfall precedes the fore one of its side.

    Mean over both sides on the circle, cycles in [0, 1): 0 pace, 0.25 lateral-sequence walk,
    0.5 trot, 0.75 diagonal-sequence walk. Source: Cartmill, Lemelin and Schmitt 2002, Zool. J.
    Linn. Soc. 136:401.

    Args:
        phases: cycles, of front left, front right, back left, back right.
    """
    front_left, front_right, back_left, back_right = phases
    left, right = front_left - back_left, front_right - back_right
    if not (np.isfinite(left) and np.isfinite(right)):
        return None
    mean = np.exp(2j * np.pi * left) + np.exp(2j * np.pi * right)
    if abs(mean) < 1e-6:
        return None
    return float(np.angle(mean) / (2.0 * np.pi) % 1.0)
