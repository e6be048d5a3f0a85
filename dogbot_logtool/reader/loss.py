"""What is said of damage."""

from collections.abc import Sequence
from dataclasses import dataclass


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


def lost_messages(losses: Sequence[Loss]) -> int | None:
    """Return how many messages are known to be lost; None when it cannot be known."""
    known = [loss.messages for loss in losses if loss.messages is not None]
    return sum(known) if len(known) == len(losses) else None
