"""How hard each foot presses, for plots and for the gait diagram."""

from collections.abc import Iterable

import numpy as np

from dogbot_logtool.core.arrays import Flags, Floats, Ints, norms
from dogbot_logtool.core.hulls import NEAR_NS
from dogbot_logtool.core.quality.quality import steady_gap_ns
from dogbot_logtool.core.scene.feet import DrawnFoot, LoadState
from dogbot_logtool.dataclass import dataclass


@dataclass(frozen=True, slots=True)
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


def foot_loads(foot: DrawnFoot, rows: slice, weight_n: float | None, opening: int) -> Loads:
    """Return the loads of a foot's samples; the first also stands at the log's first time, if near.

    Args:
        foot: the foot.
        rows: of its samples.
        weight_n: N, the robot's; None: not known.
        opening: ns, log time.
    """
    chosen = np.arange(rows.start, rows.stop)
    samples = foot.samples.pick(chosen)
    log_time, stamp = samples.log_time, samples.time
    if rows.start == 0 < rows.stop and 0 < log_time[0] - opening <= NEAR_NS:
        chosen = np.concatenate([[0], chosen])
        log_time, stamp = (np.concatenate([[opening], each]) for each in (log_time, stamp))
    force = norms(foot.samples.force[chosen].astype(np.float64))
    return Loads(
        foot=np.full(len(chosen), foot.number),
        log_time=log_time,
        stamp=stamp,
        in_contact=foot.touching[chosen],
        state=foot.state[chosen].astype(np.int64),
        force=force,
        body_weights=force / (np.nan if weight_n is None else weight_n),
    )


def silences(feet: Iterable[DrawnFoot], opening: int, end: int) -> Loads:
    """Return rows for feet that fall silent, since viewers keep a value until the next one.

    Args:
        feet: all feet.
        opening: ns, the log's first time; a foot that is silent then is unknown from there on.
        end: ns, its last.

    Returns:
        by log time.
    """
    rows = sorted(row for foot in feet for row in _silences(foot, opening, end))
    log_time, stamp, number = np.array(rows, np.int64).reshape(-1, 3).T
    nothing = np.full(len(rows), np.nan)
    return Loads(
        foot=number,
        log_time=log_time,
        stamp=stamp,
        in_contact=np.zeros(len(rows), np.bool_),
        state=np.full(len(rows), LoadState.UNKNOWN, np.int64),
        force=nothing,
        body_weights=nothing,
    )


def _silences(foot: DrawnFoot, opening: int, end: int) -> list[tuple[int, int, int]]:
    """Return log time, stamp and foot of the rows that say that nothing is known of a foot."""
    log_time, stamp = foot.samples.log_time, foot.samples.time
    longest, due = steady_gap_ns(np.diff(log_time)), foot.due_ns
    silent = np.flatnonzero(foot.ends)
    # Messages that cannot be measured may go on, and say so themselves.
    following = np.append(log_time[1:], end)[silent]
    least = np.where(silent == len(log_time) - 1, longest, due)
    silent = silent[following - log_time[silent] > least]
    rows = [
        (int(log_time[row]) + due, int(stamp[row]) + due, foot.number) for row in silent.tolist()
    ]
    late = not len(log_time) or log_time[0] - opening > longest
    return [(opening, opening, foot.number), *rows] if late else rows
