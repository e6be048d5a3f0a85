"""Feet that are fields of messages of any type: named, and checked against a log."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import type_text
from dogbot_logtool.reader.decode.field_path import readable_fields
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.messages import definition_of

_MOST_LISTED: Final = 12
_MOST_COMPARED: Final = 2000
_LIKELY: Final = ("contact", "force", "grf", "load", "stance", "touch", "wrench")
"""Parts of names of fields that may be feet."""


def _is_likely(path: str) -> bool:
    return any(word in path.lower() for word in _LIKELY)


def with_topic(foot: Foot, topic: str, path: str) -> Foot:
    """Return a foot with the topic, and the field if any, that the user names.

    What the robot's file says of the field stays, such as its scale.
    """
    if not path:
        return replace(foot, topic=topic, field=None)
    field = FootField(path) if foot.field is None else replace(foot.field, path=path)
    return replace(foot, topic=topic, field=field)


def field_channels(log: Log, topic: str, feet: Sequence[Foot]) -> list[Channel]:
    """Return the channels of a topic in which all fields of its feet exist.

    Args:
        log: the log.
        topic: the topic of all feet.
        feet: each has a field.

    Raises:
        CallError: the log has the topic, but a field does not exist in any of its messages.
    """
    found: list[Channel] = []
    because = ""
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            source_of(channel, feet)
        except DefinitionError as reason:
            because = str(reason)
        else:
            found.append(channel)
    if because and not found:
        names = f"{'foot' if len(feet) == 1 else 'feet'} {listed([foot.name for foot in feet])}"
        raise CallError(f"{shown(log.source.path)}: {names}, {topic}: {because}")
    return found


def require_field_topic(log: Log, option: str, topic: str) -> None:
    """Check that the log has the topic of a field.

    Raises:
        CallError: it does not; with the nearest that it has.
    """
    if topic in log.channels_by_topic:
        return
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    topics = sorted(log.channels_by_topic)
    close = get_close_matches(topic, topics[:_MOST_COMPARED], n=3)
    meant = f"; did you mean {' or '.join(close)}?" if close else f"; it has {listed(topics)}"
    raise CallError(f"{shown(log.source.path)}: {option}: the log has no topic {topic}{meant}")


def fields_text(log: Log, topic: str) -> str:
    """Return a sentence on the fields of a topic that can be feet; empty: there are none."""
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            fields = readable_fields(definition_of(channel))
        except DefinitionError:
            continue
        first = sorted(islice(fields, _MOST_COMPARED), key=lambda field: not _is_likely(field[0]))
        some = [f"{topic}:{path} ({type_text(kind)})" for path, kind in first]
        if some:
            return f"A field of its messages can be named: {listed(some, _MOST_LISTED)}"
    return ""
