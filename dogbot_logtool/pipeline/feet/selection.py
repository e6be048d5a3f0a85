"""Which topics are a robot's feet: by the user's word, by the robot's file, else by names."""

import shlex
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding, note, warning
from dogbot_logtool.io.listing import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.pipeline.feet.names import FootSet, leg_position, name_feet
from dogbot_logtool.pipeline.topics import (
    most_frequent,
    recorded_topics,
    require_topic,
    topics_of_type,
)
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.messages.contacts.registry import SOURCES
from dogbot_logtool.robot import Foot, Robot

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


def assign_feet(
    robot: Robot, topics: Mapping[str, str], recorded: AbstractSet[str], *, guessed: bool
) -> Robot:
    """Give feet the topics that the user names.

    Args:
        robot: with the feet of its file.
        topics: topic by foot, as the user says.
        recorded: topics that the log has.
        guessed: the user named no robot. Then all feet may be the user's own, if none of the
            robot's is left over.

    Raises:
        CallError: the robot has no such foot.
    """
    known = {foot.name: foot for foot in robot.feet}
    unknown = [name for name in topics if name not in known]
    others = [foot for foot in robot.feet if foot.name not in topics]
    left_over = {foot.topic for foot in others} & recorded - {*topics.values()}
    if known and unknown and (left_over or not guessed):
        whose = f"{robot.name}{' (guessed from the topics)' if guessed else ''}"
        raise CallError(
            f"--foot {unknown[0]}: the robot {whose} has no such foot; it has {', '.join(known)}. "
            "--robot generic takes feet of any names"
        )
    feet = {} if unknown else dict(known)
    for name, topic in topics.items():
        foot = known.get(name, Foot(name, topic, place=leg_position(name)))
        feet[name] = replace(foot, topic=topic)
    return replace(robot, feet=tuple(feet.values()))


def check_topics(log: Log, topics: Mapping[str, str]) -> None:
    """Check that the log has the topics that the user gave feet.

    Raises:
        CallError: it lacks one, or one is of a wrong type.
    """
    for name, topic in topics.items():
        require_topic(log, f"--foot {name}", topic, SOURCES.keys())


def check_feet_differ(log: Log, robot: Robot, topics: Mapping[str, str]) -> None:
    """Check that no topic that the user gave stands for two feet, if it tells of one.

    Raises:
        CallError: one does.
    """
    for name, topic in topics.items():
        sharing = [foot.name for foot in robot.feet if foot.topic == topic]
        types = {c.type_name for c in log.channels.values() if c.topic == topic} & SOURCES.keys()
        single = sorted(each for each in types if not SOURCES[each].elements)
        if len(sharing) > 1 and single:
            raise CallError(
                f"{shown(log.source.path)}: --foot {name}: {topic} would be the topic of "
                f"{listed(sharing)}; a message of type {single[0]} is about one foot"
            )


def find_feet(log: Log, robot: Robot, findings: list[Finding]) -> tuple[Robot, FootOffer | None]:
    """Find a robot's feet in a log.

    Args:
        log: the log.
        robot: its feet are those of its file or the user; if the log has none of their topics, they
            are replaced by those found.
        findings: is told what was found.

    Raises:
        CallError: two feet would be one element of a message.

    Returns:
        the robot with its feet, and other topics that may be feet if none surely are.
    """
    topics = topics_of_type(log, SOURCES.keys())
    recorded = recorded_topics(log, SOURCES.keys())
    if any(foot.topic in topics for foot in robot.feet):
        feet = tuple(_with_element(log, foot, findings) for foot in robot.feet)
        _check_elements_differ(feet)
        for foot in feet:
            if foot.topic not in recorded:
                text = f"foot {foot.name} has no messages: there is no topic {foot.topic}"
                findings.append(warning("FOOT_MISSING", text, foot.topic))
        return replace(robot, feet=feet), None
    offered: list[FootSet] = []
    for type_name, source in SOURCES.items():
        of_type = topics_of_type(log, {type_name})
        if source.elements and of_type:
            feet = _feet_of_elements(source.elements, most_frequent(log, of_type))
            findings.append(_found(feet))
            return replace(robot, feet=feet), None
        names = name_feet(of_type, contacts_only=not source.anything)
        if names.chosen is not None:
            feet = _feet_of(names.chosen)
            findings.append(_found(feet, names.chosen.missing, names.offered))
            return replace(robot, feet=feet), None
        offered.extend(names.offered[:_MOST_OFFERED])
    if not offered:
        findings.append(warning("NO_FEET", _without_feet(topics, recorded)))
    return replace(robot, feet=()), _offer(offered) if offered else None


