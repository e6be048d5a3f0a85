"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.field_path import every_field
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, Base, choices, path_source
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.others import is_static
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import (
    first_messages,
    message_count,
    require_topic,
    split_topic,
    topic_words,
)
from dogbot_logtool.robot.words import VOCABULARY

_MOST_TYPES: Final = 500
_DEEPEST: Final = 4
"""Messages within messages that are looked into."""
_MOST_OFFERED: Final = 3
_MOST_LISTED: Final = 12
_WORLDS: Final = ("odom", "world", "map", "odom_combined", "vision", "earth", "mocap")
"""Frames that stand still, the best first."""
BASES: Final = ("base_link", "base", "trunk", "torso", "pelvis", "body", "base_footprint")
"""Frames of a robot's base, the best first."""
_SCENERY: Final = frozenset(("ground_plane", "ground", "sun", "floor", "world", "terrain"))
_BASE_WORDS: Final = topic_words(
    "base body trunk torso pelvis robot odom odometry localization localisation mocap "
    "vicon optitrack estimator estimate estimated estimation"
)
"""Words of topics whose poses are the base's; a topic that is just called pose is one, too."""
_OTHER_WORDS: Final = topic_words(
    "goal initialpose initial des desired ref reference cmd command plan planned planner "
    "target setpoint set footprint foot feet leg hand arm camera object marker obstacle "
    "frame actor ball box calibration door human people person table wall wand"
)
"""Words of topics whose poses are something else, or not measured."""
_PLANNED_WORDS: Final = topic_words("plan planned planner trajectory des desired ref")
_CURRENT_WORDS: Final = topic_words("curr current measured actual")
_NO_NAMES: Final = (
    _BASE_WORDS
    | VOCABULARY
    | topic_words(
        "ground truth gazebo gz sim simulation vrpn node slam lio camera imu visual hardware pose "
        "tf map world fast lidar ekf ukf kf highstate lowstate sport control controller"
    )
)
"""Words at the beginning of topics that are no robot's name."""
_SURE, _PERHAPS, _NEVER = 0, 1, 2


@dataclass(frozen=True, slots=True)
class BaseCandidate:
    """Poses that may be the base's."""

    topic: str
    source: Source
    element: str = ""
    rank: tuple[int, ...] = (_SURE,)
    """Whether they surely are, perhaps, or never; then what sorts those of a type."""
    frames: tuple[str, ...] = ()
    """Of a transform, parent and child."""

    @property
    def name(self) -> str:
        """The name as ``--odom-topic`` takes it."""
        return f"{self.topic}:{self.element}" if self.element else self.topic

    @property
    def is_sure(self) -> bool:
        """Whether they are taken without asking, if nothing better is there."""
        return self.rank[0] == _SURE

    @property
    def is_planned(self) -> bool:
        """Whether its poses are what a planner wants."""
        words = topic_words(self.topic)
        always = self.source.row.planned == "always" and words.isdisjoint(_CURRENT_WORDS)
        return always or not words.isdisjoint(_PLANNED_WORDS)

    @property
    def robot(self) -> str:
        """What tells several robots' poses of one type apart; empty: they are all the base's."""
        if self.source.is_transform:
            return self.frames[1].lstrip("/").rpartition("/")[0]
        return self.name if self.source.row.anything or self.frames else ""


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
        _candidates(log, robot, feet), key=lambda each: (not each.is_sure, each.is_planned)
    )
    own = [each for each in every if not _is_of_another_robot(each.topic, feet)]
    if foreign := [each.topic for each in every if each not in own]:
        case, say = ((), "plain") if own else (("alone",), "alone")
        names, whose = listed([each.name for each in own]), _namespace(next(iter(feet)))
        told = {"topics": listed(foreign), "whose": whose, "own": names}
        findings.append(found("POSE_OTHER_ROBOT", *case, where=foreign[0], say=say, **told))
    best = own[0] if own and own[0].is_sure else None
    others = own[1:] if best else own
    if best is None:
        is_there = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
        poses = f", unless these poses are the base's: {_options(others)}" if others else ""
        findings.append(found("NO_BASE", say="unread" if is_there else "plain", poses=poses))
        return ChosenBase(robot, offered=_likely(others, feet))
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
    sources, reason = _sources_at(log.channels_by_topic[topic], element)
    if not sources:
        raise CallError(f"{where}: {reason}")
    source = next(iter(sources.values()))
    if not source.row.choose:
        return BaseCandidate(topic, source, element)
    every = _settled(_elements(log, robot, topic, source), ())
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
    sources, _ = _sources_at(log.channels_by_topic[topic], candidate.element)
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


# --- candidates ----------------------------------------------------------------------------------


def _sources_at(channels: Iterable[Channel], element: str) -> tuple[dict[Channel, Source], str]:
    """Return how those channels are read that have an element, and why others are not."""
    sources, reason = {}, "it holds no poses that are known"
    for channel in channels:
        source = source_of(channel, "base")
        try:
            if element and not (source and source.row.choose):
                source = path_source(channel, element)
        except DefinitionError as error:
            source, reason = None, str(error)
        if source is not None and not source.fault:
            sources[channel] = source
        reason = source.fault if source and source.fault else reason
    return sources, reason


