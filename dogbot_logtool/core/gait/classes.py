"""Which gait? The class that fits the phases and the duty factor of the feet.

Phases say how the feet are coordinated; the duty factor is a separate finding (a trot whose feet
are down for more than half of the stride is a trot all the same).
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, circular_mean, wrapped
from dogbot_logtool.core.gait.strides import Strides
from dogbot_logtool.core.metrics import Gait, LimbPhase

TOLERANCE: Final = 0.1
"""Cycles by which phases may differ from those of a class."""
ALTERNATES: Final = 0.1
"""Cycles by which the steps of two feet may be uneven before that counts as a deviation."""


def class_distances(phases: Floats, duty: Floats) -> dict[str, Floats]:
    """Return how far phases are from those of each class.

    Args:
        phases: (n, feet) cycles. Two feet: in any order. Four: front left, front right, back
            left, back right. Six: the same with middle left, middle right before the back ones.
        duty: (n,) duty factors, which decide between walk and amble or run.

    Returns:
        (n,) distance for each class; NaN where a phase is not known. Of two classes at the same
        distance the first one counts.
    """
    if phases.shape[1] == 6:
        return _of_six_feet(phases)
    return (_of_two_feet if phases.shape[1] == 2 else _of_four_feet)(phases, duty)


def _of_two_feet(phases: Floats, duty: Floats) -> dict[str, Floats]:
    """Alternating (walk above, run below a duty factor of one half) or together (hop)."""
    step = apart(phases[:, 0], phases[:, 1])
    uneven = _worst(0.5 - step - ALTERNATES)
    return {"walk": uneven + _worst(0.5 - duty), "run": uneven + _worst(duty - 0.5), "hop": step}


def _of_four_feet(phases: Floats, duty: Floats) -> dict[str, Floats]:
    """Measure symmetrical and asymmetrical gaits.

    Symmetrical ones have evenly spaced left and right feet in both pairs:

    - trot: diagonality 0.5; pace: diagonality 0;
    - walk: a diagonality further than the tolerance from both; amble: the same below a duty
      factor of one half.

    Asymmetrical ones:

    - gallop: four separate beats, with the feet of each pair up to 0.3 cycles apart;
    - canter: three beats: a hind foot, the other one with the fore foot of its diagonal, a fore
      foot;
    - half-bound: hind feet together, fore feet one after the other;
    - bound: the feet of each pair together, the pairs apart;
    - pronk: all feet together.
    """
    front_left, front_right, back_left, back_right = phases.T
    fore, hind = apart(front_left, front_right), apart(back_left, back_right)
    lag = apart(halfway(front_left, front_right), halfway(back_left, back_right))
    uneven = _worst(0.5 - fore, 0.5 - hind)
    diagonal = halfway(front_left - back_left, front_right - back_right)
    from_pace = apart(diagonal, np.zeros(len(phases)))
    walk = _worst(uneven, _separate(from_pace), _separate(0.5 - from_pace))
    closest = np.min([apart(one, other) for one, other in combinations(phases.T, 2)], axis=0)
    one_lead = _canter(back_left, back_right, front_left, front_right)
    return {
        "walk": walk + _worst(0.5 - duty),
        "amble": walk + _worst(duty - 0.5),
        "trot": _worst(uneven, 0.5 - from_pace),
        "pace": _worst(uneven, from_pace),
        "gallop": _worst(_separate(closest), _separate(lag), fore - _SPLIT, hind - _SPLIT),
        "canter": np.minimum(one_lead, _canter(back_right, back_left, front_right, front_left)),
        "half-bound": _worst(hind, _separate(fore), _separate(lag), fore - _SPLIT),
        "bound": _worst(fore, hind, _separate(lag)),
        "pronk": _worst(fore, hind, lag),
    }


def _worst(*deviations: Floats) -> Floats:
    """Return the largest of the deviations that are above 0."""
    worst: Floats = np.max([np.zeros(len(deviations[0])), *deviations], axis=0)
    return worst


def _separate(distance: Floats) -> Floats:
    """Deviation of feet that should not be together: the tolerance where they just are."""
    deviation: Floats = 2.0 * TOLERANCE - distance
    return deviation


_SPLIT: Final = 0.3
"""Cycles up to which the feet of a pair follow each other in a gallop or a canter; further apart
they are evenly spaced."""


def _canter(first: Floats, mate: Floats, diagonal: Floats, last: Floats) -> Floats:
    """Deviation from a canter of one lead.

    Args:
        first: (n,) cycles, the hind foot that begins.
        mate: the other hind foot.
        diagonal: the fore foot that falls with it.
        last: the leading fore foot.
    """
    together = halfway(mate, diagonal)
    before, after = wrapped(together - first), wrapped(last - together)
    separate = _worst(_separate(before), _separate(after))
    return _worst(apart(mate, diagonal), separate, before - _SPLIT, after - _SPLIT)


def _of_six_feet(phases: Floats) -> dict[str, Floats]:
    """Measure metachronal waves: the lag from each foot to the next one of its side.

    - tripod: half a cycle, the sides half a cycle apart;
    - tetrapod: a third, the sides a multiple of a third apart: three pairs of feet in turn;
    - wave: a sixth, the sides half a cycle apart: one foot after the other.

    Waves run from back to front, or from front to back.
    """
    third = 1.0 / 3.0
    waves = {
        "tripod": [(0.5, 0.5)],
        "tetrapod": [(lag, side) for lag in (third, -third) for side in (0.0, third, -third)],
        "wave": [(0.5 * third, 0.5), (-0.5 * third, 0.5)],
    }
    return {
        name: np.min([_from_wave(phases, *each) for each in lags], axis=0)
        for name, lags in waves.items()
    }


def _from_wave(phases: Floats, lag: float, side: float) -> Floats:
    """Largest deviation from a wave that may be shifted as a whole."""
    left = np.array([2.0 * lag, lag, 0.0])
    pattern = np.stack([left, left + side], axis=1).ravel()
    deviation = wrapped(phases - pattern)
    deviation = wrapped(deviation - deviation[:, :1])
    spread = deviation.max(axis=1) - deviation.min(axis=1)
    return np.asarray(spread / 2.0)


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
    touchdown = touchdown[timespans.covers(reference.spans, touchdown)]
    stride = np.searchsorted(reference.touchdown, touchdown, side="right") - 1
    since = touchdown - reference.touchdown[stride]
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


def apart(first: Floats, second: Floats) -> Floats:
    """Return the distance of phases on the circle, cycles in [0, 0.5]."""
    distance: Floats = np.abs(wrapped(first - second))
    return distance


def halfway(first: Floats, second: Floats) -> Floats:
    """Return the phase half-way between two, along the shorter arc."""
    middle: Floats = first + wrapped(second - first) / 2.0
    return middle


CONSISTENT: Final = 0.8
"""R that the phases of every foot must exceed."""
STAND: Final = "stand"
IRREGULAR: Final = "irregular"
FLIGHT: Final = 0.02
"""Fraction of time in flight from which a gait is no amble."""
FEWEST_STRIDES: Final = 3
"""Strides from which phases can be consistent."""
_SAME: Final = 9
"""Decimals to which two distances must agree to count as equal."""


def classify(gait: Gait, phases: Sequence[float], consistency: Sequence[float]) -> Gait:
    """Name a gait by its mean phases, its duty factor and its time in flight.

    Args:
        gait: with its duty factor and strides, without a class.
        phases: cycles, known of all feet in the order of `class_distances`.
        consistency: R of each.
    """
    by_name = class_distances(np.array([phases]), np.array([gait.duty_factor], np.float64))
    distances = {name: round(float(value[0]), _SAME) for name, value in by_name.items()}
    nearest = min(distances, key=distances.__getitem__)
    distance = distances[nearest]
    flies = nearest == "amble" and (gait.flight_fraction or 0.0) > FLIGHT
    fits = distance <= TOLERANCE and min(consistency) > CONSISTENT and not flies
    fit = max(0.0, 1.0 - distance / (2.0 * TOLERANCE))
    enough = min(1.0, (gait.strides or 0) / FEWEST_STRIDES)
    named = replace(
        gait,
        name=nearest if fits else IRREGULAR,
        confidence=fit * min(consistency) * enough,
        nearest_name=nearest,
        class_distance=distance,
    )
    return _of_pairs(named, phases) if len(phases) == 4 else named


def _of_pairs(gait: Gait, phases: Sequence[float]) -> Gait:
    """Add what the hind footfalls precede the fore ones of their sides by, and the sequence.

    Source: Hildebrand 1965. Their mean on the circle is the diagonality: 0 pace, 0.25
    lateral-sequence walk, 0.5 trot, 0.75 diagonal-sequence walk; none of sides that are half a
    cycle apart. Source: Cartmill, Lemelin and Schmitt 2002, Zool. J. Linn. Soc. 136:401.

    Args:
        gait: with its class, which may leave the sequence of the feet open.
        phases: cycles, of front left, front right, back left, back right.
    """
    front_left, front_right, back_left, back_right = phases
    sides = (front_left - back_left) % 1.0, (front_right - back_right) % 1.0
    mean, consistency = circular_mean(np.array(sides)) or (0.0, 0.0)
    sequence = None
    if gait.name in {"walk", "amble"}:
        sequence = "lateral" if mean < 0.5 else "diagonal"
    elif gait.name == "gallop":
        fore, hind = wrapped(np.array([front_right - front_left, back_right - back_left]))
        sequence = "transverse" if fore * hind > 0.0 else "rotary"
    return replace(
        gait,
        sequence=sequence,
        limb_phase=LimbPhase(*sides),
        diagonality=mean if consistency > 1e-6 else None,
    )
