"""The state of each foot and its last touchdown, from the messages up to then.

This looks back only: at any time, what counts is each foot's newest message up to then, by log
time, as a viewer that plays the log has it. What must be remembered of all earlier messages is a
few rows a foot, so it does not matter where batches end.

Contact is the Schmitt trigger of `contact_detection.py`. Touchdowns are debounced as there, but
only once that can be known: one becomes certain when the foot has stood for the debounce time.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contact_detection import contact_groups, schmitt
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples, no_samples
from dogbot_logtool.core.contact.silent_swing import LONGEST_SWING_S
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, all_finite, norms
from dogbot_logtool.core.geometry.blocks import concatenated, picked
from dogbot_logtool.core.geometry.clock import advancing
from dogbot_logtool.core.geometry.support_polygon import NEAR_NS
from dogbot_logtool.dataclass import dataclass

_TOUCH_N: Final = 1e12
"""Stands for the force of a contact that is told without one: above any threshold."""
TRAIL: Final = 3
"""Touchdowns of each foot that are remembered."""


@dataclass(frozen=True, slots=True)
class ContactSensor:
    """How the messages of a foot are to be understood."""

    rule: ContactRule
    swing_after_ns: int | None = None
    """ns of silence that mean swing, where the sensor is silent in swing; None: they mean that
    nothing is known."""
    works: bool = True
    """Whether it is known to report contacts. A sensor that never did may be dead: until the first
    one, nothing is known of the foot."""
    has_force: bool = True
    """Whether it tells a force, not only contact."""


@dataclass(frozen=True, slots=True)
class FootRows:
    """The samples of one foot, in the order of time."""

    time: Ints
    """(n,) ns, log time, strictly increasing."""
    message_time: Ints
    """(n,) ns, log time of the message; earlier than `time` where silence tells of swing."""
    down: Flags
    """(n,) whether the foot is in contact."""
    point: Floats
    """(n, 3) m, contact point in the world; NaN where there is none."""
    vertical: Floats
    """(n,) N, vertical force; NaN where its direction is not known."""

    def __len__(self) -> int:
        return len(self.time)

    def pick(self, rows: Ints) -> "FootRows":
        """Return copies of the chosen rows."""
        return picked(self, rows)

    def then(self, later: "FootRows") -> "FootRows":
        """Return these rows followed by later ones."""
        return concatenated([self, later])


@dataclass(frozen=True, slots=True)
class Touchdowns:
    """Touchdowns of one foot, oldest first."""

    since: Ints
    """(k,) ns, log time from which on it was known."""
    point: Floats
    """(k, 3) m, where it touched down, in the world."""


@dataclass(frozen=True, slots=True)
class FootMemory:
    """The state of a foot that its earlier messages leave."""

    rows: FootRows
    """The last touchdown, the lift-off after it, and the newest, as far as there are such."""
    touchdowns: Touchdowns
    """The last ones, at most `TRAIL`."""
    works: bool
    """Whether it ever reported a contact."""


def initial_memory() -> FootMemory:
    """Return the memory before a log's first message."""
    times, points = np.empty(0, np.int64), np.empty((0, 3))
    rows = FootRows(times, times, np.empty(0, np.bool_), points, np.empty(0))
    return FootMemory(rows, Touchdowns(times, points), works=False)


@dataclass(frozen=True, slots=True)
class FootState:
    """One foot at some times."""

    known: Flags
    """(n,) whether it is known if the foot is down."""
    down: Flags
    """(n,)."""
    point: Floats
    """(n, 3) m, contact point in the world; NaN where there is none."""
    vertical: Floats
    """(n,) N, vertical force; NaN where its direction is not known."""


