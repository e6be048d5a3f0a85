"""What of a log is used: which topics for what.

Topics are told by the robot's file, by options, or found.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.annotated import annotation_findings
from dogbot_logtool.core.footfall import contact_rule
from dogbot_logtool.core.loads import body_weight_n
from dogbot_logtool.errors import CallError, DefinitionError
from dogbot_logtool.findings import Finding, note, warning
from dogbot_logtool.printable import printable
from dogbot_logtool.reader.contact_sources.registry import SOURCES, check_contacts
from dogbot_logtool.reader.contact_sources.source import ContactSource, FootChannels
from dogbot_logtool.reader.log import Channel, Log
from dogbot_logtool.reader.odometry import ODOMETRY_TYPE, check_odometry
from dogbot_logtool.reader.transforms import TRANSFORM_TYPES, check_transforms, is_static
from dogbot_logtool.robot import GENERIC, Foot, Robot, known_robots, load_robot
from dogbot_logtool.storage import shown

_PLACE_WORDS: Final[Mapping[str, tuple[str, ...]]] = {
    "front": ("front", "fore"),
    "middle": ("middle", "mid"),
    "back": ("back", "hind", "rear"),
    "left": ("left",),
    "right": ("right",),
}
_PLACE_LETTERS: Final = {
    "lf": ("front", "left"),
    "fl": ("front", "left"),
    "rf": ("front", "right"),
    "fr": ("front", "right"),
    "lm": ("middle", "left"),
    "ml": ("middle", "left"),
    "rm": ("middle", "right"),
    "mr": ("middle", "right"),
    "lh": ("back", "left"),
    "bl": ("back", "left"),
    "hl": ("back", "left"),
    "rl": ("back", "left"),
    "rh": ("back", "right"),
    "br": ("back", "right"),
    "hr": ("back", "right"),
    "rr": ("back", "right"),
}
_PLACE_ORDER: Final = ("front", "middle", "back", "left", "right")


@dataclass(frozen=True, slots=True)
class TopicOptions:
    """What a user says about the robot and the topics."""

    robot: str | None = None
    """Name or TOML file; None: the known robot whose topics the log has, else the generic one."""
    odometry_topic: str | None = None
    foot_topics: Mapping[str, str] | None = None
    """Topic by foot."""
    mass_kg: float | None = None


@dataclass(frozen=True, slots=True)
class Selection:
    """The topics of a log that are used."""

    robot: Robot
    """With the feet that the log has, and their topics."""
    odometry: tuple[Channel, ...]
    contacts: tuple[Channel, ...]
    feet_of: Mapping[int, tuple[int, ...]]
    """Indices of the feet in `robot.feet` by channel id."""
    transforms: tuple[Channel, ...]
    """The log's own ``/tf`` and ``/tf_static``."""
    findings: tuple[Finding, ...]

    @property
    def static_transforms(self) -> frozenset[int]:
        """Ids of the channels whose transforms hold for ever."""
        return frozenset(channel.id for channel in self.transforms if is_static(channel))

    @property
    def sources(self) -> tuple[ContactSource, ...]:
        """The types of contact messages that are used."""
        types = sorted({channel.type_name for channel in self.contacts})
        return tuple(SOURCES[name] for name in types)

    def sources_of(self, foot: int) -> tuple[ContactSource, ...]:
        """Return the types of contact messages that tell of a foot."""
        types = {c.type_name for c in self.contacts if foot in self.feet_of[c.id]}
        return tuple(SOURCES[name] for name in sorted(types))

    def knows_force(self, foot: int) -> bool:
        """Tell whether a foot's messages give its force in newtons, not only whether it touches."""
        scaled = self.robot.feet[foot].newtons_per_count is not None
        return all(
            source.has_force and (scaled or not source.is_raw) for source in self.sources_of(foot)
        )

    def foot_channels(
        self, contact_on_n: float | None = None, contact_off_n: float | None = None
    ) -> FootChannels:
        """Return what reading contacts needs; thresholds, N, are the robot's unless given."""
        robot = self.robot
        rule = contact_rule(
            contact_on_n or robot.contact_on_n,
            contact_off_n or robot.contact_off_n,
            robot.debounce_s,
            body_weight_n(robot.mass_kg),
        )
        release_n = rule.off_n or rule.on_n / 2.0
        return FootChannels(robot.feet, self.feet_of, release_n, robot.contact_on_counts)


def select_topics(log: Log, options: TopicOptions) -> Selection:
    """Decide which topics are used for what.

    Raises:
        CallError: an option names a topic that the log does not have, or one of a wrong type.
    """
    findings: list[Finding] = [*annotation_findings(log)]
    robot = _choose_robot(log, options, findings)
    robot = _apply_options(log, robot, options)
    odometry = _choose_odometry(log, robot, findings)
    robot = _find_feet(log, robot, findings)
    contacts: list[Channel] = []
    feet_of: dict[int, tuple[int, ...]] = {}
    for topic in dict.fromkeys(foot.topic for foot in robot.feet):
        feet = tuple(index for index, foot in enumerate(robot.feet) if foot.topic == topic)
        for channel in _readable(log, topic, SOURCES.keys(), check_contacts, findings):
            contacts.append(channel)
            feet_of[channel.id] = feet
    findings.extend(_source_findings(contacts, robot))
    transforms = [
        channel
        for topic in sorted({c.topic for c in log.channels.values()})
        for channel in _readable(log, topic, TRANSFORM_TYPES, check_transforms, findings)
    ]
    return Selection(
        robot, tuple(odometry), tuple(contacts), feet_of, tuple(transforms), tuple(findings)
    )


