"""Strides of a foot, which feet are down at a time, and when the robot stands or does not step."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, distinct, median_of, picked
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.contact.stances import LONGEST_STANCE_S, Cut, Stances

LONG_FOR_FOOT: Final = 3.0
"""Times a foot's median stance from which a long stance is no step."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Strides:
    """Whole strides of one foot, in order: stance and swing both seen from end to end."""

    stance: Ints
    """(n,) row of the stride's stance in the foot's `Stances`."""
    touchdown: Ints
    """(n,) ns."""
    liftoff: Ints
    """(n,) ns."""
    end: Ints
    """(n,) ns, the next touchdown."""

    @property
    def stance_s(self) -> Floats:
        """(n,) s, lift-off minus touchdown."""
        return np.asarray((self.liftoff - self.touchdown) / 1e9)

    @property
    def period_s(self) -> Floats:
        """(n,) s, next touchdown minus touchdown."""
        return np.asarray((self.end - self.touchdown) / 1e9)

    @property
    def duty_factor(self) -> Floats:
        """(n,) stance over stride period (Hildebrand 1965; Alexander 1984)."""
        return self.stance_s / self.period_s

    @property
    def frequency_hz(self) -> float | None:
        """(touchdowns - 1) / (last - first touchdown) over unbroken runs, 1/s; None without."""
        return len(self.end) / float(self.period_s.sum()) if len(self.end) else None

    @property
    def spans(self) -> Ints:
        """(n, 2) ns, touchdown and next touchdown."""
        return np.stack([self.touchdown, self.end], axis=1)

    def rows_within(self, spans: Ints) -> Flags:
        """(n,) which strides have their middle in one of the spans."""
        return timespans.covers(spans, self.touchdown + (self.end - self.touchdown) // 2)

    def within(self, spans: Ints) -> "Strides":
        """Return the strides whose middle lies in one of the spans."""
        return picked(self, self.rows_within(spans))


def walked_stances(stances: Stances, fallen: Ints, standing: Ints) -> Stances:
    """Mark the stances that are no steps: those of a fall, and those in which the robot stands.

    The latter reach into a stand, or are much longer than the foot's others (the stand of a robot
    with a foot in the air, or with a foot that is not known).

    Args:
        stances: of one foot.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: (s, 2) ns, spans without steps.
    """
    cut, times = stances.cut.copy(), (stances.touchdown, stances.liftoff)
    cut[stances.whole & timespans.touches(fallen, *times)] = Cut.FALL
    whole = cut == Cut.WHOLE
    stands = timespans.touches(standing, *times)
    if whole.any():
        usual = float(median_of(stances.duration_s[whole]))
        stands |= stances.duration_s > max(LONGEST_STANCE_S, LONG_FOR_FOOT * usual)
    cut[whole & stands] = Cut.STANDING
    return stances._replace(cut=cut)


def strides_of(stances: Stances, gaps: Ints, fallen: Ints) -> tuple[Strides, dict[str, int]]:
    """Pair each touchdown with the next one.

    Args:
        stances: of one foot, in order.
        gaps: (g, 2) ns, silences of its sensor.
        fallen: (f, 2) ns, spans in which the robot lies.

    Returns:
        the whole strides, and the number of stances that begin none, by what cuts them.
    """
    begin, end = stances.touchdown[:-1], stances.touchdown[1:]
    cut = stances.cut.astype(np.int64)
    # The last stance begins a stride whose end the log does not show.
    cut[-1:][cut[-1:] == Cut.WHOLE] = Cut.LOG_END
    for spans, reason in ((gaps, Cut.GAP), (fallen, Cut.FALL)):
        cut[:-1][timespans.touches(spans, begin, end) & (cut[:-1] == Cut.WHOLE)] = reason
    row = np.flatnonzero(cut == Cut.WHOLE)
    counts = {reason.name.lower(): int((cut == reason).sum()) for reason in Cut if reason}
    strides = Strides(row, begin[row], stances.liftoff[row], end[row])
    return strides, {name: count for name, count in counts.items() if count}


def typical_period_s(stances: list[Stances]) -> float | None:
    """Return the median time between touchdowns over all feet, s; None without two of one foot."""
    seen = [np.diff(each.touchdown[each.cut != Cut.LOG_START]) for each in stances]
    periods = np.concatenate([np.empty(0), *seen])
    return float(median_of(periods)) / 1e9 if len(periods) else None


def any_strides(records: Sequence[FootHistory], fallen: Ints, standing: Ints) -> Ints:
    """(s, 2) ns, the strides of the first foot that has any.

    Args:
        records: of all feet.
        fallen: (f, 2) ns, spans in which the robot lies.
        standing: (s, 2) ns, spans without steps, as far as they are known.
    """
    for record in records:
        stances = walked_stances(record.stances, fallen, standing)
        strides, _ = strides_of(stances, record.gaps, fallen)
        if len(strides.stance):
            return strides.spans
    return timespans.no_spans()


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
    if support is None:
        return Standing(none, none, none)
    # A robot that lies with its feet on the ground does not stand.
    spans = support.all_down, support.in_flight
    all_down, in_flight = (timespans.subtract(each, fallen) for each in spans)
    chosen = _lasting(all_down, max(STAND_S, period_s or 0.0))
    moving = timespans.merge(np.concatenate([none, *(_moving(span, base) for span in chosen)]))
    return Standing(_lasting(timespans.subtract(chosen, moving)), moving, _lasting(in_flight))


def _lasting(spans: Ints, seconds: float = STAND_S) -> Ints:
    chosen: Ints = spans[spans[:, 1] - spans[:, 0] >= seconds * 1e9]
    return chosen


def _moving(span: Ints, base: BaseHistory) -> Ints:
    """(m, 2) ns, the parts of a span in which the base goes somewhere."""
    start, end = span.tolist()
    count = max(1, int((end - start) / (_STEP_S * 1e9)))
    time = np.linspace(start, end, count + 1).astype(np.int64)
    position = np.column_stack([base.position_at(time)[:, :2], base.yaw_at(time)])
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
