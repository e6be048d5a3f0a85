"""By how much a measured curve comes after the one that it follows, and how much of it arrives."""

from collections.abc import Callable
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats
from dogbot_logtool.dataclass import dataclass

LIKELY: Final = 3.84
"""Chi-squared of one degree of freedom that is not exceeded with 95 %."""
_VALLEY, _RIVAL = 0.9, 0.97
"""Shares of the best delay's explained squares: a delay that reaches the second beyond one that
does not reach the first is another peak, as likely for all that a log can tell."""
_FEWEST_INDEPENDENT: Final = 4
"""Times as long as what the curves are averaged over, that a delay needs."""


@dataclass(frozen=True, slots=True)
class Delay:
    """The straight line measured = offset + gain x command(t - delay) that fits best."""

    correlation: float
    """At that delay."""
    gain: float
    delay_s: float
    low_s: float
    """s, with 95 % the delay lies from here, if it is not at an end of what was tried."""
    high_s: float
    """s, up to here."""


def fit_delay(
    measured: Floats, delayed: Callable[[float], Floats], lags_s: Floats, independent: float
) -> Delay | None:
    """Find the delay at which a curve explains another best (least squares).

    The interval holds the delays whose sum of squares exceeds the smallest by no more than 3.84
    over the number of independent values: the likelihood ratio's 95 %. Between two delays that are
    tried it ends where the parabola through the best and its neighbours says.

    Args:
        measured: (n,)
        delayed: returns the other curve, (n,), delayed by some seconds.
        lags_s: (k,) s, evenly spaced: the delays that are tried.
        independent: independent values among the n.

    Returns:
        None with too few values, or where either does not vary.
    """
    if independent < _FEWEST_INDEPENDENT or len(measured) < _FEWEST_INDEPENDENT:
        return None
    there = measured - measured.mean()
    total = float(there @ there)
    slopes, parts = np.zeros(len(lags_s)), np.zeros(len(lags_s))
    for row, lag in enumerate(lags_s.tolist()):
        slopes[row], parts[row] = _explained(there, delayed(lag))
    if total <= 0.0 or parts.max() <= 0.0:
        return None
    best = int(parts.argmax())
    off, bend = _vertex(parts, best)
    step = float(lags_s[1] - lags_s[0])
    delay = float(lags_s[best]) + off * step
    slope, part = _explained(there, delayed(delay))
    rest = np.maximum(total - parts, 0.0)
    least = max(total - max(part, parts[best]), 0.0)
    allowed = least * LIKELY / independent
    likely = (rest <= least + allowed) | _rivals(parts, best)
    near = step * min(np.sqrt(2.0 * allowed / -bend), 1.0) if bend < 0.0 else 0.0
    ends = np.append(lags_s[likely], (delay - near, delay + near))
    gain = float(slope)
    return Delay(
        correlation=float(np.sign(gain) * np.sqrt(min(part / total, 1.0))),
        gain=gain,
        delay_s=delay,
        low_s=float(ends.min()),
        high_s=float(ends.max()),
    )


def _explained(there: Floats, other: Floats) -> tuple[float, float]:
    """Return the slope of the regression on another curve, and the squares that it explains."""
    here = other - other.mean()
    squares, products = float(here @ here), float(here @ there)
    if squares <= 0.0:
        return 0.0, 0.0
    return products / squares, products * products / squares


def _rivals(parts: Floats, best: int) -> Flags:
    """(k,) delays beyond a valley that explain nearly as much: the command repeats itself."""
    valley = parts < _VALLEY * parts[best]
    beyond = np.maximum.accumulate(valley[best:])
    before = np.maximum.accumulate(valley[best::-1])[::-1]
    apart: Flags = np.concatenate([before[:-1], beyond])
    apart &= parts >= _RIVAL * parts[best]
    return apart


def _vertex(values: Floats, row: int) -> tuple[float, float]:
    """Return where a parabola through a value and its neighbours peaks, in steps off the row.

    Also its second derivative, a step squared; both are 0 where it has no peak.
    """
    if not 0 < row < len(values) - 1:
        return 0.0, 0.0
    before, here, after = values[row - 1 : row + 2].tolist()
    bend = before - 2.0 * here + after
    return (0.0, 0.0) if bend >= 0.0 else (0.5 * (before - after) / bend, bend)