class FootTracker:
    """The state of one foot through a batch of its messages."""

    def __init__(self, new: "_FiniteSamples", before: FootMemory, sensor: ContactSensor) -> None:
        """Take in the messages of this foot; see `follow_feet`."""
        self._sensor = sensor
        self._before = before
        self._rows = before.rows.then(_rows(new, before.rows, sensor))
        self._debounce_ns = round(sensor.rule.debounce_s * 1e9)
        fill_ns = round(sensor.rule.fill_s * 1e9)
        self._starts, self._ends = contact_groups(self._rows.time, self._rows.down, fill_ns)
        found = self._touchdowns(len(before.rows))
        self._trail = Touchdowns(
            np.concatenate([before.touchdowns.since, found.since]),
            np.concatenate([before.touchdowns.point, found.point]),
        )

    def memory(self) -> FootMemory:
        """Return what the next batch must know."""
        rows = self._rows
        kept = {*self._starts[-1:].tolist(), *self._ends[-1:].tolist(), len(rows) - 1}
        return FootMemory(
            rows.pick(np.array(sorted(row for row in kept if 0 <= row < len(rows)), np.int64)),
            Touchdowns(self._trail.since[-TRAIL:].copy(), self._trail.point[-TRAIL:].copy()),
            self._before.works or bool(rows.down.any()),
        )

    def at(self, time: Ints) -> FootState:
        """Return what was known at some log times, ns, (n,)."""
        rows = self._rows
        if not len(rows):
            nowhere = np.full((len(time), 3), np.nan)
            never = np.zeros(len(time), np.bool_)
            return FootState(never, never, nowhere, nowhere[:, 0])
        row = np.searchsorted(rows.time, time, side="right") - 1
        known, down = self._contact(row, time)
        return FootState(known, down, rows.point[row], rows.vertical[row])

    @property
    def has_force(self) -> bool:
        """Whether its sensor tells a force, not only contact."""
        return self._sensor.has_force

    def contact_at(self, time: Ints) -> tuple[Flags, Flags]:
        """Return whether it was known at some log times, ns, (n,), if the foot is down; and if."""
        if not len(self._rows):
            never = np.zeros(len(time), np.bool_)
            return never, never
        return self._contact(np.searchsorted(self._rows.time, time, side="right") - 1, time)

    def _contact(self, row: Ints, time: Ints) -> tuple[Flags, Flags]:
        """Return what `contact_at` does; `row` is the newest at each time, -1 without one."""
        rows, sensor = self._rows, self._sensor
        known = (row >= 0) & (not sensor.rule.unusable)
        silence = time - rows.message_time[row]
        down = rows.down[row]
        if sensor.swing_after_ns is None:
            known &= silence <= NEAR_NS
        else:
            known &= silence <= LONGEST_SWING_S * 1e9
            down &= silence < sensor.swing_after_ns
        if not (sensor.works or self._before.works):
            known &= (time >= rows.time[rows.down.argmax()]) & rows.down.any()
        return known, down & known

    def trail_at(self, time: Ints) -> Floats:
        """Return the last footfalls known at some log times.

        Args:
            time: (n,) ns.

        Returns:
            (n, TRAIL, 3) m, newest first; NaN where there were fewer.
        """
        known = np.searchsorted(self._trail.since, time, side="right")
        number = known[:, None] - np.arange(1, TRAIL + 1)
        # Row -1 stands for those that there are not.
        points: Floats = np.concatenate([self._trail.point, np.full((1, 3), np.nan)])
        last: Floats = points[np.maximum(number, -1)]
        return last

    def _touchdowns(self, first_new: int) -> Touchdowns:
        """Return the touchdowns that became certain in rows from `first_new` on.

        A stance is long enough at the first row after the debounce time that is in contact, or
        ends contact.
        """
        rows = self._rows
        decides = rows.down.copy()
        decides[1:] |= rows.down[:-1]
        deciding = np.flatnonzero(decides)
        certain = rows.time[self._starts] + self._debounce_ns
        place = np.searchsorted(rows.time[deciding], certain)
        confirming = np.concatenate([deciding, [len(rows)]])[place]
        point = rows.point[self._starts]
        chosen = (confirming >= first_new) & (confirming <= self._ends) & (confirming < len(rows))
        chosen &= all_finite(point)
        # A lift-off that silence told became known with the message that ended the silence.
        known = confirming[chosen]
        known += rows.message_time[known] < rows.time[known]
        return Touchdowns(rows.time[known], point[chosen])


