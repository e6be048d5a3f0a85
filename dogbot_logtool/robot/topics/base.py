"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, Base, base_types, path_source
from dogbot_logtool.reader.messages.source import (
    BASE_TYPES,
    Source,
    base_source,
    base_type,
    lists_poses,
)
from dogbot_logtool.reader.messages.transforms import FOXGLOVE_TYPES, TRANSFORM_TYPES
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics.base_candidates import (
    OTHER_WORDS,
    BaseCandidate,
    base_candidates,
    base_source_of,
    elements_in,
    elements_of,
    frame_pair,
    is_planned_base,
    likely_base,
    of_same_robot,
    pose_topics,
    topic_words,
)
from dogbot_logtool.robot.topics.topics import (
    most_frequent,
    recorded_topics,
    require_topic,
    split_topic,
)

_MOST_OFFERED: Final = 3
_MOST_LISTED: Final = 12


@dataclass(frozen=True, slots=True)
class ChosenBase:
    """The base of a log, and the robot with the frames that it names."""

    robot: Robot
    channels: tuple[Channel, ...] = ()
    base: Base | None = None
    offered: str = ""
    """Poses that are likely the base's and are not taken unasked, as ``--odom-topic`` takes them;
    empty: there are none, or a base is known."""


def choose_base(
    log: Log, robot: Robot, findings: list[Finding], feet: Collection[str]
) -> ChosenBase:
    """Choose the base's poses of a log, and say which, what else there is, and what to know.

    Args:
        log: the log.
        robot: its file or the user may name them.
        findings: receives findings.
        feet: topics of the robot's feet; where a log has two robots, the base is that of the feet.
    """
    named = robot.odometry_topic
    if named is not None and (own := _named(log, robot, named, findings)) is not None:
        return own
    odometry = pose_topics(log, (ODOMETRY_TYPE,))
    if odometry:
        topic = most_frequent(log, of_same_robot(odometry, feet))
        findings.append(_odometry_found(log, robot, topic, odometry))
        return _chosen(log, robot, BaseCandidate(topic, base_source_of(log, topic)), findings)
    found = base_candidates(log, robot, feet)
    best = next((each for each in found if each.is_sure), None)
    others = [each for each in found if each is not best]
    if best is None:
        findings.append(_none(log, others))
        return ChosenBase(robot, offered=likely_base(log, others, feet))
    text = f"the base's poses are taken from {best.name} ({best.source.type_name})"
    if named is not None:
        text += f", since the robot's {named} is missing or cannot be used"
    if others:
        text += f"; there are also {_options(others)}"
    findings.append(Finding("TOPICS_CHOSEN", text, best.topic))
    return _chosen(log, robot, best, findings)


def check_named_base(log: Log, robot: Robot, name: str) -> None:
    """Check that a log has the poses that the user names.

    Raises:
        CallError: it has not; with what it has.
        LogError: it has, but they cannot be decoded.
    """
    topic, element = split_topic(name, log.channels_by_topic)
    channels = log.channels_by_topic.get(topic, ())
    if not element or not channels:
        require_topic(log, "--odom-topic", topic, base_types(log.channels.values()))
    where = f"{shown(log.source.path)}: --odom-topic"
    try:
        source, element = _source(channels[0], element)
    except DefinitionError as error:
        raise CallError(f"{where}: {topic}: {error}") from error
    if not source.lists_poses:
        return
    names = elements_in(log, topic, source)
    known = listed(sorted(names), _MOST_LISTED) or "none"
    if element and element not in names:
        raise CallError(f"{where}: {topic} has no {element}; it has {known}")
    if not element and not any(each.is_sure for each in elements_of(log, robot, topic, source)):
        raise CallError(
            f"{where}: {topic} is of type {source.type_name}, and which of its poses is the "
            f"base's is not known: name one as {topic}:NAME; it has {known}"
        )


def _source(channel: Channel, element: str) -> tuple[Source, str]:
    """Return the source of a channel for an element, and the element for its reader.

    Raises:
        DefinitionError: the channel has no such poses.
    """
    if lists_poses(channel.type_name):
        return base_source(channel), element.lstrip("/")
    if element:
        return path_source(channel, element), element
    return base_source(channel), ""


