"""One foot of the walk, as it is drawn: its state at any log time, its loads, labels in newtons.

What is drawn is what is measured. Each recorded sample has the state that contact detection gave
it; between samples the newest one counts, as a viewer that plays the log has it.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, median_of, norms
from dogbot_logtool.core.clock import SILENCE_NS, first_at_each_tick
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.quality import steady_gap_ns
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
        has_force=has_force,
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Loads:
    """The load on a foot at the time of each contact sample."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    in_contact: Flags
    """(n,) as measured; where contact is not known, as the sensor says."""
    state: Ints
    """(n,) a `LoadState`, by contact detection."""
    force: Floats
    """(n,) N, magnitude; not finite where the recording is not."""
    body_weights: Floats
    """(n,) the force over the robot's weight; NaN when its mass is unknown."""


def foot_loads(foot: DrawnFoot, rows: slice, weight_n: float | None) -> Loads:
    """Return the loads of a foot's samples.

    Args:
        foot: the foot.
        rows: of its samples.
        weight_n: N, the robot's; None: not known.
    """
    samples = foot.samples.pick(np.arange(rows.start, rows.stop))
    force = norms(samples.force.astype(np.float64))
    return Loads(
        foot=np.full(len(force), foot.number),
        log_time=samples.log_time,
        stamp=samples.time,
        in_contact=foot.touching[rows],
        state=foot.state[rows].astype(np.int64),
        force=force,
        body_weights=force / (np.nan if weight_n is None else weight_n),
    )


def opening_load(foot: DrawnFoot, weight_n: float | None, opening: int) -> Loads:
    """Return the first load of a foot at the log's first time, ns, if it follows at once."""
    log_time = foot.samples.log_time
    near = len(log_time) > 0 and 0 < log_time[0] - opening <= NEAR_NS
    loads = foot_loads(foot, slice(0, int(near)), weight_n)
    time = np.full(len(loads.foot), opening)
    return replace(loads, log_time=time, stamp=time)


def silences(feet: Iterable[DrawnFoot], opening: int, end: int) -> Loads:
    """Return rows for feet that fall silent, since viewers keep a value until the next one.

    Args:
        feet: all feet.
        opening: ns, the log's first time; a foot that is silent then is unknown from there on.
        end: ns, its last.

    Returns:
        by log time.
    """
    rows: list[tuple[int, int, int]] = []
    for foot in feet:
        log_time, stamp = foot.samples.log_time, foot.samples.time
        steps = np.diff(log_time)
        longest, due = steady_gap_ns(steps), round(median_of(steps)) if len(steps) else SILENCE_NS
        if not len(log_time) or log_time[0] - opening > longest:
            rows.append((opening, opening, foot.number))
        silent = np.flatnonzero(foot.ends)
        # Messages that cannot be measured may go on, and say so themselves.
        lasts = np.append(log_time[1:], end)[silent] - log_time[silent]
        silent = silent[lasts > np.where(silent == len(log_time) - 1, longest, due)]
        times = zip((log_time[silent] + due).tolist(), (stamp[silent] + due).tolist(), strict=True)
        rows += [(*each, foot.number) for each in times]
    log_time, stamp, number = np.array(sorted(rows), np.int64).reshape(-1, 3).T
    state = np.full(len(rows), LoadState.UNKNOWN, np.int64)
    nothing = np.full(len(rows), np.nan)
    return Loads(number, log_time, stamp, nothing > 0.0, state, nothing, nothing)


RATE_HZ: Final = 20.0
"""Labels a second: numbers that change faster cannot be read."""
_BELOW_M: Final = 0.1
"""m from the contact point down to the label, so that neither leg nor arrow hides it."""
_LABEL_WIDTH: Final = 6
"""Characters of the number and its unit."""
_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Labels:
    """Labels to draw or to remove, one row a written message."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    visible: Flags
    """(n,) whether to draw it; else the foot's label is removed."""
    position: Floats
    """(n, 3) m, world frame."""
    text: NDArray[np.bytes_]
    """(n,) the force and its unit, padded with spaces; empty where it is removed."""


def foot_labels(foot: DrawnFoot, rows: slice) -> Labels:
    """Return labels of a foot's samples, at most `RATE_HZ`.

    A label is removed at once when its foot leaves the ground.

    Args:
        foot: the foot.
        rows: of its samples; the one before them tells whether a tick or a swing begins.
    """
    first = max(rows.start - 1, 0)
    touching = foot.touching[first : rows.stop]
    chosen = first_at_each_tick(foot.samples.log_time[first : rows.stop], RATE_HZ)
    chosen[1:] |= touching[:-1] & ~touching[1:]
    row = first + np.flatnonzero(chosen)
    row = row[row >= rows.start]
    samples = foot.samples.pick(row)
    force = norms(samples.force.astype(np.float64))
    visible = foot.touching[row] & (samples.points > 0) & (force > 0.0)
    visible &= np.isfinite(force) & all_finite(samples.position)
    position = samples.position - np.array([0.0, 0.0, _BELOW_M])
    number = np.full(len(row), foot.number)
    text = np.full(len(row), b"", f"S{_LABEL_WIDTH}")
    text[visible] = [
        (_BEYOND if each > _LARGEST_N else f"{each:.0f} N").center(_LABEL_WIDTH).encode()
        for each in force[visible].tolist()
    ]
    return Labels(number, samples.log_time, samples.time, visible, position, text)
