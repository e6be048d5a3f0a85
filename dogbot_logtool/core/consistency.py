"""Whether base and feet are in one world and on one clock, and whether each foot's sensor works on.

Two world frames, or a drifting odometry, part base and feet. The base goes up and down when the
feet's forces drive it: so physics compares their clocks. A sensor that stops makes no step
while the others go on. A foot that is lifted, or planted, makes none either: of a lifted one the
other feet carry the load; a planted one feels the load shift, and the base does not go away from
it.
"""

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats, Ints, distinct, means_by_group, median_of
from dogbot_logtool.core.base.ground import seen_from_base
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.clock import CLOCK_SHARE_OF_STRIDE, LONGEST_DELAY_S
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.loads import CELL_RATE_HZ, mean_impulses, vertical_is_known
from dogbot_logtool.core.settings import GRAVITY_MPS2

MISSED_STEPS: Final = 4
"""Touchdowns of half of the other feet, or more, while one foot makes no step."""
ONE_FORCE: Final = 0.02
"""Share of a load within which that of a sensor that has stopped stays."""
MOSTLY: Final = 0.75
"""Share of the time in which it does so: it may stop in the midst of a stance."""
LACKS: Final = 0.5
"""Share of a foot's usual load that must be missing from the sum of all feet's."""
FAR_M: Final = 1.0
"""m: no foot stays where it is while the base goes so far."""
_INSTANTS: Final = 50
_CELL_NS: Final = round(1e9 / CELL_RATE_HZ)


def without_stopped(feet: Sequence[FootHistory], base: BaseHistory) -> tuple[FootHistory, ...]:
    """Return histories in which the time is unknown in which a foot's sensor has stopped.

    Args:
        feet: histories of all feet.
        base: poses without jumps.
    """
    stopped = [list(_stopped(row, feet, base)) for row in range(len(feet))]
    return tuple(
        foot.stopped_in(np.array(spans, np.int64)) if spans else foot
        for foot, spans in zip(feet, stopped, strict=True)
    )


def _stopped(row: int, feet: Sequence[FootHistory], base: BaseHistory) -> Iterator[tuple[int, int]]:
    """Yield spans, ns, from a foot's last touchdown until it certainly steps again."""
    foot, others = feet[row], [*feet[:row], *feet[row + 1 :]]
    stances = foot.stances
    if not others or not len(stances.touchdown):
        return
    # A sensor that speaks in contact only begins and ends with one.
    first = min(each.start for each in feet if each.start is not None)
    last = max(each.end for each in feet if each.end is not None)
    starts = np.concatenate([[first], stances.touchdown])
    leaves = np.concatenate([[first], stances.liftoff])
    ends = np.concatenate([stances.touchdown, [last]])
    down, up = _stepping(others, starts, leaves), _stepping(others, leaves, ends)
    half = max(len(others) / 2.0, 1.0)
    for at in np.flatnonzero((down > 0) | (up >= half)).tolist():
        in_stance, in_swing = np.array([[starts[at], leaves[at]], [leaves[at], ends[at]]])
        stays = down[at] >= half and _is_constant(foot, in_stance[None])
        hangs = up[at] >= half and _load_is_missing(foot, feet, in_swing[None])
        if stays or hangs or (down[at] and _goes_far(base, in_stance)):
            yield int(starts[at]), int(ends[at])


def _stepping(others: Sequence[FootHistory], start: Ints, end: Ints) -> Ints:
    """(n,) the number of other feet that go on stepping in some spans."""
    touchdowns = [each.stances.touchdown for each in others]
    steps = [np.searchsorted(each, end) - np.searchsorted(each, start) for each in touchdowns]
    stepping: Ints = (np.array(steps) >= MISSED_STEPS).sum(axis=0)
    return stepping


def _goes_far(base: BaseHistory, span: Ints) -> bool:
    """Tell whether the base goes away from where it was, (2,) ns."""
    position = base.position_at(np.linspace(span[0], span[1], _INSTANTS).astype(np.int64))[:, :2]
    return bool((np.hypot(*(position - position[0]).T) > FAR_M).any())


