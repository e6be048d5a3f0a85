"""Topics of a log by type, and what is said where an option names one that does not fit."""

import re
from collections.abc import Container, Iterable, Sequence
from collections.abc import Set as AbstractSet
from typing import Final

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.robot.topics.readable import why_unreadable

_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""
_KINDS_SHOWN: Final = 3
"""Types that are named all together."""


def recorded_topics(log: Log, types: AbstractSet[str]) -> list[str]:
    """Return the topics of some types, sorted, whether they can be decoded or not."""
    return sorted({c.topic for c in log.channels.values() if c.type_name in types})


def topics_of_type(log: Log, types: AbstractSet[str]) -> list[str]:
    """Return the topics of some types that can be decoded, sorted."""
    of_type = [channel for channel in log.channels.values() if channel.type_name in types]
    return sorted({channel.topic for channel in of_type if not why_unreadable(channel)})


def most_frequent(log: Log, topics: Iterable[str]) -> str:
    """Return the topic with the most messages; of several, the one with the shortest name."""
    counts = {
        topic: sum(log.counts.get(c.id, 0) for c in log.channels_by_topic.get(topic, ()))
        for topic in topics
    }
    return max(counts, key=lambda one: (counts[one], -len(one), one))


def split_topic(name: str, topics: Container[str]) -> tuple[str, str]:
    """Split ``/topic:field`` into the topic and what is named in its messages; empty: nothing is.

    Args:
        name: what the user wrote.
        topics: those of the log, whose names may have colons.
    """
    if name in topics:
        return name, ""
    colons = [match.start() for match in re.finditer(":", name)]
    known = (colon for colon in colons if name[:colon] in topics)
    colon = next(known, colons[0] if colons else len(name))
    return name[:colon], name[colon + 1 :]


def require_topic(
    log: Log, option: str, topic: str, wanted: AbstractSet[str], otherwise: str = ""
) -> None:
    """Check that the topic of an option is in the log, and of a type that can be used.

    Args:
        log: the log.
        option: the option, as sentences name it.
        topic: its topic.
        wanted: the types.
        otherwise: what can be done with a topic of another type.

    Raises:
        CallError: it is not; with the topics that could be meant.
        LogError: it is, but cannot be decoded.
    """
    channels = log.channels_by_topic.get(topic, ())
    types = {channel.type_name for channel in channels}
    where = f"{shown(log.source.path)}: {option}"
    if types & wanted:
        if not readable_channels(log, topic, wanted):
            reason = next(why_unreadable(c) for c in channels if c.type_name in wanted)
            raise LogError(f"{where}: {topic} cannot be read: {reason}")
        return
    usable = topics_of_type(log, wanted)
    if types:
        kinds = list(wanted)
        names = " or ".join(kinds) if len(kinds) <= _KINDS_SHOWN else f"one of {listed(kinds, 3)}"
        raise CallError(
            f"{where}: {topic} is of type {', '.join(sorted(types))}, not {names}. "
            f"Topics that can be used: {listed(usable) or 'none'}{otherwise and '. '}{otherwise}"
        )
    raise _no_such_topic(where, topic, usable)


def require_any_topic(log: Log, option: str, topic: str) -> None:
    """Check that the topic of an option is in the log.

    Raises:
        CallError: it is not; with the topics that could be meant.
    """
    if topic not in log.channels_by_topic:
        where = f"{shown(log.source.path)}: {option}"
        raise _no_such_topic(where, topic, sorted(log.channels_by_topic))


def _no_such_topic(where: str, topic: str, usable: Sequence[str]) -> CallError:
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    # The slash at the beginning is forgotten most often.
    close = [one for one in usable if one.strip("/") == topic.strip("/")]
    close = close or get_close_matches(topic, usable[:_COMPARED], n=3)
    meant = f"; did you mean {' or '.join(close)}?" if close else "."
    return CallError(
        f"{where}: the log has no topic {topic}{meant} Topics that can be used: "
        f"{listed(usable) or 'none'}"
    )


def readable_channels(log: Log, topic: str, types: AbstractSet[str]) -> list[Channel]:
    """Return the channels of a topic, of some types, that can be decoded."""
    return [
        channel
        for channel in log.channels_by_topic.get(topic, ())
        if channel.type_name in types and not why_unreadable(channel)
    ]
