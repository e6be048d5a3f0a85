"""Poses that may be the base's, and which of them belong to the robot whose feet are used."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import all_finite
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import DefinitionError, LogError
from dogbot_logtool.io.storage import shown
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import Primitive, Struct
from dogbot_logtool.reader.messages.bases import Base, choices, path_source
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.source import BASE_TYPES, Source, base_source, base_type
from dogbot_logtool.reader.messages.transforms import TRANSFORM_TYPES, is_static
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.wanted import Wanted
from dogbot_logtool.robot.first_messages import first_messages
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics.readable import why_no_poses

_FORMS: Final = (("position", "orientation"), ("translation", "rotation"))
_DEEPEST: Final = 4
"""Messages within messages that are looked into."""
_MOST_TYPES: Final = 500


def topic_words(name: str) -> frozenset[str]:
    """Return the words of a topic's name, in small letters."""
    return frozenset(re.findall(r"[a-z0-9]+", name.lower()))


_WORLDS: Final = ("odom", "world", "map", "odom_combined", "vision", "earth", "mocap")
"""Frames that stand still, the best first."""
_BASES: Final = ("base_link", "base", "trunk", "torso", "pelvis", "body", "base_footprint")
"""Frames of a robot's base, the best first."""
_BASE_WORDS: Final = topic_words(
    "base body trunk torso pelvis robot odom odometry localization localisation mocap "
    "vicon optitrack estimator estimate estimated estimation"
)
"""Words of topics whose poses are the base's; a topic that is just called pose is one, too."""
OTHER_WORDS: Final = topic_words(
    "goal initialpose initial des desired ref reference cmd command plan planned planner "
    "target setpoint set footprint foot feet leg hand arm camera object marker obstacle "
    "frame actor ball box calibration door human people person table wall wand"
)
"""Words of topics whose poses are something else, or not measured."""
_PLANNED_WORDS: Final = topic_words("plan planned planner trajectory des desired ref")
_CURRENT_WORDS: Final = frozenset(("curr", "current", "measured", "actual"))
_MOVING_M: Final = 0.05
"""m within which poses stand still, as those of scenery do."""
_MOST_SEEN: Final = 20
"""Candidates whose poses are looked at."""
_SCENERY: Final = frozenset(("ground_plane", "ground", "sun", "floor", "world", "terrain"))


@dataclass(frozen=True, slots=True)
class BaseCandidate:
    """Poses that may be the base's."""

    topic: str
    source: Source
    element: str = ""
    is_sure: bool = True
    """Whether they are taken without asking, if nothing better is there."""

    @property
    def name(self) -> str:
        """The name as ``--odom-topic`` takes it."""
        return f"{self.topic}:{self.element}" if self.element else self.topic


def base_source_of(log: Log, topic: str) -> Source:
    """Return the source of the first channel of a topic that can be read.

    Raises:
        LogError: none can.
    """
    for channel in log.channels_by_topic.get(topic, ()):
        if base_type(channel.type_name) and not why_no_poses(channel):
            return base_source(channel)
    raise LogError(f"{shown(log.source.path)}: {topic} holds no poses that can be read")


def is_planned_base(candidate: BaseCandidate) -> bool:
    """Tell whether its poses are what a planner wants."""
    words = topic_words(candidate.topic)
    return (candidate.source.row.planned == "always" and words.isdisjoint(_CURRENT_WORDS)) or not (
        words.isdisjoint(_PLANNED_WORDS)
    )


def pose_topics(log: Log, types: Collection[str]) -> list[str]:
    """Return the topics of some types whose poses can be read, sorted."""
    return sorted(
        {
            channel.topic
            for channel in log.channels.values()
            if base_type(channel.type_name) in types and not why_no_poses(channel)
        }
    )


def of_same_robot(names: Sequence[str], feet: Collection[str]) -> list[str]:
    """Return those of some names that share the most words with the topics of all feet.

    Where a log has several robots, as in ``/a1/odom`` and ``/a2/odom``, these belong to the one
    whose feet are used.
    """
    shared = frozenset.intersection(*map(topic_words, feet)) if feet else frozenset()
    counts = [len(shared & topic_words(name)) for name in names]
    return [name for name, count in zip(names, counts, strict=True) if count == max(counts)]


