"""Lists of names in sentences: the first few, and how many more there are."""

from collections.abc import Sequence
from typing import Final

MOST: Final = 10


def listed(names: Sequence[str], most: int = MOST) -> str:
    """Return ``a, b, c and 4 more``."""
    more = f" and {len(names) - most:,} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
