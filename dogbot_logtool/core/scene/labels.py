"""Labels beside the feet: their loads in newtons."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, norms
from dogbot_logtool.core.geometry.clock import first_at_each_tick
from dogbot_logtool.core.geometry.order_statistics import distinct
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.dataclass import dataclass

RATE_HZ: Final = 20.0
"""Labels a second: numbers that change faster cannot be read."""
_BELOW_M: Final = 0.1
"""m from the contact point down to the label, so that neither leg nor arrow hides it."""


@dataclass(frozen=True, slots=True)
class Labels:
    """Labels to draw or to remove, one row a written message."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    shown: Flags
    """(n,) whether to draw it; else the foot's label is removed."""
    position: Floats
    """(n, 3) m, world frame."""
    force: Floats
    """(n,) N, magnitude."""


def foot_labels(
    samples: Samples, arrows: Arrows, last_time: Mapping[int, int], down: AbstractSet[int]
) -> Labels:
    """Return labels for the arrows of samples, at most `RATE_HZ` for each foot.

    A label is removed at once when its foot leaves the ground.

    Args:
        samples: (n,).
        arrows: (n,) of the same samples.
        last_time: ns, log time of each foot's last sample before these.
        down: feet whose last sample before these was in contact.
    """
    chosen = [np.empty(0, np.int64)]
    for foot in distinct(arrows.foot).tolist():
        rows = np.flatnonzero(arrows.foot == foot)
        at_ticks = first_at_each_tick(arrows.log_time[rows], RATE_HZ, last_time.get(foot))
        was_down = np.concatenate([[foot in down], samples.in_contact[rows][:-1]])
        chosen.append(rows[at_ticks | (was_down & ~samples.in_contact[rows])])
    rows = np.concatenate(chosen)
    return Labels(
        foot=arrows.foot[rows],
        log_time=arrows.log_time[rows],
        stamp=arrows.stamp[rows],
        shown=arrows.shown[rows],
        position=arrows.position[rows] - np.array([0.0, 0.0, _BELOW_M]),
        force=norms(samples.force[rows]),
    )