def _is_constant(foot: FootHistory, span: Ints) -> bool:
    """Tell whether a foot's load hardly ever varies in a span, (1, 2) ns, but near its ends."""
    held = timespans.intersect([foot.known, span])
    time = timespans.ticks(held, _CELL_NS)
    time = time[timespans.hold_window(held, time, 0, _CELL_NS)]
    force = mean_impulses([foot], "force_impulse", time + _CELL_NS // 2, _CELL_NS // 2)[:, 0]
    if not foot.has_force or len(force) < MISSED_STEPS:
        return False
    usual = float(median_of(force))
    return bool((np.abs(force - usual) <= ONE_FORCE * usual).mean() > MOSTLY)


def _load_is_missing(foot: FootHistory, feet: Sequence[FootHistory], span: Ints) -> bool:
    """Tell whether the load that a foot usually carries is missing in a span, (1, 2) ns."""
    if not all(each.has_force for each in feet):
        return True
    known = timespans.intersect([each.known for each in feet])
    inside, usual = timespans.intersect([known, span]), timespans.subtract(known, span)
    if 2 * timespans.total(inside) < timespans.total(span) or not len(usual):
        return True
    own, now, before = (
        sum(float(each.track.force_impulse.within(spans)[0]) for each in those)
        / timespans.total(spans)
        for those, spans in (((foot,), usual), (feet, inside), (feet, usual))
    )
    return now < before - LACKS * own


WINDOW_NS: Final = 2_000_000_000
"""ns: a foot's position is averaged over so long where there are no strides, and a change of it is
told between two times that are so long."""
_MOST_WINDOWS: Final = 60
FEWEST_TICKS: Final = 25
"""Ticks of 40 ms with contact points of a foot from which its usual position is known."""
_TICK_NS: Final = 40_000_000
FEWEST_FEET: Final = 2
MOST_BEYOND: Final = 0.05
"""Share of the time in which the base may be further from the feet than they are spread."""
PART_OF_FEET: Final = 4.0
"""So many times further the base may be from some feet of a robot whose other feet tell no contact
points: from the hind pair, say. Few robots are so many times longer than wide."""
MOST_CHANGE: Final = 0.5
"""Shift of the base among the feet, against their spread, that no gait explains."""
MOST_DRIFT: Final = 0.05
"""The same of a shift that goes on steadily."""
MOST_OF_PATH: Final = 0.02
"""Share of the robot's way by which base and feet may drift apart until that is not known."""
FEWEST_WINDOWS: Final = 4
"""Windows from which a drift is told."""
STEADY: Final = 0.9
"""Share of the variance of the base's position that a straight trend explains; a robot that leans
otherwise from some moment on makes a step."""


class Worlds(NamedTuple):
    """The base among the feet that are down, seen from above and from the base."""

    distance_m: float
    """m, median horizontal distance of the base from the centroid of the feet's usual positions."""
    spread_m: float
    """m, distance of the outermost foot's usual position from that centroid."""
    beyond_fraction: float
    """Share of the time in which the base is further from it than the outermost foot, or
    `PART_OF_FEET` times as far where not all feet tell contact points."""
    shift_m: float
    """m, change of the base's position among the feet from the log's first third to its last; all
    along the log where it goes on steadily."""
    drifts: bool
    """Whether it goes on steadily."""

    @property
    def agree(self) -> bool:
        """Whether base and feet are in one world, throughout."""
        most = MOST_DRIFT if self.drifts else MOST_CHANGE
        return self.shift_m <= most * self.spread_m and self.beyond_fraction <= MOST_BEYOND


def compare_worlds(
    feet: Sequence[FootHistory], base: BaseHistory, period_s: float | None
) -> Worlds | None:
    """Compare where the feet touch with where the base is.

    Args:
        feet: histories of all feet, with contact points in the world.
        base: poses.
        period_s: s, the usual stride: positions are means over whole strides; None: none is known.

    Returns:
        None where contact points of two feet around the base are not known for a second each.
    """
    if len(base.time) < 2:
        return None
    seen = [seen_from_base(foot, base) for foot in feet]
    placed = [each for each in seen if len(distinct(each[0] // _TICK_NS)) >= FEWEST_TICKS]
    if len(placed) < FEWEST_FEET:
        return None
    usual = np.stack([median_of(place, axis=0) for _, place in placed])
    centroid = usual.mean(axis=0)
    spread = float(np.hypot(*(usual - centroid).T).max())
    start = min(int(time[0]) for time, _ in placed)
    duration = max(int(time[-1]) for time, _ in placed) - start
    window = round((period_s or 0.0) * 1e9) or WINDOW_NS
    window *= max(-(-duration // (window * _MOST_WINDOWS)), 1)
    windows = max(duration // window, 1)
    shift = np.stack(
        [
            means_by_group(place - own, np.clip((time - start) // window, 0, windows), windows + 1)
            for (time, place), own in zip(placed, usual, strict=True)
        ]
    )[:, :windows]
    known = np.isfinite(shift[:, :, 0]).any(axis=0)
    away = centroid + np.nanmean(shift[:, known], axis=0)
    distance = np.hypot(away[:, 0], away[:, 1])
    farthest = spread if len(placed) == len(feet) else PART_OF_FEET * spread
    # Less than two seconds are a leap, or a turn, and not yet another place among the feet.
    third = max(len(away) // 3, -(-WINDOW_NS // window))
    change = median_of(away[-third:], axis=0) - median_of(away[:third], axis=0)
    change *= 2 * third <= len(away)
    drift, steadiness = trend(away)
    drifts = len(away) >= FEWEST_WINDOWS and steadiness >= STEADY
    return Worlds(
        distance_m=float(median_of(distance)),
        spread_m=spread,
        beyond_fraction=float((distance > farthest).mean()),
        shift_m=float(np.hypot(*(drift if drifts else change))),
        drifts=drifts,
    )


def trend(values: Floats) -> tuple[Floats, float]:
    """Return the change along a straight line through values, (n, k), and what it explains of them.

    Returns:
        (k,) from the first to the last, and the share of the variance; 0 of none.
    """
    time = np.linspace(-0.5, 0.5, len(values))
    apart = values - values.mean(axis=0)
    change = time @ apart / max(time @ time, np.finfo(float).tiny)
    total, rest = float((apart**2).sum()), apart - np.outer(time, change)
    return change, 1.0 - float((rest**2).sum()) / total if total else 0.0


LIKELY: Final = 0.97
"""Share of what the best delay explains, from which another is as likely."""
REPEATS: Final = 0.9
"""The same of one that fits better than those around it: the heave repeats itself then."""
FOLLOWS: Final = 0.81
"""Share of the heave that forces must explain where the base follows them."""
AS_FAR: Final = (0.75, 1.33)
"""How far the base may go, against what the forces say."""
LEAST_STRIDES: Final = 2
"""Strides that are compared, beside those at the ends that means and delays take."""
FEWEST_CELLS: Final = 8
"""Cells in a stride; a trot heaves twice in it, and fewer do not show how."""
_LONGEST_S: Final = 120.0
_LATEST_S: Final = 0.5
_LAGS_S: Final = np.linspace(-_LATEST_S, _LATEST_S, 101)


class Delay(NamedTuple):
    """By how much the base comes after the forces that drive it, by the best fit."""

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
    if cells < window or window < FEWEST_CELLS:
        return None
    time = start + np.arange(cells) * _CELL_NS
    force = mean_impulses(feet, "vertical_impulse", time + _CELL_NS // 2, _CELL_NS // 2).sum(axis=1)
    # The sum of cells is known at their ends, the sum of those half a cell later.
    driven, at = _driven_heave(force, window), (time - start) / 1e9 + 1.5 / CELL_RATE_HZ
    heave = _about_mean(base.position_at(time + 3 * _CELL_NS // 2)[:, 2], window)
    edge = 2 * window + int(_LATEST_S * CELL_RATE_HZ) + 2
    inside = np.isfinite(heave) & (np.arange(cells) >= edge) & (np.arange(cells) < cells - edge)
    if inside.sum() < LEAST_STRIDES * window or force.mean() <= 0.0:
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
    own, tried = heave - heave.mean(), [each - each.mean() for each in driven]
    gains = np.array([own @ each / (each @ each) for each in tried])
    explained = np.array([gain * (own @ each) for gain, each in zip(gains, tried, strict=True)])
    explained *= (gains > 0.0) / (own @ own)
    best = int(explained.argmax())
    if not (explained[best] >= FOLLOWS and AS_FAR[0] <= gains[best] <= AS_FAR[1]):
        return None
    is_peak = explained >= np.maximum(np.roll(explained, 1), np.roll(explained, -1))
    likely = _LAGS_S[explained >= np.where(is_peak, REPEATS, LIKELY) * explained[best]]
    return Delay(float(_LAGS_S[best]), float(likely.min()), float(likely.max()))


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
