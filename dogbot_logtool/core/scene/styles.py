"""The registry of arrow styles: what each needs of a log, how its arrows look, what computes them.

A style is one row here and a function in `arrows.py`. What computes arrows is imported late, so
that the command line can list the styles at once.
"""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final

from dogbot_logtool.dataclass import dataclass

if TYPE_CHECKING:
    from dogbot_logtool.core.scene.arrows import ArrowCounts, ArrowInput, Arrows

DEFAULT_STYLE: Final = "pressure"
LIFETIME_S: Final = 0.5
"""An arrow disappears after this silence of its sensor."""


@dataclass(frozen=True, slots=True)
class ArrowStyle:
    """One way to show contact samples as arrows."""

    name: str
    summary: str
    """Description of the arrows for ``--help``."""
    compute: Callable[["ArrowInput"], tuple["Arrows", "ArrowCounts"]]
    """Called for some samples of a foot, or for contact states of one type of messages."""
    needs_contact_states: bool = False
    """Arrows are made of the recorded contact states, not of contact samples."""
    needs_directions: bool = False
    """Arrows point along the force: link-frame forces are turned into the world frame, and contact
    normals are read for forces of which only the magnitude is known."""
    coloured_by_weight: bool = False
    """The colour is the force in body weights, where the mass is known."""
    lifetime_s: float = LIFETIME_S
    """0: for ever."""
    shaft_diameter_m: float | None = None
    """None: the robot's."""


def _classic(given: "ArrowInput") -> tuple["Arrows", "ArrowCounts"]:
    from dogbot_logtool.core.scene.arrows import (  # noqa: PLC0415
        ArrowCounts,
        classic_arrows,
        no_arrows,
    )

    if given.contacts is None:
        return no_arrows(), ArrowCounts()
    return classic_arrows(given.contacts)


def _pressure(given: "ArrowInput") -> tuple["Arrows", "ArrowCounts"]:
    from dogbot_logtool.core.scene.arrows import pressure_arrows  # noqa: PLC0415

    return pressure_arrows(given.samples, given.scale)


def _force(given: "ArrowInput") -> tuple["Arrows", "ArrowCounts"]:
    from dogbot_logtool.core.scene.arrows import force_arrows  # noqa: PLC0415

    return force_arrows(
        given.samples,
        force_in_world=given.force_in_world,
        body_weight_n=given.body_weight_n,
        scale=given.scale,
    )


_STYLES: Final = (
    ArrowStyle(
        name="classic",
        summary="as arrows_rviz.py drew them",
        compute=_classic,
        needs_contact_states=True,
        lifetime_s=0.0,
        shaft_diameter_m=0.1,
    ),
    ArrowStyle(name="pressure", summary="the load straight up", compute=_pressure),
    ArrowStyle(
        name="force",
        summary="the force itself",
        compute=_force,
        needs_directions=True,
        coloured_by_weight=True,
    ),
)
ARROW_STYLES: Final[Mapping[str, ArrowStyle]] = {style.name: style for style in _STYLES}
"""By name, in the order of ``--help``."""
