"""When is a foot on the ground? Contact detection and debouncing on a stream of samples.

Contact is a Schmitt trigger on |F|: on from one threshold, off below a lower one, or as soon as
the sensor itself says that nothing touches (a message without states). Unless a lower threshold
is set, only the sensor's word ends a contact: a walking foot may carry next to nothing for a
tenth of a second and yet stay where it is, and bumpers are silent in swing. Then swings
shorter than the debounce time are filled (a foot that bounces at touchdown), and after that
stances shorter than it are dropped (a foot that brushes the ground). Two thresholds and minimum
durations are practice in biomechanics (Kinetics Toolkit, `detect_cycles`) and in state estimation
for legged robots (pronto's stance estimator).

A swing that is long enough is never filled, so it separates what lies before it from what lies
after it for good. That is what makes streaming exact: samples are kept only back to the
touchdown of the stance that is not yet decided.
"""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.stance_curves import AXES, PARTS, mean_forces
from dogbot_logtool.core.contact.stance_samples import StanceSamples
from dogbot_logtool.core.contact.stances import LONGEST_STANCE_S, StanceFigures, reduce_stances
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, dots
from dogbot_logtool.core.geometry.blocks import concatenated, picked
from dogbot_logtool.core.geometry.clock import SILENCE_NS
from dogbot_logtool.dataclass import dataclass

LONGEST_RISE_S: Final = 0.1
"""s: a touchdown is dated back by no more."""


@dataclass(frozen=True, slots=True)
class FootSignal:
    """Usable samples of one foot, with what is computed of each."""

    time: Ints
    """(n,) ns, strictly increasing."""
    force: Floats
    """(n,) N, |F|."""
    vertical: Floats
    """(n,) N, vertical force; 0 without contact, NaN where its direction is not known."""
    horizontal: Floats
    """(n, 2) N, along the world's x and y; NaN like `vertical`."""
    point: Floats
    """(n, 3) m, contact point in the world; NaN where there is none."""
    single: Flags
    """(n,) whether `point` is one contact point, not the mean of several."""
    friction: Floats
    """(n,) tangential over normal force; NaN where not known, or below the contact threshold."""
    contact: Flags
    """(n,) state of the Schmitt trigger."""
    silent_before: Flags
    """(n,) nothing was known just before: the log's first sample, or one after a silence."""

    def __len__(self) -> int:
        return len(self.time)

    def rows(self, start: int, stop: int | None = None) -> "FootSignal":
        """Return a run of rows."""
        return picked(self, slice(start, stop))

    def then(self, later: "FootSignal") -> "FootSignal":
        """Return these rows followed by later ones."""
        return concatenated([self, later])


def foot_signal(
    samples: Samples,
    time: Ints,
    force: Floats,
    rule: ContactRule,
    *,
    force_in_world: bool,
    previous: FootSignal | None,
) -> FootSignal:
    """Compute the signal of samples that have a finite force.

    Args:
        samples: (n) samples of one foot.
        time: (n,) ns, strictly increasing.
        force: (n,) N, |F|.
        rule: thresholds.
        force_in_world: whether the wrenches are in the world frame.
        previous: the last row before these, None at the log's start.
    """
    known = samples.in_world | force_in_world | (force == 0.0)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        normal = dots(samples.force, samples.normal)
        tangential = np.sqrt(np.maximum(force * force - normal * normal, 0.0))
        friction = np.where(known & (force >= rule.on_n), tangential / np.abs(normal), np.nan)
    before = np.diff(time, prepend=time[:1] if previous is None else previous.time)
    silent_before = before > SILENCE_NS
    if previous is None:
        silent_before[:1] = True
    return FootSignal(
        time=time,
        force=force,
        vertical=np.where(known, samples.force[:, 2], np.nan),
        horizontal=np.where(known[:, None], samples.force[:, :2], np.nan),
        point=np.where(np.isfinite(samples.position), samples.position, np.nan),
        single=samples.points == 1,
        friction=friction,
        contact=contact_states(
            samples, force, rule, on=previous is not None and bool(previous.contact[0])
        ),
        silent_before=silent_before,
    )


def contact_states(samples: Samples, force: Floats, rule: ContactRule, *, on: bool) -> Flags:
    """Tell which samples are in contact, by the messages' flags or by the force.

    Args:
        samples: n samples of one foot.
        force: (n,) N, |F|.
        rule: what decides.
        on: the state before these samples.

    Returns:
        (n,) bool.
    """
    return samples.in_contact.copy() if rule.by_flag else schmitt(force, rule, on=on)


def schmitt(force: Floats, rule: ContactRule, *, on: bool) -> Flags:
    """Trigger with two thresholds: between them, the state stays what it was.

    Args:
        force: (n,) N.
        rule: thresholds.
        on: the state before these samples.

    Returns:
        (n,) bool.
    """
    loaded = force >= rule.on_n
    says = loaded | (force < rule.off_n) | (force == 0.0)
    last = np.maximum.accumulate(np.where(says, np.arange(len(force)), -1))
    state: Flags = np.where(last >= 0, loaded[last], on)
    return state