def _check_elements_differ(feet: Sequence[Foot]) -> None:
    seen: dict[tuple[str, int], str] = {}
    for foot in feet:
        if foot.element is not None:
            other = seen.setdefault((foot.topic, foot.element), foot.name)
            if other != foot.name:
                raise CallError(
                    f"--foot {foot.name}: {other} is the same foot in the messages of {foot.topic}"
                )


def _feet_of_elements(elements: Sequence[str], topic: str) -> tuple[Foot, ...]:
    return tuple(
        Foot(leg, topic, place=leg_position(leg), element=element)
        for element, leg in enumerate(elements)
    )


def _feet_of(found: FootSet) -> tuple[Foot, ...]:
    return tuple(Foot(foot.name, foot.topic, place=foot.position) for foot in found.feet)


def _found(
    feet: Sequence[Foot], missing: Sequence[str] = (), others: Sequence[FootSet] = ()
) -> Finding:
    text = f"feet are found by type and name: {', '.join(f'{f.name} = {f.topic}' for f in feet)}"
    if missing:
        text += f"; there is no such topic for {', '.join(missing)}"
    if others:
        text += f"; not chosen, but possible: {' or '.join(map(foot_options, _few(others)))}"
    return note("FEET_FOUND", text)


def _few(sets: Sequence[FootSet]) -> Sequence[FootSet]:
    return sets[:_ALTERNATIVES]


def _offer(offered: Sequence[FootSet]) -> FootOffer:
    first, *others = offered
    text = ", ".join(f"{foot.name} = {foot.topic}" for foot in first.feet)
    if others:
        text += f"; or {' or '.join(map(foot_options, _few(others)))}"
    if len(others) > _ALTERNATIVES:
        text += f" or {len(others) - _ALTERNATIVES} other sets of topics"
    return FootOffer(text, foot_options(first))


def foot_options(feet: FootSet) -> str:
    """Return the words for a shell that choose these feet."""
    return " ".join(f"--foot {foot.name}={shlex.quote(foot.topic)}" for foot in feet.feet)


def _without_feet(topics: Sequence[str], recorded: Sequence[str]) -> str:
    if not topics:
        none = "no contact topics can be read" if recorded else "there are no contact topics"
        return f"{none}: no arrows, no gait"
    text = f"no topic with forces or contacts is named like a foot's: {listed(topics)}"
    return f"{text}; no arrows, no gait (--foot NAME=TOPIC names one)"


def _with_element(log: Log, foot: Foot, findings: list[Finding]) -> Foot:
    """Say which element is a foot's, where its messages tell of all feet and nobody said it."""
    types = {c.type_name for c in log.channels.values() if c.topic == foot.topic}
    elements = [SOURCES[name].elements for name in sorted(types & SOURCES.keys())]
    if foot.element is not None or not elements or not elements[0]:
        return foot
    for name in (foot.name, *("_".join(at) for at in (foot.place, leg_position(foot.name)) if at)):
        if name in elements[0]:
            return replace(foot, element=elements[0].index(name))
    text = f"which element of {foot.topic} is {foot.name} is not known; the robot's file can tell"
    findings.append(warning("ELEMENT_UNKNOWN", text, foot.topic))
    return foot
