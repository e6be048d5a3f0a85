"""What is said of damage."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from dogbot_logtool.reader.containers.log import Channel, Log

_MOST: Final = 200
"""Losses told one by one; more are summed up."""


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


_LONGEST_NAME: Final = 200


def described_twice(what: str, chosen: str, other: str, offset: int) -> Loss:
    """Say that a log describes something in two ways.

    Args:
        what: a channel, schema or connection with its number.
        chosen: as what it is read.
        other: as what it is described as well.
        offset: byte in the file, of the chunk if that stands in one.
    """
    one, two = chosen[:_LONGEST_NAME], other[:_LONGEST_NAME]
    text = f"{what} is described in two ways: as {one} and, at byte {offset}, as {two}"
    return Loss(offset, f"{text}; the former was used")


def lost_messages(losses: Sequence[Loss]) -> int | None:
    """Return how many messages are known to be lost; None when it cannot be known."""
    known = [loss.messages for loss in losses if loss.messages is not None]
    return sum(known) if len(known) == len(losses) else None


def differing_counts(
    channels: Mapping[int, "Channel"], stated: Mapping[int, int], found: Mapping[int, int]
) -> str:
    """Return what to say of stated counts of messages that differ from those found.

    Args:
        channels: by id.
        stated: messages by channel id.
        found: likewise.

    Returns:
        "5 messages of /left, but 6 were found"; empty where all are right.
    """
    wrong = [
        number
        for number in sorted({*stated, *found})
        if stated.get(number, 0) != found.get(number, 0)
    ]
    if not wrong:
        return ""
    first = wrong[0]
    name = channels[first].topic[:_LONGEST_NAME] if first in channels else f"channel {first}"
    text = f"{stated.get(first, 0)} messages of {name}, but {found.get(first, 0)} were found"
    if len(wrong) > 1:
        text += f" ({len(wrong) - 1} more wrong)"
    return text


def wrong_statistics(log: "Log", found: Mapping[int, int], losses: Sequence[Loss]) -> list[Loss]:
    """Compare a log's counts with its messages, after all of them were read.

    Args:
        log: the log. Counts that stand in its chunks' indexes were compared chunk by chunk.
        found: messages by channel id.
        losses: messages that are known to be missing explain a difference.
    """
    compared = all(chunk.counts is not None for chunk in log.chunks)
    what = (
        ""
        if compared or lost_messages(losses) != 0
        else (differing_counts(log.channels, log.counts, found))
    )
    return [Loss(0, f"the log's statistics count {what}")] if what else []


class Losses:
    """Losses in the order in which they were found; told in few, however many there are."""

    def __init__(self) -> None:
        self._told: list[Loss] = []
        self._rest: Loss | None = None
        self._rest_count = 0

    def add(self, loss: Loss) -> None:
        """Take one more."""
        if len(self._told) < _MOST:
            self._told.append(loss)
            return
        self._rest_count += 1
        rest = self._rest or Loss(loss.offset, "")
        unknown = rest.messages is None or loss.messages is None
        self._rest = Loss(
            rest.offset,
            f"{self._rest_count} more places are damaged, the first at byte {rest.offset}",
            rest.bytes + loss.bytes,
            None if unknown else (rest.messages or 0) + (loss.messages or 0),
        )

    def told(self) -> tuple[Loss, ...]:
        """Return them all."""
        return (*self._told, self._rest) if self._rest else tuple(self._told)


def undecodable(
    channels: Mapping[int, "Channel"], malformed: Mapping[int, int], consequence: str = ""
) -> list[Loss]:
    """Return the loss of messages that could not be decoded.

    Args:
        channels: by id.
        malformed: number of such messages by channel id.
        consequence: what that means, to end the sentence with.
    """
    return [
        Loss(
            0,
            f"{count} messages of {channels[number].topic} could not be decoded{consequence}",
            0,
            count,
        )
        for number, count in sorted(malformed.items())
    ]
