"""Did the robot fall, or tip over as the recording ends?"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, percentiles_of
from dogbot_logtool.core.base.motion import roll_and_pitch
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.settings import GRAVITY_MPS2

TILT_RAD: Final = np.pi / 3.0
"""A base that leans further lies."""
UPRIGHT_RAD: Final = np.pi / 6.0
"""A base that leans less may stand."""
LYING: Final = 0.4
"""A base below this share of its standing height over the feet lies, or sits."""
STANDING: Final = 0.8
"""A base above this share stands."""
SWAYS: Final = 0.95
"""A base below this share of its standing height is on its way down."""
SWAYS_RAD: Final = 0.1
"""rad more than its usual lean: the same."""
STANDING_PERCENT: Final = 90.0
"""Quantile of the height while feet are loaded that is the standing height."""
LASTING_S: Final = 0.3
"""A fall lasts; a single wrong pose does not make one."""
SLOWEST_FALL: Final = 4.0
"""Times the duration of a free fall from which a descent is sitting down."""
SLOWEST_UPRIGHT_FALL: Final = 2.0
"""The same of a base that keeps upright: legs that give way all at once."""
LEANS_RAD: Final = 0.25
"""A base that leans less on its way down, and when it is down, keeps upright."""
TOPPLES_S: Final = 3.0
"""s, from upright to lying on a side, at most; what is slower is laid down."""
LOADED_S: Final = 0.5
"""s before a fall in which a foot must be loaded: a robot that is carried does not fall."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class _Posture:
    """Columns known at each pose."""

    time: Ints
    """(n,) ns."""
    tilt: Floats
    """(n,) rad."""
    lies: Flags
    """(n,)."""
    stands: Flags
    """(n,) upright and high, as far as that is known."""
    usual: Flags
    """(n,) as upright and high as it usually stands."""
    standing_height_m: float | None


def fallen_spans(
    base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats, jumps: Ints
) -> Ints:
    """Find the spans in which the robot lies because it fell.

    A fall is a descent from standing to lying, of a robot whose feet were loaded: as fast as a
    fall is where the height tells it, or over onto a side. Sitting down is slower; a robot that is
    lifted or carried has no loaded foot; one that lies from the beginning did not fall here.

    Args:
        base: poses.
        feet: histories of all feet.
        height_m: (n,) of the base over the feet, at each pose; NaN where not known.
        jumps: (j, 2) ns, jumps of the pose; a height that jumps is no fall.

    Returns:
        (f, 2) ns, from the beginning of the descent until it lies no more.
    """
    if len(base.time) < 2:
        return timespans.no_spans()
    posture = _posture(base, feet, height_m)
    lying = timespans.spans_where(base.time, posture.lies[:-1])
    lying = lying[lying[:, 1] - lying[:, 0] >= LASTING_S * 1e9]
    onsets = [_fell_since(int(start), posture, feet, jumps) for start in lying[:, 0]]
    falls = [(since, end) for since, end in zip(onsets, lying[:, 1], strict=True) if since]
    return timespans.merge(np.array(falls, np.int64).reshape(-1, 2))


def down_spans(base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats) -> Ints:
    """(k, 2) ns, spans in which the robot does not stand upright and high: it lies, or goes down.

    Args:
        base: poses.
        feet: histories of all feet.
        height_m: (n,) of the base over the feet, at each pose; NaN where not known.
    """
    if len(base.time) < 2:
        return timespans.no_spans()
    return timespans.spans_where(base.time, ~_posture(base, feet, height_m).stands[:-1])


def _posture(base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats) -> _Posture:
    tilt = tilt_rad(base.angles)
    usual = _standing_height_m(base, feet, height_m)
    lies, stands = tilt > TILT_RAD, tilt < UPRIGHT_RAD
    as_usual = tilt < median_of(tilt[stands]) + SWAYS_RAD if stands.any() else stands
    if usual is not None:
        with np.errstate(invalid="ignore"):
            lies = lies | (height_m < LYING * usual)
            stands = stands & ~(height_m < STANDING * usual)
            as_usual = as_usual & ~(height_m < SWAYS * usual)
    return _Posture(base.time, tilt, lies, stands, as_usual, usual)


def tilt_rad(angles: Floats) -> Floats:
    """(n,) rad, angle of the body's z axis against the vertical."""
    up = np.cos(angles[:, 0]) * np.cos(angles[:, 1])
    return np.asarray(np.arccos(np.clip(up, -1.0, 1.0)))


