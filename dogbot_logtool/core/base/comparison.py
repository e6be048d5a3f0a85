"""Poses against a second witness of the same motion: the feet, or the twist beside them."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints, all_finite, median_of
from dogbot_logtool.core.base.poses import BaseHistory
from dogbot_logtool.core.base.witness import Motion, Witness, motion_in
from dogbot_logtool.core.rotations import along_heading

FEWEST_STRIDES: Final = 2
SHORTEST_WAY_M: Final = 0.2
"""m in all that a witness must tell, for a way to be compared."""
COHERENT: Final = 0.7
"""Coherence |sum a conj(b)| / sqrt(sum |a|^2 sum |b|^2) from which two ways are one."""
SWINGS: Final = 0.3
"""m a radian: a way that is shorter than a turn times this may be that of a point off the base."""


@dataclass(frozen=True, slots=True)
class Comparison:
    """The motion by poses against that by a witness, over whole strides that both tell of."""

    by: str
    """The witness."""
    way: Floats
    """(k, 2) m, ahead and to the left, by the poses; `told_way` by the witness."""
    told_way: Floats
    turn: Floats | None
    """(k,) rad, by the poses; None: the witness tells none; `told_turn` by the witness."""
    told_turn: Floats
    rise: Floats
    """(k,) m, by the poses; `told_rise` by the witness."""
    told_rise: Floats
    tells_heading: bool
    """Whether the witness tells directions."""

    @property
    def walked_m(self) -> tuple[float, float]:
        """How far the poses go and how far the witness does, m, stride by stride."""
        return tuple(float(np.hypot(*way.T).sum()) for way in (self.way, self.told_way))  # type: ignore[return-value]

    @property
    def is_telling(self) -> bool:
        """Whether the witness goes somewhere."""
        told = self.walked_m[1]
        turned = float(np.abs(self.told_turn).sum()) if self.turn is not None else 0.0
        return len(self.way) >= FEWEST_STRIDES and told > max(SHORTEST_WAY_M, SWINGS * turned)

    @property
    def scale(self) -> float | None:
        """How many times as far as the witness the poses go; None: it does not tell."""
        if not self.is_telling:
            return None
        walked, told = self.walked_m
        return self._common[0] if self._common[1] >= COHERENT else walked / told

    @property
    def direction_rad(self) -> float | None:
        """From the witness's way to that of the poses, to the left; None: it does not tell."""
        if not (self.is_telling and self.tells_heading and self._common[1] >= COHERENT):
            return None
        return self._common[2]

    @property
    def _common(self) -> tuple[float, float, float]:
        """Return the factor, the coherence and the angle between both ways."""
        one, other = (way[:, 0] + 1j * way[:, 1] for way in (self.way, self.told_way))
        squares, products = float((np.abs(other) ** 2).sum()), complex(np.vdot(other, one))
        if not squares or not products:
            return 0.0, 0.0, 0.0
        both = np.sqrt(squares * float((np.abs(one) ** 2).sum()))
        return abs(products) / squares, abs(products) / both, float(np.angle(products))


def compare(
    poses: BaseHistory, witness: Witness, windows: Ints, forward_rad: float
) -> Comparison | None:
    """Compare poses with what the feet tell; None: they have too few strides in common.

    Args:
        poses: recorded, without jumps.
        witness: the base's motion by the feet.
        windows: (k, 2) ns, strides.
        forward_rad: from the poses' heading to forward.
    """
    # Legs tell of the body's own axes, contact points of where fore and hind feet are.
    turned = forward_rad if witness.by == "legs" else 0.0
    return _compared(
        witness.by,
        motion_in(poses, windows, forward_rad),
        motion_in(witness.poses, windows, turned),
        tells_turn=witness.tells_turn,
        tells_heading=witness.tells_heading,
    )


def compare_twist(poses: BaseHistory, windows: Ints, forward_rad: float) -> Comparison | None:
    """Compare poses with the twist beside them; None: there is none, or too little of it.

    Sources give it in the world's or in the body's axes: those count that fit better.
    """
    velocity = poses.velocity
    if len(velocity) != len(poses.time) or not len(poses.time) or not velocity.any():
        return None
    velocity = np.where(all_finite(velocity)[:, None], velocity, 0.0)
    seconds = np.diff(poses.time)[:, None] / 1e9
    step = (velocity[1:] + velocity[:-1]) / 2.0 * seconds
    yaw = (poses.angles[1:, 2] + poses.angles[:-1, 2]) / 2.0
    in_body = np.stack(along_heading(step, -yaw), axis=1)
    found = []
    own = motion_in(poses, windows, forward_rad)
    for flat in (step[:, :2], in_body):
        position = np.zeros_like(poses.position)
        position[1:, :2] = np.cumsum(flat, axis=0)
        told = motion_in(replace(poses, position=position), windows, forward_rad)
        compared = _compared(
            "the twist beside them", own, told, tells_turn=False, tells_heading=True
        )
        if compared is not None:
            found.append(compared)
    return min(found, key=lambda each: abs(each.direction_rad or 0.0), default=None)


def _compared(
    by: str, own: Motion, told: Motion, *, tells_turn: bool, tells_heading: bool
) -> Comparison | None:
    both = own.known & told.known
    if both.sum() < FEWEST_STRIDES:
        return None
    return Comparison(
        by=by,
        way=own.way[both],
        told_way=told.way[both],
        turn=own.turn[both] if tells_turn else None,
        told_turn=told.turn[both],
        rise=own.rise[both],
        told_rise=told.rise[both],
        tells_heading=tells_heading,
    )


def usual_way_m(poses: BaseHistory, windows: Ints) -> float | None:
    """Return how far poses usually go in a stride, m; None: not known."""
    motion = motion_in(poses, windows)
    known = motion.way[motion.known]
    return float(median_of(np.hypot(*known.T))) if len(known) else None
