"""One foot of the walk, as it is drawn: its state at any log time, looked up.

What is drawn is what is measured. Each recorded sample has the state that contact detection gave
it; between samples the newest one counts, as a viewer that plays the log has it.
"""

from enum import IntEnum
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import SILENCE_NS
from dogbot_logtool.core.hulls import NEAR_NS
from dogbot_logtool.dataclass import dataclass

TRAIL: Final = 3
"""Touchdowns of each foot that are shown."""


class LoadState(IntEnum):
    """The state of knowledge of a foot."""

    STANCE = 0
    SWING = 1
    UNKNOWN = 2


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


@dataclass(frozen=True, slots=True)
class DrawnFoot:
    """The n samples of one foot, by log time, as they were measured."""

    number: int
    """Its index among the robot's feet."""
    samples: Samples
    """Less the sensor's offset, in the world as far as frames are known; with swings inserted for
    a sensor that is silent in swing."""
    state: NDArray[np.int8]
    """(n,) a `LoadState`."""
    touching: Flags
    """(n,) whether the foot is in contact: as measured, or else as the sensor says."""
    ends: Flags
    """(n,) whether a silence follows in which nothing is known."""
    placed: Ints
    """(n,) the last sample with a contact point; -1: none yet."""
    touchdown: Ints
    """(k,) ns, log time of each touchdown that has a place."""
    footfall: Floats
    """(k + 1, 3) m, that place in the world; the last row, NaN, stands for none."""
    due_ns: int
    """ns after a sample at which the next one is due."""
    has_force: bool
    """Whether its sensor tells a force, not only contact."""
    force_in_world: bool
    """Whether all forces are in the world frame."""

    def at(self, log_time: Ints) -> FootState:
        """Return what is known at some log times, ns, (n,)."""
        samples = self.samples
        if not len(samples.log_time):
            nowhere = np.full((len(log_time), 3), np.nan)
            never = np.zeros(len(log_time), np.bool_)
            return FootState(never, never, nowhere, nowhere[:, 0])
        row = np.searchsorted(samples.log_time, log_time, side="right") - 1
        lasts = ~self.ends[row] | (log_time - samples.log_time[row] <= NEAR_NS)
        known = (row >= 0) & (self.state[row] != LoadState.UNKNOWN) & lasts
        placed = self.placed[row]
        near = (placed >= 0) & (log_time - samples.log_time[placed] <= NEAR_NS)
        return FootState(
            known,
            known & (self.state[row] == LoadState.STANCE),
            np.where(near[:, None], samples.position[placed], np.nan),
            self._vertical(row),
        )

    def trail_at(self, log_time: Ints) -> Floats:
        """Return the last footfalls up to some log times, ns, (n,).

        Returns:
            (n, TRAIL, 3) m, newest first; NaN where there were fewer.
        """
        number = np.searchsorted(self.touchdown, log_time, side="right")[:, None]
        # Row -1 stands for those that there are not.
        last: Floats = self.footfall[np.maximum(number - np.arange(1, TRAIL + 1), -1)]
        return last

    def between(self, start: int, end: int) -> slice:
        """Return the samples from a log time on and before another, ns."""
        first, behind = np.searchsorted(self.samples.log_time, [start, end]).tolist()
        return slice(first, behind)

    def _vertical(self, row: Ints) -> Floats:
        """(n,) N, of some samples; NaN where the direction is not known."""
        force = self.samples.force[row].astype(np.float64)
        known = self.samples.in_world[row] | self.force_in_world | ~force.any(axis=1)
        return np.where(known & self.has_force, force[:, 2], np.nan)


def drawn_foot(
    number: int,
    samples: Samples,
    record: FootHistory,
    *,
    contact_known: bool,
    has_force: bool,
    force_in_world: bool,
) -> DrawnFoot:
    """Put what was measured of a foot beside its samples.

    Args:
        number: its index among the robot's feet.
        samples: (n,) of the recording that was measured, by log time.
        record: what was measured.
        contact_known: whether nothing refutes its contacts.
        has_force: whether its sensor tells a force.
        force_in_world: whether all forces are in the world frame.
    """
    state = np.full(len(samples.log_time), LoadState.UNKNOWN, np.int8)
    if contact_known and len(record.track.row):
        state = _states(samples, record)
    known = state != LoadState.UNKNOWN
    rows = np.arange(len(state), dtype=np.int32)
    has_point = (samples.points > 0) & all_finite(samples.position)
    begins = record.track.row[np.searchsorted(record.track.time, record.stances.touchdown)]
    begins = begins[has_point[begins]]
    steps = np.diff(record.track.log_time)
    return DrawnFoot(
        number=number,
        samples=samples,
        state=state,
        touching=np.where(known, state == LoadState.STANCE, samples.in_contact),
        ends=_ends(len(state), record),
        placed=np.maximum.accumulate(np.where(has_point, rows, -1)),
        touchdown=samples.log_time[begins],
        footfall=np.concatenate([samples.position[begins], np.full((1, 3), np.nan)]),
        due_ns=round(float(median_of(steps))) if len(steps) else SILENCE_NS,
        has_force=has_force,
        force_in_world=force_in_world,
    )


def _states(samples: Samples, record: FootHistory) -> NDArray[np.int8]:
    """(n,) `LoadState` of samples, by contact detection.

    A sample whose time does not advance is measured with the one before it.
    """
    count = len(samples.log_time)
    state = np.full(count, LoadState.UNKNOWN, np.int8)
    last = np.searchsorted(record.track.row, np.arange(count), side="right") - 1
    told = (last >= 0) & (all_finite(samples.force) | (not record.has_force))
    told &= ~timespans.covers(record.stopped, record.track.time)[last]
    state[told] = np.where(record.down[last[told]], LoadState.STANCE, LoadState.SWING)
    return state


def _ends(count: int, record: FootHistory) -> Flags:
    """(n,) tell which samples a silence follows: those before a gap, and the last."""
    ends = np.zeros(count, np.bool_)
    ends[-1:] = True
    silences = timespans.subtract(record.gaps, record.stopped)
    last = np.searchsorted(record.track.time, silences[:, 0], side="right") - 1
    ends[record.track.row[last[last >= 0]]] = True
    return ends
