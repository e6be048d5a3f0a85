"""Which header stamps can be used: single bad ones are left out, a clock that is set is noticed."""

from collections.abc import Callable, Iterator, Sequence
from copy import copy, deepcopy
from dataclasses import replace
from typing import Any, Final, Generic, Self

import numpy as np

from dogbot_logtool.core.geometry.arrays import Flags, Ints
from dogbot_logtool.core.geometry.blocks import Columns, picked
from dogbot_logtool.core.geometry.clock import TimeSource
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.dataclass import dataclass

NEIGHBOURS: Final = 10
"""Stamps before and after a stamp that it is compared with."""
FEWEST: Final = 3
"""Stamps on either side of a step that make it one; fewer are bad stamps."""
LARGEST_STEP_S: Final = 10.0
"""s: stamps that run ahead of log time by more, at once and for good, were set forward."""
MOST_BAD_SHARE: Final = 0.05
"""Share of bad stamps up to which their messages are left out."""
_HELD: Final = 2 * NEIGHBOURS


@dataclass(frozen=True, slots=True)
class ClockStep:
    """A moment at which the clock of the stamps was set: a simulation that was reset, say."""

    before: int
    """ns, log time of the last message before it. Also `after`, the first one after it."""
    after: int
    by_ns: int
    """ns by which the stamps stepped more than log time did; negative: back."""


class StampCheck:
    """Checks the header stamps of one topic, message by message in the order of the log.

    A stamp is bad when it is zero, or when most of the `NEIGHBOURS` stamps after it are lower.
    Stamps that step back and stay there begin anew: the clock was set. Each decision rests on a
    fixed number of neighbours, so it does not depend on how the log is split.
    """

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.messages = 0
        self.zeros = 0
        """Stamps that are zero or negative."""
        self.ahead = 0
        """Stamps that most of those after them are lower than."""
        self.behind = 0
        """Stamps lower than one before that is not bad."""
        self.steps: list[ClockStep] = []
        self.first_log_time: int | None = None
        self._stamp = np.empty(0, np.int64)
        self._log_time = np.empty(0, np.int64)
        self._past = np.empty((0, 2), np.int64)
        self._latest = np.iinfo(np.int64).min

    @property
    def bad(self) -> int:
        """Messages whose stamps cannot be used."""
        return self.zeros + self.ahead + self.behind

    def add(self, stamp: Ints, log_time: Ints) -> Flags:
        """Take in the next stamps.

        Args:
            stamp: (n,) ns.
            log_time: (n,) ns.

        Returns:
            (m,) whether each of the oldest m messages without a decision so far can be used.
        """
        if self.first_log_time is None and len(log_time):
            self.first_log_time = int(log_time[0])
        self._stamp = np.concatenate([self._stamp, stamp])
        self._log_time = np.concatenate([self._log_time, log_time])
        if self._is_calm():
            return self._accept(max(len(self._stamp) - _HELD, 0))
        valid = np.flatnonzero(self._stamp > 0)
        if len(valid) == 0:
            return self._decide(len(self._stamp), at_end=False)
        return self._decide(int(valid[max(len(valid) - _HELD, 0)]), at_end=False)

    def finish(self) -> Flags:
        """End the log; return the decisions that are left."""
        if self._is_calm():
            return self._accept(len(self._stamp))
        return self._decide(len(self._stamp), at_end=True)

    def _is_calm(self) -> bool:
        """Whether the stamps that wait only rise, and never far at once: nearly always."""
        if len(self._stamp) == 0:
            return True
        stamp = np.concatenate([self._past[:, 0], self._stamp])
        if stamp[0] <= 0 or self._stamp[0] < self._latest:
            return False
        step = np.diff(stamp)
        rises = int(step.min(initial=0)) >= 0
        return rises and int(step.max(initial=0)) <= LARGEST_STEP_S * 1e9

    def _accept(self, count: int) -> Flags:
        """Accept the first `count` messages that wait."""
        self.messages += count
        if count:
            self._latest = int(self._stamp[count - 1])
            last = slice(max(count - NEIGHBOURS, 0), count)
            accepted = np.column_stack([self._stamp[last], self._log_time[last]])
            self._past = np.concatenate([self._past, accepted])[-NEIGHBOURS:]
            self._stamp, self._log_time = self._stamp[count:], self._log_time[count:]
        return np.ones(count, np.bool_)

    def _decide(self, count: int, *, at_end: bool) -> Flags:
        """Decide on the first `count` messages that wait."""
        valid = np.flatnonzero(self._stamp > 0)
        decided = int(np.searchsorted(valid, count))
        waiting = np.column_stack([self._stamp[valid], self._log_time[valid]])
        series, begin = np.concatenate([self._past, waiting]), len(self._past)
        bad = self._bad(series, begin, begin + decided, at_end=at_end)
        usable = np.zeros(count, np.bool_)
        usable[valid[:decided]] = ~bad
        self.messages += count
        self.zeros += count - decided
        self.ahead += int(bad.sum())
        self._past = series[begin + decided - min(begin + decided, NEIGHBOURS) : begin + decided]
        self._stamp, self._log_time = self._stamp[count:], self._log_time[count:]
        return usable

    def _bad(self, series: Ints, begin: int, end: int, *, at_end: bool) -> Flags:
        """Tell which rows from `begin` to `end` of a series of stamps and log times are ahead."""
        stamp = series[:, 0]
        back = np.flatnonzero(stamp[1:] < stamp[:-1])
        begins_anew = back[_stay_below(stamp, back)] + 1
        ahead = _ahead(stamp, back[~np.isin(back, begins_anew - 1)], begins_anew)
        forward = self._forward_steps(series, ahead, begins_anew)
        if at_end:
            late = forward > len(series) - FEWEST
            if late.any():
                ahead[forward[late][0] :] = True
            forward = forward[~late]
        self._note_steps(series, begin, end, distinct(np.concatenate([begins_anew, forward])))
        good = stamp[begin:end][~ahead[begin:end]]
        before = np.maximum.accumulate(np.concatenate([[self._latest], good]))
        self.behind += int((good < before[:-1]).sum())
        self._latest = int(before[-1])
        return ahead[begin:end]

    def _forward_steps(self, series: Ints, ahead: Flags, begins_anew: Ints) -> Ints:
        """Return the rows at which stamps step forward by far more than log time does."""
        good = np.flatnonzero(~ahead)
        stamp_step, log_step = np.diff(series[good], axis=0).T
        far = stamp_step - log_step > np.maximum(LARGEST_STEP_S * 1e9, 10.0 * log_step)
        rows, before = good[1:][far], good[:-1][far]
        after = np.minimum(rows[:, None] + np.arange(NEIGHBOURS), len(series) - 1)
        stays = series[after, 0].min(axis=1) - series[before, 0] > LARGEST_STEP_S * 1e9
        forward: Ints = rows[stays & ~np.isin(rows, begins_anew)]
        return forward

    def _note_steps(self, series: Ints, begin: int, end: int, rows: Ints) -> None:
        for row in rows[(rows >= max(begin, 1)) & (rows < end)].tolist():
            stamp_step, log_step = (series[row] - series[row - 1]).tolist()
            before, after = int(series[row - 1, 1]), int(series[row, 1])
            self.steps.append(ClockStep(before, after, stamp_step - log_step))


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