def nothing_to_do(log: Log) -> str:
    """Return a sentence for a log that has nothing of use, with what it does have."""
    found = sorted({(c.topic, c.type_name) for c in log.channels.values()})
    listed = (
        "".join(f"\n  {printable(topic)}  {printable(kind)}" for topic, kind in found) or " nothing"
    )
    return (
        f"{shown(log.source.path)}: has neither nav_msgs/Odometry nor contact messages such as "
        "gazebo_msgs/ContactsState that can be used (--odom-topic and --foot name topics). "
        f"It has:{listed}"
    )


def _choose_robot(log: Log, options: TopicOptions, findings: list[Finding]) -> Robot:
    if options.robot is not None:
        robot = load_robot(options.robot)
    else:
        topics = {channel.topic for channel in log.channels.values()}
        known = [load_robot(name) for name in known_robots()]
        robot = max(known, key=lambda one: (len(one.topics & topics), one.name == GENERIC))
        text = f"the robot is taken to be {robot.name!r}; --robot says otherwise"
        findings.append(note("ROBOT_GUESSED", text))
    return robot.with_mass(options.mass_kg)


def _apply_options(log: Log, robot: Robot, options: TopicOptions) -> Robot:
    if options.odometry_topic is not None:
        _require(log, "--odom-topic", options.odometry_topic, {ODOMETRY_TYPE})
        robot = replace(robot, odometry_topic=options.odometry_topic)
    if options.foot_topics:
        feet = {foot.name: foot for foot in robot.feet}
        for name, topic in options.foot_topics.items():
            _require(log, "--foot", topic, SOURCES.keys())
            known = feet.get(name, Foot(name, topic, place=_place(name)))
            feet[name] = replace(known, topic=topic)
        robot = replace(robot, feet=tuple(feet.values()))
    return robot


def _require(log: Log, option: str, topic: str, wanted: AbstractSet[str]) -> None:
    types = {c.type_name for c in log.channels.values() if c.topic == topic}
    names = " or ".join(wanted)
    if not types:
        listed = ", ".join(_topics_of_type(log, wanted)) or "none"
        raise CallError(
            f"{shown(log.source.path)}: {option}: the log has no topic {topic}; of type {names} "
            f"it has: {listed}"
        )
    if not types & wanted:
        raise CallError(
            f"{shown(log.source.path)}: {option}: {topic} is of type {', '.join(sorted(types))}, "
            f"not {names}"
        )


def _choose_odometry(log: Log, robot: Robot, findings: list[Finding]) -> list[Channel]:
    topic = robot.odometry_topic
    if topic is not None:
        channels = _readable(log, topic, {ODOMETRY_TYPE}, check_odometry, findings)
        if channels:
            return channels
    topics = _topics_of_type(log, {ODOMETRY_TYPE})
    if not topics:
        text = "there is no odometry: no /tf and no figures of the base's motion"
        findings.append(warning("NO_ODOMETRY", text))
        return []
    # The one that is heard most often is most likely the one to follow.
    chosen = max(topics, key=lambda one: (_count(log, one), -len(one), one))
    rest = ", ".join(one for one in topics if one != chosen)
    text = f"odometry is taken from {chosen}, found by its type"
    text += f"; there are also {rest} (--odom-topic chooses)" if rest else ""
    findings.append(note("ODOMETRY_FOUND", text, chosen))
    return _readable(log, chosen, {ODOMETRY_TYPE}, check_odometry, findings)


def _find_feet(log: Log, robot: Robot, findings: list[Finding]) -> Robot:
    topics = _topics_of_type(log, SOURCES.keys())
    present = [foot for foot in robot.feet if foot.topic in topics]
    if present:
        robot = replace(
            robot, feet=tuple(_with_element(log, foot, findings) for foot in robot.feet)
        )
        for foot in robot.feet:
            if foot.topic not in topics:
                text = f"foot {foot.name} has no messages: there is no topic {foot.topic}"
                findings.append(warning("FOOT_MISSING", text, foot.topic))
        return robot
    feet = _feet_by_type(log)
    if not feet:
        findings.append(warning("NO_FEET", "there are no contact topics: no arrows, no gait"))
        return replace(robot, feet=())
    listed = ", ".join(f"{foot.name} = {foot.topic}" for foot in feet)
    findings.append(note("FEET_FOUND", f"feet are found by type and name: {listed}"))
    return replace(robot, feet=tuple(feet))