def _named(log: Log, robot: Robot, name: str, findings: list[Finding]) -> ChosenBase | None:
    """Return the base that the user or the robot's file names; None if the log has none."""
    topic, element = split_topic(name, log.channels_by_topic)
    for channel in log.channels_by_topic.get(topic, ()):
        try:
            source, element = _source(channel, element)
        except DefinitionError:
            continue
        if source.lists_poses and not element:
            offers = [o for o in elements_of(log, robot, topic, source) if o.is_sure]
            if not offers:
                return None
            element = offers[0].element
        return _chosen(log, robot, BaseCandidate(topic, source, element), findings)
    return None


def _chosen(
    log: Log, robot: Robot, candidate: BaseCandidate, findings: list[Finding]
) -> ChosenBase:
    """Return what is read of a candidate, with findings about what its poses are."""
    source, topic = candidate.source, candidate.topic
    channels = []
    for channel in log.channels_by_topic[topic]:
        try:
            fits = _source(channel, candidate.element)[0].fields == source.fields
        except DefinitionError:
            continue
        if fits and source.type_name in {channel.type_name, base_type(channel.type_name)}:
            channels.append(channel)
    if is_planned_base(candidate):
        text = f"{candidate.name}: these poses are planned, not measured"
        findings.append(Finding("PLANNED", text, topic, cases=("base",)))
    if remark := source.row.remark:
        findings.append(Finding("TOPICS_CHOSEN", f"{candidate.name}: {remark}", topic))
    if not source.has_header:
        text = f"{source.type_name} has no header: log time is used for it"
        findings.append(Finding("LOG_TIME_USED", text, cases=("no_header",)))
    if source.is_transform:
        parent, child = frame_pair(candidate.element)
        robot = replace(robot, world_frame=parent, base_frame=child)
        if "footprint" in child:
            text = (
                f"{child} is the base's projection on the ground: height, roll and pitch are "
                "those of the ground"
            )
            findings.append(Finding("TOPICS_CHOSEN", text, topic))
    return ChosenBase(robot, tuple(channels), Base(source, candidate.element))


def _odometry_found(log: Log, robot: Robot, chosen: str, topics: Sequence[str]) -> Finding:
    """Say which of several odometry topics is used."""
    others = [*(topic for topic in topics if topic != chosen), *_other_poses(log)]
    rest = listed(others, _MOST_LISTED)
    text = f"odometry is taken from {chosen}, found by its type"
    named = robot.odometry_topic
    if named is not None:
        recorded = recorded_topics(log, {ODOMETRY_TYPE})
        why = "cannot be used" if named in recorded else "is missing"
        text += f", since the robot's {named} {why}"
    text += f"; there are also {rest} (--odom-topic chooses)" if rest else ""
    return Finding("TOPICS_CHOSEN", text, chosen)


def _other_poses(log: Log) -> list[str]:
    """Return the topics whose poses may be the base's, besides odometry and transforms."""
    types = [
        type_name
        for type_name in BASE_TYPES
        if type_name not in {ODOMETRY_TYPE, *TRANSFORM_TYPES, *FOXGLOVE_TYPES}
    ]
    return [
        topic for topic in pose_topics(log, types) if topic_words(topic).isdisjoint(OTHER_WORDS)
    ]


def _none(log: Log, offered: Sequence[BaseCandidate]) -> Finding:
    found = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
    none = "no odometry can be read" if found else "there is no odometry"
    text = f"{none}: no /tf and no figures of the base's motion"
    if offered:
        text += f", unless these poses are the base's: {_options(offered)}"
    return Finding("NO_BASE", text)


def _options(candidates: Sequence[BaseCandidate]) -> str:
    """Return the options that choose candidates."""
    names = [
        f"--odom-topic {each.name}{' (planned)' if is_planned_base(each) else ''}"
        for each in candidates[:_MOST_OFFERED]
    ]
    more = len(candidates) - len(names)
    return ", ".join(names) + (f" and {more:,} more" if more else "")
