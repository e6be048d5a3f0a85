"""Topics of a log by type, and what is said where an option names one that does not fit."""

from collections.abc import Callable, Iterable
from collections.abc import Set as AbstractSet
from difflib import get_close_matches
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.findings import Finding, warning
from dogbot_logtool.reader.log import Channel, Log
from dogbot_logtool.storage import shown

_LISTED: Final = 20
"""Topics that an error lists."""
_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""


def topics_of_type(log: Log, types: AbstractSet[str]) -> list[str]:
    """Return the topics of some types, sorted."""
    return sorted({c.topic for c in log.channels.values() if c.type_name in types})


def most_frequent(log: Log, topics: Iterable[str]) -> str:
    """Return the topic with the most messages; of several, the one with the shortest name."""
    counts = dict.fromkeys(topics, 0)
    for channel in log.channels.values():
        if channel.topic in counts:
            counts[channel.topic] += log.counts.get(channel.id, 0)
    return max(counts, key=lambda one: (counts[one], -len(one), one))


def require_topic(log: Log, option: str, topic: str, wanted: AbstractSet[str]) -> None:
    """Check that the topic of an option is in the log, and of a type that can be used.

    Raises:
        CallError: it is not; with the topics that could be meant.
    """
    types = {c.type_name for c in log.channels.values() if c.topic == topic}
    if types & wanted:
        return
    where = f"{shown(log.source.path)}: {option}"
    usable = topics_of_type(log, wanted)
    if types:
        names = " or ".join(wanted)
        raise CallError(f"{where}: {topic} is of type {', '.join(sorted(types))}, not {names}")
    # The slash at the beginning is forgotten most often.
    close = get_close_matches(topic, usable[:_COMPARED], n=3)
    close = [one for one in usable if one.strip("/") == topic.strip("/")] or close
    meant = f"; did you mean {' or '.join(close)}?" if close else "."
    raise CallError(
        f"{where}: the log has no topic {topic}{meant} Topics that can be used: {listed(usable)}"
    )


def listed(topics: Iterable[str]) -> str:
    """Return topics for a sentence: not all where there are many."""
    names = list(topics)
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more or "none"


def channels_of(log: Log, topic: str, types: AbstractSet[str]) -> list[Channel]:
    """Return the channels of a topic that are of some types."""
    return [c for c in log.channels.values() if c.topic == topic and c.type_name in types]


def readable(
    channels: Iterable[Channel], check: Callable[[Channel], object], findings: list[Finding]
) -> list[Channel]:
    """Return the channels whose definitions can be read; say which cannot."""
    found: list[Channel] = []
    for channel in channels:
        try:
            check(channel)
            found.append(channel)
        except DefinitionError as error:
            findings.append(warning("UNREADABLE", f"{error}; it is not used", channel.topic))
    return found
