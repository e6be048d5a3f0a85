"""The weight of a robot."""

from typing import Final

GRAVITY_MPS2: Final = 9.81
"""Standard in simulators (Gazebo's default world has 9.8)."""


def body_weight_n(mass_kg: float | None) -> float | None:
    """Return the weight of a robot, N, or None when its mass is unknown."""
    return None if mass_kg is None else mass_kg * GRAVITY_MPS2
