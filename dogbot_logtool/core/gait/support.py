"""How many feet, and which, are down at a time; when the robot stands, or moves without steps."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints, all_finite, distinct
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory

MOST_FREQUENT: Final = 5
"""Support sets that are reported."""
STAND_S: Final = 1.0
"""All feet down for longer, and for longer than a stride, is no part of a stride."""
MOVED_M: Final = 0.15
"""m from its first position that a base reaches only if it moves; swaying is less."""
TURNED_RAD: Final = 0.5
"""rad, the same for its heading."""
STILL_MPS: Final = 0.01
"""m/s: a base slower than this over `_WINDOW_S` is still."""
STILL_RADPS: Final = 0.02
_STEP_S: Final = 0.25
_WINDOW_S: Final = 2.0


class Support(NamedTuple):
    """Fractions of the time known to all feet."""

    feet_down: tuple[float, ...]
    """(feet + 1) fraction of that time with 0, 1, 2 ... feet in contact."""
    sets: tuple[tuple[tuple[int, ...], float], ...]
    """The most frequent sets of feet in contact, and their fractions, most frequent first."""
    all_down: Ints
    """(n, 2) ns, spans with all feet in contact."""
    in_flight: Ints
    """(f, 2) ns, spans with no foot in contact."""


def support(feet: Sequence[FootHistory], within: Ints = timespans.ALWAYS) -> Support | None:
    """Measure support patterns; None where there is no time known to all feet.

    Args:
        feet: histories of all feet.
        within: (w, 2) ns, a part of the log.
    """
    known = timespans.intersect([foot.known for foot in feet])
    known = timespans.intersect([known, within])
    if not timespans.total(known):
        return None
    contacts = [timespans.intersect([foot.in_contact, known]) for foot in feet]
    edges = distinct(np.concatenate([spans.ravel() for spans in (known, *contacts)]))
    down = np.stack([timespans.covers(spans, edges[:-1]) for spans in contacts])
    inside, number = timespans.covers(known, edges[:-1]), down.sum(axis=0)
    weight, total = np.where(inside, np.diff(edges), 0).astype(np.float64), timespans.total(known)
    by_number = np.bincount(number, weights=weight, minlength=len(feet) + 1) / total
    codes, row = np.unique((1 << np.arange(len(feet))) @ down, return_inverse=True)
    by_code = np.bincount(row, weights=weight) / total
    order = np.argsort(-by_code, kind="stable")[:MOST_FREQUENT]
    return Support(
        feet_down=tuple(by_number.tolist()),
        sets=tuple(
            (tuple(np.flatnonzero(codes[each] >> np.arange(len(feet)) & 1).tolist()), by_code[each])
            for each in order.tolist()
            if by_code[each] > 0.0
        ),
        all_down=timespans.spans_where(edges, inside & (number == len(feet))),
        in_flight=timespans.spans_where(edges, inside & (number == 0)),
    )


class Standing(NamedTuple):
    """Spans that are no part of a stride, with all feet down or none."""

    still: Ints
    """(s, 2) ns, the base is still, or not known: the robot stands."""
    moving: Ints
    """(m, 2) ns, the base moves all the same: wheels, or contacts that are wrong."""
    lifted: Ints
    """(l, 2) ns, no foot is down for longer than a leap takes: the robot is held in the air."""

    @property
    def without_steps(self) -> Ints:
        """(n, 2) ns, all of these."""
        return timespans.merge(np.concatenate(self))


def standing_in(
    support: Support | None,
    period_s: float | None,
    base: BaseHistory,
    fallen: Ints,
) -> Standing:
    """Find where all feet are down, or in the air, for longer than within a stride.

    Args:
        support: which feet are down; None: never known of all, or no contact is.
        period_s: s, median time between touchdowns of a foot; None without any.
        base: poses, without jumps.
        fallen: (f, 2) ns, spans in which the robot lies.
    """
    none = timespans.no_spans()
    all_down, in_flight, longest_step_s = none, none, STAND_S
    if support is not None:
        # A robot that lies with its feet on the ground does not stand.
        all_down = timespans.subtract(support.all_down, fallen)
        in_flight = timespans.subtract(support.in_flight, fallen)
        longest_step_s = max(STAND_S, period_s or 0.0)
    chosen = _lasting(all_down, longest_step_s)
    moving = timespans.merge(np.concatenate([none, *(_moving(span, base) for span in chosen)]))
    still = none if support is None else _lasting(timespans.subtract(chosen, moving))
    return Standing(still, moving, _lasting(in_flight))


def _lasting(spans: Ints, seconds: float = STAND_S) -> Ints:
    chosen: Ints = spans[spans[:, 1] - spans[:, 0] >= seconds * 1e9]
    return chosen


def _moving(span: Ints, base: BaseHistory) -> Ints:
    """(m, 2) ns, the parts of a span in which the base goes somewhere."""
    start, end = span.tolist()
    count = max(1, int((end - start) / (_STEP_S * 1e9)))
    time = np.linspace(start, end, count + 1).astype(np.int64)
    position = np.column_stack([base.position_at(time)[:, :2], base.angles_at(time)[:, 2]])
    known = position[all_finite(position)]
    away = np.abs(known - known[:1])
    if not (np.hypot(*away[:, :2].T) >= MOVED_M).any() and not (away[:, 2] >= TURNED_RAD).any():
        return timespans.no_spans()
    # Around each instant; where that is not known, it does not move.
    reach, rows = round(_WINDOW_S / _STEP_S / 2.0), np.arange(count + 1)
    after, before = np.minimum(rows + reach, count), np.maximum(rows - reach, 0)
    x, y, turn = np.abs(position[after] - position[before]).T
    seconds = (after - before) * _STEP_S
    moves = (np.hypot(x, y) > STILL_MPS * seconds) | (turn > STILL_RADPS * seconds)
    return _lasting(timespans.spans_where(time, moves[:-1]))
