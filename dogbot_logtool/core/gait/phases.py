"""Phases of the feet in the stride of a reference foot."""

from collections.abc import Sequence

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, wrapped
from dogbot_logtool.core.gait.strides import Strides


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


def apart(first: Floats, second: Floats) -> Floats:
    """Return the distance of phases on the circle, cycles in [0, 0.5]."""
    distance: Floats = np.abs(wrapped(first - second))
    return distance


def halfway(first: Floats, second: Floats) -> Floats:
    """Return the phase half-way between two, along the shorter arc."""
    middle: Floats = first + wrapped(second - first) / 2.0
    return middle


def limb_phases(phases: Sequence[float]) -> tuple[float, float]:
    """Return by which share of the stride the hind footfall precedes the fore one of its side.

    Source: Hildebrand 1965.

    Args:
        phases: cycles, of front left, front right, back left, back right.

    Returns:
        cycles in [0, 1), of the left and of the right side; NaN where a phase is.
    """
    front_left, front_right, back_left, back_right = phases
    return (front_left - back_left) % 1.0, (front_right - back_right) % 1.0


def diagonality(phases: Sequence[float]) -> float | None:
    """Return the mean of the limb phases of both sides, on the circle, cycles in [0, 1).

    0 pace, 0.25 lateral-sequence walk, 0.5 trot, 0.75 diagonal-sequence walk. Source: Cartmill,
    Lemelin and Schmitt 2002, Zool. J. Linn. Soc. 136:401.

    Args:
        phases: cycles, of front left, front right, back left, back right.

    Returns:
        None where a phase is not known, or the sides are half a cycle apart.
    """
    left, right = limb_phases(phases)
    if not (np.isfinite(left) and np.isfinite(right)):
        return None
    mean = np.exp(2j * np.pi * left) + np.exp(2j * np.pi * right)
    if abs(mean) < 1e-6:
        return None
    return float(np.angle(mean) / (2.0 * np.pi) % 1.0)