def rising_since(signal: FootSignal, rule: ContactRule) -> Ints:
    """(n,) the row at which the force last rose above the off threshold, for every row.

    A rise lasts `LONGEST_RISE_S` at most and does not reach over a silence.
    """
    rows = np.arange(len(signal))
    low = (signal.force < rule.off_n) | (signal.force == 0.0)
    after_low = np.maximum.accumulate(np.where(low, rows + 1, 0))
    after_silence = np.maximum.accumulate(np.where(signal.silent_before, rows, 0))
    earliest = np.searchsorted(signal.time, signal.time - round(LONGEST_RISE_S * 1e9))
    since: Ints = np.maximum(np.maximum(after_low, after_silence), earliest)
    return since


def backdated(signal: FootSignal, rule: ContactRule) -> FootSignal:
    """Date touchdowns back to where the force rose above the off threshold."""
    begins = np.flatnonzero(signal.contact & ~np.concatenate([[True], signal.contact[:-1]]))
    if not rule.backdates or not len(begins):
        return signal
    since = np.minimum(rising_since(signal, rule)[begins], begins)
    change = np.zeros(len(signal) + 1, np.int64)
    np.add.at(change, since, 1)
    np.add.at(change, begins, -1)
    return replace(signal, contact=signal.contact | (np.cumsum(change[:-1]) > 0))


def contact_groups(
    time: Ints, contact: Flags, fill_ns: int, silent_before: Flags | None = None
) -> tuple[Ints, Ints]:
    """Join the runs of contact over short swings.

    Args:
        time: (n,) ns, strictly increasing.
        contact: (n,) state of the Schmitt trigger.
        fill_ns: shorter swings are short.
        silent_before: (n,) nothing was known just before: a swing that begins so is not short.

    Returns:
        first row in contact, and first row after it, of each; the number of rows where contact
        lasts to the last row.
    """
    padded = np.concatenate([[False], contact, [False]])
    edges = np.flatnonzero(padded[1:] != padded[:-1])
    starts, ends = edges[::2], edges[1::2]
    filled = time[starts[1:]] - time[ends[:-1]] < fill_ns
    if silent_before is not None:
        filled &= ~silent_before[ends[:-1]]
    first = np.concatenate([[True], ~filled])[: len(starts)]
    last = np.concatenate([~filled, [True]])[: len(starts)]
    return starts[first], ends[last]


@dataclass(frozen=True, slots=True)
class DecidedStances:
    """Stances after debouncing, in order."""

    touchdown: Ints
    """(n,) ns, the first sample in contact."""
    liftoff: Ints
    """(n,) ns, the first sample after it that is not; the last sample where the log ends in it."""
    figures: Floats
    """(n, k) in the order of `StanceFigures`; NaN where a stance is too long to be a step's."""
    forces: Floats
    """(n, AXES * PARTS) N, see `mean_forces`; NaN like `figures`."""


def _no_stances() -> DecidedStances:
    times = np.empty(0, np.int64)
    figures, forces = np.empty((0, len(StanceFigures._fields))), np.empty((0, AXES * PARTS))
    return DecidedStances(times, times, figures, forces)


