"""Which header stamps can be used: single bad ones are left out, a clock that is set is noticed."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Protocol, TypeVar

import numpy as np

from dogbot_logtool.core.arrays import Flags, Ints, Record, distinct
from dogbot_logtool.dataclass import dataclass

NEIGHBOURS: Final = 10
"""Stamps before and after a stamp that it is compared with."""
FEWEST: Final = 3
"""Stamps on either side of a step that make it one; fewer are bad stamps."""
LARGEST_STEP_S: Final = 10.0
"""s: stamps that run ahead of log time by more, at once and for good, were set forward."""
MOST_BAD_SHARE: Final = 0.05
"""Share of bad stamps up to which their messages are left out."""


@dataclass(frozen=True, slots=True)
class ClockStep:
    """A moment at which the clock of the stamps was set: a simulation that was reset, say."""

    before: int
    """ns, log time of the last message before it. Also `after`, the first one after it."""
    after: int
    by_ns: int
    """ns by which the stamps stepped more than log time did; negative: back."""


@dataclass(frozen=True, slots=True)
class StampCheck:
    """The header stamps of one topic, checked."""

    topic: str
    usable: Flags
    """(n,) whether each message's stamp can be used; those that are `behind` are kept, since they
    do not advance anyway."""
    zeros: int
    """Stamps that are zero or negative."""
    ahead: int
    """Stamps that most of those after them are lower than."""
    behind: int
    """Stamps lower than one before that is not bad."""
    steps: tuple[ClockStep, ...]
    first_log_time: int | None

    @property
    def messages(self) -> int:
        """Messages that were checked."""
        return len(self.usable)

    @property
    def bad(self) -> int:
        """Messages whose stamps cannot be used."""
        return self.zeros + self.ahead + self.behind

    @property
    def mostly_usable(self) -> bool:
        """Whether there are stamps, most of which can be used."""
        return self.messages > 0 and 2 * self.bad <= self.messages


def check_stamps(topic: str, stamp: Ints, log_time: Ints) -> StampCheck:
    """Check the header stamps of one topic.

    A stamp is bad when it is zero, or when most of the `NEIGHBOURS` stamps after it are lower.
    Stamps that step back and stay there begin anew: the clock was set.

    Args:
        topic: its name.
        stamp: (n,) ns, in the order of the log.
        log_time: (n,) ns.
    """
    valid = np.flatnonzero(stamp > 0)
    ahead, rows = _judged(stamp[valid], log_time[valid])
    good = stamp[valid[~ahead]]
    usable = np.zeros(len(stamp), np.bool_)
    usable[valid[~ahead]] = True
    return StampCheck(
        topic=topic,
        usable=usable,
        zeros=len(stamp) - len(valid),
        ahead=int(ahead.sum()),
        behind=int((good < np.maximum.accumulate(good)).sum()),
        steps=_clock_steps(stamp[valid], log_time[valid], rows),
        first_log_time=int(log_time[0]) if len(log_time) else None,
    )


def _judged(stamp: Ints, log_time: Ints) -> tuple[Flags, Ints]:
    """Tell which stamps are ahead, (n,), and the rows at which the clock was set.

    Args:
        stamp: (n,) ns, above 0.
        log_time: (n,) ns.
    """
    none = np.empty(0, np.int64)
    if not len(stamp) or _is_calm(stamp):
        return np.zeros(len(stamp), np.bool_), none
    back = np.flatnonzero(stamp[1:] < stamp[:-1])
    begins_anew = back[_stay_below(stamp, back)] + 1
    ahead = _ahead(stamp, back[~np.isin(back, begins_anew - 1)], begins_anew)
    forward = _forward_steps(stamp, log_time, ahead, begins_anew)
    late = forward[forward > len(stamp) - FEWEST]
    if len(late):
        ahead[late[0] :] = True
    forward = np.setdiff1d(forward, late)
    return ahead, distinct(np.concatenate([begins_anew, forward]))


def _is_calm(stamp: Ints) -> bool:
    """Whether stamps only rise, and never far at once: nearly always."""
    step = np.diff(stamp)
    return int(step.min(initial=0)) >= 0 and int(step.max(initial=0)) <= LARGEST_STEP_S * 1e9


def _clock_steps(stamp: Ints, log_time: Ints, rows: Ints) -> tuple[ClockStep, ...]:
    """Return the steps of a clock that was set at some rows."""
    rows = rows[rows > 0]
    before, after = log_time[rows - 1], log_time[rows]
    by = stamp[rows] - stamp[rows - 1] - (after - before)
    return tuple(map(ClockStep, before.tolist(), after.tolist(), by.tolist()))


def _forward_steps(stamp: Ints, log_time: Ints, ahead: Flags, begins_anew: Ints) -> Ints:
    """Return the rows at which stamps step forward by far more than log time does."""
    good = np.flatnonzero(~ahead)
    stamp_step, log_step = np.diff(stamp[good]), np.diff(log_time[good])
    far = stamp_step - log_step > np.maximum(LARGEST_STEP_S * 1e9, 10.0 * log_step)
    rows, before = good[1:][far], good[:-1][far]
    after = np.minimum(rows[:, None] + np.arange(NEIGHBOURS), len(stamp) - 1)
    stays = stamp[after].min(axis=1) - stamp[before] > LARGEST_STEP_S * 1e9
    forward: Ints = rows[stays & ~np.isin(rows, begins_anew)]
    return forward


def _stay_below(stamp: Ints, back: Ints) -> Flags:
    """Tell after which rows all stamps near are lower than all near before.

    Args:
        stamp: (n,) ns.
        back: (b,) rows whose next stamp is lower.
    """
    before = back[:, None] - np.arange(NEIGHBOURS)
    after = back[:, None] + 1 + np.arange(NEIGHBOURS)
    highest, lowest = np.iinfo(np.int64).max, np.iinfo(np.int64).min
    earlier = np.where(before >= 0, stamp[np.maximum(before, 0)], highest)
    later = np.where(after < len(stamp), stamp[np.minimum(after, len(stamp) - 1)], lowest)
    enough = (back + 1 >= FEWEST) & (back + FEWEST < len(stamp))
    below: Flags = enough & (later.max(axis=1) < earlier.min(axis=1))
    return below


def _ahead(stamp: Ints, back: Ints, begins_anew: Ints) -> Flags:
    """Tell which stamps most of those after them are lower than, up to where the clock is set.

    Args:
        stamp: (n,) ns.
        back: (b,) rows whose next stamp is lower.
        begins_anew: (s,) rows at which the clock was set back.
    """
    ahead = np.zeros(len(stamp), np.bool_)
    rows = distinct(np.maximum(back[:, None] - np.arange(NEIGHBOURS), 0))
    if len(rows) == 0:
        return ahead
    after = rows[:, None] + 1 + np.arange(NEIGHBOURS)
    within = after < len(stamp)
    after = np.minimum(after, len(stamp) - 1)
    epoch = np.searchsorted(begins_anew, np.arange(len(stamp)), side="right")
    within &= epoch[after] == epoch[rows, None]
    lower = within & (stamp[after] < stamp[rows, None])
    ahead[rows] = 2 * lower.sum(axis=1) > within.sum(axis=1)
    return ahead


class _StampedRecord(Record, Protocol):
    """Columns with header stamps."""

    @property
    def stamp(self) -> Ints:
        """(n,) ns."""


Columns = TypeVar("Columns", bound=_StampedRecord)


def without_bad_stamps(columns: Columns, check: StampCheck) -> Columns:
    """Return columns with zero for header stamps that cannot be used."""
    if check.usable.all():
        return columns
    changed: Columns = replace(columns, stamp=np.where(check.usable, columns.stamp, 0))
    return changed


def why_unusable(checks: Sequence[StampCheck]) -> str:
    """Say why header stamps cannot be the clock of the log; empty where they can.

    Args:
        checks: of all topics that are measured.
    """
    stamped = [check for check in checks if check.messages]
    for check in stamped:
        most = max(FEWEST, MOST_BAD_SHARE * check.messages)
        if 2 * check.zeros > check.messages:
            return f"header stamps of {check.topic} are zero"
        if not check.steps and check.bad > most:
            what = "are zero" if check.zeros == check.bad else "are zero or go backwards"
            if not check.zeros:
                what = "go backwards"
            counted = f"{check.bad} of {check.messages}"
            return f"header stamps of {check.topic} {what} ({counted})"
    return _why_set(stamped)


def _why_set(checks: Sequence[StampCheck]) -> str:
    """Say which topics' clocks were set, when and by how much; empty where none was."""
    stepped = {check.topic: check.steps for check in checks if check.steps}
    if not stepped:
        return ""
    start = min(check.first_log_time or 0 for check in checks)
    first = min((step for steps in stepped.values() for step in steps), key=lambda s: s.after)
    back = "back" if first.by_ns < 0 else "forward"
    at, by = (first.after - start) / 1e9, abs(first.by_ns) / 1e9
    everywhere = len(stepped) == len({check.topic for check in checks})
    topics = "all topics" if everywhere else ", ".join(sorted(stepped))
    times = max(len(steps) for steps in stepped.values())
    more = "" if times == 1 else f", and {times - 1} more times"
    text = f"the clock of {topics} was set {back} by {by:.2f} s at {at:.2f} s{more}"
    return f"{text} (was the simulation reset?)" if everywhere and first.by_ns < 0 else text


def set_spans(checks: Sequence[StampCheck]) -> Ints:
    """(s, 2) ns, log time: the spans in which the clock of any topic was set."""
    spans = [(step.before, step.after) for check in checks for step in check.steps]
    return np.array(spans, np.int64).reshape(-1, 2)
