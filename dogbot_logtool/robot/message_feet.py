"""The feet of messages that tell of all feet at once, plans, and what contact messages lack."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

from dogbot_logtool.finding import Finding, found
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.feet import MessageFoot, feet_in
from dogbot_logtool.reader.messages.message_type import is_named_as_planned
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.robot.leg_names import leg_position
from dogbot_logtool.robot.names import label_names
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import first_messages, most_frequent
from dogbot_logtool.robot.words import Part, words_of

_ORDER: Final = ("front", "middle", "back", "left", "right")
_JOINT_FOOT: Final = "sensor_msgs/JointState"
"""Type of messages of joints and feet; the velocities of the feet are planned contacts."""
_JOINTS: Final = 12
"""Joints before the feet."""


def feet_of_messages(log: Log, topic: str) -> tuple[Foot, ...]:
    """Return the feet that a topic's messages tell of; none where they are not about feet."""
    for channel in log.channels_by_topic.get(topic, ()):
        source = source_of(channel, "feet")
        if source is None or source.fault or not source.tells_all_feet:
            continue
        found = [MessageFoot(name=leg) for leg in source.row.legs]
        if not found or source.row.maybe_without_legs:
            seen = [feet_in(source, each) for each in first_messages(log, channel, source.columns)]
            labelled = {foot.label: foot for feet in seen for foot in feet if foot.label}
            found = [labelled[label] for label in sorted(labelled)] or max(
                seen, key=len, default=[]
            )
        if found:
            return _named_feet(_without_hands(found), topic)
    return ()


def _without_hands(found: Sequence[MessageFoot]) -> Sequence[MessageFoot]:
    """Leave out hands, wheels, tools ... where other labels say that they are feet."""
    parts = [{word.part for word in words_of(foot.label)} for foot in found]
    legs = [bool({Part.FOOT, Part.LEG} & each) for each in parts]
    pairs = zip(found, parts, legs, strict=True)
    return [
        foot
        for foot, each, is_leg in pairs
        if is_leg or Part.NOT_A_FOOT not in each or not any(legs)
    ]


def _named_feet(found: Sequence[MessageFoot], topic: str) -> tuple[Foot, ...]:
    labelled = label_names([foot.label for foot in found])
    names = [foot.name or each.name for foot, each in zip(found, labelled, strict=True)]
    feet = [
        Foot(
            name if names.count(name) == 1 else foot.label or f"{name}_{element + 1}",
            topic,
            leg_position=leg_position(name) or each.leg_position,
            element=element,
            label=foot.label,
        )
        for element, (foot, name, each) in enumerate(zip(found, names, labelled, strict=True))
    ]
    return tuple(sorted(feet, key=front_to_back))


def front_to_back(foot: Foot) -> tuple[int, int, str]:
    """Sort feet front to back, left before right."""
    if foot.leg_position is None:
        return len(_ORDER), 0, foot.name
    end, side = ((*_ORDER, each).index(each) for each in foot.leg_position)
    return end, side, foot.name


def is_planned(channel: Channel) -> bool:
    """Tell whether a channel's messages tell what was planned, not what was measured."""
    source = source_of(channel, "feet")
    return source is not None and source.row.is_planned(channel.topic)


def planned_feet(log: Log, robot: Robot, contacts: Sequence[Channel]) -> tuple[Foot, ...]:
    """Return the feet of a robot as a plan in the log tells of them; none: there is no plan.

    Args:
        log: the log.
        robot: with the feet that are used.
        contacts: their channels.
    """
    used = {channel.topic: channel.type_name for channel in contacts}
    if any(is_named_as_planned(topic) for topic in used):
        return ()
    if _JOINT_FOOT in used.values():
        return tuple(_by_velocity(foot) for foot in robot.feet if foot.element is not None)
    topics: dict[str, list[str]] = {}
    for channel in log.channels.values():
        if channel.topic not in used and is_planned(channel):
            topics.setdefault(channel.type_name, []).append(channel.topic)
    names = {foot.name for foot in robot.feet}
    # A plan of the measurement's own type tells forces in the same way.
    for _, of_type in sorted(topics.items(), key=lambda each: each[0] not in used.values()):
        feet = feet_of_messages(log, most_frequent(log, of_type))
        if found := tuple(foot for foot in feet if foot.name in names):
            return found
    return ()


def _by_velocity(foot: Foot) -> Foot:
    """Return a foot whose planned contact is the velocity beside its count."""
    field = FootField(f"velocity[{_JOINTS + (foot.element or 0)}]", kind="contact", threshold=0.5)
    return replace(foot, element=None, field=field, newtons_per_count=None, offset=0.0)


def contact_findings(feet_of: Mapping[Channel, tuple[int, ...]], robot: Robot) -> Iterator[Finding]:
    """Say what contact messages do not tell."""
    unscaled = [foot for foot in robot.feet if foot.newtons_per_count is None]
    for channel in sorted(feet_of, key=lambda channel: channel.type_name):
        name = channel.type_name
        source = foot_source(channel, robot.feet_of(channel.topic))
        if source is None:
            continue
        if not source.has_force:
            yield found("NO_FORCE", say="type", type=name)
        if source.row.unit == "counts" and unscaled:
            yield not_calibrated(robot, unscaled, name)
        if not source.has_header:
            yield found("LOG_TIME_USED", "no_header", say="type", type=name)
        if source.row.silent_in_swing:
            yield found("SILENT_SWING", type=name)
    for channel in filter(is_planned, feet_of):
        yield found("PLANNED", topic=channel.topic)


def not_calibrated(
    robot: Robot, feet: Sequence[Foot], name: str, say: str = "unseen", reason: str = ""
) -> Finding:
    """Return a warning of what is missing while the counts of raw sensors have no scale.

    Args:
        robot: with the threshold of contact.
        feet: those without a scale.
        name: of the type of their messages.
        say: where the threshold of contact is from, if there is none in the robot's file.
        reason: why contact cannot be estimated.
    """
    names = tuple(foot.name for foot in feet)
    counts = robot.contact_on_counts
    told = found(
        "NOT_CALIBRATED",
        say="given" if counts is not None and say != "estimated" else say,
        type=name,
        names=", ".join(names),
        counts=counts,
        reason=reason,
    )
    return replace(told, feet=names)
