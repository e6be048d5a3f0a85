"""One foot of the walk, as it is drawn: its state at any log time, looked up.

What is drawn is what is measured. Each recorded sample has the state that contact detection gave
it; between samples the newest one counts, as a viewer that plays the log has it.
"""

from collections.abc import Sequence
from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, median_of
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import SILENCE_NS
from dogbot_logtool.core.stability import NEAR_NS

TRAIL: Final = 3
"""Touchdowns of each foot that are shown."""

FOOT_COLOURS: Final = ("#0072b2", "#c28200", "#009e73", "#d55e00", "#c96fa0", "#3d97cf")
"""A colour a foot, in turn: those of Okabe and Ito, which colour-blind readers tell apart, three of
them darker, so that lines have a contrast of 3:1 on white and on a dark page."""


def foot_colour(row: int) -> str:
    """Return the colour of a foot by its index."""
    return FOOT_COLOURS[row % len(FOOT_COLOURS)]


def colour_parts(colour: str) -> tuple[float, float, float]:
    """Return red, green and blue in [0, 1] of a colour as ``#rrggbb``."""
    red, green, blue = (int(colour[first : first + 2], 16) / 255.0 for first in (1, 3, 5))
    return red, green, blue


def short_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return initials, ``FL`` for ``front_left``, that still tell the feet apart.

    A name of one word stays; where initials would be alike, all names stay.
    """
    short = tuple(_initials(name) for name in names)
    return short if len(set(short)) == len(short) else tuple(names)


def _initials(name: str) -> str:
    words = name.split("_")
    return "".join(word[:1].upper() for word in words) if len(words) > 1 else name


class LoadState(IntEnum):
    """The state of knowledge of a foot."""

    STANCE = 0
    SWING = 1
    UNKNOWN = 2


class FootState(NamedTuple):
    """One foot at some times."""

    known: Flags
    """(n,) whether it is known if the foot is down."""
    down: Flags
    """(n,)."""
    point: Floats
    """(n, 3) m, contact point in the world; NaN where there is none."""
    vertical: Floats
    """(n,) N, vertical force; NaN where its direction is not known."""


class DrawnFoot(NamedTuple):
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

    def at(self, log_time: Ints) -> FootState:
        """Return what is known at some log times, ns, (n,)."""
        samples = self.samples
        if not len(samples.log_time):
            nowhere = np.full((len(log_time), 3), np.nan)
            never = np.zeros(len(log_time), np.bool_)
            return FootState(never, never, nowhere, nowhere[:, 0])
        log_time = self._begun(log_time)
        row = np.searchsorted(samples.log_time, log_time, side="right") - 1
        lasts = ~self.ends[row] | (log_time - samples.log_time[row] <= NEAR_NS)
        known = (row >= 0) & (self.state[row] != LoadState.UNKNOWN) & lasts
        placed = self.placed[row]
        near = (placed >= 0) & (log_time - samples.log_time[placed] <= NEAR_NS)
        force = samples.force[row].astype(np.float64)
        is_vertical = samples.in_world[row] | ~force.any(axis=1)
        return FootState(
            known,
            known & (self.state[row] == LoadState.STANCE),
            np.where(near[:, None], samples.position[placed], np.nan),
            np.where(is_vertical & self.has_force, force[:, 2], np.nan),
        )

    def trail_at(self, log_time: Ints) -> Floats:
        """Return the last footfalls up to some log times, ns, (n,).

        Returns:
            (n, TRAIL, 3) m, newest first; NaN where there were fewer.
        """
        log_time = self._begun(log_time)
        number = np.searchsorted(self.touchdown, log_time, side="right")[:, None]
        # Row -1 stands for those that there are not.
        last: Floats = self.footfall[np.maximum(number - np.arange(1, TRAIL + 1), -1)]
        return last

    def _begun(self, log_time: Ints) -> Ints:
        """Return log times with that of the first sample instead of those shortly before it."""
        first = int(self.samples.log_time[0]) if len(self.samples.log_time) else 0
        early = (log_time < first) & (first - log_time <= NEAR_NS)
        return np.where(early, first, log_time)


def drawn_foot(
    number: int,
    samples: Samples,
    record: FootHistory,
    *,
    contact_known: bool,
    has_force: bool,
) -> DrawnFoot:
    """Put what was measured of a foot beside its samples.

    Args:
        number: its index among the robot's feet.
        samples: (n,) of the recording that was measured, by log time.
        record: what was measured.
        contact_known: whether nothing refutes its contacts.
        has_force: whether its sensor tells a force.
    """
    track, count = record.track, len(samples.log_time)
    rows = np.arange(count, dtype=np.int32)
    state = np.full(count, LoadState.UNKNOWN, np.int8)
    if contact_known and len(track.row):
        # A sample whose time does not advance is measured with the one before it.
        last = np.searchsorted(track.row, rows, side="right") - 1
        known = (last >= 0) & (all_finite(samples.force) | (not record.has_force))
        known &= ~timespans.covers(record.stopped, track.time)[last]
        state[known] = np.where(record.down[last[known]], LoadState.STANCE, LoadState.SWING)
    # A silence follows the samples before a gap, and the last.
    ends = np.zeros(count, np.bool_)
    ends[-1:] = True
    silences = timespans.subtract(record.gaps, record.stopped)
    before = np.searchsorted(track.time, silences[:, 0], side="right") - 1
    ends[track.row[before[before >= 0]]] = True
    has_point = (samples.points > 0) & all_finite(samples.position)
    begins = track.row[np.searchsorted(track.time, record.stances.touchdown)]
    begins = begins[has_point[begins]]
    is_stance = state == LoadState.STANCE
    return DrawnFoot(
        number=number,
        samples=samples,
        state=state,
        touching=np.where(state == LoadState.UNKNOWN, samples.in_contact, is_stance),
        ends=ends,
        placed=np.maximum.accumulate(np.where(has_point, rows, -1)),
        touchdown=samples.log_time[begins],
        footfall=np.concatenate([samples.position[begins], np.full((1, 3), np.nan)]),
        due_ns=round(float(median_of(np.diff(track.log_time))))
        if len(track.log_time) > 1
        else SILENCE_NS,
        has_force=has_force,
    )