def _candidates(log: Log, robot: Robot, feet: Collection[str]) -> Iterator[BaseCandidate]:
    """Yield the poses that may be the base's, those of better types first."""
    by_type: dict[str, dict[str, Source]] = {}
    for channel in log.channels.values():
        source = source_of(channel, "base")
        if source is not None and not source.fault and not is_static(channel):
            by_type.setdefault(source.row.name, {}).setdefault(channel.topic, source)
    for type_name in types_of("base"):
        of_type: list[BaseCandidate] = []
        for topic, source in sorted(by_type.get(type_name, {}).items()):
            if source.row.choose:
                of_type += _elements(log, robot, topic, source)
            else:
                rank = _rank_of_topic(log, topic, source)
                of_type.append(BaseCandidate(topic, source, rank=rank))
        yield from (each for each in _settled(of_type, feet) if each.rank[0] < _NEVER)
    unknown = _in_unknown_messages(log)
    yield from sorted(unknown, key=lambda each: topic_words(each.name).isdisjoint(_BASE_WORDS))


def _settled(of_type: Sequence[BaseCandidate], feet: Collection[str]) -> list[BaseCandidate]:
    """Sort poses of one type; of two robots', or of two objects', none is surely the base's."""
    sure = [each for each in of_type if each.is_sure]
    several = any(each.robot or each.source.row.name == ODOMETRY_TYPE for each in sure)
    same = _of_same_robot([each.name for each in sure], feet if several else ())
    is_clear = len({each.robot for each in sure if each.name in same}) == 1
    found = []
    for each in sorted(of_type, key=lambda each: each.rank):
        is_doubtful = each.is_sure and not (is_clear and each.name in same)
        found.append(replace(each, rank=(_PERHAPS, *each.rank[1:])) if is_doubtful else each)
    return found


def _rank_of_topic(log: Log, topic: str, source: Source) -> tuple[int, ...]:
    """Rank the poses that each message of a topic has one of."""
    if source.row.name == ODOMETRY_TYPE:
        return _SURE, -message_count(log, topic), len(topic)
    words = topic_words(topic)
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    is_other = source.row.anything and not (named and words.isdisjoint(_OTHER_WORDS))
    # Such states have the feet relative to the base, whose own pose is zero.
    is_other |= not source.row.anything and topic.endswith("body_frame")
    return (_PERHAPS if source.row.on_request or is_other else _SURE,)


def _in_unknown_messages(log: Log) -> Iterator[BaseCandidate]:
    """Yield poses in messages of unknown types."""
    unknown = {c.topic: c for c in log.channels.values() if source_of(c, "base") is None}
    for topic, channel in islice(unknown.items(), _MOST_TYPES):
        try:
            fields = list(every_field(definition_of(channel)))
        except DefinitionError:
            continue
        for path, kind in fields:
            is_message = isinstance(kind, Struct) and "[]" not in path
            if is_message and path.count(".") < _DEEPEST and not topic_words(path) & _OTHER_WORDS:
                sources, _ = _sources_at([channel], path)
                for source in sources.values():
                    yield BaseCandidate(topic, source, path, (_PERHAPS,))


def _elements(log: Log, robot: Robot, topic: str, source: Source) -> list[BaseCandidate]:
    """Return what a topic's first messages hold poses of."""
    frames: dict[str, tuple[str, ...]] = {}
    for channel in log.channels_by_topic[topic]:
        if source_of(channel, "base") is source:
            for messages in first_messages(log, channel, source.columns):
                frames |= choices(source, messages)
    return [
        BaseCandidate(topic, source, name, _rank(parts, robot, source), parts)
        for name, parts in sorted(frames.items())
    ]


def _rank(parts: Sequence[str], robot: Robot, source: Source) -> tuple[int, ...]:
    """Rank listed poses by their names; those of scenery and of arms are never the base's."""
    bases = ((robot.base_frame or "").rpartition("/")[2].lower(), *BASES)
    names = [part.rpartition("/")[2].lower() for part in parts]
    if source.is_transform:
        if names[0] not in _WORLDS or names[1] in _WORLDS:
            return _NEVER, 0, 0
        return (
            int(names[1] not in bases),
            [*bases, names[1]].index(names[1]),
            _WORLDS.index(names[0]),
        )
    model, _, link = parts[0].lower().partition("::")
    if model in _SCENERY:
        return _NEVER, 0, 0
    if not source.row.name.endswith("LinkStates"):
        return _SURE, 0, 0
    return _SURE if link in bases else _PERHAPS, [*bases, link].index(link), 0


def _of_same_robot(names: Sequence[str], feet: Collection[str]) -> list[str]:
    """Return those of some names that share the most words with the topics of all feet.

    Where a log has several robots, as in ``/a1/odom`` and ``/a2/odom``, these belong to the one
    whose feet are used.
    """
    shared = frozenset.intersection(*map(topic_words, feet)) if feet else frozenset()
    counts = [len(shared & topic_words(name)) for name in names]
    return [name for name, count in zip(names, counts, strict=True) if count == max(counts)]


def _is_of_another_robot(name: str, feet: Collection[str]) -> bool:
    """Tell whether a topic's namespace is the name of another robot than that of the feet."""
    own, other = {_namespace(each) for each in feet}, _namespace(name)
    return len(own) == 1 and bool(other) and own.isdisjoint((other, ""))


def _namespace(topic: str) -> str:
    """Return the first part of a topic if it may be a robot's name; else nothing."""
    first, *rest = topic.strip("/").lower().split("/")
    unknown = frozenset(re.findall(r"[a-z]+", first)) - _NO_NAMES or re.search(r"\d", first)
    return first if rest and unknown else ""


def _likely(candidates: Sequence[BaseCandidate], feet: Collection[str]) -> str:
    """Return the name of the poses to offer; empty: there are none.

    These are the only ones, or the first of the feet's robot that are named like a base.
    """
    measured = [
        each.name
        for each in candidates
        if not each.is_planned and topic_words(each.name).isdisjoint(_OTHER_WORDS)
    ]
    named = [name for name in measured if not topic_words(name).isdisjoint(_BASE_WORDS)]
    best = _of_same_robot(named, feet) or (measured if len(measured) == 1 else [])
    return next(iter(best), "")
