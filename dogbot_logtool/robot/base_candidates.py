"""Poses that may be the base's, the best first."""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import all_finite
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.messages.bases import (
    ODOMETRY_TYPE,
    Base,
    choices,
    path_source,
)
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.source import (
    BASE_TYPES,
    Source,
    base_source,
    base_type,
)
from dogbot_logtool.reader.messages.transforms import TRANSFORM_TYPES, is_static
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.reader.wanted import Wanted
from dogbot_logtool.robot.first_messages import first_messages
from dogbot_logtool.robot.readable import message_count, why_unreadable
from dogbot_logtool.robot.robot import Robot

_DEEPEST: Final = 4
"""Messages within messages that are looked into."""
_MOST_TYPES: Final = 500


def _topic_words(name: str) -> frozenset[str]:
    """Return the words of a topic's name, in small letters."""
    return frozenset(re.findall(r"[a-z0-9]+", name.lower()))


_WORLDS: Final = ("odom", "world", "map", "odom_combined", "vision", "earth", "mocap")
"""Frames that stand still, the best first."""
BASES: Final = ("base_link", "base", "trunk", "torso", "pelvis", "body", "base_footprint")
"""Frames of a robot's base, the best first."""
_BASE_WORDS: Final = _topic_words(
    "base body trunk torso pelvis robot odom odometry localization localisation mocap "
    "vicon optitrack estimator estimate estimated estimation"
)
"""Words of topics whose poses are the base's; a topic that is just called pose is one, too."""
_OTHER_WORDS: Final = _topic_words(
    "goal initialpose initial des desired ref reference cmd command plan planned planner "
    "target setpoint set footprint foot feet leg hand arm camera object marker obstacle "
    "frame actor ball box calibration door human people person table wall wand"
)
"""Words of topics whose poses are something else, or not measured."""
_PLANNED_WORDS: Final = _topic_words("plan planned planner trajectory des desired ref")
_CURRENT_WORDS: Final = frozenset(("curr", "current", "measured", "actual"))
_MOVING_M: Final = 0.05
"""m within which poses stand still, as those of scenery do."""
_MOST_SEEN: Final = 20
"""Candidates whose poses are looked at."""
_SCENERY: Final = frozenset(("ground_plane", "ground", "sun", "floor", "world", "terrain"))
_NEVER: Final = 2


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

    @property
    def is_planned(self) -> bool:
        """Whether its poses are what a planner wants."""
        words = _topic_words(self.topic)
        always = self.source.row.planned == "always" and words.isdisjoint(_CURRENT_WORDS)
        return always or not words.isdisjoint(_PLANNED_WORDS)


def _of_same_robot(names: Sequence[str], feet: Collection[str]) -> list[str]:
    """Return those of some names that share the most words with the topics of all feet.

    Where a log has several robots, as in ``/a1/odom`` and ``/a2/odom``, these belong to the one
    whose feet are used.
    """
    shared = frozenset.intersection(*map(_topic_words, feet)) if feet else frozenset()
    counts = [len(shared & _topic_words(name)) for name in names]
    return [name for name, count in zip(names, counts, strict=True) if count == max(counts)]


def likely_base(log: Log, candidates: Sequence[BaseCandidate], feet: Collection[str]) -> str:
    """Return the name of the candidate that is most likely the base's; empty: none is likely.

    It is of the robot of the feet, then moves, then is named like a base.
    """
    possible = [
        each
        for each in candidates
        if not each.is_planned and _topic_words(each.name).isdisjoint(_OTHER_WORDS)
    ][:_MOST_SEEN]
    same = _of_same_robot([each.name for each in possible], feet)
    best: list[tuple[bool, bool, bool, str]] = []
    for each in possible:
        stands, unnamed = not _moves(log, each), _topic_words(each.name).isdisjoint(_BASE_WORDS)
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
        of_type: list[BaseCandidate] = []
        for topic, source in _sources(log, type_name).items():
            if source.lists_poses:
                of_type += elements_of(log, robot, topic, source, feet)
            else:
                of_type.append(BaseCandidate(topic, source, "", _is_base(topic, source)))
        # Of two robots' poses, or two objects', none is surely the base's.
        sure = [each.name for each in of_type if each.is_sure]
        if of_type and (of_type[0].source.anything or type_name == ODOMETRY_TYPE):
            sure = _of_same_robot(sure, feet)
            sure = [] if of_type[0].source.anything and len(sure) > 1 else sure
        if type_name == ODOMETRY_TYPE:
            of_type.sort(key=lambda each: (-message_count(log, each.topic), len(each.topic)))
        found += [replace(each, is_sure=each.name in sure) for each in of_type]
    found += _in_unknown_messages(log)
    return sorted(found, key=lambda each: (not each.is_sure, each.is_planned))


