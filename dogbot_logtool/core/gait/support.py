"""How many feet, and which, are down at a time; when the robot stands, or moves without steps."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, distinct, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import LONGEST_STANCE_S, Cut, Stances
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


STAND_S: Final = 1.0
"""All feet down for longer, and for longer than a stride, is no part of a stride."""
MOVED_M: Final = 0.15
"""m from its first position that a base reaches only if it moves; swaying is less."""
TURNED_RAD: Final = 0.5
"""rad, the same for its heading."""
STILL_MPS: Final = 0.01
"""m/s: a base slower than this over `_WINDOW_S` is still."""
STILL_RADPS: Final = 0.02
LONG_FOR_FOOT: Final = 3.0
"""Times a foot's median stance from which a long stance is no step."""
_STEP_S: Final = 0.25
_WINDOW_S: Final = 2.0


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
    stances: list[Stances],
    base: BaseHistory,
    fallen: Ints,
    *,
    is_steady: bool,
) -> Standing:
    """Find where the robot stands, moves without steps, or is in the air.

    Args:
        support: which feet are down; None: never known of all, or no contact is.
        stances: of all feet.
        base: poses, without jumps.
        fallen: (f, 2) ns, spans in which the robot lies.
        is_steady: whether no foot's load ever comes and goes, so that there are no steps even where
            contact is not known.
    """
    none = timespans.no_spans()
    if support is None:
        whole = base.known if is_steady else none
        return Standing(none, find_standing(whole, none, None, base).moving, none)
    # A robot that lies with its feet on the ground does not stand.
    all_down = timespans.subtract(support.all_down, fallen)
    in_flight = timespans.subtract(support.in_flight, fallen)
    return find_standing(all_down, in_flight, typical_period_s(stances), base)


def find_standing(
    all_down: Ints, in_flight: Ints, typical_period_s: float | None, base: BaseHistory
) -> Standing:
    """Find where all feet are down, or in the air, for longer than within a stride.

    Args:
        all_down: (n, 2) ns, all feet in contact.
        in_flight: (n, 2) ns, no foot in contact.
        typical_period_s: s, median time between touchdowns of a foot; None without any.
        base: poses, without jumps.
    """
    longest_step = max(STAND_S, typical_period_s or 0.0)
    chosen = all_down[all_down[:, 1] - all_down[:, 0] >= longest_step * 1e9]
    moving = [_moving(span, base) for span in chosen]
    joined = timespans.merge(np.concatenate(moving)) if moving else timespans.no_spans()
    still = timespans.subtract(chosen, joined) if len(joined) else chosen
    return Standing(_lasting(still), joined, _lasting(in_flight))


def _lasting(spans: Ints) -> Ints:
    chosen: Ints = spans[spans[:, 1] - spans[:, 0] >= STAND_S * 1e9]
    return chosen


def _moving(span: Ints, base: BaseHistory) -> Ints:
    """(m, 2) ns, the parts of a span in which the base goes somewhere."""
    start, end = span.tolist()
    count = max(1, int((end - start) / (_STEP_S * 1e9)))
    time = np.linspace(start, end, count + 1).astype(np.int64)
    position = np.column_stack([base.position_at(time)[:, :2], base.angles_at(time)[:, 2]])
    known = position[all_finite(position)]
    if len(known) < 2:
        return timespans.no_spans()
    away = known - known[0]
    if _distance(away).max() < MOVED_M and np.abs(away[:, 2]).max() < TURNED_RAD:
        return timespans.no_spans()
    return _lasting(timespans.spans_where(time, _moves(position)[:-1]))


def _moves(position: Floats) -> Flags:
    """(n,) whether the base moves around each instant; not where it is not known."""
    reach = round(_WINDOW_S / _STEP_S / 2.0)
    rows = np.arange(len(position))
    after, before = np.minimum(rows + reach, len(position) - 1), np.maximum(rows - reach, 0)
    way, seconds = position[after] - position[before], (after - before) * _STEP_S
    fast = _distance(way) > STILL_MPS * seconds
    moves: Flags = fast | (np.abs(way[:, 2]) > STILL_RADPS * seconds)
    return moves


def _distance(position: Floats) -> Floats:
    distance: Floats = np.hypot(position[:, 0], position[:, 1])
    return distance


def typical_period_s(stances: list[Stances]) -> float | None:
    """Return the median time between touchdowns over all feet, s; None without two of one foot."""
    seen = [each.touchdown[each.cut != Cut.LOG_START] for each in stances]
    periods = np.concatenate([np.diff(each) for each in seen]) if seen else np.empty(0)
    return float(median_of(periods)) / 1e9 if len(periods) else None


def steps_apart(standing: Ints, stances: Stances) -> Flags:
    """Tell which whole stances are no steps, since the robot stands in them.

    Those that reach into a stand, and those that are much longer than the foot's others (the
    stand of a robot with a foot in the air, or with a foot that is not known).

    Args:
        standing: (s, 2) ns, spans without steps.
        stances: of one foot.
    """
    found = timespans.touches(standing, stances.touchdown, stances.liftoff)
    whole = stances.cut == Cut.WHOLE
    if whole.any():
        usual = float(median_of(stances.duration_s[whole]))
        found |= stances.duration_s > max(LONGEST_STANCE_S, LONG_FOR_FOOT * usual)
    apart: Flags = found & whole
    return apart
