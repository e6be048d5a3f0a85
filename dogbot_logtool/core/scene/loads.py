"""How hard each foot presses: for plots, for the gait diagram, and as labels in newtons."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Floats, Ints, all_finite, norms
from dogbot_logtool.core.corrections.clock import first_at_each_tick
from dogbot_logtool.core.quality import steady_gap_ns
from dogbot_logtool.core.scene.feet import DrawnFoot, LoadState
from dogbot_logtool.core.stability import NEAR_NS


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
        longest, due = steady_gap_ns(np.diff(log_time)), foot.due_ns
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
