"""Sensors that stop in the course of a log: one foot makes no step while the others go on.

A foot that is lifted, or planted, makes no step either. Of a lifted one the other feet carry the
load; a planted one feels that load shift, and the base does not go away from it.
"""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints, all_finite, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.loads import CELL_RATE_HZ, mean_impulses

MISSED_STEPS: Final = 4
"""Touchdowns of half of the other feet, or more, while one foot makes no step."""
ONE_FORCE: Final = 0.02
"""Share of a load within which that of a sensor that has stopped stays."""
MOSTLY: Final = 0.75
"""Share of the time in which it does so: it may stop in the midst of a stance."""
FAR_M: Final = 1.0
"""m: no foot stays where it is while the base goes so far."""
_INSTANTS: Final = 50
_CELL_NS: Final = round(1e9 / CELL_RATE_HZ)
LACKS: Final = 0.5
"""Share of a foot's usual load that must be missing from the sum of all feet's."""


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
    if not len(base.time):
        return False
    start, end = span.tolist()
    position = base.position_at(np.linspace(start, end, _INSTANTS).astype(np.int64))[:, :2]
    known = position[all_finite(position)]
    return len(known) > 1 and float(np.hypot(*(known - known[0]).T).max()) > FAR_M


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


def all_silent(feet: Sequence[FootHistory], base: BaseHistory) -> Ints:
    """Return the spans in which all feet have a gap and the base has none.

    Args:
        feet: records of all feet; those without usable messages do not count.
        base: poses.

    Returns:
        (s, 2) ns; none with fewer than two feet.
    """
    speaking = [
        timespans.subtract(foot.gaps, foot.stopped) for foot in feet if foot.start is not None
    ]
    if len(speaking) < 2:
        return timespans.no_spans()
    return timespans.intersect([*speaking, base.known])
