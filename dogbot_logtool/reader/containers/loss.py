"""Damage in a log."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.dataclass import dataclass

LONGEST_NAME: Final = 200
"""Characters of a name from the log that a sentence repeats."""


@dataclass(frozen=True, slots=True)
class Loss:
    """Damage that was found: what could not be read, and where."""

    offset: int
    """Byte in the file."""
    what: str
    """A sentence without the file's name."""
    bytes: int = 0
    """Bytes of the file that gave nothing."""
    messages: int | None = 0
    """Messages known to be lost; None when their number is not known."""


def described_twice(what: str, chosen: str, other: str, offset: int) -> Loss:
    """Say that a log describes something in two ways.

    Args:
        what: a channel, schema or connection with its number.
        chosen: as what it is read.
        other: as what it is described as well.
        offset: byte in the file, of the chunk if that stands in one.
    """
    one, two = chosen[:LONGEST_NAME], other[:LONGEST_NAME]
    text = f"{what} is described in two ways: as {one} and, at byte {offset}, as {two}"
    return Loss(offset, f"{text}; the former was used")


def lost_messages(losses: Sequence[Loss]) -> int | None:
    """Return how many messages are known to be lost; None when it cannot be known."""
    known = [loss.messages for loss in losses if loss.messages is not None]
    return sum(known) if len(known) == len(losses) else None