def likely_base(log: Log, candidates: Sequence[BaseCandidate], feet: Collection[str]) -> str:
    """Return the name of the candidate that is most likely the base's; empty: none is likely.

    It is of the robot of the feet, then moves, then is named like a base.
    """
    possible = [
        each
        for each in candidates
        if not is_planned_base(each) and topic_words(each.name).isdisjoint(OTHER_WORDS)
    ][:_MOST_SEEN]
    same = of_same_robot([each.name for each in possible], feet)
    best: list[tuple[bool, bool, bool, str]] = []
    for each in possible:
        stands, unnamed = not _moves(log, each), topic_words(each.name).isdisjoint(_BASE_WORDS)
        if not (stands and unnamed):
            best.append((each.name not in same, stands, unnamed, each.name))
    return min(best, key=lambda one: one[:3])[3] if best else ""


def _moves(log: Log, candidate: BaseCandidate) -> bool:
    """Tell whether a candidate's poses move."""
    channels = log.channels_by_topic[candidate.topic]
    base = Base(candidate.source, candidate.element)
    ids = {channel.id for channel in channels}
    chunks = (c for c in log.chunks if c.counts is None or not ids.isdisjoint(c.counts))
    wanted = Wanted((), FootChannels((), {}), base, channels)
    position = read_recording(log, wanted, 1, spans=log.grouped(chunks)).recording.base.position
    position = position[all_finite(position)]
    return bool(len(position)) and bool(np.ptp(position, axis=0).max() > _MOVING_M)


def base_candidates(log: Log, robot: Robot, feet: Collection[str]) -> list[BaseCandidate]:
    """Return the poses that may be the base's, the best first.

    Args:
        log: the log.
        robot: its frames are looked for.
        feet: topics of its feet; of two robots' poses, these tell which are the base's.
    """
    found: list[BaseCandidate] = []
    for type_name in BASE_TYPES:
        topics = pose_topics(log, (type_name,))
        sure = []
        for topic in topics:
            source = base_source_of(log, topic)
            if any(is_static(channel) for channel in log.channels_by_topic[topic]):
                continue
            if source.lists_poses:
                sure += elements_of(log, robot, topic, source, feet)
            else:
                sure.append(BaseCandidate(topic, source, "", _is_base(topic, source)))
        # Of two robots' poses, or two objects', none is surely the base's.
        bases = [each.name for each in sure if each.is_sure]
        if sure and sure[0].source.anything:
            bases = of_same_robot(bases, feet)
            bases = [] if len(bases) > 1 else bases
        found += [replace(each, is_sure=each.name in bases) for each in sure]
    found += _in_unknown_messages(log)
    return sorted(found, key=lambda each: (not each.is_sure, is_planned_base(each)))


def _in_unknown_messages(log: Log) -> list[BaseCandidate]:
    """Return poses in messages of unknown types, those named like the base's first."""
    found = [
        BaseCandidate(channel.topic, path_source(channel, path), path, is_sure=False)
        for path, channel in pose_fields(log)
        if topic_words(path).isdisjoint(OTHER_WORDS)
    ]
    return sorted(found, key=lambda each: topic_words(each.name).isdisjoint(_BASE_WORDS))


def _is_base(topic: str, source: Source) -> bool:
    """Tell whether a topic's poses are surely the base's."""
    if source.row.on_request:
        return False
    if not source.anything:
        # Such states have the feet relative to the base, whose own pose is zero.
        return not topic.endswith("body_frame")
    words = topic_words(topic)
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    return named and words.isdisjoint(OTHER_WORDS)


def elements_in(log: Log, topic: str, source: Source) -> frozenset[str]:
    """Return what a topic's messages hold poses of, by its first messages."""
    channels = [
        channel
        for channel in log.channels_by_topic[topic]
        if base_type(channel.type_name) == source.type_name and not why_no_poses(channel)
    ]
    found: set[str] = set()
    for channel in channels:
        for messages in first_messages(log, channel, source.fields):
            found |= choices(source, messages)
    return frozenset(found)


