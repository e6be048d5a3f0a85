"""The arrow styles: what each needs of a log, and how its arrows look.

``classic``   the markers of the live script `arrows_rviz.py`, bit for bit;
``pressure``  the same picture corrected: newest physics step, all states, straight up;
``force``     ground-reaction forces, along the force, coloured by body weights.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

LIFETIME_S: Final = 0.5
"""An arrow disappears after this silence of its sensor."""


@dataclass(frozen=True, slots=True)
class ArrowStyle:
    """One way to show contact samples as arrows."""

    name: str
    needs_contact_states: bool = False
    """Arrows are made of the recorded contact states, not of contact samples."""
    along_force: bool = False
    """Arrows point along the force, coloured by body weights where the mass is known: link-frame
    forces are turned into the world frame, and contact normals are read for forces of which only
    the magnitude is known."""
    lifetime_s: float = LIFETIME_S
    """0: for ever."""
    shaft_diameter_m: float | None = None
    """None: the robot's."""


ARROW_STYLES: Final[Mapping[str, ArrowStyle]] = {
    "classic": ArrowStyle(
        "classic",
        needs_contact_states=True,
        lifetime_s=0.0,
        shaft_diameter_m=0.1,
    ),
    "pressure": ArrowStyle("pressure"),
    "force": ArrowStyle("force", along_force=True),
}
"""By name."""
