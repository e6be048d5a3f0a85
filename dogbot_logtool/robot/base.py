"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, Base
from dogbot_logtool.robot.base_candidates import (
    BaseCandidate,
    base_candidates,
    elements_of,
    is_of_another_robot,
    likely_base,
    namespace_of,
    settled,
    sources_at,
)
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import require_topic, split_topic

_MOST_OFFERED: Final = 3
_MOST_LISTED: Final = 12


@dataclass(frozen=True, slots=True, eq=False, repr=False)
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
        if named:
            return _chosen(log, robot, _named(log, robot, named), findings)
    except (CallError, LogError):
        if is_asked:
            raise
    every = sorted(
        base_candidates(log, robot, feet), key=lambda each: (not each.is_sure, each.is_planned)
    )
    own = [each for each in every if not is_of_another_robot(each.topic, feet)]
    if foreign := [each.topic for each in every if each not in own]:
        case, say = ((), "plain") if own else (("alone",), "alone")
        names, whose = listed([each.name for each in own]), namespace_of(next(iter(feet)))
        told = {"topics": listed(foreign), "whose": whose, "own": names}
        findings.append(found("POSE_OTHER_ROBOT", *case, where=foreign[0], say=say, **told))
    best = own[0] if own and own[0].is_sure else None
    others = own[1:] if best else own
    if best is None:
        is_there = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
        poses = f", unless these poses are the base's: {_options(others)}" if others else ""
        findings.append(found("NO_BASE", say="unread" if is_there else "plain", poses=poses))
        return ChosenBase(robot, offered=likely_base(others, feet))
    text = f"the base's poses are taken from {best.name} ({best.source.row.name})"
    text += f", since the robot's {named} is missing or cannot be used" if named else ""
    text += f"; there are also {_options(others)}" if others else ""
    findings.append(Finding("TOPICS_CHOSEN", text, best.topic))
    return _chosen(log, robot, best, findings)


def _named(log: Log, robot: Robot, name: str) -> BaseCandidate:
    """Return the poses that the user or the robot's file names.

    Raises:
        CallError: the log has none of that name; with what it has.
        LogError: it has, but they cannot be decoded.
    """
    topic, element = split_topic(name, log.channels_by_topic)
    if not element or topic not in log.channels_by_topic:
        require_topic(log, "--odom-topic", topic, "base")
    where = f"{name_of(log.source.path)}: --odom-topic: {topic}"
    sources, reason = sources_at(log.channels_by_topic[topic], element)
    if not sources:
        raise CallError(f"{where}: {reason}")
    source = next(iter(sources.values()))
    if not source.row.choose:
        return BaseCandidate(topic, source, element)
    every = settled(elements_of(log, robot, topic, source), ())
    element = element.lstrip("/")
    known = listed(sorted(each.element for each in every), _MOST_LISTED) or "none"
    fitting = [each for each in every if each.element == element or (each.is_sure and not element)]
    if element and not fitting:
        raise CallError(f"{where} has no {element}; it has {known}")
    if not fitting:
        raise CallError(
            f"{where} is of type {source.row.name}, and which of its poses is the "
            f"base's is not known: name one as {topic}:NAME; it has {known}"
        )
    return fitting[0]


def _chosen(
    log: Log, robot: Robot, candidate: BaseCandidate, findings: list[Finding]
) -> ChosenBase:
    """Return what is read of a candidate, with findings about what its poses are."""
    source, topic = candidate.source, candidate.topic
    sources, _ = sources_at(log.channels_by_topic[topic], candidate.element)
    channels = tuple(
        channel
        for channel, like in sources.items()
        if like.row.name == source.row.name and like.columns == source.columns
    )
    if candidate.is_planned:
        findings.append(found("PLANNED", "base", where=topic, name=candidate.name))
    if remark := source.row.remark:
        findings.append(Finding("TOPICS_CHOSEN", f"{candidate.name}: {remark}", topic))
    if not source.has_header:
        findings.append(found("LOG_TIME_USED", "no_header", say="type", type=source.row.name))
    if source.is_transform:
        parent, child = (frame.lstrip("/") for frame in candidate.frames)
        robot = replace(robot, world_frame=parent, base_frame=child)
        if "footprint" in child:
            text = f"{child} is the base's projection on the ground: height, roll and pitch are "
            findings.append(Finding("TOPICS_CHOSEN", f"{text}those of the ground", topic))
    return ChosenBase(robot, channels, Base(source, candidate.element))


def _options(candidates: Sequence[BaseCandidate]) -> str:
    """Return the words that choose some candidates."""
    words = [
        f"--odom-topic {each.name}{' (planned)' if each.is_planned else ''}"
        for each in candidates[:_MOST_OFFERED]
    ]
    more = len(candidates) - len(words)
    return ", ".join(words) + (f" and {more} more" if more else "")
