"""Which poses are the base's: what the user or the robot's file names, else the best that there is.

A base is a topic, and where its messages hold poses of several things an element behind a colon:
``/tf:odom/base_link``, ``/gazebo/model_states:anymal``, ``/state:base.pose``.
"""

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from typing import Final

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding, note, warning
from dogbot_logtool.io.listing import listed
from dogbot_logtool.io.storage import shown
from dogbot_logtool.pipeline.topics.pose_fields import pose_fields
from dogbot_logtool.pipeline.topics.readable import why_no_poses
from dogbot_logtool.pipeline.topics.topics import (
    most_frequent,
    recorded_topics,
    require_topic,
    split_topic,
)
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases.numbers import path_source
from dogbot_logtool.reader.messages.bases.poses import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.bases.registry import (
    BASE_SOURCES,
    Base,
    base_source,
    base_type,
    base_types,
)
from dogbot_logtool.reader.messages.bases.source import BaseSource
from dogbot_logtool.reader.messages.messages import decode_channels
from dogbot_logtool.reader.messages.transforms import is_static
from dogbot_logtool.robot import Robot


def _words(name: str) -> frozenset[str]:
    """Return the words of a topic's name, in small letters."""
    return frozenset(re.findall(r"[a-z0-9]+", name.lower()))


_CHUNKS_SEEN: Final = 6
"""Chunks that are searched for the names of frames, models and links."""
_WORLDS: Final = ("odom", "world", "map", "odom_combined", "vision", "earth", "mocap")
"""Frames that stand still, the best first."""
_BASES: Final = ("base_link", "base", "trunk", "torso", "pelvis", "body", "base_footprint")
"""Frames of a robot's base, the best first."""
_BASE_WORDS: Final = _words(
    "base body trunk torso pelvis robot odom odometry localization localisation mocap "
    "vicon optitrack estimator estimate estimated estimation"
)
"""Words of topics whose poses are the base's; a topic that is just called pose is one, too."""
_OTHER_WORDS: Final = _words(
    "goal initialpose initial des desired ref reference cmd command plan planned planner "
    "target setpoint set footprint foot feet leg hand arm camera object marker obstacle "
    "frame"
)
"""Words of topics whose poses are something else, or not measured."""
_PLANNED_WORDS: Final = _words("plan planned planner trajectory des desired ref")
_CURRENT_WORDS: Final = frozenset(("curr", "current", "measured", "actual"))
_SCENERY: Final = frozenset(("ground_plane", "ground", "sun", "floor", "world", "terrain"))
_MOST_OFFERED: Final = 3
_MOST_LISTED: Final = 12


@dataclass(frozen=True, slots=True)
class ChosenBase:
    """The base of a log, and the robot with the frames that it names."""

    robot: Robot
    channels: tuple[Channel, ...] = ()
    base: Base | None = None
    offered: str = ""
    """Poses that are named like the base's and are not taken unasked, as ``--odom-topic`` takes
    them; empty: there are none, or a base is known."""


@dataclass(frozen=True, slots=True)
class _Candidate:
    """Poses that may be the base's."""

    topic: str
    source: BaseSource
    element: str = ""
    is_sure: bool = True
    """Whether they are taken without asking, if nothing better is there."""

    @property
    def name(self) -> str:
        return f"{self.topic}:{self.element}" if self.element else self.topic


def choose_base(log: Log, robot: Robot, findings: list[Finding]) -> ChosenBase:
    """Choose the base's poses of a log, and say which, what else there is, and what to know."""
    named = robot.odometry_topic
    if named is not None and (own := _named(log, robot, named, findings)) is not None:
        return own
    odometry = _topics(log, (ODOMETRY_TYPE,))
    if odometry:
        topic = most_frequent(log, odometry)
        findings.append(_odometry_found(log, robot, topic, odometry))
        return _chosen(log, robot, _Candidate(topic, base_source_of(log, topic)), findings)
    found = _candidates(log, robot)
    best = next((each for each in found if each.is_sure), None)
    others = [each for each in found if each is not best]
    if best is None:
        findings.append(_none(log, others))
        likely = (o for o in others if not _words(o.name).isdisjoint(_BASE_WORDS))
        return ChosenBase(robot, offered=next((o.name for o in likely if not _is_planned(o)), ""))
    text = f"the base's poses are taken from {best.name} ({best.source.type_name})"
    if named is not None:
        text += f", since the robot's {named} is missing or cannot be used"
    if others:
        text += f"; there are also {_options(others)}"
    findings.append(note("BASE_FOUND", text, best.topic))
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
    if source.elements is None:
        return
    names = _elements(log, topic, source)
    known = listed(sorted(names), _MOST_LISTED) or "none"
    if element and element not in names:
        raise CallError(f"{where}: {topic} has no {element}; it has {known}")
    if not element and not any(each.is_sure for each in _elements_of(log, robot, topic, source)):
        raise CallError(
            f"{where}: {topic} is of type {source.type_name}, and which of its poses is the "
            f"base's is not known: name one as {topic}:NAME; it has {known}"
        )


