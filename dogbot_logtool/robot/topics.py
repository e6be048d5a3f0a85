"""Topics of a log by the names that users write, and what is said of those that cannot be read."""

import re
from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import MOST, listed, printable
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.reader.containers.log import Batch, Channel, Log, damage_of
from dogbot_logtool.reader.decode.paths import Columns
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.messages import SERIALISATIONS, DecodedMessages, decode_channels
from dogbot_logtool.reader.messages.others import FOXGLOVE_TYPES, TRANSFORM_TYPES
from dogbot_logtool.reader.messages.source import Source, source_of
from dogbot_logtool.robot.robot import Robot

_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""
_LIKELY_WORDS: Final = ("odom", "contact", "foot", "feet", "force", "wrench", "pose", "leg")
"""Words in topics and types that may tell of the base or the feet."""
_MOST_REASONS: Final = 3
_NOT_USED: Final = "; not used"
_SPAN_NS: Final = 5_000_000_000
"""ns of a log in which a robot has named all of its feet and frames."""
_MOST_CHUNKS: Final = 64


def message_count(log: Log, topic: str) -> int:
    """Return how many messages of a topic the index counts."""
    return sum(log.counts.get(channel.id, 0) for channel in log.channels_by_topic.get(topic, ()))


def most_frequent(log: Log, topics: Iterable[str]) -> str:
    """Return the topic with the most messages; of several, the one with the shortest name."""
    return max(topics, key=lambda topic: (message_count(log, topic), -len(topic), topic))


def is_readable(channel: Channel, part: Part) -> bool:
    """Tell whether a part of a channel's messages is told and can be decoded."""
    source = source_of(channel, part)
    return source is not None and not source.fault


def sources_of(log: Log, topic: str, part: Part) -> list[Source]:
    """Return how a part of a topic's messages is read; faulty ones are left out."""
    sources = [source_of(channel, part) for channel in log.channels_by_topic.get(topic, ())]
    return [source for source in sources if source and not source.fault]


def readable_topics(log: Log, part: Part) -> list[str]:
    """Return the topics that tell of a part and can be decoded, sorted."""
    return sorted(topic for topic in log.channels_by_topic if sources_of(log, topic, part))


def first_batches(log: Log, channel: Channel) -> Iterator[Batch]:
    """Yield the messages of a channel's first seconds, which tell names, wherever they stand."""
    end: int | None = None
    for chunk in islice(log.chunks_of({channel.id}), _MOST_CHUNKS):
        if end is not None and chunk.start_time is not None and chunk.start_time > end:
            return
        batch = log.read((chunk,))
        time = batch.messages.log_time[batch.messages.channel == channel.id]
        if len(time):
            end = int(time.min()) + _SPAN_NS if end is None else end
            yield batch.cropped(None, end)


def first_messages(log: Log, channel: Channel, columns: Columns) -> Iterator[DecodedMessages]:
    """Decode the messages of a channel's first seconds."""
    for batch in first_batches(log, channel):
        yield from decode_channels(batch, [channel], columns)


def has_field(channel: Channel, foot: Foot) -> bool:
    """Tell whether a foot is a field of a channel's messages."""
    try:
        named = channel.topic == foot.topic and foot.field is not None
        return named and foot_source(channel, [foot]) is not None
    except DefinitionError:
        return False


def split_topic(name: str, topics: Container[str]) -> tuple[str, str]:
    """Split ``/topic:field`` into the topic and what is named in its messages; empty: nothing is.

    Args:
        name: what the user wrote.
        topics: those of the log, whose names may have colons.
    """
    if name in topics:
        return name, ""
    colons = [match.start() for match in re.finditer(":", name)]
    known = (colon for colon in colons if name[:colon] in topics)
    colon = next(known, colons[0] if colons else len(name))
    return name[:colon], name[colon + 1 :]


def require_topic(
    log: Log, option: str, topic: str, part: Part | None, otherwise: str = ""
) -> None:
    """Check that the topic of an option is in the log, and of a type that can be used.

    Args:
        log: the log.
        option: the option, as sentences name it.
        topic: its topic.
        part: what its messages must tell of; None: any will do.
        otherwise: what can be done with a topic of another type.

    Raises:
        CallError: it is not; with the topics that could be meant.
        LogError: it is, but cannot be decoded.
    """
    channels = log.channels_by_topic.get(topic, ())
    where = f"{name_of(log.source.path)}: {option}"
    sources = [source for c in channels if part and (source := source_of(c, part))]
    if sources and all(source.fault for source in sources):
        raise LogError(f"{where}: {topic} cannot be read: {sources[0].fault}")
    if sources or (channels and part is None):
        return
    usable = readable_topics(log, part) if part else sorted(log.channels_by_topic)
    can_be_used = f"Topics that can be used: {listed(usable) or 'none'}"
    if channels:
        found = ", ".join(sorted({channel.type_name for channel in channels}))
        raise CallError(
            f"{where}: {topic} is of type {found}, which does not fit. {can_be_used}"
            f"{otherwise and '. '}{otherwise}"
        )
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    # The slash at the beginning is forgotten most often.
    close = [one for one in usable if one.strip("/") == topic.strip("/")]
    close = close or get_close_matches(topic, usable[:_COMPARED], n=3)
    meant = f"; did you mean {' or '.join(close)}?" if close else "."
    raise CallError(f"{where}: the log has no topic {topic}{meant} {can_be_used}")


