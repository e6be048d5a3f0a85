"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases import (
    ODOMETRY_TYPE,
    Base,
    base_types,
    path_source,
)
from dogbot_logtool.reader.messages.source import (
    Source,
    base_source,
    base_type,
    lists_poses,
)
from dogbot_logtool.robot.base_candidates import (
    BaseCandidate,
    base_candidates,
    elements_in,
    elements_of,
    frame_pair,
    likely_base,
)
from dogbot_logtool.robot.other_robots import is_of_another_robot, of_another_robot
from dogbot_logtool.robot.readable import require_topic, split_topic
from dogbot_logtool.robot.robot import Robot

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
    log: Log, robot: Robot, findings: list[Finding], feet: Collection[str], *, is_asked: bool
) -> ChosenBase:
    """Choose the base's poses of a log, and say which, what else there is, and what to know.

    Args:
        log: the log.
        robot: its file or the user may name them.
        findings: receives findings.
        feet: topics of the robot's feet; where a log has two robots, the base is that of the feet.
        is_asked: whether the user names them.

    Raises:
        CallError: the log has not the poses that the user names.
        LogError: it has them, but they cannot be decoded.
    """
    named = robot.odometry_topic
    try:
        own = _named(log, robot, named) if named else None
    except (CallError, LogError):
        if is_asked:
            raise
        own = None
    if own is not None:
        return _chosen(log, robot, own, findings)
    found = base_candidates(log, robot, feet)
    foreign = [each.topic for each in found if is_of_another_robot(each.topic, feet)]
    if foreign:
        found = [each for each in found if each.topic not in foreign]
        findings.append(of_another_robot(foreign, [each.name for each in found], feet))
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


def _named(log: Log, robot: Robot, name: str) -> BaseCandidate:
    """Return the poses that the user or the robot's file names.

    Raises:
        CallError: the log has none of that name; with what it has.
        LogError: it has, but they cannot be decoded.
    """
    topic, element = split_topic(name, log.channels_by_topic)
    channels = log.channels_by_topic.get(topic, ())
    if not element or not channels:
        require_topic(log, "--odom-topic", topic, base_types(log.channels.values()))
    where = f"{shown(log.source.path)}: --odom-topic"
    try:
        source, element = _source_of(channels, element)
    except DefinitionError as error:
        raise CallError(f"{where}: {topic}: {error}") from error
    if not source.lists_poses:
        return BaseCandidate(topic, source, element)
    names = elements_in(log, topic, source)
    known = listed(sorted(names), _MOST_LISTED) or "none"
    if element and element not in names:
        raise CallError(f"{where}: {topic} has no {element}; it has {known}")
    sure = [each for each in elements_of(log, robot, topic, source) if each.is_sure]
    if not element and not sure:
        raise CallError(
            f"{where}: {topic} is of type {source.type_name}, and which of its poses is the "
            f"base's is not known: name one as {topic}:NAME; it has {known}"
        )
    return BaseCandidate(topic, source, element) if element else sure[0]


def _source_of(channels: Iterable[Channel], element: str) -> tuple[Source, str]:
    """Return the source of the first channel with an element, and the element for its reader.

    Raises:
        DefinitionError: no channel has such poses.
    """
    reason = DefinitionError("it has no messages")
    for channel in channels:
        try:
            if lists_poses(channel.type_name):
                return base_source(channel), element.lstrip("/")
            return (path_source(channel, element) if element else base_source(channel)), element
        except DefinitionError as error:
            reason = error
    raise reason


def _chosen(
    log: Log, robot: Robot, candidate: BaseCandidate, findings: list[Finding]
) -> ChosenBase:
    """Return what is read of a candidate, with findings about what its poses are."""
    source, topic = candidate.source, candidate.topic
    channels = []
    for channel in log.channels_by_topic[topic]:
        try:
            fits = _source_of([channel], candidate.element)[0].fields == source.fields
        except DefinitionError:
            continue
        if fits and source.type_name in {channel.type_name, base_type(channel.type_name)}:
            channels.append(channel)
    if candidate.is_planned:
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


def _none(log: Log, offered: Sequence[BaseCandidate]) -> Finding:
    found = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
    none = "no odometry can be read" if found else "there is no odometry"
    text = f"{none}: no /tf and no figures of the base's motion"
    if offered:
        text += f", unless these poses are the base's: {_options(offered)}"
    return Finding("NO_BASE", text)


def _options(candidates: Sequence[BaseCandidate]) -> str:
    """Return the words that choose some candidates."""
    shown_ones = candidates[:_MOST_OFFERED]
    words = [
        f"--odom-topic {each.name}{' (planned)' if each.is_planned else ''}" for each in shown_ones
    ]
    more = len(candidates) - len(shown_ones)
    return ", ".join(words) + (f" and {more} more" if more else "")
