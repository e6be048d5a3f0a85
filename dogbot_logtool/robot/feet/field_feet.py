"""Feet that are fields of messages of any type: named, checked against a log, and offered."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import PurePath
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed, shell_joined, shell_quoted
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import type_text
from dogbot_logtool.reader.decode.field_path import readable_fields
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contact_messages import source_of
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.robot.feet.candidates import FootCandidates, word_of

_MOST_LISTED: Final = 12
_MOST_COMPARED: Final = 2000
_LIKELY: Final = ("contact", "force", "grf", "load", "stance", "touch", "wrench")
"""Parts of names of fields that may be feet."""

_ALTERNATIVES: Final = 2
"""Sets that are offered beside the most likely one."""


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


def candidates_finding(log: Log, found: Sequence[FootCandidates], call: str, base: str) -> Finding:
    """Return which fields may be feet, why, and the command that measures with them.

    Args:
        log: the log.
        found: what `find_candidates` finds, at least one.
        call: a call of `stats` without the feet.
        base: poses that may be the base's, as ``--odom-topic`` takes them; empty: none.
    """
    first, *others = found
    text = f"fields of {first.type_name} look like feet: {first.text}"
    for other in others[:_ALTERNATIVES]:
        text += f"; or {other.text}"
    if any(foot.leg_position is None for foot in first.feet):
        text += (
            "; which leg each is, they do not say: put front_left, back_right ... for "
            f"{first.feet[0].name} and the others, and gaits have names"
        )
    file = f"{PurePath(log.words[0]).stem}.toml"
    chosen = ["--odom-topic", base] if base else []
    draft = shell_joined(["dogbot-logtool", "robots", "new", *log.words, *chosen, "-o", file])
    if any(foot.field and foot.field.kind for foot in first.feet):
        # What the fields are can only be said in a robot's file.
        text += f"; they are not used unasked. This writes a robot's file with them: {draft}"
        return Finding("FEET_UNSURE", text, command=draft, cases=("possible",))
    words = " ".join(f"--foot {foot.name}={shell_quoted(word_of(foot))}" for foot in first.feet)
    command = f"{call} {words}"
    text += (
        f"; they are not used unasked. `{draft}` writes a robot's file with them; this measures "
        f"with them: {command}"
    )
    return Finding("FEET_UNSURE", text, command=command, cases=("possible",))