def elements_of(
    log: Log, robot: Robot, topic: str, source: Source, feet: Collection[str] = ()
) -> list[BaseCandidate]:
    """Return the poses in a topic's messages that may be the base's, the best first.

    Args:
        log: the log.
        robot: its frames are looked for.
        topic: the topic.
        source: of its messages.
        feet: topics of the robot's feet; see `base_candidates`.
    """
    names = elements_in(log, topic, source)
    ranked = sorted((_rank(name, robot, source), name) for name in names)
    best = of_same_robot([name for rank, name in ranked if rank[0] == 0], feet)
    # Two robots' bases: none is surely the one that is meant.
    bases = {frame_pair(name)[1] if source.is_transform else name for name in best}
    if source.is_transform:
        leaf = {base.rpartition("/")[2] for base in bases}
        is_sure = len(bases) == len(leaf)
    else:
        is_sure = len(best) == 1
    return [
        BaseCandidate(topic, source, name, is_sure and name in best)
        for rank, name in ranked
        if rank[0] < _NEVER
    ]


_NEVER: Final = 2
_Rank = tuple[int, int, int]


def _rank(name: str, robot: Robot, source: Source) -> _Rank:
    """Return what sorts elements: 0 surely the base, 1 perhaps, 2 never; then by preference."""
    if source.is_transform:
        parent, child = (frame.rpartition("/")[2].lower() for frame in frame_pair(name))
        bases = ((robot.base_frame or "").rpartition("/")[2].lower(), *_BASES)
        if parent not in _WORLDS or child in _WORLDS:
            return _NEVER, 0, 0
        return (0 if child in bases else 1), _index(bases, child), _index(_WORLDS, parent)
    model, _, link = name.partition("::")
    if model.lower() in _SCENERY:
        return _NEVER, 0, 0
    if source.type_name.endswith("LinkStates"):
        bases = ((robot.base_frame or "").lower(), *_BASES)
        return (0, _index(bases, link.lower()), 0) if link.lower() in bases else (1, 0, 0)
    return 0, 0, 0


def _index(names: Iterable[str], name: str) -> int:
    known = list(names)
    return known.index(name) if name in known else len(known)


def frame_pair(pair: str) -> tuple[str, str]:
    """Split a pair of frames, whose names may hold slashes, where the child most likely begins."""
    parts = pair.split("/")
    splits = [("/".join(parts[:cut]), "/".join(parts[cut:])) for cut in range(1, len(parts))]

    def likely(split: tuple[str, str]) -> tuple[bool, bool]:
        parent, child = (frame.rpartition("/")[2].lower() for frame in split)
        return parent not in _WORLDS, child not in _BASES

    return min(splits or [(pair, "")], key=likely)


def pose_fields(log: Log) -> Iterator[tuple[str, Channel]]:
    """Yield the paths of single poses in messages of unknown types, with their channels."""
    seen: set[str] = set()
    for channel in log.channels.values():
        name = channel.type_name
        is_known = base_type(name) and not why_no_poses(channel)
        if is_known or name in TRANSFORM_TYPES or channel.topic in seen:
            continue
        if len(seen) == _MOST_TYPES:
            return
        seen.add(channel.topic)
        try:
            definition = definition_of(channel)
        except DefinitionError:
            continue
        yield from ((path, channel) for path in _poses("", definition, _DEEPEST) if path)


def _poses(path: str, struct: Struct, depth: int) -> Iterator[str]:
    if _is_pose(struct):
        yield path
        return
    for name, kind in struct.fields:
        if depth and isinstance(kind, Struct):
            yield from _poses(f"{path}.{name}" if path else name, kind, depth - 1)


def _is_pose(struct: Struct) -> bool:
    parts = dict(struct.fields)
    return any(
        _numbers(parts.get(position)) == ("x", "y", "z")
        and _numbers(parts.get(orientation)) == ("x", "y", "z", "w")
        for position, orientation in _FORMS
    )


def _numbers(field: object) -> tuple[str, ...]:
    """Return the names of a message's fields if all are numbers."""
    if not isinstance(field, Struct) or not all(isinstance(f, Primitive) for _, f in field.fields):
        return ()
    return tuple(name for name, _ in field.fields)
