"""Losses of a log: collected, and found by comparing counts of messages."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.containers.loss import LONGEST_NAME, Damage, Loss, lost_messages

_MOST: Final = 200
"""Losses kept one by one; more are summed up."""


def differing_counts(
    channels: Mapping[int, Channel], stated: Mapping[int, int], found: Mapping[int, int]
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
    name = channels[first].topic[:LONGEST_NAME] if first in channels else f"channel {first}"
    text = f"{stated.get(first, 0)} messages of {name}, but {found.get(first, 0)} were found"
    if len(wrong) > 1:
        text += f" ({len(wrong) - 1} more wrong)"
    return text


def wrong_statistics(log: Log, found: Mapping[int, int], losses: Sequence[Loss]) -> list[Loss]:
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


def damage_of(log: Log, losses: Iterable[Loss]) -> Damage:
    """Return what was lost of a log.

    Args:
        log: the log.
        losses: all that were found, in opening it and in reading it.
    """
    return Damage(shown(log.source.path), tuple(losses), log.start_time)


class Losses:
    """Losses in the order in which they were found; beyond a number, they are summed up."""

    def __init__(self) -> None:
        self._first: list[Loss] = []
        self._rest: Loss | None = None
        self._rest_count = 0

    def add(self, loss: Loss) -> None:
        """Take one more."""
        if len(self._first) < _MOST:
            self._first.append(loss)
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

    def all(self) -> tuple[Loss, ...]:
        """Return all losses."""
        return (*self._first, self._rest) if self._rest else tuple(self._first)


def malformed_messages(
    channels: Mapping[int, Channel], malformed: Mapping[int, int], consequence: str = ""
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