def _sources(log: Log, type_name: str) -> Mapping[str, Source]:
    """Return the topics of a type whose poses can be read, sorted."""
    found: dict[str, Source] = {}
    for channel in log.channels.values():
        if base_type(channel.type_name) == type_name and not is_static(channel):
            try:
                found.setdefault(channel.topic, base_source(channel))
            except DefinitionError:
                continue
    return dict(sorted(found.items()))


def _is_base(topic: str, source: Source) -> bool:
    """Tell whether a topic's poses are surely the base's."""
    if source.row.on_request:
        return False
    if not source.anything:
        # Such states have the feet relative to the base, whose own pose is zero.
        return not topic.endswith("body_frame")
    words = _topic_words(topic)
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    return named and words.isdisjoint(_OTHER_WORDS)


def elements_in(log: Log, topic: str, source: Source) -> frozenset[str]:
    """Return what a topic's messages hold poses of, by its first messages."""
    found: set[str] = set()
    for channel in log.channels_by_topic[topic]:
        if base_type(channel.type_name) == source.type_name and not why_unreadable(channel):
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
    best = _of_same_robot([name for rank, name in ranked if rank[0] == 0], feet)
    # Two robots' bases: none is surely the one that is meant.
    bases = {frame_pair(name)[1] for name in best} if source.is_transform else set(best)
    is_sure = len(bases) == len({base.rpartition("/")[2] for base in bases})
    is_sure = is_sure if source.is_transform else len(best) == 1
    return [
        BaseCandidate(topic, source, name, is_sure and name in best)
        for rank, name in ranked
        if rank[0] < _NEVER
    ]


def _rank(name: str, robot: Robot, source: Source) -> tuple[int, int, int]:
    """Return what sorts elements: 0 surely the base, 1 perhaps, 2 never; then by preference."""
    own = (robot.base_frame or "").rpartition("/")[2].lower()
    bases = (own, *BASES)
    if source.is_transform:
        parent, child = (frame.rpartition("/")[2].lower() for frame in frame_pair(name))
        if parent not in _WORLDS or child in _WORLDS:
            return _NEVER, 0, 0
        return int(child not in bases), _index(bases, child), _WORLDS.index(parent)
    model, _, link = name.lower().partition("::")
    if model in _SCENERY:
        return _NEVER, 0, 0
    is_link = source.type_name.endswith("LinkStates")
    return int(is_link and link not in bases), _index(bases, link) if is_link else 0, 0


def _index(names: Sequence[str], name: str) -> int:
    return names.index(name) if name in names else len(names)


def frame_pair(pair: str) -> tuple[str, str]:
    """Split a pair of frames, whose names may hold slashes, where the child most likely begins."""
    parts = pair.split("/")
    splits = [("/".join(parts[:cut]), "/".join(parts[cut:])) for cut in range(1, len(parts))]

    def likely(split: tuple[str, str]) -> tuple[bool, bool]:
        parent, child = (frame.rpartition("/")[2].lower() for frame in split)
        return parent not in _WORLDS, child not in BASES

    return min(splits or [(pair, "")], key=likely)


def _in_unknown_messages(log: Log) -> list[BaseCandidate]:
    """Return poses in messages of unknown types, those named like the base's first."""
    found: list[BaseCandidate] = []
    unknown = {
        channel.topic: channel
        for channel in log.channels.values()
        if not base_type(channel.type_name) and channel.type_name not in TRANSFORM_TYPES
    }
    for topic, channel in [*unknown.items()][:_MOST_TYPES]:
        try:
            paths = [*_messages_in("", definition_of(channel), _DEEPEST)]
        except DefinitionError:
            continue
        for path in paths:
            try:
                source = path_source(channel, path)
            except DefinitionError:
                continue
            if _topic_words(path).isdisjoint(_OTHER_WORDS):
                found.append(BaseCandidate(topic, source, path, is_sure=False))
    return sorted(found, key=lambda each: _topic_words(each.name).isdisjoint(_BASE_WORDS))


def _messages_in(path: str, struct: Struct, depth: int) -> Iterator[str]:
    """Yield the paths of messages within a message."""
    for name, kind in struct.fields if depth else ():
        if isinstance(kind, Struct):
            inner = f"{path}.{name}".lstrip(".")
            yield inner
            yield from _messages_in(inner, kind, depth - 1)
