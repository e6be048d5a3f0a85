"""Strides: from each touchdown of a foot to its next one."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.dataclass import dataclass

REASONS: Final[Mapping[int, str]] = {
    Cut.LOG_START: "log_start",
    Cut.LOG_END: "log_end",
    Cut.GAP: "gap",
    Cut.STANDING: "standing",
    Cut.FALL: "fall",
}
"""Names of what cuts a stride, for reports."""


@dataclass(frozen=True, slots=True)
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
        return _seconds(self.liftoff - self.touchdown)

    @property
    def swing_s(self) -> Floats:
        """(n,) s, next touchdown minus lift-off."""
        return _seconds(self.end - self.liftoff)

    @property
    def period_s(self) -> Floats:
        """(n,) s, next touchdown minus touchdown."""
        return _seconds(self.end - self.touchdown)

    @property
    def duty_factor(self) -> Floats:
        """(n,) stance over stride period (Hildebrand 1965; Alexander 1984)."""
        return self.stance_s / self.period_s

    @property
    def frequency_hz(self) -> float | None:
        """(touchdowns - 1) / (last - first touchdown) over unbroken runs, 1/s; None without."""
        if len(self.touchdown) == 0:
            return None
        return len(self.touchdown) / float(self.period_s.sum())

    @property
    def spans(self) -> Ints:
        """(n, 2) ns, touchdown and next touchdown."""
        return np.stack([self.touchdown, self.end], axis=1)

    def rows_within(self, spans: Ints) -> Flags:
        """(n,) which strides have their middle in one of the spans."""
        return timespans.covers(spans, self.touchdown + (self.end - self.touchdown) // 2)

    def within(self, spans: Ints) -> "Strides":
        """Return the strides whose middle lies in one of the spans."""
        rows = self.rows_within(spans)
        return Strides(self.stance[rows], self.touchdown[rows], self.liftoff[rows], self.end[rows])


def no_strides() -> Strides:
    """Return none."""
    none = np.empty(0, np.int64)
    return Strides(none, none, none, none)


def cut_by_fall(stances: Stances, fallen: Ints) -> Stances:
    """Mark the stances that a fall cuts; what a fallen robot's feet do is not walking.

    Args:
        stances: of one foot.
        fallen: (f, 2) ns, spans in which the robot lies.
    """
    cut = stances.cut.copy()
    cut[timespans.touches(fallen, stances.touchdown, stances.liftoff) & stances.whole] = Cut.FALL
    return replace(stances, cut=cut)


def cut_outside(stances: Stances, within: Ints) -> Stances:
    """Mark the stances that do not have their middle in some spans, (w, 2) ns."""
    middle = stances.touchdown + (stances.liftoff - stances.touchdown) // 2
    inside = timespans.covers(within, middle)
    return replace(stances, cut=np.where(inside, stances.cut, Cut.OUTSIDE).astype(np.int8))


def cut_by_standing(stances: Stances, steps_apart: Flags) -> Stances:
    """Mark the stances in which the robot stands; they are no part of a stride.

    Args:
        stances: of one foot.
        steps_apart: (n,) which of them.
    """
    return replace(stances, cut=np.where(steps_apart, Cut.STANDING, stances.cut).astype(np.int8))


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
        broken = timespans.touches(spans, begin, end) & (cut[:-1] == Cut.WHOLE)
        cut[:-1][broken] = reason
    row = np.flatnonzero(cut == Cut.WHOLE)
    strides = Strides(row, begin[row], stances.liftoff[row], end[row])
    counts = {name: int((cut == reason).sum()) for reason, name in REASONS.items()}
    return strides, {name: count for name, count in counts.items() if count}


def _seconds(duration: Ints) -> Floats:
    seconds: Floats = duration / 1e9
    return seconds
