"""Touchdowns and lift-offs, and the touchdowns that come too early."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints
from dogbot_logtool.core.contact.stances import Cut
from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.gait.foot_steps import FootSteps
from dogbot_logtool.core.gait.segments import Segment

EARLY: Final = 0.7
"""Share of the usual swing below which a swing ends early."""
BOUNCE: Final = 0.2
"""Share of the usual swing below which a swing is a bounce, at touchdown or lift-off."""
SHORT_STANCE: Final = 0.5
"""Share of the usual stance below which a contact is no step."""
STRIDE_GOES_ON: Final = 1.4
"""Times the usual swing that two swings and a contact between them last at most, if they are one
swing in which the foot hits something."""
NEIGHBOURS: Final = 5
"""Swings before, and after, that say what is usual."""
FEWEST: Final = 3


def step_events(feet: tuple[FootSteps, ...]) -> Iterator[Event]:
    """Yield all touchdowns and lift-offs that were seen."""
    for row, foot in enumerate(feet):
        for times, kind in (
            (foot.touchdown, EventType.TOUCHDOWN),
            (foot.liftoff, EventType.LIFT_OFF),
        ):
            yield from (Event(time, 0, kind, row) for time in times.tolist())


def early_touchdowns(foot: int, figures: FootSteps, walks: list[Segment]) -> Iterator[Event]:
    """Yield the touchdowns of a foot that come well before its usual swing is over.

    The foot hits something in mid-swing and swings on: a stumble. Or it stays on the ground: an
    early contact. A foot that bounces as it lands, or as it leaves, does neither.

    Args:
        foot: its index.
        figures: its stances and strides.
        walks: segments with strides; elsewhere no swing is usual.
    """
    stances = figures.stances
    if len(stances.touchdown) < FEWEST + 2:
        return
    swing, stance = _swings_s(figures), stances.duration_s
    usual_swing = _usual(swing, np.minimum)
    usual_stance = _usual(np.where(stances.whole, stance, np.nan), np.maximum)
    short = stance < SHORT_STANCE * usual_stance
    early = (swing > BOUNCE * usual_swing) & (swing < EARLY * usual_swing) & stances.whole
    # After a contact that is no step, a short swing is the rest of the swing before it.
    early[1:] &= ~short[:-1]
    early &= _inside(walks, stances.touchdown)
    rest = np.append(swing[1:], np.nan)
    whole_swing = swing + stance + rest
    goes_on = (rest > BOUNCE * usual_swing) & (whole_swing < STRIDE_GOES_ON * usual_swing)
    stumbles, lands = early & short & goes_on, early & ~short
    for row in np.flatnonzero(stumbles | lands).tolist():
        onset, lasts = int(stances.touchdown[row]), round(stance[row] * 1e9)
        if stumbles[row]:
            done = float(swing[row] / whole_swing[row])
            yield Event(onset, lasts, EventType.STUMBLE, foot, done, "swing")
        else:
            by_s = float(usual_swing[row] - swing[row])
            yield Event(onset, 0, EventType.EARLY_CONTACT, foot, by_s, "s")


def _swings_s(figures: FootSteps) -> Floats:
    """(stances,) s, swing before each stance; NaN where it was not seen from end to end."""
    stances, gaps = figures.stances, figures.record.gaps
    swing = np.full(len(stances.touchdown), np.nan)
    swing[1:] = (stances.touchdown[1:] - stances.liftoff[:-1]) / 1e9
    swing[np.isin(stances.touchdown, gaps[:, 1])] = np.nan
    broken = stances.cut != Cut.WHOLE
    swing[1:][broken[:-1]] = np.nan
    swing[broken] = np.nan
    return swing


def _usual(values: Floats, of: np.ufunc) -> Floats:
    """(n,) the median of the values before each one, or of those after it; NaN of too few.

    Where both are known, `of` chooses between them: a gait that changes is no event of one foot.
    """
    unknown = np.full(NEIGHBOURS, np.nan)
    padded = np.concatenate([unknown, np.where(np.isfinite(values), values, np.nan), unknown])
    windows = np.lib.stride_tricks.sliding_window_view(padded, NEIGHBOURS)
    before, after = _medians(windows[: len(values)]), _medians(windows[NEIGHBOURS + 1 :])
    both = of(before, after)
    usual: Floats = np.where(np.isnan(before), after, np.where(np.isnan(after), before, both))
    return usual


def _medians(windows: Floats) -> Floats:
    """(n,) the median of what each row, (n, w), knows; NaN of fewer than `FEWEST`."""
    known = np.isfinite(windows).sum(axis=1)
    ordered, rows = np.sort(windows, axis=1), np.arange(len(windows))
    # NaN is sorted to the end.
    middle = ordered[rows, np.maximum(known - 1, 0) // 2] + ordered[rows, known // 2]
    return np.where(known < FEWEST, np.nan, middle / 2.0)


def _inside(segments: list[Segment], time: Ints) -> Flags:
    inside = np.zeros(len(time), np.bool_)
    for each in segments:
        inside |= (time > each.start) & (time <= each.end)
    return inside
