"""Gaits by their phases: what each foot's touchdown is in the cycle, and what the gait is called.

Phases are cycles after the first foot's touchdown, in the order of the robot's feet; of a
quadruped: front left, front right, back left, back right. Sources: Hildebrand 1965 and 1976;
for six legs Wilson 1966.
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np


@dataclass(frozen=True, slots=True)
class Gait:
    """Coordination of the feet."""

    name: str
    """The class that `stats` should give."""
    phases: tuple[float, ...]
    duty: float
    sequence: str | None = None

    def mirrored(self) -> "Gait":
        """Swap left and right: feet are listed left, right, left, right."""
        swapped = [self.phases[foot ^ 1] for foot in range(len(self.phases))]
        return replace(self, phases=tuple(swapped))

    def advanced(self, cycles: float) -> "Gait":
        """Let another moment of the cycle be its beginning."""
        return replace(self, phases=tuple((phase + cycles) % 1.0 for phase in self.phases))

    def support(self) -> tuple[float, ...]:
        """Return the parts of a stride in which 0, 1, 2 ... feet are down."""
        moments = np.arange(0.5, 10_000.0)[:, None] / 10_000.0
        down = ((moments - self.phases) % 1.0 < self.duty).sum(axis=1)
        return tuple(float((down == count).mean()) for count in range(len(self.phases) + 1))


def symmetrical(duty: float, diagonality: float) -> Gait:
    """Make a gait of Hildebrand's grid.

    Args:
        duty: share of the stride that each foot is down.
        diagonality: share of the stride by which a hind footfall precedes the fore one of its
            side: 0 pace, 0.25 lateral sequence, 0.5 trot, 0.75 diagonal sequence.
    """
    phases = (diagonality, diagonality + 0.5, 0.0, 0.5)
    name, sequence = "irregular", None
    nearest = round(diagonality * 4.0) % 4
    if abs(diagonality * 4.0 - round(diagonality * 4.0)) <= 0.4:
        name = ("pace", "walk", "trot", "walk")[nearest]
        sequence = (None, "lateral", None, "diagonal")[nearest]
    if name == "walk" and duty < 0.5:
        name = "amble"
    return Gait(name, tuple(phase % 1.0 for phase in phases), duty, sequence)


TROT: Final = Gait("trot", (0.0, 0.5, 0.5, 0.0), 0.6)
PACE: Final = Gait("pace", (0.0, 0.5, 0.0, 0.5), 0.6)
WALK: Final = Gait("walk", (0.0, 0.5, 0.75, 0.25), 0.75, "lateral")

PRONK: Final = Gait("pronk", (0.0, 0.0, 0.0, 0.0), 0.4)
BOUND: Final = Gait("bound", (0.5, 0.5, 0.0, 0.0), 0.4)
HALF_BOUND: Final = Gait("half-bound", (0.45, 0.6, 0.0, 0.0), 0.35)
TRANSVERSE_GALLOP: Final = Gait("gallop", (0.5, 0.65, 0.0, 0.15), 0.3, "transverse")
ROTARY_GALLOP: Final = Gait("gallop", (0.5, 0.65, 0.15, 0.0), 0.3, "rotary")
CANTER: Final = Gait("canter", (0.65, 0.33, 0.33, 0.0), 0.4)
ASYMMETRICAL: Final = (PRONK, BOUND, HALF_BOUND, TRANSVERSE_GALLOP, ROTARY_GALLOP, CANTER)

BIPED_WALK: Final = Gait("walk", (0.0, 0.5), 0.62)
BIPED_RUN: Final = Gait("run", (0.0, 0.5), 0.35)
BIPED_HOP: Final = Gait("hop", (0.0, 0.0), 0.4)

TRIPOD: Final = Gait("tripod", (0.0, 0.5, 0.5, 0.0, 0.0, 0.5), 0.6)
TETRAPOD: Final = Gait("tetrapod", (2 / 3, 0.0, 1 / 3, 2 / 3, 0.0, 1 / 3), 0.7)
WAVE: Final = Gait("wave", (2 / 6, 5 / 6, 1 / 6, 4 / 6, 0.0, 3 / 6), 0.85)
