"""The plan of feet whose contacts are measured, where a log has both."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from dogbot_logtool.pipeline.feet.message_feet import feet_of_messages, is_planned
from dogbot_logtool.pipeline.topics.readable import why_unreadable
from dogbot_logtool.pipeline.topics.topics import most_frequent
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.messages.contacts import joint_foot
from dogbot_logtool.reader.messages.contacts.registry import source_of
from dogbot_logtool.reader.messages.contacts.whole_robot import is_named_as_planned
from dogbot_logtool.robot import Foot, FootField, Robot

_HALF: Final = 0.5


def planned_feet(log: Log, robot: Robot, contacts: Sequence[Channel]) -> tuple[Foot, ...]:
    """Return the feet of a robot as a plan in the log tells of them; none: there is no plan.

    Args:
        log: the log.
        robot: with the feet that are used.
        contacts: their channels.
    """
    used = {channel.topic for channel in contacts}
    if any(is_named_as_planned(topic) for topic in used):
        return ()
    for channel in contacts:
        source = source_of(channel, robot.feet_of(channel.topic))
        if source is not None and source.type_name == joint_foot.SOURCE.type_name:
            return tuple(_by_velocity(foot) for foot in robot.feet if foot.element is not None)
    topics: dict[str, list[str]] = {}
    for channel in log.channels.values():
        source = source_of(channel)
        if source is None or channel.topic in used or why_unreadable(channel):
            continue
        if source.tells_all_feet and is_planned(channel):
            topics.setdefault(channel.type_name, []).append(channel.topic)
    own = {channel.type_name for channel in contacts}
    # A plan of the measurement's own type tells forces in the same way.
    for _, of_type in sorted(topics.items(), key=lambda each: each[0] not in own):
        names = {foot.name for foot in robot.feet}
        found = [f for f in feet_of_messages(log, most_frequent(log, of_type)) if f.name in names]
        if found:
            return tuple(found)
    return ()


def _by_velocity(foot: Foot) -> Foot:
    """Return a foot whose planned contact is the velocity beside its count."""
    index = joint_foot.JOINTS + (foot.element or 0)
    field = FootField(f"velocity[{index}]", kind="contact", threshold=_HALF)
    return replace(foot, element=None, field=field, newtons_per_count=None, offset=0.0)
