"""How far the feet's phases are from those of each gait that has a name.

A distance is the largest deviation, in cycles, from what defines the class (walk, amble and run:
plus that of the duty factor from the right side of one half); the class fits up to `TOLERANCE`.
All distances depend on differences of phases only, and treat left and right alike: they stay the
same with another reference foot, and for the mirror image of a gait.

Sources: Hildebrand 1965, 1976 and 1977 (quadrupeds); Schmitt et al. 2006 (evenly spaced pairs);
Wilson 1966 (hexapods).
"""

from itertools import combinations
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, wrapped
from dogbot_logtool.core.gait.phases import apart, halfway

TOLERANCE: Final = 0.1
"""Cycles by which phases may differ from those of a class."""
BIPED: Final = 2
QUADRUPED: Final = 4
HEXAPOD: Final = 6
CLASS_NAMES: Final = (
    "walk",
    "amble",
    "trot",
    "pace",
    "gallop",
    "canter",
    "half-bound",
    "bound",
    "pronk",
    "run",
    "hop",
    "tripod",
    "tetrapod",
    "wave",
)
"""Classes that a gait of two, four or six feet may have."""
ALTERNATES: Final = 0.1
"""Cycles by which the steps of two feet may be uneven before that counts as a deviation."""


def class_distances(phases: Floats, duty_factor: Floats | None = None) -> dict[str, Floats]:
    """Return how far phases are from those of each class.

    Args:
        phases: (n, feet) cycles. Two feet: in any order. Four: front left, front right, back
            left, back right. Six: the same with middle left, middle right before the back ones.
        duty_factor: (n,) decides between walk and amble or run; None: taken as above one half.

    Returns:
        (n,) distance for each class; NaN where a phase is not known. Empty for any other number
        of feet. Of two classes at the same distance the first one counts.
    """
    duty = np.ones(len(phases)) if duty_factor is None else duty_factor
    feet = phases.shape[1]
    if feet == BIPED:
        return _of_two_feet(phases, duty)
    if feet == QUADRUPED:
        return _of_four_feet(phases, duty)
    if feet == HEXAPOD:
        return _of_six_feet(phases)
    return {}


def _of_two_feet(phases: Floats, duty: Floats) -> dict[str, Floats]:
    """Alternating (walk above, run below a duty factor of one half) or together (hop)."""
    step = apart(phases[:, 0], phases[:, 1])
    uneven = np.clip(0.5 - step - ALTERNATES, 0.0, None)
    below, above = _worst(0.5 - duty), _worst(duty - 0.5)
    return {
        "walk": uneven + below,
        "run": uneven + above,
        "hop": step,
    }


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
    below, above = _worst(0.5 - duty), _worst(duty - 0.5)
    from_pace = _from_pace(phases)
    walk = _worst(uneven, _separate(from_pace), _separate(0.5 - from_pace))
    closest = np.min([apart(one, other) for one, other in combinations(phases.T, 2)], axis=0)
    return {
        "walk": walk + below,
        "amble": walk + above,
        "trot": _worst(uneven, 0.5 - from_pace),
        "pace": _worst(uneven, from_pace),
        "gallop": _worst(_separate(closest), _separate(lag), _one_after_other(fore, hind)),
        "canter": np.minimum(
            _canter(back_left, back_right, front_left, front_right),
            _canter(back_right, back_left, front_right, front_left),
        ),
        "half-bound": _worst(hind, _separate(fore), _separate(lag), _one_after_other(fore)),
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
"""Cycles up to which the feet of a pair follow each other in a gallop or a canter."""


def _one_after_other(*splits: Floats) -> Floats:
    """Deviation of pairs whose feet are so far apart that they are evenly spaced."""
    return _worst(*(split - _SPLIT for split in splits))


def _from_pace(phases: Floats) -> Floats:
    """(n,) distance of the diagonality from 0, cycles."""
    front_left, front_right, back_left, back_right = phases.T
    return apart(halfway(front_left - back_left, front_right - back_right), np.zeros(len(phases)))


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
    return _worst(
        apart(mate, diagonal),
        _separate(before),
        _separate(after),
        _one_after_other(before, after),
    )


def _of_six_feet(phases: Floats) -> dict[str, Floats]:
    """Measure metachronal waves: the lag from each foot to the next one of its side.

    - tripod: half a cycle, the sides half a cycle apart;
    - tetrapod: a third, the sides a multiple of a third apart: three pairs of feet in turn;
    - wave: a sixth, the sides half a cycle apart: one foot after the other.

    Waves run from back to front, or from front to back.
    """
    third = 1.0 / 3.0
    return {
        "tripod": _from_wave(phases, 0.5, 0.5),
        "tetrapod": np.min(
            [
                _from_wave(phases, lag, side)
                for lag in (third, -third)
                for side in (0.0, third, -third)
            ],
            axis=0,
        ),
        "wave": np.minimum(_from_wave(phases, 1.0 / 6.0, 0.5), _from_wave(phases, -1.0 / 6.0, 0.5)),
    }


def _from_wave(phases: Floats, lag: float, side: float) -> Floats:
    """Largest deviation from a wave that may be shifted as a whole."""
    left = np.array([2.0 * lag, lag, 0.0])
    pattern = np.stack([left, left + side], axis=1).ravel()
    deviation = wrapped(phases - pattern)
    deviation = wrapped(deviation - deviation[:, :1])
    spread = deviation.max(axis=1) - deviation.min(axis=1)
    return np.asarray(spread / 2.0)
