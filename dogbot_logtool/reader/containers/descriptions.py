"""What a log says of its channels, and where it says it in two ways.

Of records that describe one thing the first one holds. What stands in chunks comes before what
stands outside of them, since checksums vouch for it.
"""

from collections.abc import Callable, Iterable
from typing import Any, Final, NamedTuple

from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Loss

_MOST_BYTES: Final = 64 << 20
"""A log that describes its channels in more words is not honest."""
_MOST_RECORDS: Final = 1 << 17
"""All channels and schemas that an MCAP can have; more are not looked at."""


class Description(NamedTuple):
    """What a record says of a channel, a schema or a connection."""

    kind: str
    """``channel``, ``schema`` or ``connection``."""
    number: int
    name: str
    facts: Any
    """All that it says, as the container's own code decodes it."""


_Key = tuple[str, int]
"""Kind and number."""


class Descriptions:
    """The first description of each thing, in the order in which they were met."""

    def __init__(self, decode: Callable[[bytes], Description | None]) -> None:
        """Begin with none.

        Args:
            decode: returns what a record describes; None: it is malformed.
        """
        self.decode = decode
        self.first: dict[_Key, Description] = {}
        self._agreeing: set[int] = set()
        """Hashes of the records that were met: most are repeated as they are."""
        self._bytes = 0

    def of_kind(self, kind: str) -> list[Description]:
        """Return those of a kind."""
        return [each for each in self.first.values() if each.kind == kind]

    def compare(self, records: Iterable[bytes], offset: int, *, adding: bool) -> list[Loss]:
        """Return what to say of records that differ from the first ones, or are malformed.

        Args:
            records: whole.
            offset: byte in the file, of the chunk if they stand in one.
            adding: keep those that are the first of their kind and number.
        """
        losses: dict[_Key | None, Loss] = {}
        for record in records:
            digest = hash(record)
            if digest in self._agreeing or len(self._agreeing) > _MOST_RECORDS:
                continue
            found = self.decode(record)
            self._bytes += len(record) if adding else 0
            if found is None or self._bytes > _MOST_BYTES:
                what = f"a description of a channel at byte {offset} is damaged"
                losses.setdefault(None, Loss(offset, what))
                continue
            key = found.kind, found.number
            known = self.first.get(key, found)
            if adding:
                self.first[key] = known
            if known == found:
                self._agreeing.add(digest)
            else:
                losses.setdefault(key, _described_twice(known, found, offset))
        return list(losses.values())


def _described_twice(known: Description, other: Description, offset: int) -> Loss:
    """Say that a log describes something in two ways.

    Args:
        known: as what it is read.
        other: as what it is described as well.
        offset: byte in the file, of the chunk if that stands in one.
    """
    one, two = known.name[:LONGEST_NAME], other.name[:LONGEST_NAME]
    two = "another of that name" if one == two else two
    what = f"{known.kind} {known.number} is described in two ways: as {one} and, at byte {offset},"
    return Loss(offset, f"{what} as {two}; the former was used")
