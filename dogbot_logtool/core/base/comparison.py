"""Poses against a second witness of the same motion, over whole strides: feet, twist, gyroscope."""

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Complexes, Flags, Floats, Ints, all_finite
from dogbot_logtool.core.base.poses import BaseHistory

FEWEST_STRIDES: Final = 2
SHORTEST_PATH_M: Final = 0.2
"""m in all that a witness must tell, for a way to be compared."""
FAR_MORE: Final = 5.0
"""Times such a way that poses must go beside a witness that hardly moves."""
COHERENT: Final = 0.7
"""Coherence |sum a conj(b)| / sqrt(sum |a|^2 sum |b|^2) from which two ways are one."""
SWINGS: Final = 0.3
"""m a radian: a way that is shorter than a turn times this may be that of a point off the base."""


class Motion(NamedTuple):
    """How far a base moves in each of k windows; NaN where that is not known."""

    displacement: Complexes
    """(k,) m, ahead + i x to the left, along its own heading."""
    turn: Floats
    """(k,) rad."""
    rise: Floats
    """(k,) m."""

    @property
    def walked_m(self) -> float:
        """The sum of all distances, m."""
        return float(np.abs(self.displacement).sum())

    def pick(self, rows: Flags) -> "Motion":
        """Return the chosen windows."""
        return Motion(self.displacement[rows], self.turn[rows], self.rise[rows])


def stride_windows(strides: Ints, period_s: float) -> Ints:
    """Return spans, each as long as the usual stride, one after another while a robot walks.

    Args:
        strides: (s, 2) ns, merged spans with strides.
        period_s: s, the usual stride.
    """
    period = round(period_s * 1e9)
    starts = [
        np.arange(start, end - period + 1, period, dtype=np.int64)
        for start, end in strides.tolist()
    ]
    first = np.concatenate([np.empty(0, np.int64), *starts])
    return np.stack([first, first + period], axis=1)


def motion_in(base: BaseHistory, windows: Ints, forward_rad: float = 0.0) -> Motion:
    """Add up a base's steps in some windows.

    Args:
        base: poses.
        windows: (k, 2) ns.
        forward_rad: from the heading of its poses to forward.
    """
    if len(base.time) < 2:
        return turn_only(np.full(len(windows), np.nan))
    ahead, left, _ = base.steps(forward_rad)
    path = np.concatenate([[0.0], np.cumsum(ahead + 1j * left)])
    edges = windows - base.time[0]
    since = (base.time - base.time[0]).astype(np.float64)
    outside = (edges[:, 0] < 0) | (edges[:, 1] > since[-1])
    outside |= timespans.touches(base.gaps, windows[:, 0], windows[:, 1])
    columns = path, base.angles[:, 2], base.position[:, 2]
    changes = [np.diff(np.interp(edges, since, each))[:, 0] for each in columns]
    return Motion(*(np.where(outside, np.nan, each) for each in changes))


def turn_only(turn: Floats) -> Motion:
    """Return the motion by a witness that tells nothing but turns, (k,) rad."""
    unknown = np.full(len(turn), np.nan)
    return Motion(unknown + 0j, turn, unknown)


class Comparison(NamedTuple):
    """The motion by poses against that by a witness, over whole strides that both tell of."""

    by: str
    """The witness."""
    own: Motion
    """By the poses; `reference`, by the witness."""
    reference: Motion
    tells_turn: bool
    """Whether the witness tells turns, and not only the way; `tells_heading`, directions."""
    tells_heading: bool
    reach_m: float = SWINGS
    """How far from the base what tells of its motion may be."""

    @property
    def strides(self) -> int:
        """The strides that are compared."""
        return len(self.own.turn)

    @property
    def scale(self) -> float | None:
        """How many times as far as the witness the poses go; None: it does not tell."""
        factor, coherence, _ = likeness(self.own.displacement, self.reference.displacement)
        if not self._is_telling:
            return None
        return factor if coherence >= COHERENT else self.own.walked_m / self.reference.walked_m

    @property
    def direction_rad(self) -> float | None:
        """From the witness's way to that of the poses, to the left; None: it does not tell."""
        _, coherence, angle = likeness(self.own.displacement, self.reference.displacement)
        return angle if self._is_telling and self.tells_heading and coherence >= COHERENT else None

    @property
    def _is_telling(self) -> bool:
        """Whether the witness goes somewhere, or the poses do by far."""
        turned = float(np.abs(self.reference.turn).sum()) if self.tells_turn else 0.0
        walked_m = max(self.reference.walked_m, self.own.walked_m / FAR_MORE)
        return self.reference.walked_m > 0.0 and walked_m > max(
            SHORTEST_PATH_M, self.reach_m * turned
        )


def likeness(own: Complexes, reference: Complexes) -> tuple[float, float, float]:
    """Compare horizontal vectors, x + iy, with what they should be.

    Returns:
        How many times as long they are, the coherence, and by which angle they are turned, rad.
    """
    squares, product = float(np.vdot(reference, reference).real), complex(np.vdot(reference, own))
    if not squares or not product:
        return 0.0, 0.0, 0.0
    both = np.sqrt(squares * float(np.vdot(own, own).real))
    return abs(product) / squares, abs(product) / both, float(np.angle(product))


def compare(
    by: str,
    own: Motion,
    reference: Motion,
    *,
    tells_turn: bool,
    tells_heading: bool,
    reach_m: float = SWINGS,
) -> Comparison | None:
    """Compare the motion by poses with that by a witness; None: too few strides in common."""
    both = np.isfinite(own.turn) & np.isfinite(reference.turn)
    if both.sum() < FEWEST_STRIDES:
        return None
    return Comparison(by, own.pick(both), reference.pick(both), tells_turn, tells_heading, reach_m)


def compare_twist(poses: BaseHistory, windows: Ints, forward_rad: float) -> Comparison | None:
    """Compare poses with the twist beside them; None: there is none, or too little of it.

    Sources give it in the world's or in the body's axes: those count that fit better.
    """
    velocity = poses.velocity
    if len(velocity) != len(poses.time) or not velocity.any():
        return None
    velocity = np.where(all_finite(velocity)[:, None], velocity, 0.0)
    step = (velocity[1:] + velocity[:-1]) / 2.0 * (np.diff(poses.time)[:, None] / 1e9)
    flat = step[:, 0] + 1j * step[:, 1]
    heading = (poses.angles[1:, 2] + poses.angles[:-1, 2]) / 2.0
    own = motion_in(poses, windows, forward_rad)
    found = []
    for path in (flat, flat * np.exp(1j * heading)):
        at = np.concatenate([[0.0], np.cumsum(path)])
        position = np.stack([at.real, at.imag, np.zeros(len(at))], axis=1)
        reference = motion_in(replace(poses, position=position), windows, forward_rad)
        found.append(
            compare("the twist beside them", own, reference, tells_turn=False, tells_heading=True)
        )
    known = [each for each in found if each is not None]
    return min(known, key=lambda each: abs(each.direction_rad or 0.0), default=None)
