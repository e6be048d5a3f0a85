"""Poses that may be the base's, by their types and names: surely, perhaps, or never."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Final

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.field_path import every_field
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, choices, path_source
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.others import is_static
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import first_messages, message_count, topic_words
from dogbot_logtool.robot.words import VOCABULARY

_MOST_TYPES: Final = 500
_DEEPEST: Final = 4
"""Messages within messages that are looked into."""
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


def sources_at(channels: Iterable[Channel], element: str) -> tuple[dict[Channel, Source], str]:
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


def base_candidates(log: Log, robot: Robot, feet: Collection[str]) -> Iterator[BaseCandidate]:
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
                of_type += elements_of(log, robot, topic, source)
            else:
                rank = _rank_of_topic(log, topic, source)
                of_type.append(BaseCandidate(topic, source, rank=rank))
        yield from (each for each in settled(of_type, feet) if each.rank[0] < _NEVER)
    unknown = _in_unknown_messages(log)
    yield from sorted(unknown, key=lambda each: topic_words(each.name).isdisjoint(_BASE_WORDS))


def settled(of_type: Sequence[BaseCandidate], feet: Collection[str]) -> list[BaseCandidate]:
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
                sources, _ = sources_at([channel], path)
                for source in sources.values():
                    yield BaseCandidate(topic, source, path, (_PERHAPS,))


def elements_of(log: Log, robot: Robot, topic: str, source: Source) -> list[BaseCandidate]:
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


def is_of_another_robot(name: str, feet: Collection[str]) -> bool:
    """Tell whether a topic's namespace is the name of another robot than that of the feet."""
    own, other = {namespace_of(each) for each in feet}, namespace_of(name)
    return len(own) == 1 and bool(other) and own.isdisjoint((other, ""))


def namespace_of(topic: str) -> str:
    """Return the first part of a topic if it may be a robot's name; else nothing."""
    first, *rest = topic.strip("/").lower().split("/")
    unknown = frozenset(re.findall(r"[a-z]+", first)) - _NO_NAMES or re.search(r"\d", first)
    return first if rest and unknown else ""


def likely_base(candidates: Sequence[BaseCandidate], feet: Collection[str]) -> str:
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
