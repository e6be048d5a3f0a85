"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, choices, path_source
from dogbot_logtool.reader.messages.message_type import MessageType
from dogbot_logtool.reader.messages.messages import without_sender
from dogbot_logtool.reader.messages.others import is_static
from dogbot_logtool.reader.messages.source import Source, Topic
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import (
    first_messages,
    require_topic,
    split_topic,
    topics_of,
)
from dogbot_logtool.robot.words import PLANNED, VOCABULARY, texts_of, word_set

_MOST_OFFERED: Final = 3
_MOST_LISTED: Final = 12
_WORLDS: Final = ("odom", "world", "map", "odom_combined", "vision", "earth", "mocap")
"""Frames that stand still, the best first."""
BASES: Final = ("base_link", "base", "trunk", "torso", "pelvis", "body", "base_footprint")
"""Frames of a robot's base, the best first."""
_SCENERY: Final = word_set("ground_plane ground sun floor world terrain")
_BASE_WORDS: Final = word_set(
    "base body trunk torso pelvis robot odom odometry localization localisation mocap "
    "vicon optitrack estimator estimate estimated estimation"
)
"""Words of topics whose poses are the base's; a topic that is just called pose is one, too."""
_OTHER_WORDS: Final = PLANNED | word_set(
    "initialpose initial set footprint foot feet leg hand arm camera object marker obstacle "
    "frame actor ball box calibration door human people person table wall wand"
)
"""Words of topics whose poses are something else, or not measured."""
_CURRENT_WORDS: Final = word_set("curr current measured actual")
_NO_NAMES: Final = (
    _BASE_WORDS
    | VOCABULARY
    | word_set(
        "ground truth gazebo gz sim simulation vrpn node slam lio camera imu visual hardware pose "
        "tf map world fast lidar ekf ukf kf highstate lowstate sport control controller"
    )
)
"""Words at the beginning of topics that are no robot's name."""
_SURE, _PERHAPS, _NEVER = 0, 1, 2


class _Candidate(NamedTuple):
    """Poses that may be the base's."""

    topic: Topic
    rank: tuple[int, ...] = (_SURE,)
    """Whether they surely are, perhaps, or never; then what sorts those of a topic."""
    frames: tuple[str, ...] = ()
    """Of a transform, parent and child."""

    @property
    def row(self) -> MessageType:
        """What is known of the type of the messages."""
        return self.topic.source.row

    @property
    def is_planned(self) -> bool:
        """Whether its poses are what a planner wants."""
        words = texts_of(self.topic.topic)
        always = self.row.planned == "always" and words.isdisjoint(_CURRENT_WORDS)
        return always or not words.isdisjoint(PLANNED)

    @property
    def robot(self) -> str:
        """What tells several robots' poses of one type apart; empty: they are all the base's."""
        if self.topic.source.is_transform:
            return self.frames[1].lstrip("/").rpartition("/")[0]
        return self.topic.name if self.row.anything or self.frames else ""


def choose_base(
    log: Log, robot: Robot, findings: list[Finding], feet: Collection[str], *, is_asked: bool
) -> tuple[Robot, Topic | None]:
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
            return _chosen(robot, _named(log, robot, named), findings)
    except (CallError, LogError):
        if is_asked:
            raise
    moving = [each for each in topics_of(log, "base") if not is_static(each.channels[0])]
    every = [pose for topic in moving for pose in _poses_in(log, robot, topic)]
    likely = [each for each in every if each.rank[0] != _NEVER]
    robots = {_namespace_of(topic) for topic in feet}
    whose = robots.pop() if len(robots) == 1 else ""
    names = [each.topic.topic for each in likely]
    foreign = [name for name in names if whose and _namespace_of(name) not in {whose, ""}]
    own = _sorted([each for each in likely if each.topic.topic not in foreign])
    if foreign:
        told = {"topics": listed(foreign), "own": listed([each.topic.name for each in own])}
        case = () if own else ("alone",)
        findings.append(found("POSE_OTHER_ROBOT", *case, where=foreign[0], whose=whose, **told))
    if not own or own[0].rank[0] != _SURE:
        is_there = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
        poses = f", unless these poses are the base's: {_options(own)}" if own else ""
        findings.append(found("NO_BASE", say="unread" if is_there else "plain", poses=poses))
        return robot, None
    best, *others = own
    text = f"the base's poses are taken from {best.topic.name} ({best.row.name})"
    text += f", since the robot's {named} is missing or cannot be used" if named else ""
    text += f"; there are also {_options(others)}" if others else ""
    findings.append(Finding("TOPICS_CHOSEN", text, best.topic.topic))
    return _chosen(robot, best, findings)


