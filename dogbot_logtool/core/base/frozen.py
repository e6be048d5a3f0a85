"""Poses that stay the same to the bit while the feet step: the time is masked, unless it is true.

A simulator without noise that steps on the spot has one pose, too. Where the feet's places show
that the base stays, one pose is right.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints, median_of
from dogbot_logtool.core.base.comparison import motion_in, stride_windows
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.base.witness import Witness
from dogbot_logtool.core.contact.foot_history import FootHistory

SHORTEST_STRIDES: Final = 1.5
"""Strides that one pose must last for."""
FEWEST_TOUCHDOWNS: Final = 2
STAYS_MPS: Final = 0.02
"""m/s: feet that walk on less quickly stay where they are."""
STAYS_RADPS: Final = 0.03
"""rad/s, the same of a turn."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Frozen:
    """Time in which one pose is repeated although the robot walks, or may walk, on."""

    spans: Ints
    """(s, 2) ns."""
    whole: bool
    """Whether no other poses are left."""
    moves_mps: float | None
    """m/s, how fast the witness says that the base moves in that time; None: there is none."""
    turns_radps: float | None
    """rad/s, how fast it turns, likewise."""
    by: str
    """The witness; empty: none tells whether the base moves."""


def find_frozen(
    base: BaseHistory, feet: Sequence[FootHistory], witness: Witness | None, period_s: float | None
) -> Frozen | None:
    """Find the time in which poses are frozen; None: they are not.

    Args:
        base: poses as recorded.
        feet: histories of all feet.
        witness: the base's motion by its feet; None: not known.
        period_s: s, the usual stride; None: there is none.
    """
    if not period_s or len(base.time) < 2:
        return None
    spans = _one_pose(base, SHORTEST_STRIDES * period_s * 1e9)
    steps = [_touchdowns(feet, span) >= FEWEST_TOUCHDOWNS for span in spans]
    spans = spans[np.array(steps, np.bool_)]
    if not len(spans):
        return None
    speeds = turns = np.empty(0)
    by = ""
    if witness is not None:
        motion = motion_in(witness.poses, stride_windows(spans, period_s))
        known = np.isfinite(motion.turn)
        speeds = np.abs(motion.displacement[known]) / period_s
        turns = np.abs(motion.turn[known]) / period_s
        by = witness.by if known.any() else ""
    moves, turned = (float(median_of(each)) if by else None for each in (speeds, turns))
    if by and (moves or 0.0) < STAYS_MPS and (turned or 0.0) < STAYS_RADPS:
        return None
    return Frozen(spans, len(without_frozen(base, spans).time) < 2, moves, turned, by)


def without_frozen(base: BaseHistory, spans: Ints) -> BaseHistory:
    """Return poses without those of some spans, (s, 2) ns, which become gaps."""
    inside = timespans.covers(spans, base.time - 1) | timespans.covers(spans, base.time)
    rows = np.flatnonzero(~inside)
    return base.pick(rows) if len(rows) > 1 else base.without_poses()


def _one_pose(base: BaseHistory, shortest_ns: float) -> Ints:
    """(s, 2) ns, spans of one pose."""
    same = (np.diff(base.position, axis=0) == 0.0).all(axis=1)
    same &= (np.diff(base.angles, axis=0) == 0.0).all(axis=1)
    spans = timespans.spans_where(base.time, same)
    return spans[spans[:, 1] - spans[:, 0] >= shortest_ns]


def _touchdowns(feet: Sequence[FootHistory], span: Ints) -> int:
    """Return the most touchdowns of one foot in a span, (2,) ns."""
    counts = [
        int(((each.stances.touchdown > span[0]) & (each.stances.touchdown < span[1])).sum())
        for each in feet
    ]
    return max(counts, default=0)
