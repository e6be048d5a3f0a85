"""Whether the base goes up and down when the feet's forces drive it: clocks compared by physics."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import CLOCK_SHARE_OF_STRIDE, LONGEST_DELAY_S
from dogbot_logtool.core.loads import CELL_RATE_HZ, mean_impulses, vertical_is_known
from dogbot_logtool.core.settings import GRAVITY_MPS2

LIKELY: Final = 0.97
"""Share of what the best delay explains, from which another is as likely."""
FOLLOWS: Final = 0.9
"""Correlation of both ways from which the base follows the forces."""
AS_FAR: Final = (0.75, 1.33)
"""How far the base may go, against what the forces say."""
LEAST_STRIDES: Final = 6
FEWEST_CELLS: Final = 8
"""Cells in a stride; a trot heaves twice in it, and fewer do not show how."""
_LONGEST_S: Final = 120.0
_CELL_NS: Final = round(1e9 / CELL_RATE_HZ)
_LATEST_S: Final = 0.5
_LAGS_S: Final = np.linspace(-_LATEST_S, _LATEST_S, 101)


class Delay(NamedTuple):
    """By how much the base comes after the forces that drive it, by the best fit."""

    correlation: float
    """At that delay."""
    delay_s: float
    low_s: float
    """s: delays from here are as likely for all that the log can tell."""
    high_s: float
    """s, up to here."""


@np.errstate(over="ignore", invalid="ignore")
def long_delay(
    feet: Sequence[FootHistory], base: BaseHistory, period_s: float, walked: Ints
) -> Delay | None:
    """Return by how much the base comes after the feet's forces, if that is long.

    Long is surely more than odometry takes, and than a few per cent of a stride. A heave that
    repeats itself in less than a second makes that uncertain.

    Args:
        feet: histories of all feet.
        base: poses without jumps.
        period_s: s, the usual stride.
        walked: (s, 2) ns, time in strides, in which nothing but the feet carries the robot.

    Returns:
        None also where vertical forces are not known over strides enough in a row, or the base does
        not follow them closely.
    """
    if not all(vertical_is_known(foot) for foot in feet):
        return None
    spans = timespans.intersect([walked, base.known, *(foot.vertical_known for foot in feet)])
    if not len(spans):
        return None
    start, end = spans[np.argmax(spans[:, 1] - spans[:, 0])].tolist()
    cells = int(min((end - start) / 1e9, _LONGEST_S) * CELL_RATE_HZ)
    window = max(round(period_s * CELL_RATE_HZ), 1)
    if cells < LEAST_STRIDES * window or window < FEWEST_CELLS:
        return None
    time = start + np.arange(cells) * _CELL_NS
    force = mean_impulses(feet, "vertical_impulse", time + _CELL_NS // 2, _CELL_NS // 2).sum(axis=1)
    if not force.mean() > 0.0:
        return None
    # The sum of cells is known at their ends, the sum of those half a cell later.
    driven, at = _driven_heave(force, window), (time - start) / 1e9 + 1.5 / CELL_RATE_HZ
    heave = _about_mean(base.position_at(time + 3 * _CELL_NS // 2)[:, 2], window)
    edge = 2 * window + int(_LATEST_S * CELL_RATE_HZ) + 2
    inside = np.isfinite(heave) & (np.arange(cells) >= edge) & (np.arange(cells) < cells - edge)
    if not inside.any():
        return None
    found = _best_fit(heave[inside], [np.interp(at[inside] - lag, at, driven) for lag in _LAGS_S])
    least = max(CLOCK_SHARE_OF_STRIDE * period_s, LONGEST_DELAY_S)
    return found if found and (found.low_s > least or found.high_s < -least) else None


def _best_fit(heave: Floats, driven: Sequence[Floats]) -> Delay | None:
    """Find the delay at which what forces drive explains the heave best (least squares).

    Args:
        heave: (n,) m.
        driven: (n,) m for each of the delays that are tried.

    Returns:
        None where it does not explain it closely.
    """
    there, others = heave - heave.mean(), np.stack(driven)
    others -= others.mean(axis=1, keepdims=True)
    squares, products = (others * others).sum(axis=1), others @ there
    total = float(there @ there)
    if total <= 0.0 or not squares.all():
        return None
    explained = products**2 / squares
    best = int(explained.argmax())
    likely = _LAGS_S[explained >= LIKELY * explained[best]]
    gain = products[best] / squares[best]
    correlation = np.sqrt(min(explained[best] / total, 1.0))
    if correlation < FOLLOWS or not AS_FAR[0] <= gain <= AS_FAR[1]:
        return None
    return Delay(float(correlation), float(_LAGS_S[best]), float(likely.min()), float(likely.max()))


def _driven_heave(force: Floats, window: int) -> Floats:
    """(n,) m, the way about its mean over a stride that mean forces in cells drive, (n,) N."""
    step = 1.0 / CELL_RATE_HZ
    acceleration = GRAVITY_MPS2 * (force / force.mean() - 1.0)
    speed = _about_mean(np.cumsum(_about_mean(acceleration, window)) * step, window)
    return _about_mean(np.cumsum(speed) * step, window)


def _about_mean(values: Floats, window: int) -> Floats:
    """(n,) what values differ by from their mean over a window about them."""
    mean = np.convolve(values, np.full(window, 1.0 / window), mode="same")
    rest: Floats = values - mean
    return rest
