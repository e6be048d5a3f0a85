"""Losses of a log: found by comparing counts of messages, and those of messages."""

from collections.abc import Iterable, Mapping, Sequence

from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.contents import Channel
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.containers.loss import Damage, Loss, differing_counts, lost_messages


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