def _standing_height_m(
    base: BaseHistory, feet: Sequence[FootHistory], height_m: Floats
) -> float | None:
    """Return the height at which the robot stands: high, and with a loaded foot."""
    loaded = np.zeros(len(base.time), np.bool_)
    for foot in feet:
        loaded |= timespans.covers(foot.in_contact, base.time)
    known = height_m[loaded & np.isfinite(height_m)]
    return float(percentiles_of(known, STANDING_PERCENT)) if len(known) else None


def _fell_since(
    start: int, posture: _Posture, feet: Sequence[FootHistory], jumps: Ints
) -> int | None:
    """Return when the fall into the lying that begins at `start` began, ns; None: it is none."""
    row = int(np.searchsorted(posture.time, start))
    stood = np.flatnonzero(posture.stands[:row])
    if len(stood) == 0:
        return None
    since = int(posture.time[stood[-1]])
    down = int(np.searchsorted(posture.time, start + round(LASTING_S * 1e9), side="right"))
    leans = bool((posture.tilt[stood[-1] : down] > LEANS_RAD).any())
    slowest = SLOWEST_FALL if leans else SLOWEST_UPRIGHT_FALL
    topples = bool(posture.tilt[row] > TILT_RAD)
    longest = TOPPLES_S if topples else slowest * _free_fall_s(posture.standing_height_m)
    if start - since > longest * 1e9:
        return None
    descent = np.array([[since, start]], np.int64)
    jumped = timespans.touches(descent, jumps[:, 0] + 1, jumps[:, 1] - 1).any()
    if (jumped and not topples) or not _loaded_before(feet, since, start):
        return None
    usual = np.flatnonzero(posture.usual[: stood[-1] + 1])
    began = int(posture.time[usual[-1]]) if len(usual) else since
    return began if since - began <= TOPPLES_S * 1e9 else since


def _free_fall_s(height_m: float | None) -> float:
    """Return how long a free fall from standing to lying takes, s."""
    drop = (STANDING - LYING) * (height_m or 0.0)
    return float(np.sqrt(2.0 * drop / GRAVITY_MPS2))


def _loaded_before(feet: Sequence[FootHistory], since: int, start: int) -> bool:
    """Tell whether a foot was loaded shortly before a descent or in it; yes where not known."""
    before = np.array([[since - round(LOADED_S * 1e9), start]], np.int64)
    known = [foot for foot in feet if timespans.total(timespans.intersect([foot.known, before]))]
    loaded = [timespans.total(timespans.intersect([foot.in_contact, before])) for foot in known]
    return not known or any(loaded)


LAST_S: Final = 2.0
"""s before the end in which tipping begins; what was before is usual."""
USUAL_S: Final = 2.0
"""s that must come before."""
BEYOND_RAD: Final = 0.1
"""rad beyond the usual range."""
RISING_S: Final = 0.3
"""s before the end in which the angle must grow."""
_RISES_RAD: Final = 0.02


@dataclass(frozen=True, slots=True)
class Tipping:
    """A roll or pitch that leaves its usual range and does not return."""

    since: int
    """ns, when it leaves its usual range."""
    angle: str
    """``roll`` or ``pitch``."""
    last_rad: float
    """rad, at the end of the recording."""


def find_tipping(base: BaseHistory, forward_axis: str) -> Tipping | None:
    """Return how the robot tips at the end of the recording; None: it does not.

    An angle counts that leaves the range of all the time before, and is still growing at the end.
    """
    if len(base.time) < 3 or base.time[-1] - base.time[0] < (LAST_S + USUAL_S) * 1e9:
        return None
    angles = zip(("roll", "pitch"), roll_and_pitch(base.angles, forward_axis), strict=True)
    found = [each for name, values in angles if (each := _tips(base, name, values))]
    return max(found, key=lambda each: abs(each.last_rad), default=None)


def _tips(base: BaseHistory, name: str, angle: Floats) -> Tipping | None:
    before = base.time < base.time[-1] - LAST_S * 1e9
    low, high = float(angle[before].min()), float(angle[before].max())
    beyond = np.maximum(angle - high, low - angle)
    inside = np.flatnonzero(beyond <= 0.0)
    first = int(inside[-1]) + 1 if len(inside) else 0
    if first >= len(angle) or beyond[-1] < BEYOND_RAD:
        return None
    earlier = int(np.searchsorted(base.time, base.time[-1] - RISING_S * 1e9))
    if beyond[-1] - beyond[earlier] < _RISES_RAD:
        return None
    return Tipping(int(base.time[first]), name, float(angle[-1]))
