"""What of a log is used: which topics for what.

Topics are told by the robot's file, by options, or found.
"""

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from dogbot_logtool.core.contact.footfall import contact_rule
from dogbot_logtool.core.load.loads import body_weight_n
from dogbot_logtool.finding import Finding, note, warning
from dogbot_logtool.io.listing import MOST
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.pipeline.annotated import annotation_findings
from dogbot_logtool.pipeline.feet.selection import (
    FootOffer,
    assign_feet,
    check_feet_differ,
    check_topics,
    find_feet,
)
from dogbot_logtool.pipeline.options import TopicOptions
from dogbot_logtool.pipeline.readable import (
    other_encodings,
    own_definition_findings,
    reasons,
    unreadable_findings,
)
from dogbot_logtool.pipeline.topics import (
    most_frequent,
    readable_channels,
    recorded_topics,
    require_topic,
    topics_of_type,
)
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.contacts.registry import SOURCES
from dogbot_logtool.reader.messages.contacts.source import (
    ContactSource,
    FootChannels,
)
from dogbot_logtool.reader.messages.odometry import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.transforms import TRANSFORM_TYPES, is_static
from dogbot_logtool.robot import GENERIC, Robot, known_robots, load_robot

_LIKELY_WORDS: Final = ("odom", "contact", "foot", "feet", "force", "wrench", "pose", "leg")
"""Words in topics and types that may tell of the base or the feet."""


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
    offered_feet: Finding | None = None
    """Which topics may be feet, and how to say so, where none surely is; also in `findings`."""

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
        LogError: an option names a topic that cannot be decoded.
    """
    findings: list[Finding] = [*annotation_findings(log)]
    robot = _apply_options(log, _choose_robot(log, options, findings), options)
    if options.robot is not None and robot.topics.isdisjoint(_usable_topics(log)):
        findings.extend(_without_topics(robot))
    odometry = _choose_odometry(log, robot, findings)
    robot, offer = find_feet(log, robot, findings)
    offered = None if offer is None else _offered(log, options, offer)
    findings.extend([offered] if offered else [])
    contacts: list[Channel] = []
    feet_of: dict[int, tuple[int, ...]] = {}
    for topic in dict.fromkeys(foot.topic for foot in robot.feet):
        feet = tuple(index for index, foot in enumerate(robot.feet) if foot.topic == topic)
        for channel in readable_channels(log, topic, SOURCES.keys()):
            contacts.append(channel)
            feet_of[channel.id] = feet
    findings.extend(_source_findings(contacts, robot))
    transforms = [
        channel
        for topic in recorded_topics(log, TRANSFORM_TYPES)
        for channel in readable_channels(log, topic, TRANSFORM_TYPES)
    ]
    unreadable = list(unreadable_findings(log.channels.values(), odometry, contacts))
    if not (odometry or contacts or unreadable) and (others := other_encodings(log.channels)):
        unreadable.append(note("UNREADABLE", others))
    findings.extend(unreadable)
    findings.extend(own_definition_findings([*odometry, *contacts, *transforms]))
    return Selection(
        robot,
        tuple(odometry),
        tuple(contacts),
        feet_of,
        tuple(transforms),
        tuple(findings),
        offered,
    )


def nothing_to_do(log: Log, selection: Selection) -> str:
    """Return a sentence for a log that has nothing of use: why, or else what it does have."""
    path = shown(log.source.path)
    if selection.offered_feet is not None:
        offered = selection.offered_feet
        return f"{path}: there is no nav_msgs/Odometry, and {offered.sentence}\n  {offered.command}"
    if because := reasons(selection.findings):
        return f"{path}: has no odometry and no contact messages that can be read: {because}"
    found = sorted({(c.topic, c.type_name) for c in log.channels.values()}, key=_unlikely)
    lines = [
        f"\n  {printable(topic)}  {printable(kind) or '(of no type)'}"
        for topic, kind in found[:MOST]
    ]
    if len(found) > MOST:
        lines.append(f"\n  and {len(found) - MOST:,} more; `dogbot-logtool info` lists them")
    damage = f" It is damaged: {log.losses[0].what}." if log.losses else ""
    return (
        f"{path}: has neither nav_msgs/Odometry nor contact messages such as "
        "gazebo_msgs/ContactsState that can be used (--odom-topic and --foot name topics)."
        f"{damage} It has:{''.join(lines) or ' nothing'}"
    )


def _unlikely(topic: tuple[str, str]) -> tuple[bool, tuple[str, str]]:
    """Return what sorts topics, given with their types: likely ones first, then by name."""
    name = " ".join(topic).lower()
    return not any(word in name for word in _LIKELY_WORDS), topic


def _choose_robot(log: Log, options: TopicOptions, findings: list[Finding]) -> Robot:
    if options.robot is not None:
        robot = load_robot(options.robot)
    else:
        topics = _usable_topics(log)
        known = [load_robot(name) for name in known_robots()]
        robot = max(known, key=lambda one: (len(one.topics & topics), one.name == GENERIC))
        text = f"the robot is taken to be {robot.name!r}; --robot says otherwise"
        findings.append(note("ROBOT_GUESSED", text))
    return robot.with_mass(options.mass_kg)


def _usable_topics(log: Log) -> frozenset[str]:
    """Return the topics with odometry or contacts: a name alone makes no robot known."""
    return frozenset(topics_of_type(log, {ODOMETRY_TYPE, *SOURCES}))


def _without_topics(robot: Robot) -> Iterator[Finding]:
    """Say that the robot that the user named does not show in the log."""
    if robot.topics:
        text = (
            f"the log has none of the topics of the robot {robot.name!r}: feet and odometry are "
            "looked for by type and name, but its mass, axes and frames are used; check --robot"
        )
        yield warning("ROBOT_ABSENT", text)


def _apply_options(log: Log, robot: Robot, options: TopicOptions) -> Robot:
    if options.odometry_topic is not None:
        require_topic(log, "--odom-topic", options.odometry_topic, {ODOMETRY_TYPE})
        robot = replace(robot, odometry_topic=options.odometry_topic)
    if options.foot_topics:
        given, guessed = options.foot_topics, options.robot is None
        check_topics(log, given)
        robot = assign_feet(robot, given, _usable_topics(log), guessed=guessed)
        check_feet_differ(log, robot, given)
    return robot


def _offered(log: Log, options: TopicOptions, offer: FootOffer) -> Finding:
    """Return a warning with the command that chooses the feet."""
    words = ["dogbot-logtool", "stats", shown(log.source.path)]
    if options.odometry_topic is not None:
        words += ["--odom-topic", options.odometry_topic]
    if options.mass_kg is not None:
        words += ["--mass", f"{options.mass_kg:g}"]
    command = f"{shlex.join(words)} {offer.options}"
    text = (
        f"feet may be among the topics, but their names do not tell surely: {offer.text}; "
        f"no arrows, no gait, until --foot says which they are: {command}"
    )
    return replace(warning("FEET_UNSURE", text), command=command)


def _choose_odometry(log: Log, robot: Robot, findings: list[Finding]) -> list[Channel]:
    topic = robot.odometry_topic
    if topic is not None:
        own = readable_channels(log, topic, {ODOMETRY_TYPE})
        if own:
            return own
    topics = topics_of_type(log, {ODOMETRY_TYPE})
    if not topics:
        found = any(channel.type_name == ODOMETRY_TYPE for channel in log.channels.values())
        none = "no odometry can be read" if found else "there is no odometry"
        text = f"{none}: no /tf and no figures of the base's motion"
        findings.append(warning("NO_ODOMETRY", text))
        return []
    # The one with the most messages is most likely the one to follow.
    chosen = most_frequent(log, topics)
    rest = ", ".join(one for one in topics if one != chosen)
    text = f"odometry is taken from {chosen}, found by its type"
    if topic is not None:
        recorded = recorded_topics(log, {ODOMETRY_TYPE})
        why = "cannot be used" if topic in recorded else "is missing"
        text += f", since the robot's {topic} {why}"
    text += f"; there are also {rest} (--odom-topic chooses)" if rest else ""
    findings.append(note("ODOMETRY_FOUND", text, chosen))
    return readable_channels(log, chosen, {ODOMETRY_TYPE})


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
