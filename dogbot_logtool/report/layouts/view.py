"""What a view shows, in whatever viewer."""

from math import floor, log10
from typing import Final

from dogbot_logtool.dataclass import dataclass

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
    robot_name: str = ""
    """As in its description."""

    @property
    def heading_deg(self) -> float:
        """Where the robot looks if its base is not turned, from +x to the left."""
        return {"+x": 0.0, "+y": 90.0, "-x": 180.0, "-y": 270.0}[self.forward_axis]


def upper_bound(value: float) -> float:
    """Return a round number that is at least a positive one, and hardly more."""
    power = 10.0 ** floor(log10(value))
    return next(power * step for step in _STEPS if power * step >= value * (1.0 - 1e-9))