def base_source_of(log: Log, topic: str) -> BaseSource:
    """Return the source of the first channel of a topic that can be read.

    Raises:
        LogError: none can.
    """
    for channel in log.channels_by_topic.get(topic, ()):
        if base_type(channel.type_name) and not why_no_poses(channel):
            return base_source(channel)
    raise LogError(f"{shown(log.source.path)}: {topic} holds no poses that can be read")


def _source(channel: Channel, element: str) -> tuple[BaseSource, str]:
    """Return the source of a channel for an element, and the element for its reader.

    Raises:
        DefinitionError: the channel has no such poses.
    """
    known = BASE_SOURCES.get(base_type(channel.type_name), ())
    if any(source.elements for source in known):
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
        if source.elements and not element:
            offers = [o for o in _elements_of(log, robot, topic, source) if o.is_sure]
            if not offers:
                return None
            element = offers[0].element
        return _chosen(log, robot, _Candidate(topic, source, element), findings)
    return None


def _chosen(log: Log, robot: Robot, candidate: _Candidate, findings: list[Finding]) -> ChosenBase:
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
    if _is_planned(candidate):
        text = f"{candidate.name}: these poses are planned, not measured"
        findings.append(warning("BASE_PLANNED", text, topic))
    if source.remark:
        findings.append(note("BASE_REMARK", f"{candidate.name}: {source.remark}", topic))
    if not source.has_header:
        text = f"{source.type_name} has no header: log time is used for it"
        findings.append(note("NO_HEADER", text))
    if source.is_transform:
        parent, child = _frames(candidate.element)
        robot = replace(robot, world_frame=parent, base_frame=child)
        if "footprint" in child:
            text = (
                f"{child} is the base's projection on the ground: height, roll and pitch are "
                "those of the ground"
            )
            findings.append(note("BASE_REMARK", text, topic))
    return ChosenBase(robot, tuple(channels), Base(source, candidate.element))


def _is_planned(candidate: _Candidate) -> bool:
    words = _words(candidate.topic)
    return (candidate.source.is_planned and words.isdisjoint(_CURRENT_WORDS)) or not (
        words.isdisjoint(_PLANNED_WORDS)
    )


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
    return note("ODOMETRY_FOUND", text, chosen)


def _other_poses(log: Log) -> list[str]:
    """Return the topics whose poses may be the base's, besides odometry and transforms."""
    types = [
        type_name
        for type_name, (source, *_) in BASE_SOURCES.items()
        if type_name != ODOMETRY_TYPE and not source.is_transform
    ]
    return [topic for topic in _topics(log, types) if _words(topic).isdisjoint(_OTHER_WORDS)]


def _none(log: Log, offered: Sequence[_Candidate]) -> Finding:
    found = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
    none = "no odometry can be read" if found else "there is no odometry"
    text = f"{none}: no /tf and no figures of the base's motion"
    if offered:
        text += f", unless these poses are the base's: {_options(offered)}"
    return warning("NO_ODOMETRY", text)


def _options(candidates: Sequence[_Candidate]) -> str:
    """Return the options that choose candidates."""
    names = [
        f"--odom-topic {each.name}{' (planned)' if _is_planned(each) else ''}"
        for each in candidates[:_MOST_OFFERED]
    ]
    more = len(candidates) - len(names)
    return ", ".join(names) + (f" and {more:,} more" if more else "")


def _topics(log: Log, types: Collection[str]) -> list[str]:
    """Return the topics of some types whose poses can be read, sorted."""
    return sorted(
        {
            channel.topic
            for channel in log.channels.values()
            if base_type(channel.type_name) in types and not why_no_poses(channel)
        }
    )


