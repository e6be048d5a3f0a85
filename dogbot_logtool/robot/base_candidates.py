"""Poses that may be the base's, the best first."""

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import all_finite
from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.decode.definition import Struct
from dogbot_logtool.reader.decode.field_path import every_field
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE, Base, choices, path_source
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.messages import definition_of
from dogbot_logtool.reader.messages.others import is_static
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.reader.wanted import Wanted
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import first_messages, message_count, read_wanted, topic_words
from dogbot_logtool.robot.words import VOCABULARY

_MOST_SEEN: Final = 20
"""Candidates whose poses are looked at."""
_MOST_TYPES: Final = 500
_DEEPEST: Final = 4
"""Messages within messages that are looked into."""
_MOVING_M: Final = 0.05
"""m within which poses stand still, as those of scenery do."""

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
    is_sure: bool = True
    """Whether they are taken without asking, if nothing better is there."""
    frames: tuple[str, ...] = ()
    """Of a transform, parent and child."""

    @property
    def name(self) -> str:
        """The name as ``--odom-topic`` takes it."""
        return f"{self.topic}:{self.element}" if self.element else self.topic

    @property
    def is_planned(self) -> bool:
        """Whether its poses are what a planner wants."""
        words = topic_words(self.topic)
        always = self.source.row.planned == "always" and words.isdisjoint(_CURRENT_WORDS)
        return always or not words.isdisjoint(_PLANNED_WORDS)


def sources_at(channels: Iterable[Channel], element: str) -> tuple[list[Source], str]:
    """Return how those channels are read that have an element, and why others are not."""
    found, reason = [], "it holds no poses that are known"
    for channel in channels:
        source = source_of(channel, "base")
        try:
            if element and not (source and source.row.choose):
                source = path_source(channel, element)
        except DefinitionError as error:
            source, reason = None, str(error)
        if source is not None and not source.fault:
            found.append(source)
        reason = source.fault if source and source.fault else reason
    return found, reason


def base_candidates(log: Log, robot: Robot, feet: Collection[str]) -> Iterator[BaseCandidate]:
    """Yield the poses that may be the base's, those of better types first."""
    by_type: dict[str, dict[str, Source]] = {}
    for channel in log.channels.values():
        source = source_of(channel, "base")
        if source is not None and not source.fault and not is_static(channel):
            by_type.setdefault(source.row.name, {}).setdefault(channel.topic, source)
    for type_name in types_of("base"):
        found: list[BaseCandidate] = []
        for topic, source in sorted(by_type.get(type_name, {}).items()):
            if source.row.choose:
                listed = elements_of(log, robot, topic, source, feet)
                found += (each for each in listed if may_be_base(each, robot))
            else:
                found.append(BaseCandidate(topic, source, "", _is_base(topic, source)))
        # Of two robots' poses, or two objects', none is surely the base's.
        sure = [each.name for each in found if each.is_sure]
        anything = any(each.source.row.anything for each in found)
        if anything or type_name == ODOMETRY_TYPE:
            sure = _of_same_robot(sure, feet)
            sure = [] if anything and len(sure) > 1 else sure
        if type_name == ODOMETRY_TYPE:
            found.sort(key=lambda each: (-message_count(log, each.topic), len(each.topic)))
        surely = frozenset(sure)
        yield from (replace(each, is_sure=each.name in surely) for each in found)
    yield from sorted(
        _in_unknown_messages(log), key=lambda each: topic_words(each.name).isdisjoint(_BASE_WORDS)
    )


def _is_base(topic: str, source: Source) -> bool:
    """Tell whether a topic's poses are surely the base's."""
    words = topic_words(topic)
    if source.row.on_request:
        return False
    if not source.row.anything:
        # Such states have the feet relative to the base, whose own pose is zero.
        return not topic.endswith("body_frame")
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    return named and words.isdisjoint(_OTHER_WORDS)


def _in_unknown_messages(log: Log) -> Iterator[BaseCandidate]:
    """Yield poses in messages of unknown types."""
    unknown = {c.topic: c for c in log.channels.values() if source_of(c, "base") is None}
    for topic, channel in [*unknown.items()][:_MOST_TYPES]:
        try:
            fields = list(every_field(definition_of(channel)))
        except DefinitionError:
            continue
        for path, kind in fields:
            is_message = isinstance(kind, Struct) and "[]" not in path
            if is_message and path.count(".") < _DEEPEST and not topic_words(path) & _OTHER_WORDS:
                sources, _ = sources_at([channel], path)
                yield from (BaseCandidate(topic, each, path, is_sure=False) for each in sources)


