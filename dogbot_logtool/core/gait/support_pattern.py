"""How many feet, and which, are down at a time."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints, distinct
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.dataclass import dataclass

MOST_FREQUENT: Final = 5
"""Support sets that are reported."""


@dataclass(frozen=True, slots=True)
class Support:
    """Fractions of the time known to all feet."""

    time_s: float
    """s, time known to all feet."""
    feet_down: tuple[float, ...]
    """(feet + 1) fraction of that time with 0, 1, 2 ... feet in contact."""
    sets: tuple[tuple[tuple[int, ...], float], ...]
    """The most frequent sets of feet in contact, and their fractions, most frequent first."""
    known: Ints
    """(k, 2) ns, time known to all feet."""
    all_down: Ints
    """(n, 2) ns, spans with all feet in contact."""
    in_flight: Ints
    """(f, 2) ns, spans with no foot in contact."""

    @property
    def double_support_fraction(self) -> float | None:
        """Fraction of time with both feet of a robot of two in contact; None for others."""
        return self.feet_down[2] if len(self.feet_down) == 3 else None

    def flight_within(self, spans: Ints) -> float | None:
        """Return the fraction of the known part of spans in flight; None without any."""
        known = timespans.total(timespans.intersect([self.known, spans]))
        flight = timespans.total(timespans.intersect([self.in_flight, spans]))
        return flight / known if known else None

    @property
    def flight_fraction(self) -> float:
        """Fraction of time without any foot in contact."""
        return self.feet_down[0]


def support(feet: Sequence[FootHistory], within: Ints | None = None) -> Support | None:
    """Measure support patterns; None where there is no time known to all feet.

    Args:
        feet: histories of all feet.
        within: (w, 2) ns, a part of the log; None: all of it.
    """
    known = timespans.intersect([foot.known for foot in feet])
    known = known if within is None else timespans.intersect([known, within])
    if timespans.total(known) == 0:
        return None
    contacts = [timespans.intersect([foot.in_contact, known]) for foot in feet]
    edges = distinct(np.concatenate([spans.ravel() for spans in (known, *contacts)]))
    begin, duration = edges[:-1], np.diff(edges)
    code = np.zeros(len(begin), np.int64)
    number = np.zeros(len(begin), np.int64)
    for foot, spans in enumerate(contacts):
        down = timespans.covers(spans, begin)
        code += down.astype(np.int64) << foot
        number += down
    inside = timespans.covers(known, begin)
    all_down = timespans.spans_where(edges, inside & (number == len(feet)))
    in_flight = timespans.spans_where(edges, inside & (number == 0))

    time = float(timespans.total(known))
    weight = np.where(inside, duration, 0).astype(np.float64)
    by_number = np.bincount(number, weights=weight, minlength=len(feet) + 1) / time
    codes, row = np.unique(code, return_inverse=True)
    by_code = np.bincount(row, weights=weight) / time
    order = np.argsort(-by_code, kind="stable")[:MOST_FREQUENT]
    sets = tuple(
        (_members(int(codes[each]), len(feet)), float(by_code[each]))
        for each in order
        if by_code[each] > 0.0
    )
    return Support(
        time_s=time / 1e9,
        feet_down=tuple(float(share) for share in by_number),
        sets=sets,
        known=known,
        all_down=all_down,
        in_flight=in_flight,
    )


def _members(code: int, feet: int) -> tuple[int, ...]:
    return tuple(foot for foot in range(feet) if code >> foot & 1)
