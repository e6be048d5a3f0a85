"""Which topics of a log can be decoded, and what users should know of those that cannot."""

import re
from collections.abc import Collection, Container, Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.messages import SERIALISATIONS, check_channel
from dogbot_logtool.reader.messages.source import base_source, base_type
from dogbot_logtool.reader.messages.transforms import FOXGLOVE_TYPES, TRANSFORM_TYPES

_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""
_MOST_REASONS: Final = 3
_NOT_USED: Final = "; not used"
_ALWAYS_USED: Final = frozenset((ODOMETRY_TYPE, *TRANSFORM_TYPES))
"""Types that cannot be about anything else, like those of feet: what they would tell is missed."""


def why_unreadable(channel: Channel) -> str:
    """Return why the messages of a channel cannot be decoded; empty if they can be."""
    try:
        source = source_of(channel)
        if source is None and base_type(channel.type_name):
            source = base_source(channel)
        if source is not None:
            check_channel(channel, source.fields)
    except DefinitionError as reason:
        return str(reason)
    return ""


def topics_of_type(log: Log, types: AbstractSet[str]) -> list[str]:
    """Return the topics of some types that can be decoded, sorted."""
    of_type = [channel for channel in log.channels.values() if channel.type_name in types]
    return sorted({channel.topic for channel in of_type if not why_unreadable(channel)})


def message_count(log: Log, topic: str) -> int:
    """Return how many messages of a topic the index counts."""
    return sum(log.counts.get(channel.id, 0) for channel in log.channels_by_topic.get(topic, ()))


def most_frequent(log: Log, topics: Iterable[str]) -> str:
    """Return the topic with the most messages; of several, the one with the shortest name."""
    return max(topics, key=lambda topic: (message_count(log, topic), -len(topic), topic))


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
    log: Log, option: str, topic: str, types: AbstractSet[str] | None, otherwise: str = ""
) -> None:
    """Check that the topic of an option is in the log, and of a type that can be used.

    Args:
        log: the log.
        option: the option, as sentences name it.
        topic: its topic.
        types: None: any will do.
        otherwise: what can be done with a topic of another type.

    Raises:
        CallError: it is not; with the topics that could be meant.
        LogError: it is, but cannot be decoded.
    """
    channels = log.channels_by_topic.get(topic, ())
    fitting = [channel for channel in channels if types is None or channel.type_name in types]
    where = f"{shown(log.source.path)}: {option}"
    reasons = [why_unreadable(channel) for channel in fitting] if types is not None else []
    if fitting:
        if reasons and all(reasons):
            raise LogError(f"{where}: {topic} cannot be read: {reasons[0]}")
        return
    usable = sorted(log.channels_by_topic) if types is None else topics_of_type(log, types)
    can_be_used = f"Topics that can be used: {listed(usable) or 'none'}"
    if channels:
        found = ", ".join(sorted({channel.type_name for channel in channels}))
        raise CallError(
            f"{where}: {topic} is of type {found}, which does not fit. {can_be_used}"
            f"{otherwise and '. '}{otherwise}"
        )
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    # The slash at the beginning is forgotten most often.
    close = [one for one in usable if one.strip("/") == topic.strip("/")]
    close = close or get_close_matches(topic, usable[:_COMPARED], n=3)
    meant = f"; did you mean {' or '.join(close)}?" if close else "."
    raise CallError(f"{where}: the log has no topic {topic}{meant} {can_be_used}")


def unreadable_findings(
    log: Log, odometry: Sequence[Channel], contacts: Sequence[Channel]
) -> Iterator[Finding]:
    """Say which topics of types that could be used cannot be decoded, once for every reason.

    It is an error where no odometry, or no foot, is left.

    Args:
        log: the log.
        odometry: channels that are used.
        contacts: channels that are used.
    """
    lost: dict[tuple[bool, str], set[str]] = {}
    for channel in log.channels.values():
        source = source_of(channel)
        if channel.type_name not in _ALWAYS_USED and source is None:
            continue
        if reason := why_unreadable(channel):
            # Messages that can be about anything need not be about feet.
            is_error = source is not None and not source.anything and not contacts
            if channel.type_name == ODOMETRY_TYPE:
                is_error = not odometry
            lost.setdefault((is_error, reason), set()).add(channel.topic)
    for (is_error, reason), topics in sorted(lost.items()):
        yield _about(topics, reason + _NOT_USED, () if is_error else ("one_topic",))
    others = {c.topic: c.message_encoding for c in log.channels.values() if not _is_read(c)}
    if others and not (contacts or lost):
        many, all_topics = len(others), len(log.channels_by_topic)
        what = f"{many:,} of {all_topics:,} topics" if all_topics > 1 else "its topic"
        text = (
            f"{what} {'is' if many == 1 else 'are'} encoded as "
            f"{listed(sorted({encoding or 'nothing' for encoding in others.values()}))}; only "
            "ROS 1 messages, CDR and Foxglove's poses, transforms and joints are read"
        )
        yield Finding("UNREADABLE", text, cases=("not_needed",))


def _is_read(channel: Channel) -> bool:
    if channel.message_encoding in SERIALISATIONS or channel.type_name in FOXGLOVE_TYPES:
        return True
    return bool(base_type(channel.type_name)) and not why_unreadable(channel)


def own_definition_findings(used: Iterable[Channel]) -> Iterator[Finding]:
    """Say for which of the used channels this program's definition stands in for the log's."""
    found: dict[str, set[str]] = {}
    for channel in used:
        for find in (source_of, base_source):
            try:
                source = find(channel)
                because = check_channel(channel, source.fields) if source else ""
            except DefinitionError:
                # It is used for something else: a robot's state may have a base and no feet.
                continue
            if because:
                found.setdefault(because, set()).add(channel.topic)
    for because, topics in sorted(found.items()):
        text = f"{because}; the one that comes with dogbot-logtool is used"
        yield _about(topics, text, ("own_definition",))


def _about(topics: Collection[str], text: str, cases: tuple[str, ...]) -> Finding:
    named = sorted(topics)
    where = named[0] if len(named) == 1 else ""
    return Finding("UNREADABLE", f"{listed(named)}: {text}", where, cases=cases)


def reasons(findings: Iterable[Finding]) -> str:
    """Return why topics that could have been used cannot be read; empty: there are none."""
    texts = [
        each.text.removesuffix(_NOT_USED)
        for each in findings
        if each.code == "UNREADABLE" and "own_definition" not in each.cases
    ]
    more = f"; and {len(texts) - _MOST_REASONS} more" if len(texts) > _MOST_REASONS else ""
    return "; ".join(texts[:_MOST_REASONS]) + more
