"""Strides: from each touchdown of a foot to its next one."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, median_of, picked
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