def _candidates(log: Log, robot: Robot) -> list[_Candidate]:
    """Return the poses that may be the base's, the best first."""
    found: list[_Candidate] = []
    for type_name in BASE_SOURCES:
        topics = _topics(log, (type_name,))
        sure = []
        for topic in topics:
            source = base_source_of(log, topic)
            if any(is_static(channel) for channel in log.channels_by_topic[topic]):
                continue
            if source.elements:
                sure += _elements_of(log, robot, topic, source)
            else:
                sure.append(_Candidate(topic, source, "", _is_base(topic, source)))
        # Of two robots' poses, or two objects', none is surely the base's.
        several = sum(each.is_sure for each in sure) > 1 and sure[0].source.anything
        found += [replace(each, is_sure=each.is_sure and not several) for each in sure]
    found += _in_unknown_messages(log)
    return sorted(found, key=lambda each: (not each.is_sure, _is_planned(each)))


def _in_unknown_messages(log: Log) -> list[_Candidate]:
    """Return poses in messages of unknown types, those named like the base's first."""
    found = [
        _Candidate(channel.topic, path_source(channel, path), path, is_sure=False)
        for path, channel in pose_fields(log)
        if _words(path).isdisjoint(_OTHER_WORDS)
    ]
    return sorted(found, key=lambda each: _words(each.name).isdisjoint(_BASE_WORDS))


def _is_base(topic: str, source: BaseSource) -> bool:
    """Tell whether a topic's poses are surely the base's."""
    if source.on_request:
        return False
    if not source.anything:
        # Such states have the feet relative to the base, whose own pose is zero.
        return not topic.endswith("body_frame")
    words = _words(topic)
    named = not words.isdisjoint(_BASE_WORDS) or words == {"pose"}
    return named and words.isdisjoint(_OTHER_WORDS)


def _elements(log: Log, topic: str, source: BaseSource) -> frozenset[str]:
    """Return what a topic's messages hold poses of, in some chunks of the log."""
    channels = [
        channel
        for channel in log.channels_by_topic[topic]
        if base_type(channel.type_name) == source.type_name and not why_no_poses(channel)
    ]
    ids = {channel.id for channel in channels}
    chunks = [c for c in log.chunks if c.counts is None or not ids.isdisjoint(c.counts)]
    step = max(len(chunks) // _CHUNKS_SEEN, 1)
    found: set[str] = set()
    for span in log.grouped(chunks[::step][:_CHUNKS_SEEN]):
        for messages in decode_channels(log.read(span), channels, source.fields):
            found |= source.elements(messages) if source.elements else frozenset()
    return frozenset(found)


def _elements_of(log: Log, robot: Robot, topic: str, source: BaseSource) -> list[_Candidate]:
    """Return the poses in a topic's messages that may be the base's, the best first."""
    names = _elements(log, topic, source)
    ranked = sorted((_rank(name, robot, source), name) for name in names)
    best = [name for rank, name in ranked if rank[0] == 0]
    # Two robots' bases: none is surely the one that is meant.
    bases = {_frames(name)[1] if source.is_transform else name for name in best}
    if source.is_transform:
        leaf = {base.rpartition("/")[2] for base in bases}
        is_sure = len(bases) == len(leaf)
    else:
        is_sure = len(best) == 1
    return [
        _Candidate(topic, source, name, is_sure and rank[0] == 0)
        for rank, name in ranked
        if rank[0] < _NEVER
    ]


_NEVER: Final = 2
_Rank = tuple[int, int, int]


def _rank(name: str, robot: Robot, source: BaseSource) -> _Rank:
    """Return what sorts elements: 0 surely the base, 1 perhaps, 2 never; then by preference."""
    if source.is_transform:
        parent, child = (frame.rpartition("/")[2].lower() for frame in _frames(name))
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


def _frames(pair: str) -> tuple[str, str]:
    """Split a pair of frames, whose names may hold slashes, where the child most likely begins."""
    parts = pair.split("/")
    splits = [("/".join(parts[:cut]), "/".join(parts[cut:])) for cut in range(1, len(parts))]

    def likely(split: tuple[str, str]) -> tuple[bool, bool]:
        parent, child = (frame.rpartition("/")[2].lower() for frame in split)
        return parent not in _WORLDS, child not in _BASES

    return min(splits or [(pair, "")], key=likely)