def _rows(new: "_FiniteSamples", before: FootRows, sensor: ContactSensor) -> FootRows:
    """Return what new messages of a foot say."""
    usable = advancing(new.time, int(before.time[-1]) if len(before) else None)
    if not usable.all():
        new = picked(new, usable)
    down = np.zeros(len(new.time), np.bool_)
    rows, force = FootRows(new.time, new.time, down, new.point, new.vertical), new.force
    if sensor.swing_after_ns is not None:
        rows, force = _with_swings(rows, force, before, sensor.swing_after_ns)
    on = len(before) > 0 and bool(before.down[-1])
    if sensor.rule.by_flag:
        # Forces are 0 where the flag says that the foot is in the air.
        rows.down[:] = force > 0.0
    else:
        rows.down[:] = schmitt(force, sensor.rule, on=on)
    return rows


def _with_swings(
    rows: FootRows, force: Floats, before: FootRows, swing_after_ns: int
) -> tuple[FootRows, Floats]:
    """Insert a row without contact into each silence that tells of swing, where it begins to."""
    message_time = np.concatenate([before.message_time[-1:], rows.time])
    silent = np.flatnonzero(np.diff(message_time) >= swing_after_ns)
    place = silent + len(rows) - (len(message_time) - 1)
    lifted = message_time[silent] + swing_after_ns
    return FootRows(
        time=np.insert(rows.time, place, lifted),
        message_time=np.insert(rows.message_time, place, message_time[silent]),
        down=np.insert(rows.down, place, values=False),
        point=np.insert(rows.point, place, np.nan, axis=0),
        vertical=np.insert(rows.vertical, place, 0.0),
    ), np.insert(force, place, 0.0)


@dataclass(frozen=True, slots=True)
class _FiniteSamples:
    """Messages whose force is a finite number."""

    foot: Ints
    """(n,)."""
    time: Ints
    """(n,) ns, log time."""
    force: Floats
    """(n,) N, |F|."""
    point: Floats
    """(n, 3) m."""
    vertical: Floats
    """(n,) N; NaN where not known."""


def follow_feet(
    samples: Sequence[Samples],
    before: Sequence[FootMemory],
    sensors: Sequence[ContactSensor],
    *,
    force_in_world: bool,
) -> tuple[FootTracker, ...]:
    """Follow all feet through a batch.

    Args:
        samples: of any feet; each foot's in the order of the log. Those whose force is not finite,
            or that come no later than one before, are left out.
        before: what is known of each foot so far.
        sensors: how to understand each foot.
        force_in_world: whether all forces are in the world frame.
    """
    if not sensors:
        return ()
    forceless = [foot for foot, sensor in enumerate(sensors) if not sensor.has_force]
    told = _finite_samples(samples, forceless, force_in_world=force_in_world)
    return tuple(
        FootTracker(picked(told, np.flatnonzero(told.foot == foot)), memory, sensor)
        for foot, (memory, sensor) in enumerate(zip(before, sensors, strict=True))
    )


def _finite_samples(
    samples: Sequence[Samples], forceless: Sequence[int], *, force_in_world: bool
) -> _FiniteSamples:
    """Return the messages of all feet; where there are several sorts, in the order of the log."""
    together = concatenated(samples) if samples else no_samples()
    force = norms(together.force)
    known = together.in_world | force_in_world | (force == 0.0)
    if forceless:
        touch = np.isin(together.foot, forceless) & together.in_contact
        force, known = np.where(touch, _TOUCH_N, force), known & ~touch
    told = _FiniteSamples(
        together.foot,
        together.log_time,
        force,
        together.position,
        np.where(known, together.force[:, 2], np.nan),
    )
    if len(samples) > 1:
        told = picked(told, np.argsort(told.time, kind="stable"))
    finite = np.isfinite(told.force)
    return told if finite.all() else picked(told, finite)
