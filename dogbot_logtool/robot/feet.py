"""Which topics are a robot's feet: by the user's word, by the robot's file, else by names."""

from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed, shell_quoted
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.feet import feet_in
from dogbot_logtool.reader.messages.source import Source, Topic, source_of
from dogbot_logtool.robot.names import FootSet, label_names, leg_order, leg_position, name_feet
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import (
    first_messages,
    foot_options,
    is_named_as_planned,
    is_planned,
    names_of,
    require_topic,
    split_topic,
    topics_of,
)
from dogbot_logtool.robot.words import Part, parts_of

_JOINT_FOOT: Final = "sensor_msgs/JointState"
"""Type of messages of joints and feet; the velocities of the feet are planned contacts."""
_JOINTS: Final = 12
"""Joints before the feet."""


# --- by the user's word --------------------------------------------------------------------------


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
    others = {foot.topic for foot in robot.feet if foot.name not in topics} & recorded
    named = {split_topic(word, recorded)[0] for word in topics.values()}
    if known and unknown and (others - named or not guessed):
        whose = f"{robot.name}{' (guessed from the topics)' if guessed else ''}"
        raise CallError(
            f"--foot {unknown[0]}: the robot {whose} has no such foot; it has {', '.join(known)}. "
            "--robot generic takes feet of any names"
        )
    feet = {} if unknown else dict(known)
    for name, word in topics.items():
        foot = known.get(name, Foot(name, word, leg_position=leg_position(name)))
        topic, path = split_topic(word, recorded)
        # What the robot's file says of the field stays, such as its scale.
        field = replace(foot.field or FootField(path), path=path) if path else None
        feet[name] = replace(foot, topic=topic, field=field)
    return replace(robot, feet=tuple(feet.values()))


def check_topics(log: Log, topics: Mapping[str, str]) -> None:
    """Check that the log has the topics that the user gave feet.

    Raises:
        CallError: it lacks one, or one is of a wrong type.
    """
    for name, word in topics.items():
        topic, path = split_topic(word, log.channels_by_topic)
        otherwise = f"A field of its messages can be named: {name}={topic}:FIELD"
        require_topic(log, f"--foot {name}", topic, None if path else "feet", otherwise)


def channels_of_feet(log: Log, robot: Robot) -> dict[Channel, tuple[int, ...]]:
    """Return the channels from which feet can be read, and which feet each tells of.

    Raises:
        CallError: a field of a foot does not exist, only some of the feet have one, or two feet
            would be the same in the messages of a topic.
    """
    found: dict[Channel, tuple[int, ...]] = {}
    for topic in dict.fromkeys(foot.topic for foot in robot.feet):
        indices = tuple(index for index, foot in enumerate(robot.feet) if foot.topic == topic)
        feet, where = robot.feet_of(topic), f"{name_of(log.source.path)}: foot"
        for channel in log.channels_by_topic.get(topic, ()):
            try:
                source = foot_source(channel, feet)
            except DefinitionError as reason:
                names = listed([foot.name for foot in feet])
                raise CallError(f"{where} {names}, {topic}: {reason}") from None
            if source is None or source.fault:
                continue
            if same := _same_foot(feet, source):
                raise CallError(f"{where} {same}")
            found[channel] = indices
    return found


def _same_foot(feet: Sequence[Foot], source: Source) -> str:
    """Say which feet of a topic would be the same in its messages; empty: all differ."""
    own = [foot.field.path if foot.field else foot.element for foot in feet]
    for foot, what in zip(feet, own, strict=True):
        other = feet[own.index(what)]
        if other is not foot and not (what is None and source.tells_all_feet):
            return (
                f"{foot.name}: {foot.word} would be that of {other.name}, {foot.name}, and is "
                "about one foot; each needs a topic or a field of its own"
            )
    return ""


# --- by types and names --------------------------------------------------------------------------