def _feet_by_type(log: Log) -> list[Foot]:
    """Return the feet of the first type of contact messages that the log has."""
    for name, source in SOURCES.items():
        topics = _topics_of_type(log, {name})
        if source.elements and topics:
            # A robot often publishes its state twice, once at a lower rate.
            topic = max(topics, key=lambda one: (_count(log, one), -len(one), one))
            return [
                Foot(leg, topic, place=_place(leg), element=element)
                for element, leg in enumerate(source.elements)
            ]
        if source.anything:
            topics = [topic for topic in topics if _place(topic) is not None]
        if topics:
            return _feet_by_name(topics)
    return []


def _with_element(log: Log, foot: Foot, findings: list[Finding]) -> Foot:
    """Say which element is a foot's, where its messages tell of all feet and nobody said it."""
    types = {c.type_name for c in log.channels.values() if c.topic == foot.topic}
    elements = [SOURCES[name].elements for name in sorted(types & SOURCES.keys())]
    if foot.element is not None or not elements or not elements[0]:
        return foot
    names = [foot.name, "_".join(foot.place or ()), "_".join(_place(foot.name) or ())]
    for name in names:
        if name in elements[0]:
            return replace(foot, element=elements[0].index(name))
    text = f"which element of {foot.topic} is {foot.name} is not known; the robot's file can tell"
    findings.append(warning("ELEMENT_UNKNOWN", text, foot.topic))
    return foot


def _source_findings(contacts: Sequence[Channel], robot: Robot) -> list[Finding]:
    """Say what contact messages do not tell."""
    findings: list[Finding] = []
    for name in sorted({channel.type_name for channel in contacts}):
        source = SOURCES[name]
        if not source.has_force:
            text = f"{name} tells contact, not force: gait figures only, no arrows, no loads"
            findings.append(note("NO_FORCE", text))
        if source.is_raw:
            findings.extend(_not_calibrated(name, robot))
        if not source.has_header:
            findings.append(note("NO_HEADER", f"{name} has no header: log time is used for it"))
        if source.silent_in_swing:
            text = f"{name} is published only in contact: silence is taken for swing"
            findings.append(note("SILENT_SWING", text))
    return findings


def _not_calibrated(name: str, robot: Robot) -> Iterator[Finding]:
    """Say what the counts of raw sensors do not tell as long as nobody has said what they mean."""
    unscaled = [foot.name for foot in robot.feet if foot.newtons_per_count is None]
    if not unscaled:
        return
    text = f"{name} tells raw counts, and the robot's file has no newtons_per_count for "
    text += f"{', '.join(unscaled)}: no forces"
    if robot.contact_on_counts is None:
        text += ", and without contact.on_counts no contact either"
    else:
        text += f"; contact from {robot.contact_on_counts:g} counts above a foot's offset on"
    yield warning("NOT_CALIBRATED", text)


def _feet_by_name(topics: Sequence[str]) -> list[Foot]:
    """Name feet after the places that their topics tell, else after the topics."""
    places = {topic: _place(topic) for topic in topics}
    told = [place for place in places.values() if place is not None]
    feet: list[Foot] = []
    for topic, place in places.items():
        if place is not None and told.count(place) == 1:
            feet.append(Foot("_".join(place), topic, place=place))
        else:
            feet.append(Foot(re.sub(r"[^A-Za-z0-9]+", "_", topic).strip("_"), topic))
    return sorted(feet, key=_foot_order)


def _foot_order(foot: Foot) -> tuple[int, list[int], str]:
    if foot.place is None:
        return 1, [], foot.name
    return 0, [_PLACE_ORDER.index(word) for word in foot.place if word in _PLACE_ORDER], foot.name


def _place(name: str) -> tuple[str, str] | None:
    """Return where a foot sits, from words or letters in a name."""
    words = [word for word in re.split(r"[^a-z]+", _spaced(name)) if word]
    for word in words:
        if word in _PLACE_LETTERS:
            return _PLACE_LETTERS[word]
    joined = " ".join(words)
    ends = [end for end in ("front", "middle", "back") if _says(joined, end)]
    sides = [side for side in ("left", "right") if _says(joined, side)]
    return (ends[0], sides[0]) if len(ends) == len(sides) == 1 else None


def _spaced(name: str) -> str:
    """Split camelCase, and lower."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower()


def _says(words: str, place: str) -> bool:
    return any(word in words for word in _PLACE_WORDS[place])


def _topics_of_type(log: Log, types: AbstractSet[str]) -> list[str]:
    return sorted({c.topic for c in log.channels.values() if c.type_name in types})


def _count(log: Log, topic: str) -> int:
    return sum(log.counts.get(c.id, 0) for c in log.channels.values() if c.topic == topic)


def _readable(
    log: Log,
    topic: str,
    types: AbstractSet[str],
    check: Callable[[Channel], object],
    findings: list[Finding],
) -> list[Channel]:
    """Return the channels of a topic whose definitions can be read."""
    readable: list[Channel] = []
    for channel in log.channels.values():
        if channel.topic == topic and channel.type_name in types:
            try:
                check(channel)
                readable.append(channel)
            except DefinitionError as error:
                findings.append(warning("UNREADABLE", f"{error}; it is not used", topic))
    return readable
