"""Robots that walk in closed form: masses, and feet around the base."""

from dataclasses import dataclass
from typing import Final

GRAVITY_MPS2: Final = 9.81


@dataclass(frozen=True, slots=True)
class Robot:
    """A robot whose base moves along its +x."""

    name: str
    feet: tuple[str, ...]
    corners_m: tuple[tuple[float, float], ...]
    """Forward and left of each foot in mid-stance, from the base."""
    mass_kg: float = 20.0
    height_m: float = 0.45
    """Of the base over the ground, while it walks."""

    @property
    def weight_n(self) -> float:
        """Body weight."""
        return self.mass_kg * GRAVITY_MPS2

    def topic(self, foot: int) -> str:
        """Return the contact topic of a foot."""
        return f"/{self.name}/{self.feet[foot]}/contact"

    @property
    def odometry_topic(self) -> str:
        """Topic of the base's poses."""
        return f"/{self.name}/odom"


def quadruped(mass_kg: float = 20.0) -> Robot:
    """Make a four-legged robot, its legs as long as its mass suggests (20 kg: 0.45 m)."""
    size = (mass_kg / 20.0) ** (1.0 / 3.0)
    x, y = 0.3 * size, 0.15 * size
    names = ("front_left", "front_right", "back_left", "back_right")
    return Robot("quad", names, ((x, y), (x, -y), (-x, y), (-x, -y)), mass_kg, 0.45 * size)


def biped(mass_kg: float = 60.0) -> Robot:
    """Make a two-legged robot."""
    return Robot("duo", ("left", "right"), ((0.0, 0.1), (0.0, -0.1)), mass_kg, 0.85)


def hexapod(mass_kg: float = 2.0) -> Robot:
    """Make a six-legged robot."""
    rows = (("front", 0.15), ("middle", 0.0), ("back", -0.15))
    sides = (("left", 0.12), ("right", -0.12))
    names = tuple(f"{row}_{side}" for row, _ in rows for side, _ in sides)
    corners = tuple((x, y) for _, x in rows for _, y in sides)
    return Robot("hexa", names, corners, mass_kg, 0.12)


def spider(mass_kg: float = 4.0) -> Robot:
    """Return a robot of eight legs, numbered from front to back on each side."""
    rows = range(4)
    names = tuple(f"{side}_leg_{row + 1}" for row in rows for side in ("left", "right"))
    corners = tuple((0.2 - 0.13 * row, side * 0.15) for row in rows for side in (1, -1))
    return Robot("spider", names, corners, mass_kg, 0.15)