def find_feet(log: Log, robot: Robot, findings: list[Finding]) -> tuple[Robot, Sequence[FootSet]]:
    """Find a robot's feet in a log.

    Args:
        log: the log.
        robot: its feet are those of its file or the user; if the log has none of their topics, they
            are replaced by those found.
        findings: receives findings.

    Returns:
        the robot with its feet, and sets of topics that may be feet if none surely are.
    """
    named = {foot.topic for foot in robot.feet if foot.field is not None}
    topics = {*names_of(log, "feet"), *named & log.channels_by_topic.keys()}
    best, offered = _feet_by_names(log)
    if any(foot.topic in topics for foot in robot.feet):
        feet = tuple(_with_element(log, foot, findings) for foot in robot.feet)
        silent = (foot for foot in feet if foot.topic not in log.channels_by_topic)
        findings += (_missing("no_topic", foot.topic, foot.name) for foot in silent)
        unnamed = _unnamed(best.feet if best else (), feet)
        for foot in unnamed:
            values = {"topic": foot.topic, "robot": robot.name, "call": foot_options([foot])}
            findings.append(found("NO_MESSAGES", say="unnamed", **values))
        # Their messages are not read, so that what rests on all feet is not known.
        missing = (replace(foot, topic="", element=None, label="") for foot in unnamed)
        return replace(robot, feet=(*feet, *missing)), ()
    if best is not None:
        words = ", ".join(f"{foot.name} = {foot.topic}" for foot in best.feet)
        findings.append(Finding("TOPICS_CHOSEN", f"feet are found by type and name: {words}"))
        findings += [_missing("unlike", name, name) for name in best.missing]
        # A foot that none tells of stays a foot of the robot: what all feet carry is not known.
        added = [Foot(name, "", leg_position=leg_position(name)) for name in best.missing]
        both = (*best.feet, *added)
        return replace(robot, feet=_front_to_back(both) if added else both), ()
    if not offered:
        is_recorded = any(source_of(channel, "feet") for channel in log.channels.values())
        say = "unlike" if topics else "unread" if is_recorded else "no_topics"
        names = sorted(topics)
        topic = shell_quoted(names[0]) if names else ""
        findings.append(found("NO_FEET", say=say, topics=listed(names), topic=topic))
    return replace(robot, feet=()), offered


def _unnamed(found: Sequence[Foot], feet: Sequence[Foot]) -> list[Foot]:
    """Return the feet that types and names of topics tell beside those that are named."""
    known = {(foot.topic, foot.element) for foot in feet}
    if not known < {(foot.topic, foot.element) for foot in found}:
        return []
    names = {foot.name for foot in feet}
    others = [foot for foot in found if foot.topic and (foot.topic, foot.element) not in known]
    return [] if names.intersection(foot.name for foot in others) else others


def _feet_by_names(log: Log) -> tuple[FootSet | None, list[FootSet]]:
    """Return the feet that types and names of topics tell, and what else may be.

    Of several types, the first that tells of all feet is used, else the first that tells of some;
    measured ones are better than planned ones.
    """
    offered: list[FootSet] = []
    best: FootSet | None = None
    for topics in _by_type(log):
        if best is not None and is_planned(topics[0].channels[0]):
            break
        source, names = topics[0].source, [each.name for each in topics]
        if source.tells_all_feet:
            told = feet_of_messages(log, topics[0])
            chosen, possible = FootSet(told, "elements") if told else None, tuple[FootSet, ...]()
        else:
            chosen, possible = name_feet(names, contacts_only=not source.row.anything)
        if chosen is not None and (best is None or not chosen.missing):
            best = chosen
            if not best.missing:
                break
        offered.extend(possible)
    return best, offered


def _by_type(log: Log) -> list[list[Topic]]:
    """Return the topics of feet of each type, measured ones first, then those of better types."""
    groups: dict[tuple[int, str], list[Topic]] = {}
    for topic in topics_of(log, "feet"):
        named = topic.source.tells_all_feet and is_named_as_planned(topic.name)
        key = is_planned(topic.channels[0]) + named, topic.source.row.name
        groups.setdefault(key, []).append(topic)
    return [groups[key] for key in sorted(groups, key=lambda key: key[0])]


def _missing(say: str, where: str, foot: str) -> Finding:
    told = found("NO_MESSAGES", "foot", where=where, say=say, name=foot, topic=where)
    return replace(told, feet=(foot,))