def unreadable_findings(
    log: Log, odometry: Sequence[Channel], contacts: Sequence[Channel]
) -> Iterator[Finding]:
    """Say which topics of types that could be used cannot be decoded, once for every reason.

    It is an error where no odometry, or no foot, is left.

    Args:
        log: the log.
        odometry: channels that are used.
        contacts: channels that are used.
    """
    lost: dict[tuple[bool, str], set[str]] = {}
    for channel in log.channels.values():
        foot, source = source_of(channel, "feet"), source_of(channel, "base")
        # Messages that can be about anything need not be about feet.
        is_error = foot is not None and not foot.row.anything and not contacts
        if channel.type_name in {ODOMETRY_TYPE, *TRANSFORM_TYPES}:
            foot, is_error = source, channel.type_name == ODOMETRY_TYPE and not odometry
        if foot is not None and foot.fault:
            lost.setdefault((is_error, foot.fault), set()).add(channel.topic)
    for (is_error, reason), topics in sorted(lost.items()):
        yield _about(topics, reason + _NOT_USED, () if is_error else ("one_topic",))
    others = {c.topic: c.message_encoding for c in log.channels.values() if not _is_read(c)}
    if others and not (contacts or lost):
        many, all_topics = len(others), len(log.channels_by_topic)
        what = f"{many:,} of {all_topics:,} topics" if all_topics > 1 else "its topic"
        text = (
            f"{what} {'is' if many == 1 else 'are'} encoded as "
            f"{listed(sorted({encoding or 'nothing' for encoding in others.values()}))}; only "
            "ROS 1 messages, CDR and Foxglove's poses, transforms and joints are read"
        )
        yield Finding("UNREADABLE", text, cases=("not_needed",))


def _is_read(channel: Channel) -> bool:
    is_known = channel.message_encoding in SERIALISATIONS or channel.type_name in FOXGLOVE_TYPES
    return is_known or is_readable(channel, "base")


def is_planned(channel: Channel) -> bool:
    """Tell whether a channel's messages tell what was planned, not what was measured."""
    source = source_of(channel, "feet")
    return source is not None and source.row.is_planned(channel.topic)


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
    finding = found(
        "NO_FORCE",
        "counts",
        say="given" if counts is not None and say != "estimated" else say,
        type=name,
        names=", ".join(names),
        counts=counts,
        reason=reason,
    )
    return replace(finding, feet=names)


def own_definition_findings(used: Iterable[Channel]) -> Iterator[Finding]:
    """Say for which of the used channels this program's definition stands in for the log's."""
    found: dict[str, set[str]] = {}
    for channel in used:
        for source in (source_of(channel, "feet"), source_of(channel, "base")):
            if source and source.own_definition:
                found.setdefault(source.own_definition, set()).add(channel.topic)
    for because, topics in sorted(found.items()):
        text = f"{because}; the one that comes with dogbot-logtool is used"
        yield _about(topics, text, ("own_definition",))


def _about(topics: Collection[str], text: str, cases: tuple[str, ...]) -> Finding:
    named = sorted(topics)
    where = named[0] if len(named) == 1 else ""
    return Finding("UNREADABLE", f"{listed(named)}: {text}", where, cases=cases)


def nothing_to_do(log: Log, findings: Sequence[Finding]) -> str:
    """Return a sentence for a log that has nothing of use: why, or else what it does have.

    Args:
        log: the log.
        findings: of the choice of its topics.
    """
    path = name_of(log.source.path)
    offers = [
        each
        for each in findings
        if each.code == "FEET_UNSURE" or (each.code == "NO_BASE" and "--odom-topic" in each.text)
    ]
    for offer in sorted(offers, key=lambda each: each.code):
        command = offer.command and f"\n  {offer.command}"
        return f"{path}: nothing is surely the base or a foot; {offer.sentence}{command}"
    unread = [each for each in findings if each.code == "UNREADABLE"]
    reasons = [each.text for each in unread if "own_definition" not in each.cases]
    if because := "; ".join(text.removesuffix(_NOT_USED) for text in reasons[:_MOST_REASONS]):
        return f"{path}: has no odometry and no contact messages that can be read: {because}"
    known = sorted({(c.topic, c.type_name) for c in log.channels.values()}, key=_unlikely)
    lines = [
        f"\n  {printable(topic)}  {printable(kind) or '(of no type)'}"
        for topic, kind in known[:MOST]
    ]
    if len(known) > MOST:
        lines.append(f"\n  and {len(known) - MOST:,} more; `dogbot-logtool info` lists them")
    damage = f" It is damaged: {damage_of(log, log.losses).text}." if log.losses else ""
    return (
        f"{path}: has neither nav_msgs/Odometry nor contact messages such as "
        "gazebo_msgs/ContactsState that can be used (--odom-topic and --foot name topics)."
        f"{damage} It has:{''.join(lines) or ' nothing'}"
    )


def _unlikely(topic: tuple[str, str]) -> tuple[bool, tuple[str, str]]:
    """Return what sorts topics, given with their types: likely ones first, then by name."""
    name = " ".join(topic).lower()
    return not any(word in name for word in _LIKELY_WORDS), topic
