"""Content of a view, for any viewer."""

from math import floor, log10
from typing import Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.reader.containers.loss import SOUND, Damage

_ASIDE_DEG: Final = 75.0
"""The camera looks at the robot's front from this much to its right: nearer to the front, a
quadruped's right fore leg hides the left hind one, which stands with it in a trot."""
_STEPS: Final = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


@dataclass(frozen=True, slots=True)
class View:
    """The robot whose annotated log is shown."""

    feet: tuple[str, ...]
    world_frame: str
    """The frame in which the ground is."""
    base_frame: str
    """The frame to follow."""
    forward_axis: str = "+x"
    """The body axis that points forward."""
    peak_n: float | None = None
    """N, upper bound of the load curves; None: not known."""
    size_m: float = 0.6
    """m, length of the body."""
    turned_deg: float = 0.0
    """Yaw of the base in the world at the log's start."""
    has_stamps: bool = True
    """Whether header stamps tell when a transform holds."""
    damage: Damage = SOUND
    """What could not be read of the log that was looked at."""

    @property
    def camera_deg(self) -> float:
        """Direction of the camera from the base, from its +x to the left: 0 to 360."""
        heading = {"+x": 0.0, "+y": 90.0, "-x": 180.0, "-y": 270.0}[self.forward_axis]
        return (heading - _ASIDE_DEG) % 360.0

    @property
    def camera_in_world_deg(self) -> float:
        """Direction of the camera from the base, from the world's +x to the left: 0 to 360."""
        return (self.camera_deg + self.turned_deg) % 360.0


def upper_bound(value: float) -> float:
    """Return a round number that is at least a positive one, and hardly more."""
    power = 10.0 ** floor(log10(value))
    return next(power * step for step in _STEPS if power * step >= value * (1.0 - 1e-9))