def _with_element(log: Log, foot: Foot, findings: list[Finding]) -> Foot:
    """Note which element is a foot's, where messages hold all feet and no option says it."""
    topic = next((each for each in topics_of(log, "feet") if each.name == foot.topic), None)
    if foot.field is not None or topic is None or not topic.source.tells_all_feet:
        return foot
    row = topic.source.row
    if foot.element is not None and row.legs and not row.maybe_without_legs:
        return foot
    told = {each.label if foot.label else each.name: each for each in feet_of_messages(log, topic)}
    position = foot.leg_position or leg_position(foot.name)
    for name in (foot.label,) if foot.label else (foot.name, "_".join(position or ())):
        if other := told.get(name):
            return replace(foot, element=other.element, label=other.label)
    if foot.element is None:
        findings.append(found("FEET_UNSURE", say="element", topic=foot.topic, name=foot.name))
    return foot


# --- by messages of all feet, and by plans -------------------------------------------------------


def feet_of_messages(log: Log, topic: Topic) -> tuple[Foot, ...]:
    """Return the feet that a topic's messages tell of; none where they are not about feet."""
    row, columns = topic.source.row, topic.source.columns
    if row.legs and not row.maybe_without_legs:
        return _at_legs(row.legs, topic)
    seen: list[Sequence[str]] = []
    for channel in topic.channels:
        seen += (feet_in(topic.source, each) for each in first_messages(log, channel, columns))
        if any(seen):
            break
    if not row.label:
        return _at_legs(max(seen, key=len, default=()), topic)
    # Hands, wheels, tools ... are left out where other labels say that they are feet.
    parts = {label: parts_of([label]) for label in sorted({each for own in seen for each in own})}
    legs = {label for label, own in parts.items() if own & {Part.FOOT, Part.LEG}}
    kept = [label for label, own in parts.items() if label in legs or Part.NOT_A_FOOT not in own]
    named = label_names(kept if legs else [*parts])
    names = [foot.name for foot in named]
    feet = []
    for element, foot in enumerate(named):
        name = foot.name if names.count(foot.name) == 1 else foot.topic
        told = replace(foot, name=name, topic=topic.name, label=foot.topic, element=element)
        feet.append(told)
    return _front_to_back(feet)


def _at_legs(legs: Sequence[str], topic: Topic) -> tuple[Foot, ...]:
    """Return the feet of legs that messages tell of in this order."""
    return _front_to_back(
        Foot(leg, topic.name, leg_position=leg_position(leg), element=element)
        for element, leg in enumerate(legs)
    )


def _front_to_back(feet: Iterable[Foot]) -> tuple[Foot, ...]:
    """Sort feet front to back, left before right; those of unknown legs stand behind."""
    return tuple(sorted(feet, key=lambda foot: leg_order(foot.name, foot.leg_position)))


def planned_feet(log: Log, robot: Robot, contacts: Sequence[Channel]) -> tuple[Foot, ...]:
    """Return the feet of a robot as a plan in the log tells of them; none: there is no plan.

    Args:
        log: the log.
        robot: with the feet that are used.
        contacts: their channels.
    """
    used = {channel.topic: channel.type_name for channel in contacts}
    if _JOINT_FOOT in used.values():
        return tuple(_by_velocity(foot) for foot in robot.feet if foot.element is not None)
    plans = [
        each
        for each in topics_of(log, "feet")
        if each.source.tells_all_feet and is_planned(each.channels[0]) and each.topic not in used
    ]
    names = {foot.name for foot in robot.feet}
    # A plan of the measurement's own type tells forces in the same way.
    for plan in sorted(plans, key=lambda each: each.channels[0].type_name not in used.values()):
        feet = feet_of_messages(log, plan)
        if found := tuple(foot for foot in feet if foot.name in names):
            return found
    return ()


def _by_velocity(foot: Foot) -> Foot:
    """Return a foot whose planned contact is the velocity beside its count."""
    field = FootField(f"velocity[{_JOINTS + (foot.element or 0)}]", kind="contact", threshold=0.5)
    return replace(foot, element=None, field=field, newtons_per_count=None, offset=0.0)
