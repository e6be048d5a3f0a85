"""How a foot follows its plan: touchdowns early, late and missed."""

from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Aggregate, Ints, aggregate, median_of, nearest_rows
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.dataclass import dataclass

ON_TIME_S: Final = 0.02
"""s; touchdowns that are off by less are on time, and by less than a sample of either, too."""
_LONE_S: Final = 0.25
"""s around a touchdown without neighbours in which its match is looked for."""


@dataclass(frozen=True, slots=True)
class PlannedFoot:
    """A foot's measured steps against its planned ones, in the time that is known of both."""

    topic: str
    """Topic of the plan."""
    touchdowns: int
    """Planned ones."""
    delay: Aggregate | None
    """s, of the touchdowns that have a match: measured minus planned; positive: late."""
    early: int
    """Matched touchdowns that are more than `tolerance_s` early. Also `late`."""
    late: int
    missed: int
    """Planned touchdowns without a measured one."""
    unplanned: int
    """Measured touchdowns without a planned one."""
    tolerance_s: float
    agreement: float | None
    """Share of the time in which plan and measurement agree on contact; None: no common time."""


def follow_plan(measured: FootSteps, planned: FootSteps) -> PlannedFoot:
    """Compare a foot's steps with its plan.

    A planned touchdown is matched with the nearest measured one if it is the nearest of that one,
    too, and nearer than half the way to the planned touchdowns before and after it. Touchdowns
    nearer than that to where either is unknown are left out: their match may be hidden.

    Args:
        measured: the foot.
        planned: the same foot in a plan, on the same clock.
    """
    both = timespans.intersect([measured.record.known, planned.record.known])
    plan = planned.touchdown
    reach = _reach(plan)
    steps = measured.touchdown
    match = _matches(plan, steps, reach)
    found = match >= 0
    counted = timespans.hold_window(both, plan, reach, reach) | (
        found & timespans.covers(both, plan)
    )
    delay = (steps[match[found & counted]] - plan[found & counted]) / 1e9
    tolerance = max(
        ON_TIME_S, *(foot.record.median_interval_s or 0.0 for foot in (measured, planned))
    )
    alone = np.setdiff1d(np.arange(len(steps)), match[found])
    margin = int(median_of(reach) if len(reach) else _LONE_S * 1e9)
    return PlannedFoot(
        topic=planned.topic,
        touchdowns=int(counted.sum()),
        delay=aggregate(delay),
        early=int((delay < -tolerance).sum()),
        late=int((delay > tolerance).sum()),
        missed=int((counted & ~found).sum()),
        unplanned=int(timespans.hold_window(both, steps[alone], margin, margin).sum()),
        tolerance_s=tolerance,
        agreement=_agreement(both, measured, planned),
    )


def _reach(plan: Ints) -> Ints:
    """(p,) ns around each planned touchdown in which its match may be."""
    if len(plan) < 2:
        return np.full(len(plan), round(_LONE_S * 1e9), np.int64)
    steps = np.diff(plan)
    before = np.concatenate([steps[:1], steps])
    after = np.concatenate([steps, steps[-1:]])
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


def _agreement(both: Ints, measured: FootSteps, planned: FootSteps) -> float | None:
    known = timespans.total(both)
    if not known:
        return None
    down = [timespans.intersect([foot.record.in_contact, both]) for foot in (measured, planned)]
    together = timespans.total(timespans.intersect(down))
    differ = timespans.total(down[0]) + timespans.total(down[1]) - 2 * together
    return 1.0 - differ / known