def elements_of(
    log: Log, robot: Robot, topic: str, source: Source, feet: Collection[str] = ()
) -> list[BaseCandidate]:
    """Return what a topic's first messages hold poses of, what is most likely the base first.

    Args:
        log: the log.
        robot: its frames are looked for.
        topic: the topic.
        source: of its messages.
        feet: topics of the robot's feet; see `base_candidates`.
    """
    frames: dict[str, tuple[str, ...]] = {}
    for channel in log.channels_by_topic[topic]:
        if source_of(channel, "base") is source:
            for messages in first_messages(log, channel, source.fields):
                frames |= choices(source, messages)
    ranked = sorted((_rank(parts, robot, source), name) for name, parts in frames.items())
    best = _of_same_robot([name for rank, name in ranked if rank[0] == _SURE], feet)
    # Two robots' bases: none is surely the one that is meant.
    bases = {frames[name][-1].lstrip("/") for name in best}
    is_sure = len(bases) == len({base.rpartition("/")[2] for base in bases})
    is_sure = is_sure if source.is_transform else len(best) == 1
    return [
        BaseCandidate(topic, source, name, is_sure and name in best, frames[name])
        for rank, name in ranked
    ]


def may_be_base(candidate: BaseCandidate, robot: Robot) -> bool:
    """Tell whether poses in a list may be the base's: those of scenery and of arms are not."""
    return _rank(candidate.frames, robot, candidate.source)[0] < _NEVER


def _rank(parts: Sequence[str], robot: Robot, source: Source) -> tuple[int, int, int]:
    """Return what sorts elements: whether each is surely the base; then by preference."""
    bases = ((robot.base_frame or "").rpartition("/")[2].lower(), *BASES)
    names = [part.rpartition("/")[2].lower() for part in parts]
    if source.is_transform:
        if names[0] not in _WORLDS or names[1] in _WORLDS:
            return _NEVER, 0, 0
        return int(names[1] not in bases), _index(bases, names[1]), _WORLDS.index(names[0])
    model, _, link = parts[0].lower().partition("::")
    if model in _SCENERY or not source.row.name.endswith("LinkStates"):
        return _NEVER if model in _SCENERY else _SURE, 0, 0
    return _SURE if link in bases else _PERHAPS, _index(bases, link), 0


def _index(names: Sequence[str], name: str) -> int:
    return names.index(name) if name in names else len(names)


def _of_same_robot(names: Sequence[str], feet: Collection[str]) -> list[str]:
    """Return those of some names that share the most words with the topics of all feet.

    Where a log has several robots, as in ``/a1/odom`` and ``/a2/odom``, these belong to the one
    whose feet are used.
    """
    shared = frozenset.intersection(*map(topic_words, feet)) if feet else frozenset()
    counts = [len(shared & topic_words(name)) for name in names]
    most = max(counts, default=0)
    return [name for name, count in zip(names, counts, strict=True) if count == most]


def is_of_another_robot(name: str, feet: Collection[str]) -> bool:
    """Tell whether a topic's namespace is the name of another robot than that of the feet."""
    own, other = {namespace(each) for each in feet}, namespace(name)
    return len(own) == 1 and bool(other) and own.isdisjoint((other, ""))


def namespace(topic: str) -> str:
    """Return the first part of a topic if it may be a robot's name; else nothing."""
    first, *rest = topic.strip("/").lower().split("/")
    unknown = frozenset(re.findall(r"[a-z]+", first)) - _NO_NAMES or re.search(r"\d", first)
    return first if rest and unknown else ""


def likely_base(log: Log, candidates: Sequence[BaseCandidate], feet: Collection[str]) -> str:
    """Return the name of the candidate that is most likely the base's; empty: none is likely.

    It is of the robot of the feet, then moves, then is named like a base.
    """
    possible = [
        each
        for each in candidates
        if not each.is_planned and topic_words(each.name).isdisjoint(_OTHER_WORDS)
    ][:_MOST_SEEN]
    same = _of_same_robot([each.name for each in possible], feet)
    best: list[tuple[bool, bool, bool, str]] = []
    for each in possible:
        stands, unnamed = not _moves(log, each), topic_words(each.name).isdisjoint(_BASE_WORDS)
        if not (stands and unnamed):
            best.append((each.name not in same, stands, unnamed, each.name))
    return min(best, key=lambda one: one[:3])[3] if best else ""


def _moves(log: Log, candidate: BaseCandidate) -> bool:
    """Tell whether a candidate's poses move."""
    base = Base(candidate.source, candidate.element)
    channels = log.channels_by_topic[candidate.topic]
    wanted = Wanted((), FootChannels((), {}), base, channels)
    position = read_wanted(log, wanted).base.position
    position = position[all_finite(position)]
    return bool(len(position)) and bool(np.ptp(position, axis=0).max() > _MOVING_M)
