"""How an accelerometer sits on the base, and in which unit it reads: told by gravity."""

from enum import StrEnum
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.load.loads import GRAVITY_MPS2
from dogbot_logtool.core.rotations import rotate
from dogbot_logtool.dataclass import dataclass

TOLERANCE: Final = 0.05
"""Share by which an accelerometer of g may read too much or too little."""
NO_GRAVITY: Final = 0.04
"""Share of g: a mean specific force below it has no gravity in it; one in g reads 0.1 of it."""
TILTED_RAD: Final = np.deg2rad(5.0)
"""A mounting that is less off is as good as mountings are."""
STEADY: Final = 0.1
"""Share of g: root mean square of means over strides that a mounting need not explain."""


class Reading(StrEnum):
    """The kind of readings of an accelerometer."""

    SOUND = "m/s^2"
    IN_G = "g"
    WITHOUT_GRAVITY = "without gravity"
    NOTHING = "nothing"
    OTHER_SCALE = "another scale"


@dataclass(frozen=True, slots=True)
class Mounting:
    """How an accelerometer sits on the base, as far as gravity tells."""

    reading: Reading | None
    """None: its readings do not follow the base's attitude, and nothing is told."""
    mean_mps2: float
    """Mean specific force, as recorded, along its own direction."""
    scale: float
    """Reading over expected value."""
    tilt_rad: float | None
    """Angle of its mean specific force against what is up for the base; None: not known."""
    turn: Floats
    """(4,) x, y, z, w: what levels it, in the base's frame. About the vertical gravity tells
    nothing."""

    @property
    def is_tilted(self) -> bool:
        """Whether it is turned against the frame that it is said to be in."""
        return self.tilt_rad is not None and self.tilt_rad > TILTED_RAD

    @property
    def roll_pitch_rad(self) -> tuple[float, float] | None:
        """How it is turned about the base's x and y axis; None: not known."""
        if self.tilt_rad is None:
            return None
        size = float(np.linalg.norm(self.turn[:3]))
        axis = self.turn[:3] / size if size > 0.0 else np.zeros(3)
        return float(axis[0] * self.tilt_rad), float(axis[1] * self.tilt_rad)

    def corrected(self, sensed: Floats) -> Floats:
        """Return readings, (n, 3) in the base's frame, levelled and in m/s^2.

        Gravity that is not in them is not put in.
        """
        level = rotate(self.turn[None, :], sensed)
        return level * GRAVITY_MPS2 if self.reading is Reading.IN_G else level


def find_mounting(sensed: Floats, expected: Floats) -> Mounting:
    """Find what turns and scales means over strides into those that are expected.

    Args:
        sensed: (n, 3) m/s^2, means over a stride, in the base's frame.
        expected: (n, 3) m/s^2, the same from attitude, gravity and poses.
    """
    mean, wanted = sensed.mean(axis=0), expected.mean(axis=0)
    size = float(np.linalg.norm(mean))
    scale = size / float(np.linalg.norm(wanted))
    straight = np.array([0.0, 0.0, 0.0, 1.0])
    if not sensed.any():
        return Mounting(Reading.NOTHING, size, scale, None, straight)
    if size < NO_GRAVITY * GRAVITY_MPS2:
        return Mounting(Reading.WITHOUT_GRAVITY, size, scale, None, straight)
    turn, angle = _between(mean, wanted)
    rest = rotate(turn[None, :], sensed) / scale - expected
    reading: Reading | None = _reading(scale)
    if float(np.sqrt((rest * rest).sum(axis=1).mean())) > STEADY * GRAVITY_MPS2:
        return Mounting(None, size, scale, None, straight)
    return Mounting(reading, size, scale, angle, turn)


def _reading(scale: float) -> Reading:
    if abs(scale - 1.0) <= TOLERANCE:
        return Reading.SOUND
    if abs(scale * GRAVITY_MPS2 - 1.0) <= TOLERANCE:
        return Reading.IN_G
    return Reading.OTHER_SCALE


def _between(first: Floats, second: Floats) -> tuple[Floats, float]:
    """Return the shortest rotation from one direction to another, x, y, z, w, and its angle."""
    one, other = (each / np.linalg.norm(each) for each in (first, second))
    axis = np.cross(one, other)
    sine, cosine = float(np.linalg.norm(axis)), float(one @ other)
    angle = float(np.arctan2(sine, cosine))
    if sine < 1e-9:
        # Any axis at a right angle will do.
        axis = np.cross(one, np.eye(3)[int(np.abs(one).argmin())])
        sine = float(np.linalg.norm(axis))
    turn = np.append(axis / sine * np.sin(angle / 2.0), np.cos(angle / 2.0))
    return turn, angle
