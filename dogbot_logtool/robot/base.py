"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, Base, choices, path_source
from dogbot_logtool.reader.messages.others import is_static
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import (
    first_messages,
    message_count,
    readable_source,
    require_topic,
    split_topic,
)
from dogbot_logtool.robot.words import VOCABULARY, texts_of, word_set

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
_OTHER_WORDS: Final = word_set(
    "goal initialpose initial des desired ref reference cmd command plan planned planner "
    "target setpoint set footprint foot feet leg hand arm camera object marker obstacle "
    "frame actor ball box calibration door human people person table wall wand"
)
"""Words of topics whose poses are something else, or not measured."""
_PLANNED_WORDS: Final = word_set("plan planned planner trajectory des desired ref")
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


class ChosenBase(NamedTuple):
    """The base of a log, and the robot with the frames that it names."""

    robot: Robot
    channels: tuple[Channel, ...] = ()
    base: Base | None = None
    offered: str = ""
    """Poses that are likely the base's and are not taken unasked, as ``--odom-topic`` takes them;
    empty: there are none, or a base is known."""


class _Candidate(NamedTuple):
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
    def is_planned(self) -> bool:
        """Whether its poses are what a planner wants."""
        words = texts_of(self.topic)
        always = self.source.row.planned == "always" and words.isdisjoint(_CURRENT_WORDS)
        return always or not words.isdisjoint(_PLANNED_WORDS)

    @property
    def robot(self) -> str:
        """What tells several robots' poses of one type apart; empty: they are all the base's."""
        if self.source.is_transform:
            return self.frames[1].lstrip("/").rpartition("/")[0]
        return self.name if self.source.row.anything or self.frames else ""


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
    every = sorted(_candidates(log, robot, feet), key=lambda each: (each.rank[0], each.is_planned))
    own = [each for each in every if not _is_of_another_robot(each.topic, feet)]
    if foreign := [each.topic for each in every if each not in own]:
        case, say = ((), "plain") if own else (("alone",), "alone")
        names, whose = listed([each.name for each in own]), _namespace_of(next(iter(feet)))
        told = {"topics": listed(foreign), "whose": whose, "own": names}
        findings.append(found("POSE_OTHER_ROBOT", *case, where=foreign[0], say=say, **told))
    if not own or own[0].rank[0] != _SURE:
        is_there = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
        poses = f", unless these poses are the base's: {_options(own)}" if own else ""
        findings.append(found("NO_BASE", say="unread" if is_there else "plain", poses=poses))
        return ChosenBase(robot, offered=_likely_base(own, feet))
    best, *others = own
    text = f"the base's poses are taken from {best.name} ({best.source.row.name})"
    text += f", since the robot's {named} is missing or cannot be used" if named else ""
    text += f"; there are also {_options(others)}" if others else ""
    findings.append(Finding("TOPICS_CHOSEN", text, best.topic))
    return _chosen(log, robot, best, findings)


def _named(log: Log, robot: Robot, name: str) -> _Candidate:
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
        return _Candidate(topic, source, element)
    every, element = _settled(_elements_of(log, robot, topic, source), ()), element.lstrip("/")
    for each in every:
        if each.element == element if element else each.rank[0] == _SURE:
            return each
    known = listed(sorted(each.element for each in every), _MOST_LISTED) or "none"
    if element:
        raise CallError(f"{where} has no {element}; it has {known}")
    raise CallError(
        f"{where} is of type {source.row.name}, and which of its poses is the "
        f"base's is not known: name one as {topic}:NAME; it has {known}"
    )


def _chosen(log: Log, robot: Robot, candidate: _Candidate, findings: list[Finding]) -> ChosenBase:
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


def _options(candidates: Sequence[_Candidate]) -> str:
    """Return the words that choose some candidates."""
    planned = (" (planned)" if each.is_planned else "" for each in candidates)
    words = [
        f"--odom-topic {each.name}{note}" for each, note in zip(candidates, planned, strict=True)
    ]
    return listed(words, _MOST_OFFERED)


def _sources_at(channels: Sequence[Channel], element: str) -> tuple[dict[Channel, Source], str]:
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


# --- by types and names --------------------------------------------------------------------------


