"""Which robot a log is of: the one that the user names, else the known one with its topics."""

from collections.abc import Sequence

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.contact_messages import contact_types, source_of
from dogbot_logtool.robot.robot import GENERIC, Robot, known_robots, load_robot, robot_toml
from dogbot_logtool.robot.topics.topics import topics_of_type


def choose_robot(log: Log, options: RobotOptions, findings: list[Finding]) -> Robot:
    """Return the robot that the user names, else the known one whose topics the log has."""
    if options.robot is not None:
        robot = load_robot(options.robot)
    else:
        recorded = frozenset(log.channels_by_topic)
        known = [load_robot(name) for name in known_robots() if _may_fit(name, recorded)]
        topics = usable_topics(log) | _field_topics(log, known)
        robot = max(known, key=lambda one: (len(one.topics & topics), one.name == GENERIC))
        text = f"robot: {robot.name} (guessed from the topics; change with --robot)"
        findings.append(Finding("ROBOT_GUESSED", text))
    return robot.with_mass(options.mass)


def _may_fit(name: str, topics: frozenset[str]) -> bool:
    """Tell, without parsing its file, whether a known robot may have one of some topics."""
    text = robot_toml(name)
    return name == GENERIC or any(topic in text for topic in topics)


def _field_topics(log: Log, robots: Sequence[Robot]) -> frozenset[str]:
    """Return the topics of robots all of whose feet are fields that the log's messages have."""
    found: set[str] = set()
    for robot in robots:
        if robot.feet and all(_has_field(log, foot) for foot in robot.feet):
            found.update(foot.topic for foot in robot.feet)
    return frozenset(found)


def _has_field(log: Log, foot: Foot) -> bool:
    """Tell whether a foot is a field, and the log's messages have it."""
    for channel in log.channels_by_topic.get(foot.topic, ()) if foot.field else ():
        try:
            source_of(channel, [foot])
        except DefinitionError:
            continue
        return True
    return False


def usable_topics(log: Log) -> frozenset[str]:
    """Return the topics with odometry or contacts: a name alone makes no robot known."""
    return frozenset(topics_of_type(log, {ODOMETRY_TYPE, *contact_types(log.channels.values())}))
