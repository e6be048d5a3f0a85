"""How hard each foot presses, for plots and for the gait diagram."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, norms

GRAVITY_MPS2: Final = 9.81
"""Standard in simulators (Gazebo's default world has 9.8)."""


@dataclass(frozen=True, slots=True)
class Loads:
    """The load on a foot at the time of each contact sample."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    in_contact: Flags
    """(n,)."""
    force: Floats
    """(n,) N, magnitude; not finite where the recording is not."""
    body_weights: Floats
    """(n,) the force over the robot's weight; NaN when its mass is unknown."""


def body_weight_n(mass_kg: float | None) -> float | None:
    """Return the weight of a robot, N, or None when its mass is unknown."""
    return None if mass_kg is None else mass_kg * GRAVITY_MPS2


def foot_loads(samples: Samples, weight_n: float | None) -> Loads:
    """Return the load of every sample."""
    force = norms(samples.force)
    return Loads(
        foot=samples.foot,
        log_time=samples.log_time,
        stamp=samples.time,
        in_contact=samples.in_contact,
        force=force,
        body_weights=force / (np.nan if weight_n is None else weight_n),
    )