class StampFilter(Generic[Columns]):
    """Sets bad header stamps to zero in a stream of columns; holds back the last few rows.

    On log time the columns pass as they are, and stamps are only checked.
    """

    def __init__(self, topic: str, clock: TimeSource) -> None:
        self.check = StampCheck(topic)
        self._clock = clock
        self._held: list[Columns] = []

    def add(self, columns: Columns) -> Iterator[Columns]:
        """Take in rows; give those that are decided on."""
        if len(columns.log_time) == 0:
            return
        usable = self.check.add(_stamps(columns), columns.log_time)
        if self._clock is TimeSource.LOG:
            yield columns
            return
        self._held.append(columns)
        yield from self._release(usable)

    def finish(self) -> Iterator[Columns]:
        """End the log; give the rest."""
        yield from self._release(self.check.finish())

    def changed(self, change: Callable[[Columns], Columns]) -> Self:
        """Return a copy whose rows that are held back are changed."""
        other = copy(self)
        other.check = deepcopy(self.check)
        other._held = [change(each) for each in self._held]  # noqa: SLF001 - its own
        return other

    def _release(self, usable: Flags) -> Iterator[Columns]:
        waiting, self._held = self._held, []
        for columns in waiting:
            rows = len(columns.log_time)
            decided = usable[:rows]
            usable = usable[rows:]
            if len(decided):
                yield _without_bad_stamps(picked(columns, slice(len(decided))), decided)
            if len(decided) < rows:
                # A copy, so that the rest does not keep the whole batch alive.
                self._held.append(columns.pick(np.arange(len(decided), rows)))


def _stamps(columns: Any) -> Ints:  # noqa: ANN401 - any columns with header stamps
    stamp: Ints = columns.stamp
    return stamp


def _without_bad_stamps(columns: Columns, usable: Flags) -> Columns:
    if usable.all():
        return columns
    changed: Columns = replace(columns, stamp=np.where(usable, _stamps(columns), 0))
    return changed


def why_unusable(checks: Sequence[StampCheck]) -> str:
    """Say why header stamps cannot be the clock of the log; empty where they can.

    Args:
        checks: of all topics that are measured, at the end of the log.
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
