"""The choice of a log's topics, and the use of each.

Topics are given by the robot's file or options, or found.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, NamedTuple

from dogbot_logtool.finding import Finding, found
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.feet import FootChannels
from dogbot_logtool.reader.messages.others import TRANSFORM_TYPES
from dogbot_logtool.reader.messages.source import Source, Topic
from dogbot_logtool.reader.part import Wanted
from dogbot_logtool.robot.base import choose_base
from dogbot_logtool.robot.feet import assign_feet, channels_of_feet, check_topics, find_feet
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.robot import (
    GENERIC,
    Robot,
    known_robots,
    load_robot,
    robot_toml,
    with_settings,
)
from dogbot_logtool.robot.topics import (
    call_of,
    contact_findings,
    has_field,
    names_of,
    offer_finding,
    split_topic,
    topics_of,
    unreadable_findings,
)
from dogbot_logtool.robot.unknown import find_candidates


class Selection(NamedTuple):
    """The topics of a log that are used."""

    robot: Robot
    """With the feet that the log has, and their topics."""
    feet_of: Mapping[Channel, tuple[int, ...]]
    """Indices in `robot.feet` of the feet that each channel of contacts tells of."""
    transforms: tuple[Channel, ...]
    """The log's own ``/tf`` and ``/tf_static``."""
    findings: tuple[Finding, ...]
    possible_feet: tuple[FootSet, ...] = ()
    """Fields that may be feet, the most likely first, where no topics are; see also `findings`."""
    ignored_flags: frozenset[int] = frozenset()
    """Feet of which forces decide contact, since they contradict the flags of the messages."""
    base: Topic | None = None
    """How the base's poses are read; None: there are none."""
    robot_is_guessed: bool = False
    """Whether the robot was guessed from the log's topics."""
    contact_from: Literal["", "joint_torques", "kinematics"] = ""
    """What contacts are estimated from; empty: sensors tell."""
    base_from_legs: bool = False
    """Whether the base's poses are worked out from the legs."""

    @property
    def contacts(self) -> tuple[Channel, ...]:
        """Channels of contacts."""
        return tuple(self.feet_of)

    @property
    def odometry(self) -> tuple[Channel, ...]:
        """Channels of the base's poses."""
        return self.base.channels if self.base else ()

    @property
    def has_base(self) -> bool:
        """Whether there are poses of the base, recorded or worked out."""
        return bool(self.odometry) or self.base_from_legs

    @property
    def has_points(self) -> bool:
        """Whether feet have contact points."""
        return bool(self.contact_from) or any(source.has_points for source in self.sources)

    @property
    def base_name(self) -> str | None:
        """Name of the base's poses, as ``--odom-topic`` takes it; None: there are none."""
        return self.base.name if self.base else None

    @property
    def sources(self) -> tuple[Source, ...]:
        """How contact messages are read, each once, by type name."""
        feet = self.robot.feet_of
        found = (source for c in self.contacts if (source := foot_source(c, feet(c.topic))))
        return tuple(sorted(dict.fromkeys(found), key=lambda source: source.row.name))

    def sources_of(self, foot: int) -> tuple[Source, ...]:
        """Return how the contact messages are read that tell of a foot."""
        own = {channel: feet for channel, feet in self.feet_of.items() if foot in feet}
        return self._replace(feet_of=own).sources

    def wanted(self) -> Wanted:
        """Return what is read of base, feet and frames."""
        feet = FootChannels(self.robot.feet, self.feet_of)
        return Wanted(feet, self.base, self.transforms)


def select_topics(log: Log, options: RobotOptions) -> Selection:
    """Decide which topics are used for what.

    Raises:
        CallError: an option names a topic that the log does not have, or one of a wrong type.
        LogError: an option names a topic that cannot be decoded.
    """
    findings: list[Finding] = []
    if log.annotations is not None and log.annotations.channels:
        findings.append(found("ANNOTATED", count=log.annotations.messages))
    named = _with_options(log, _choose_robot(log, options, findings), options)
    of_feet: list[Finding] = []
    robot, unsure = find_feet(log, named, of_feet)
    robot = with_settings(robot, options)
    feet_of = channels_of_feet(log, robot)
    possible = find_candidates(log) if not (feet_of or unsure) else []
    offers = [*unsure, *possible]
    of_robot = {foot.topic for foot in (offers[0].feet if offers else robot.feet)}
    robot, base = choose_base(
        log, robot, findings, of_robot, is_asked=options.odom_topic is not None
    )
    poses = base.channels if base else ()
    used = {channel.topic for channel in (*feet_of, *poses)}
    known = {split_topic(topic, log.channels_by_topic)[0] for topic in named.topics}
    if options.robot is not None and known and known.isdisjoint(used):
        findings.append(found("ROBOT_GUESSED", "absent", robot=robot.name))
    findings += of_feet
    if offers:
        findings.append(offer_finding(log, offers, call_of(log, options)))
    frames = [each for each in topics_of(log, "base") if each.source.row.name in TRANSFORM_TYPES]
    frames.sort(key=lambda each: each.name)
    transforms = [channel for each in frames for channel in each.channels]
    findings += contact_findings(feet_of, robot)
    findings += unreadable_findings(log, feet_of, poses, transforms)
    return Selection(
        robot,
        feet_of,
        tuple(transforms),
        tuple(dict.fromkeys(findings)),
        tuple(possible),
        base=base,
        robot_is_guessed=options.robot is None,
    )


def _choose_robot(log: Log, options: RobotOptions, findings: list[Finding]) -> Robot:
    """Return the robot that the user names, else the known one whose topics the log has."""
    if options.robot is not None:
        return load_robot(options.robot)
    usable, recorded = _usable_topics(log), log.channels_by_topic
    robot, most = load_robot(GENERIC), 0
    for name in known_robots():
        # Without parsing its file, whether a known robot may have one of the topics.
        if not any(topic in robot_toml(name) for topic in recorded):
            continue
        known = load_robot(name)
        fields = [foot for foot in known.feet if foot.field is not None]
        fits = all(any(has_field(c, f) for c in recorded.get(f.topic, ())) for f in fields)
        topics = known.topics & usable.union(foot.topic for foot in fields)
        if fits and len(topics) > most:
            robot, most = known, len(topics)
    findings.append(found("ROBOT_GUESSED", robot=robot.name))
    return robot


def _usable_topics(log: Log) -> frozenset[str]:
    """Return the topics with odometry or contacts: a name alone makes no robot known."""
    odometry = {
        each.name for each in topics_of(log, "base") if each.source.row.name == ODOMETRY_TYPE
    }
    return frozenset({*names_of(log, "feet"), *odometry})


def _with_options(log: Log, robot: Robot, options: RobotOptions) -> Robot:
    if options.odom_topic is not None:
        robot = replace(robot, odometry_topic=options.odom_topic)
    if options.feet:
        robot = replace(robot, feet=options.feet)
    if options.foot:
        check_topics(log, options.foot)
        guessed = options.robot is None
        robot = assign_feet(robot, options.foot, _usable_topics(log), guessed=guessed)
    return robot
