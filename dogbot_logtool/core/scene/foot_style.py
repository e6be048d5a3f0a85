"""How feet are drawn: their colours, and their short names."""

from collections.abc import Sequence
from typing import Final

FOOT_COLOURS: Final = ("#0072b2", "#c28200", "#009e73", "#d55e00", "#c96fa0", "#3d97cf")
"""A colour a foot, in turn: those of Okabe and Ito, which colour-blind readers tell apart, three of
them darker, so that lines have a contrast of 3:1 on white and on a dark page."""


def foot_colour(row: int) -> str:
    """Return the colour of a foot by its index."""
    return FOOT_COLOURS[row % len(FOOT_COLOURS)]


def colour_parts(colour: str) -> tuple[float, float, float]:
    """Return red, green and blue in [0, 1] of a colour as ``#rrggbb``."""
    red, green, blue = (int(colour[first : first + 2], 16) / 255.0 for first in (1, 3, 5))
    return red, green, blue


def short_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return initials, ``FL`` for ``front_left``, that still tell the feet apart.

    A name of one word stays; where initials would be alike, all names stay.
    """
    short = tuple(_initials(name) for name in names)
    return short if len(set(short)) == len(short) else tuple(names)


def _initials(name: str) -> str:
    words = name.split("_")
    return "".join(word[:1].upper() for word in words) if len(words) > 1 else name