def _named(log: Log, robot: Robot, name: str) -> _Candidate:
    """Return the poses that the user or the robot's file names.

    Raises:
        CallError: the log has none of that name; with what it has.
        LogError: it has, but they cannot be decoded.
    """
    topic, element = split_topic(name, log.channels_by_topic)
    if not element or topic not in log.channels_by_topic:
        require_topic(log, "--odom-topic", topic, "base")
    told = next((each for each in topics_of(log, "base") if each.name == topic), None)
    where = f"{name_of(log.source.path)}: --odom-topic: {topic}"
    if told is not None and told.source.row.choose:
        every, element = _sorted(_poses_in(log, robot, told)), element.lstrip("/")
        for each in every:
            if each.topic.element == element if element else each.rank[0] == _SURE:
                return each
        known = listed(sorted(each.topic.element for each in every), _MOST_LISTED) or "none"
        what = element or f"pose that is surely the base's, so {topic}:NAME names one"
        raise CallError(f"{where} has no {what}; it has {known}")
    if told is not None and not element:
        return _Candidate(told)
    channels = log.channels_by_topic[topic]
    own = [c for c in channels if without_sender(c) == without_sender(channels[0])]
    try:
        return _Candidate(Topic(path_source(own[0], element), tuple(own), element))
    except DefinitionError as reason:
        raise CallError(f"{where}: {reason}") from None


def _chosen(
    robot: Robot, candidate: _Candidate, findings: list[Finding]
) -> tuple[Robot, Topic | None]:
    """Return what is read of a candidate, with findings about what its poses are."""
    topic, row = candidate.topic, candidate.row
    if candidate.is_planned:
        findings.append(found("PLANNED", "base", where=topic.topic, name=topic.name))
    if row.remark:
        findings.append(Finding("TOPICS_CHOSEN", f"{topic.name}: {row.remark}", topic.topic))
    if not topic.source.has_header:
        findings.append(found("LOG_TIME_USED", "no_header", say="type", type=row.name))
    if topic.source.is_transform:
        parent, child = (frame.lstrip("/") for frame in candidate.frames)
        robot = replace(robot, world_frame=parent, base_frame=child)
        if "footprint" in child:
            text = f"{child} is the base's projection on the ground: height, roll and pitch are "
            findings.append(Finding("TOPICS_CHOSEN", f"{text}those of the ground", topic.topic))
    return robot, topic


def _options(candidates: Sequence[_Candidate]) -> str:
    """Return the words that choose some candidates."""
    planned = (" (planned)" if each.is_planned else "" for each in candidates)
    words = [
        f"--odom-topic {each.topic.name}{which}"
        for each, which in zip(candidates, planned, strict=True)
    ]
    return listed(words, _MOST_OFFERED)


# --- by types and names --------------------------------------------------------------------------


def _poses_in(log: Log, robot: Robot, topic: Topic) -> list[_Candidate]:
    """Return what a topic's messages hold poses of; where they list several, the first ones."""
    row = topic.source.row
    if row.choose:
        frames: dict[str, tuple[str, ...]] = {}
        for channel in topic.channels:
            for messages in first_messages(log, channel, topic.source.columns):
                frames |= choices(topic.source, messages)
        return [
            _Candidate(topic._replace(element=name), _rank(parts, robot, topic.source), parts)
            for name, parts in sorted(frames.items())
        ]
    words = texts_of(topic.name)
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    is_other = row.anything and not (named and words.isdisjoint(_OTHER_WORDS))
    # Such states have the feet relative to the base, whose own pose is zero.
    is_other |= not row.anything and topic.name.endswith("body_frame")
    return [_Candidate(topic, (_PERHAPS if row.on_request or is_other else _SURE,))]


def _rank(parts: Sequence[str], robot: Robot, source: Source) -> tuple[int, ...]:
    """Rank listed poses by their names; those of scenery and of arms are never the base's."""
    bases = ((robot.base_frame or "").rpartition("/")[2].lower(), *BASES)
    names = [part.rpartition("/")[2].lower() for part in parts]
    if source.is_transform:
        world, child = names
        if world not in _WORLDS or child in _WORLDS:
            return (_NEVER,)
        doubt = _SURE if child in bases else _PERHAPS
        return doubt, (*bases, child).index(child), _WORLDS.index(world)
    model, _, link = parts[0].lower().partition("::")
    if model in _SCENERY:
        return (_NEVER,)
    if not source.row.name.endswith("LinkStates"):
        return (_SURE,)
    return _SURE if link in bases else _PERHAPS, (*bases, link).index(link)


def _sorted(candidates: Sequence[_Candidate]) -> list[_Candidate]:
    """Sort poses, the best first; of two robots' of one type, none is surely the base's."""
    robots: dict[str, set[str]] = {}
    for each in candidates:
        if each.rank[0] == _SURE:
            robots.setdefault(each.row.name, set()).add(each.robot)
    several = {name for name, own in robots.items() if len(own) > 1}
    types = types_of("base")
    ranked = []
    for each in candidates:
        doubt, *rank = each.rank
        doubt = max(doubt, _PERHAPS) if each.row.name in several else doubt
        order = doubt, each.is_planned, types.index(each.row.name), rank
        ranked.append((order, each._replace(rank=(doubt, *rank))))
    return [each for _, each in sorted(ranked, key=lambda one: one[0])]


def _namespace_of(topic: str) -> str:
    """Return the first part of a topic if it may be a robot's name; else nothing."""
    first, *rest = topic.strip("/").split("/")
    return first.lower() if rest and texts_of(first) - _NO_NAMES else ""
