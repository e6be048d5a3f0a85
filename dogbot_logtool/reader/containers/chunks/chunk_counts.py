"""How many messages of each channel the chunks of a log hold, in little memory."""

from collections.abc import Mapping


class SharedCounts:
    """Stores equal counts once: chunks are much alike, and counts are a third of their memory."""

    def __init__(self) -> None:
        self._known: dict[tuple[tuple[int, int], ...], Mapping[int, int]] = {}

    def of(self, counts: Mapping[int, int]) -> Mapping[int, int]:
        """Return these counts, or equal ones that were asked for before."""
        return self._known.setdefault(tuple(sorted(counts.items())), counts)