class StanceFinder:
    """Finds stances in a stream of `FootSignal`, each as soon as it is decided."""

    def __init__(self, rule: ContactRule) -> None:
        self._rule = rule
        self._debounce_ns = round(rule.debounce_s * 1e9)
        self._fill_ns = round(rule.fill_s * 1e9)
        self._open: FootSignal | None = None
        self._standing_since: int | None = None
        self.filled_swings = 0
        self.dropped_stances = 0

    @property
    def last(self) -> FootSignal | None:
        """The last row so far."""
        return None if self._open is None else self._open.rows(-1)

    def add(self, signal: FootSignal) -> DecidedStances:
        """Take in more rows; return the stances that no later row can change."""
        if len(signal) == 0:
            return _no_stances()
        signal = signal if self._open is None else self._open.then(signal)
        signal = backdated(signal, self._rule)
        starts, ends = self._groups(signal)
        undecided = len(starts) > 0 and not self._is_over(signal, int(ends[-1]))
        settled = len(starts) - undecided
        found = self._stances(signal, starts[:settled], ends[:settled])
        if undecided:
            self._open = self._kept_of_open(signal, int(starts[-1]))
        else:
            self._open = signal.rows(max(self._settled(signal) - 1, 0))
        return found

    def finish(self) -> DecidedStances:
        """End the log: what is open stays as it is."""
        if self._open is None:
            return _no_stances()
        starts, ends = self._groups(self._open)
        if not len(starts) or self._is_over(self._open, int(ends[-1])):
            return _no_stances()
        return self._stances(self._open, starts, ends, may_be_brief=True)

    def _groups(self, signal: FootSignal) -> tuple[Ints, Ints]:
        return contact_groups(signal.time, signal.contact, self._fill_ns, signal.silent_before)

    def _is_over(self, signal: FootSignal, end: int) -> bool:
        """Tell whether the swing that begins at a row can no longer be filled."""
        if end == len(signal):
            return False
        swing = int(signal.time[max(self._settled(signal) - 1, end)] - signal.time[end])
        return swing >= self._fill_ns or bool(signal.silent_before[end])

    def _settled(self, signal: FootSignal) -> int:
        """Return the number of rows whose contact no later row can change."""
        if not self._rule.backdates or signal.contact[-1]:
            return len(signal)
        return int(min(rising_since(signal, self._rule)[-1], len(signal)))

    def _stances(
        self, signal: FootSignal, starts: Ints, ends: Ints, *, may_be_brief: bool = False
    ) -> DecidedStances:
        """Drop the groups that are too short, reduce the others."""
        if not len(starts):
            return _no_stances()
        self.filled_swings += _runs(signal.contact[: ends[-1]]) - len(starts)
        # Where the log ends in a stance, its last sample ends it.
        ends = np.minimum(ends, len(signal) - 1)
        touchdown, liftoff = signal.time[starts], signal.time[ends]
        stood = self._standing_since is not None and starts[0] == 0
        if self._standing_since is not None and stood:
            touchdown[0], self._standing_since = self._standing_since, None
        if not may_be_brief:
            brief = _loaded_ns(signal, starts, ends) < self._debounce_ns
            brief &= ~signal.silent_before[starts]
            brief[0] &= not stood
            self.dropped_stances += int(brief.sum())
            starts, ends, touchdown, liftoff = (
                rows[~brief] for rows in (starts, ends, touchdown, liftoff)
            )
        duration = liftoff - touchdown
        steps = (duration > 0) & (duration <= LONGEST_STANCE_S * 1e9)
        figures = np.full((len(starts), len(StanceFigures._fields)), np.nan)
        forces = np.full((len(starts), AXES * PARTS), np.nan)
        if steps.any():
            samples = _stance_samples(signal, starts[steps], ends[steps])
            figures[steps] = np.stack(reduce_stances(samples), axis=1)
            forces[steps] = mean_forces(samples)
        return DecidedStances(touchdown, liftoff, figures, forces)

    def _kept_of_open(self, signal: FootSignal, start: int) -> FootSignal:
        """Keep the open stance and the row before it; of one that never ends, only its tail."""
        since = int(signal.time[start])
        if self._standing_since is not None and start == 0:
            since = self._standing_since
        if signal.time[-1] - since <= LONGEST_STANCE_S * 1e9:
            return signal.rows(max(start - 1, 0))
        self._standing_since = since
        tail = int(np.flatnonzero(signal.contact)[-1])
        self.filled_swings += _rises(signal.contact[start : tail + 1])
        return signal.rows(tail)


def _loaded_ns(signal: FootSignal, starts: Ints, ends: Ints) -> Ints:
    """(k,) ns in contact between some rows, without the swings that were filled.

    A single sample stands for no more than the interval before it: the next may be lost.
    """
    step = np.diff(signal.time)
    total = np.concatenate([[0], np.cumsum(step * signal.contact[:-1])])
    loaded: Ints = total[ends] - total[starts]
    before = np.where(starts > 0, step[np.maximum(starts - 1, 0)], loaded)
    return np.where(ends - starts == 1, np.minimum(loaded, before), loaded)


def _rises(contact: Flags) -> int:
    """Number of times that contact comes back."""
    return int((contact[1:] & ~contact[:-1]).sum())


def _runs(contact: Flags) -> int:
    """Number of runs of contact."""
    return _rises(contact) + int(contact[0])


def _stance_samples(signal: FootSignal, starts: Ints, ends: Ints) -> StanceSamples:
    """Lay stances end to end.

    Args:
        signal: samples of a foot.
        starts: (k,) rows of touchdowns.
        ends: (k,) rows that end the stances.
    """
    counts = ends - starts + 2
    behind = np.cumsum(counts)
    stance = np.repeat(np.arange(len(starts)), counts)
    rows = np.arange(len(stance)) + (ends + 1 - behind)[stance]
    np.maximum(rows, 0, out=rows)
    touchdown = behind - counts + 1
    return StanceSamples(
        first=touchdown - (starts > 0),
        touchdown=touchdown,
        end=behind - 1,
        stance=stance,
        time=(signal.time[rows] - signal.time[starts][stance]) / 1e9,
        force=signal.force[rows],
        vertical=signal.vertical[rows],
        force_x=signal.horizontal[rows, 0],
        force_y=signal.horizontal[rows, 1],
        x=signal.point[rows, 0],
        y=signal.point[rows, 1],
        single=signal.single[rows],
        friction=signal.friction[rows],
    )
