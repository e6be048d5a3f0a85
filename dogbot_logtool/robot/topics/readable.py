"""Which channels of a log can be decoded, and what users should know of those that cannot."""

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Final

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.reader.containers.log import Channel
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.messages import SERIALISATIONS, check_channel
from dogbot_logtool.reader.messages.source import base_source, base_type
from dogbot_logtool.reader.messages.transforms import FOXGLOVE_TYPES, TRANSFORM_TYPES

_MOST_REASONS: Final = 3
_NOT_USED: Final = "; not used"
_ALWAYS_USED: Final = frozenset((ODOMETRY_TYPE, *TRANSFORM_TYPES))
"""Types that cannot be about anything else, like those of feet: what they would tell is missed."""


def why_unreadable(channel: Channel) -> str:
    """Return why the messages of a channel cannot be decoded; empty if they can be."""
    try:
        _check(channel)
    except DefinitionError as reason:
        return str(reason)
    return ""


def _check(channel: Channel) -> str:
    source = source_of(channel)
    if source is None and base_type(channel.type_name):
        source = base_source(channel)
    return check_channel(channel, source.fields) if source else ""


def unreadable_findings(
    channels: Iterable[Channel], odometry: Collection[Channel], contacts: Collection[Channel]
) -> Iterator[Finding]:
    """Say which topics of types that could be used cannot be decoded, once for every reason.

    It is an error where no odometry, or no foot, is left.

    Args:
        channels: all of a log.
        odometry: those that are used.
        contacts: those that are used.
    """
    lost: dict[tuple[bool, str], set[str]] = {}
    for channel in channels:
        used = channel.type_name in _ALWAYS_USED or source_of(channel) is not None
        if used and (reason := why_unreadable(channel)):
            key = _is_lost(channel, odometry, contacts), reason
            lost.setdefault(key, set()).add(channel.topic)
    for (is_error, reason), topics in sorted(lost.items()):
        yield _about(topics, reason + _NOT_USED, () if is_error else ("one_topic",))


def _is_lost(
    channel: Channel, odometry: Collection[Channel], contacts: Collection[Channel]
) -> bool:
    """Tell whether what a channel's messages would tell is not known from any other."""
    if channel.type_name == ODOMETRY_TYPE:
        return not odometry
    source = source_of(channel)
    # Messages that can be about anything need not be about feet.
    return source is not None and not source.anything and not contacts


def own_definition_findings(used: Iterable[Channel]) -> Iterator[Finding]:
    """Say for which of the used channels this program's definition stands in for the log's."""
    found: dict[str, set[str]] = {}
    for channel in used:
        if because := _own_definition_because(channel):
            found.setdefault(because, set()).add(channel.topic)
    for because, topics in sorted(found.items()):
        text = f"{because}; the one that comes with dogbot-logtool is used"
        yield _about(topics, text, ("own_definition",))


def _own_definition_because(channel: Channel) -> str:
    """Return why this program's definition is used for a channel; empty: the log's is."""
    for find in (source_of, base_source):
        try:
            if source := find(channel):
                return check_channel(channel, source.fields)
        except DefinitionError:
            # It is used for something else: a robot's state may have a base and no feet.
            continue
    return ""


def _about(topics: Collection[str], text: str, cases: tuple[str, ...]) -> Finding:
    named = sorted(topics)
    where = named[0] if len(named) == 1 else ""
    return Finding("UNREADABLE", f"{listed(named)}: {text}", where, cases=cases)


def other_encodings(channels: Mapping[int, Channel]) -> str:
    """Return a sentence on the topics that are in no encoding that is read; empty: none are."""
    others = {c.topic: c.message_encoding for c in channels.values() if not _is_read(c)}
    if not others:
        return ""
    topics = {channel.topic for channel in channels.values()}
    many = f"{len(others):,} of {len(topics):,} topics" if len(topics) > 1 else "its topic"
    return (
        f"{many} {'is' if len(others) == 1 else 'are'} encoded as "
        f"{listed(sorted({encoding or 'nothing' for encoding in others.values()}))}; only ROS 1 "
        "messages, CDR and Foxglove's poses, transforms and joints are read"
    )


def _is_read(channel: Channel) -> bool:
    if channel.message_encoding in SERIALISATIONS or channel.type_name in FOXGLOVE_TYPES:
        return True
    return bool(base_type(channel.type_name)) and not why_unreadable(channel)


def reasons(findings: Iterable[Finding]) -> str:
    """Return why topics that could have been used cannot be read; empty: there are none."""
    found = [
        each
        for each in findings
        if each.code == "UNREADABLE" and "own_definition" not in each.cases
    ]
    texts = [each.text.removesuffix(_NOT_USED) for each in found]
    more = f"; and {len(texts) - _MOST_REASONS} more" if len(texts) > _MOST_REASONS else ""
    return "; ".join(texts[:_MOST_REASONS]) + more
