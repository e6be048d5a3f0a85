"""How a foot follows its plan: touchdowns early, late and missed."""

from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints, aggregate, median_of, nearest_rows
from dogbot_logtool.core.gait.feet import FootSteps
from dogbot_logtool.core.metrics import Planned

ON_TIME_S: Final = 0.02
"""s; touchdowns that are off by less are on time, and by less than a sample of either, too."""
_LONE_S: Final = 0.25
"""s around a touchdown without neighbours in which its match is looked for."""


class PlannedFoot(NamedTuple):
    """A foot's measured steps against its planned ones, in the time that is known of both."""

    topic: str
    """Topic of the plan."""
    touchdowns: int
    """Planned ones."""
    early: int
    """Matched touchdowns that are early by more than a sample and `ON_TIME_S`. Also `late`."""
    late: int
    metrics: Planned


def follow_plan(measured: FootSteps, planned: FootSteps) -> PlannedFoot:
    """Compare a foot's steps with its plan.

    A planned touchdown is matched with the nearest measured one if it is the nearest of that one,
    too, and nearer than half the way to the planned touchdowns before and after it. Touchdowns
    nearer than that to where either is unknown are left out: their match may be hidden.

    Args:
        measured: the foot.
        planned: the same foot in a plan, on the same clock.
    """
    records = measured.record, planned.record
    both = timespans.intersect([record.known for record in records])
    plan, steps = planned.touchdown, measured.touchdown
    reach = _reach(plan)
    match = _matches(plan, steps, reach)
    found = match >= 0
    seen = found & timespans.covers(both, plan)
    counted = timespans.hold_window(both, plan, reach, reach) | seen
    delay = (steps[match[found & counted]] - plan[found & counted]) / 1e9
    tolerance = max(ON_TIME_S, *(record.median_interval_s or 0.0 for record in records))
    alone = np.setdiff1d(np.arange(len(steps)), match[found])
    margin = int(median_of(reach) if len(reach) else _LONE_S * 1e9)
    down = [timespans.intersect([record.in_contact, both]) for record in records]
    together = timespans.total(timespans.intersect(down))
    differ = sum(map(timespans.total, down)) - 2 * together
    known = timespans.total(both)
    return PlannedFoot(
        topic=planned.topic,
        touchdowns=int(counted.sum()),
        early=int((delay < -tolerance).sum()),
        late=int((delay > tolerance).sum()),
        metrics=Planned(
            delay_s=aggregate(delay),
            missed=int((counted & ~found).sum()),
            unplanned=int(timespans.hold_window(both, steps[alone], margin, margin).sum()),
            agreement=1.0 - differ / known if known else None,
        ),
    )


def _reach(plan: Ints) -> Ints:
    """(p,) ns around each planned touchdown in which its match may be."""
    if len(plan) < 2:
        return np.full(len(plan), round(_LONE_S * 1e9), np.int64)
    steps = np.diff(plan)
    before, after = np.append(steps[:1], steps), np.append(steps, steps[-1:])
    reach: Ints = np.minimum(before, after) // 2
    return reach


def _matches(plan: Ints, steps: Ints, reach: Ints) -> Ints:
    """(p,) measured touchdown of each planned one; -1: none."""
    if not len(plan) or not len(steps):
        return np.full(len(plan), -1, np.int64)
    nearest = nearest_rows(steps, plan)
    mutual = nearest_rows(plan, steps)[nearest] == np.arange(len(plan))
    near = np.abs(steps[nearest] - plan) <= reach
    match: Ints = np.where(mutual & near, nearest, -1)
    return match
