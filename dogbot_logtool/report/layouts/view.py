"""What a view shows, in whatever viewer."""

from dataclasses import dataclass


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

    @property
    def heading_deg(self) -> float:
        """Where the robot looks if its base is not turned, from +x to the left."""
        return {"+x": 0.0, "+y": 90.0, "-x": 180.0, "-y": 270.0}[self.forward_axis]
