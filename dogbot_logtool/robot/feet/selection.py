"""Which topics are a robot's feet: by the user's word, by the robot's file, else by names."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from itertools import islice
from typing import Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed, shell_quoted
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import type_text
from dogbot_logtool.reader.decode.field_path import readable_fields
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contact_messages import contact_types, source_of
from dogbot_logtool.reader.messages.message_type import is_named_as_planned
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.source import FOOT_TYPES, Source
from dogbot_logtool.robot.feet.message_feet import (
    feet_of_messages,
    front_to_back,
    is_planned,
)
from dogbot_logtool.robot.names import FootSet, leg_position, name_feet
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics.readable import why_unreadable
from dogbot_logtool.robot.topics.topics import (
    most_frequent,
    readable_channels,
    recorded_topics,
    require_any_topic,
    require_topic,
    split_topic,
    topics_of_type,
)

_MOST_LISTED: Final = 12
_MOST_COMPARED: Final = 2000
_LIKELY: Final = ("contact", "force", "grf", "load", "stance", "touch", "wrench")
"""Parts of names of fields that may be feet."""
_RARE: Final = 2
"""States that come less often than this fraction of others are rare."""
_MOST_OFFERED: Final = 16
"""Sets of topics of a type that are looked at more closely."""
_ALTERNATIVES: Final = 3
"""Sets of topics that are offered beside the most likely one."""


@dataclass(frozen=True, slots=True)
class FootOffer:
    """Topics that may be feet, for the user to decide."""

    text: str
    """Which topics, and which feet they seem to be."""
    options: str
    """Words for a shell that choose the most likely ones: ``--foot left=/left_foot/wrench``."""
    topics: frozenset[str]
    """Those of the most likely ones."""


def assign_feet(
    robot: Robot, topics: Mapping[str, str], recorded: AbstractSet[str], *, guessed: bool
) -> Robot:
    """Give feet the topics that the user names.

    Args:
        robot: with the feet of its file.
        topics: topic by foot, as the user says, with the field where one is named.
        recorded: topics that the log has.
        guessed: the user named no robot. Then all feet may be the user's own, if none of the
            robot's is left over.

    Raises:
        CallError: the robot has no such foot.
    """
    known = {foot.name: foot for foot in robot.feet}
    unknown = [name for name in topics if name not in known]
    others = [foot for foot in robot.feet if foot.name not in topics]
    named = {split_topic(word, recorded)[0] for word in topics.values()}
    left_over = {foot.topic for foot in others} & recorded - named
    if known and unknown and (left_over or not guessed):
        whose = f"{robot.name}{' (guessed from the topics)' if guessed else ''}"
        raise CallError(
            f"--foot {unknown[0]}: the robot {whose} has no such foot; it has {', '.join(known)}. "
            "--robot generic takes feet of any names"
        )
    feet = {} if unknown else dict(known)
    for name, word in topics.items():
        foot = known.get(name, Foot(name, word, leg_position=leg_position(name)))
        feet[name] = _with_topic(foot, *split_topic(word, recorded))
    return replace(robot, feet=tuple(feet.values()))


def _with_topic(foot: Foot, topic: str, path: str) -> Foot:
    """Return a foot with the topic, and the field if any, that the user names.

    What the robot's file says of the field stays, such as its scale.
    """
    if not path:
        return replace(foot, topic=topic, field=None)
    field = FootField(path) if foot.field is None else replace(foot.field, path=path)
    return replace(foot, topic=topic, field=field)


def check_topics(log: Log, topics: Mapping[str, str]) -> None:
    """Check that the log has the topics that the user gave feet.

    Raises:
        CallError: it lacks one, or one is of a wrong type.
    """
    types = contact_types(log.channels.values())
    for name, word in topics.items():
        topic, path = split_topic(word, log.channels_by_topic)
        if path:
            require_any_topic(log, f"--foot {name}", topic)
        else:
            require_topic(log, f"--foot {name}", topic, types, _fields_text(log, topic))


def _fields_text(log: Log, topic: str) -> str:
    """Return a sentence on the fields of a topic that can be feet; empty: there are none."""
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            fields = readable_fields(definition_of(channel))
        except DefinitionError:
            continue
        first = sorted(
            islice(fields, _MOST_COMPARED),
            key=lambda one: not any(word in one[0].lower() for word in _LIKELY),
        )
        some = [f"{topic}:{path} ({type_text(kind)})" for path, kind in first]
        if some:
            return f"A field of its messages can be named: {listed(some, _MOST_LISTED)}"
    return ""


def foot_channels(log: Log, robot: Robot, topic: str) -> list[Channel]:
    """Return the channels from which a topic's feet can be read.

    Raises:
        CallError: a field of a foot does not exist, or only some of the feet have one.
    """
    feet = robot.feet_of(topic)
    fields = [foot for foot in feet if foot.field is not None]
    if not fields:
        return readable_channels(log, topic, contact_types(log.channels_by_topic.get(topic, ())))
    if len(fields) < len(feet):
        raise CallError(f"{topic}: all feet of a topic need a field, or none")
    return _field_channels(log, topic, feet)


def _field_channels(log: Log, topic: str, feet: Sequence[Foot]) -> list[Channel]:
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


def find_feet(log: Log, robot: Robot, findings: list[Finding]) -> tuple[Robot, FootOffer | None]:
    """Find a robot's feet in a log.

    Args:
        log: the log.
        robot: its feet are those of its file or the user; if the log has none of their topics, they
            are replaced by those found.
        findings: receives findings.

    Raises:
        CallError: two feet would be the same in the messages of a topic.

    Returns:
        the robot with its feet, and other topics that may be feet if none surely are.
    """
    types = contact_types(log.channels.values())
    named = {foot.topic for foot in robot.feet if foot.field is not None}
    named &= log.channels_by_topic.keys()
    topics = sorted({*topics_of_type(log, types), *named})
    recorded = sorted({*recorded_topics(log, types), *named})
    if any(foot.topic in topics for foot in robot.feet):
        feet = tuple(_with_element(log, foot, findings) for foot in robot.feet)
        _check_feet_differ(log, feet)
        for foot in feet:
            if foot.topic not in recorded:
                text = f"foot {foot.name} has no messages: there is no topic {foot.topic}"
                findings.append(_missing(text, foot.topic, foot.name))
        unnamed = _unnamed(log, feet)
        for foot in unnamed:
            options = f"--foot {foot.name}={shell_quoted(foot.topic)}"
            text = f"{foot.topic} is like the feet of {robot.name}, but none of them ({options})"
            findings.append(Finding("NO_MESSAGES", text, foot.topic))
        # Their messages are not read, so that what rests on all feet is not known.
        missing = (replace(foot, topic="", element=None, label="") for foot in unnamed)
        return replace(robot, feet=(*feet, *missing)), None
    found, offered = _feet_by_names(log, findings)
    if not found and not offered:
        findings.append(Finding("NO_FEET", _without_feet(topics, recorded)))
    return replace(robot, feet=found), _offer(offered) if offered and not found else None


def _unnamed(log: Log, feet: Sequence[Foot]) -> list[Foot]:
    """Return the feet that types and names of topics tell beside those that are named."""
    found, _ = _feet_by_names(log, [])
    known = {(foot.topic, foot.element) for foot in feet}
    if not known < {(foot.topic, foot.element) for foot in found}:
        return []
    names = {foot.name for foot in feet}
    others = [foot for foot in found if foot.topic and (foot.topic, foot.element) not in known]
    return [] if names.intersection(foot.name for foot in others) else others


def _feet_by_names(log: Log, findings: list[Finding]) -> tuple[tuple[Foot, ...], Sequence[FootSet]]:
    """Return the feet that types and names of topics tell, and topics that may be feet."""
    offered: list[FootSet] = []
    parts: list[tuple[FootSet, tuple[FootSet, ...]]] = []
    for source, of_source in _candidates(log):
        if parts and _is_plan(log, of_source):
            break
        if source.tells_all_feet:
            feet = feet_of_messages(log, most_frequent(log, of_source))
            if feet:
                findings.append(_found(feet))
                return feet, ()
            continue
        names = name_feet(of_source, contacts_only=not source.anything)
        if names.chosen is not None and not names.chosen.missing:
            feet = _feet_of(names.chosen)
            findings.append(_found(feet, names.offered))
            return feet, ()
        if names.chosen is not None:
            parts.append((names.chosen, names.offered))
        offered.extend(names.offered[:_MOST_OFFERED])
    return (_of_part(*parts[0], offered, findings) if parts else ()), offered


def _of_part(
    part: FootSet,
    others: Sequence[FootSet],
    offered: Sequence[FootSet],
    findings: list[Finding],
) -> tuple[Foot, ...]:
    """Return the feet of a robot of which one type of messages tells some feet only.

    Another type may tell of the rest. A foot that none tells of stays a foot of the robot: what
    all feet carry is not known without it.
    """
    found = list(_feet_of(part))
    rest = next((one for one in offered if one.completes(part)), None)
    found += _feet_of(rest) if rest is not None else ()
    findings.append(_found(found, [one for one in others if one is not rest]))
    for name in part.missing if rest is None else ():
        text = f"foot {name} has no messages: there is no topic like those of the other feet"
        findings.append(_missing(text, name, name))
        found.append(Foot(name, "", leg_position=leg_position(name)))
    return tuple(sorted(found, key=front_to_back))


def _candidates(log: Log) -> list[tuple[Source, list[str]]]:
    """Return the topics of each source, the best first: measured before planned.

    Of Unitree's states, those with positions come first, unless others are much more frequent.
    """
    groups: dict[tuple[int, str], tuple[Source, list[str]]] = {}
    frequencies: dict[tuple[int, str], int] = {}
    for channel in log.channels.values():
        source = source_of(channel)
        if source is None or why_unreadable(channel):
            continue
        key = _planning(channel, source), source.type_name
        _, topics = groups.setdefault(key, (source, []))
        if channel.topic not in topics:
            topics.append(channel.topic)
        count = log.counts.get(channel.id, 0)
        frequencies[key] = max(frequencies.get(key, 0), count)
    raw = {key for key, (source, _) in groups.items() if source.is_raw}
    most_raw = max((frequencies[key] for key in raw), default=0)

    def rank(key: tuple[int, str]) -> tuple[int, bool, int]:
        planned, name = key
        return planned, key in raw and _RARE * frequencies[key] < most_raw, FOOT_TYPES.index(name)

    return [(groups[key][0], sorted(groups[key][1])) for key in sorted(groups, key=rank)]


def _planning(channel: Channel, source: Source) -> int:
    """Return 0 for a measurement, 1 for what only planners write, 2 for what is named a plan."""
    named = source.tells_all_feet and is_named_as_planned(channel.topic)
    return int(is_planned(channel)) + int(named)


def _is_plan(log: Log, topics: Sequence[str]) -> bool:
    """Tell whether a plan is among topics."""
    channels = [channel for topic in topics for channel in log.channels_by_topic.get(topic, ())]
    return any((source := source_of(c)) and _planning(c, source) for c in channels)


def _check_feet_differ(log: Log, feet: Sequence[Foot]) -> None:
    """Check that no two feet are the same in the messages of a topic.

    Raises:
        CallError: two are.
    """
    seen: dict[tuple[str, str | int | None], str] = {}
    for foot in feet:
        own = foot.field.path if foot.field is not None else foot.element
        channels = log.channels_by_topic.get(foot.topic, ())
        sources = [source for channel in channels if (source := source_of(channel))]
        if own is None and all(source.tells_all_feet for source in sources):
            continue
        other = seen.setdefault((foot.topic, own), foot.name)
        if other == foot.name:
            continue
        text = f"{other} is the same foot in the messages of {foot.topic}"
        if foot.field is not None:
            text += "; each needs a field of its own"
        elif own is None:
            text = f"{foot.topic} would be the topic of {other}, {foot.name}; a message of type "
            text += f"{sources[0].type_name} is about one foot"
        raise CallError(f"{shown(log.source.path)}: --foot {foot.name}: {text}")


def _feet_of(found: FootSet) -> tuple[Foot, ...]:
    return tuple(Foot(foot.name, foot.topic, leg_position=foot.position) for foot in found.feet)


def _missing(text: str, where: str, foot: str) -> Finding:
    return Finding("NO_MESSAGES", text, where, cases=("foot",), feet=(foot,))


def _found(feet: Sequence[Foot], others: Sequence[FootSet] = ()) -> Finding:
    text = f"feet are found by type and name: {', '.join(f'{f.name} = {f.topic}' for f in feet)}"
    if others:
        text += f"; not chosen, but possible: {' or '.join(map(foot_options, _few(others)))}"
    return Finding("TOPICS_CHOSEN", text)


def _few(sets: Sequence[FootSet]) -> Sequence[FootSet]:
    return sets[:_ALTERNATIVES]


def _offer(offered: Sequence[FootSet]) -> FootOffer:
    first, *others = offered
    text = ", ".join(f"{foot.name} = {foot.topic}" for foot in first.feet)
    if others:
        text += f"; or {' or '.join(map(foot_options, _few(others)))}"
    if len(others) > _ALTERNATIVES:
        text += f" or {len(others) - _ALTERNATIVES} other sets of topics"
    return FootOffer(text, foot_options(first), first.topics)


def foot_options(feet: FootSet) -> str:
    """Return the words for a shell that choose these feet."""
    return " ".join(f"--foot {foot.name}={shell_quoted(foot.topic)}" for foot in feet.feet)


def _without_feet(topics: Sequence[str], recorded: Sequence[str]) -> str:
    if not topics:
        none = "no contact topics can be read" if recorded else "there are no contact topics"
        return f"{none}: no arrows, no gait"
    text = f"no topic with forces or contacts is named like a foot's: {listed(topics)}"
    return f"{text}; no arrows, no gait (--foot NAME=TOPIC names one)"


def _with_element(log: Log, foot: Foot, findings: list[Finding]) -> Foot:
    """Note which element is a foot's, where messages hold all feet and no option says it."""
    if foot.field is not None:
        return foot
    channels = log.channels_by_topic.get(foot.topic, ())
    sources = [source for channel in channels if (source := source_of(channel))]
    if not sources or not sources[0].tells_all_feet:
        return foot
    if foot.element is not None and sources[0].legs:
        return foot
    found = feet_of_messages(log, foot.topic)
    positions = (foot.leg_position, leg_position(foot.name))
    for name in (foot.name, *("_".join(position) for position in positions if position)):
        for other in found:
            if foot.label == other.label if foot.label else name == other.name:
                return replace(foot, element=other.element, label=other.label)
    if foot.element is not None:
        return foot
    text = f"which element of {foot.topic} is {foot.name} is not known; the robot's file can tell"
    findings.append(Finding("FEET_UNSURE", text, foot.topic))
    return foot