def _candidates(log: Log, robot: Robot, feet: Collection[str]) -> Iterator[_Candidate]:
    """Yield the poses that may be the base's, those of better types first."""
    by_type: dict[str, dict[str, Source]] = {name: {} for name in types_of("base")}
    for channel in log.channels.values():
        source = readable_source(channel, "base")
        if source and not is_static(channel):
            by_type[source.row.name].setdefault(channel.topic, source)
    for sources in by_type.values():
        of_type: list[_Candidate] = []
        for topic, source in sorted(sources.items()):
            if source.row.choose:
                of_type += _elements_of(log, robot, topic, source)
            else:
                of_type.append(_Candidate(topic, source, rank=_rank_of_topic(log, topic, source)))
        yield from (each for each in _settled(of_type, feet) if each.rank[0] != _NEVER)


def _settled(of_type: Sequence[_Candidate], feet: Collection[str]) -> list[_Candidate]:
    """Sort poses of one type; of two robots', or of two objects', none is surely the base's."""
    sure = [each for each in of_type if each.rank[0] == _SURE]
    several = any(each.robot or each.source.row.name == ODOMETRY_TYPE for each in sure)
    same = _of_same_robot(sure, feet if several else ())
    is_clear = len({each.robot for each in same}) == 1
    doubtful = [each for each in sure if not (is_clear and each in same)]
    ranked = sorted(of_type, key=lambda each: each.rank)
    return [
        each._replace(rank=(_PERHAPS, *each.rank[1:])) if each in doubtful else each
        for each in ranked
    ]


def _rank_of_topic(log: Log, topic: str, source: Source) -> tuple[int, ...]:
    """Rank the poses that each message of a topic has one of."""
    if source.row.name == ODOMETRY_TYPE:
        return _SURE, -message_count(log, topic), len(topic)
    words = texts_of(topic)
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    is_other = source.row.anything and not (named and words.isdisjoint(_OTHER_WORDS))
    # Such states have the feet relative to the base, whose own pose is zero.
    is_other |= not source.row.anything and topic.endswith("body_frame")
    return (_PERHAPS if source.row.on_request or is_other else _SURE,)


def _elements_of(log: Log, robot: Robot, topic: str, source: Source) -> list[_Candidate]:
    """Return what a topic's first messages hold poses of."""
    frames: dict[str, tuple[str, ...]] = {}
    for channel in log.channels_by_topic[topic]:
        if source_of(channel, "base") is source:
            for messages in first_messages(log, channel, source.columns):
                frames |= choices(source, messages)
    return [
        _Candidate(topic, source, name, _rank(parts, robot, source), parts)
        for name, parts in sorted(frames.items())
    ]


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


def _of_same_robot(candidates: Sequence[_Candidate], feet: Collection[str]) -> list[_Candidate]:
    """Return those of some candidates that share the most words with the topics of all feet.

    Where a log has several robots, as in ``/a1/odom`` and ``/a2/odom``, these belong to the one
    whose feet are used.
    """
    shared = frozenset.intersection(*map(texts_of, feet)) if feet else frozenset()
    counts = [len(shared & texts_of(each.name)) for each in candidates]
    return [each for each, count in zip(candidates, counts, strict=True) if count == max(counts)]


def _is_of_another_robot(name: str, feet: Collection[str]) -> bool:
    """Tell whether a topic's namespace is the name of another robot than that of the feet."""
    own, other = {_namespace_of(each) for each in feet}, _namespace_of(name)
    return len(own) == 1 and bool(other) and own.isdisjoint((other, ""))


def _namespace_of(topic: str) -> str:
    """Return the first part of a topic if it may be a robot's name; else nothing."""
    first, *rest = topic.strip("/").split("/")
    return first.lower() if rest and texts_of(first) - _NO_NAMES else ""


def _likely_base(candidates: Sequence[_Candidate], feet: Collection[str]) -> str:
    """Return the name of the poses to offer; empty: there are none.

    These are the only ones, or the first of the feet's robot that are named like a base.
    """
    measured = [
        each for each in candidates if not (each.is_planned or texts_of(each.name) & _OTHER_WORDS)
    ]
    named = [each for each in measured if texts_of(each.name) & _BASE_WORDS]
    best = _of_same_robot(named, feet) or (measured if len(measured) == 1 else [])
    return best[0].name if best else ""
