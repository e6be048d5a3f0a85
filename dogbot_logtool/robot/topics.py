"""Topics of a log: by the names that users write, by what they tell, and what is said of them."""

from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import PurePath
from typing import Final

from dogbot_logtool.errors import CallError, DefinitionError, LogError
from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import MOST, listed, printable, shell_joined, shell_quoted
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Channel, Log, damage_of
from dogbot_logtool.reader.decode.paths import Columns
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.message_type import Part
from dogbot_logtool.reader.messages.messages import SERIALISATIONS, DecodedMessages, decode_channels
from dogbot_logtool.reader.messages.source import Topic, source_of
from dogbot_logtool.reader.messages.table import types_of
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.words import PLANNED, texts_of, word_set

_COMPARED: Final = 2000
"""Topics that a wrong name is compared with."""
_SPAN_NS: Final = 5_000_000_000
"""ns of a log in which a robot has named all of its feet and frames."""
_MOST_CHUNKS: Final = 64
_MEASURED: Final = word_set(
    "odom odometry measured actual current feedback estimate estimated estimator state est meas "
    "real gt truth groundtruth"
)
"""Words of topics whose twists are no commands."""
_COMMANDS: Final = (
    word_set("cmd"),
    word_set("command commands commanded cmds"),
    PLANNED | {"teleop", "joy"},
)
"""Words of topics whose twists are commands, the surest first."""
_ELSEWHERE: Final = word_set(
    "foot feet leg wrist hand arm head camera cam gripper phone 435 455 265 realsense zed lidar "
    "livox ouster velodyne"
)
"""Words of topics of inertial units that are not the base's; numbers are those of cameras."""
_OTHER: Final = 9
"""Rank of topics of something else."""
_NO_STATES: Final = PLANNED | {"teleop", "joy", "foot"}
"""Words in topics whose joint states are no positions of joints."""
_MOST_CHANNELS: Final = 16


def topics_of(log: Log, part: Part) -> list[Topic]:
    """Return the topics that tell of a part and can be decoded, the best first.

    These are of the better type, then those with the most messages, then with a shorter name.
    """
    order, own = types_of(part), dict[tuple[str, str], Topic]()
    for channel in log.channels.values():
        source = source_of(channel, part)
        if source is None or source.fault:
            continue
        key = source.row.name, channel.topic
        topic = own.setdefault(key, Topic(source, ()))
        if source.columns == topic.source.columns:
            own[key] = topic._replace(channels=(*topic.channels, channel))

    def rank(topic: Topic) -> tuple[int, int, int, str]:
        count = sum(log.counts.get(channel.id, 0) for channel in topic.channels)
        return order.index(topic.source.row.name), -count, len(topic.name), topic.name

    return sorted(own.values(), key=rank)


def names_of(log: Log, part: Part) -> list[str]:
    """Return the names of the topics that tell of a part and can be decoded, sorted."""
    return sorted({each.name for each in topics_of(log, part)})


def first_messages(log: Log, channel: Channel, columns: Columns) -> Iterator[DecodedMessages]:
    """Decode the messages of a channel's first seconds, which tell names, wherever they stand."""
    end: int | None = None
    for chunk in islice(log.chunks_of({channel.id}), _MOST_CHUNKS):
        if end is not None and chunk.start_time is not None and chunk.start_time > end:
            return
        batch = log.read((chunk,))
        time = batch.messages.log_time[batch.messages.channel == channel.id]
        if len(time):
            end = int(time.min()) + _SPAN_NS if end is None else end
            yield from decode_channels(batch.cropped(None, end), [channel], columns)


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
    topic, _, field = name.partition(":")
    return (name, "") if name in topics else (topic, field)


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
    usable = names_of(log, part) if part else sorted(log.channels_by_topic)
    can_be_used = f"Topics that can be used: {listed(usable) or 'none'}"
    if channels:
        found = ", ".join(sorted({channel.type_name for channel in channels}))
        raise CallError(
            f"{where}: {topic} is of type {found}, which does not fit. {can_be_used}"
            f"{otherwise and '. '}{otherwise}"
        )
    from difflib import get_close_matches  # noqa: PLC0415 - for wrong calls only

    close = get_close_matches(topic, usable[:_COMPARED], n=1)
    meant = f"; did you mean {close[0]}?" if close else "."
    raise CallError(f"{where}: the log has no topic {topic}{meant} {can_be_used}")


def is_planned(channel: Channel) -> bool:
    """Tell whether a channel's messages tell what was planned of feet, not what was measured."""
    source = source_of(channel, "feet")
    how = source.row.planned if source else ""
    return how == "always" or (how == "by name" and is_named_as_planned(channel.topic))


def is_named_as_planned(topic: str) -> bool:
    """Tell whether the name of a topic of feet says that it is a plan or a command."""
    return not texts_of(topic).isdisjoint(PLANNED | {"control", "mpc"})


# --- beside feet and base -----------------------------------------------------------------------


def joint_channels(log: Log) -> list[Channel]:
    """Return the first channels of joints' measured states, those that name joints first."""
    topics = sorted(topics_of(log, "joints"), key=lambda each: not each.source.row.joint)
    found = [
        channel
        for topic in topics
        for channel in topic.channels
        if log.counts.get(channel.id, 1) and not texts_of(topic.name) & _NO_STATES
    ]
    return found[:_MOST_CHANNELS]


_BESIDE: Final[Mapping[Part, tuple[str, str]]] = {
    "commands": ("command_topic", "velocity commands"),
    "accelerations": ("imu_topic", "the base's accelerations"),
}
"""Fields of robots that name topics, and what these tell."""


def side_topic(log: Log, robot: Robot, part: Part, findings: list[Finding]) -> tuple[Channel, ...]:
    """Return the channels of velocity commands or of the base's inertial unit; none: of no topic.

    Args:
        log: the log.
        robot: it may name the topic.
        part: which of the two.
        findings: receives which of several topics it is.

    Raises:
        CallError: the robot names a topic that the log does not have, or one of a wrong type.
        LogError: the robot names a topic that cannot be decoded.
    """
    option, what = _BESIDE[part]
    asked, topics = getattr(robot, option), topics_of(log, part)
    if asked is not None:
        require_topic(log, option, asked, part)
        return next(each.channels for each in topics if each.name == asked)
    ranked = sorted((_rank(each.name, part), row) for row, each in enumerate(topics))
    likely = [topics[row] for rank, row in ranked if rank < _OTHER]
    if not likely:
        return ()
    best, *others = [each.name for each in likely]
    text = f"{what} are taken from {best}, found by type and name"
    text += f"; there are also {listed(others)} (--set {option} chooses)" if others else ""
    findings.append(Finding("TOPICS_CHOSEN", text, best))
    return likely[0].channels


def _rank(name: str, part: Part) -> int:
    """Rank topics that are named like commands, or like the base's inertial unit; 0 is best."""
    words = texts_of(name)
    if part == "accelerations":
        return _OTHER if words & _ELSEWHERE else int("raw" in words)
    if words & _MEASURED:
        return _OTHER
    if name.rpartition("/")[2] == "cmd_vel":
        return 0
    return next((row for row, sure in enumerate(_COMMANDS, start=1) if words & sure), _OTHER)


# --- what is offered, and what is said -----------------------------------------------------------


_MOST_OFFERED: Final = 3
"""Sets of topics or fields that are offered."""
_MOST_REASONS: Final = 3
_NOT_USED: Final = "; not used"


def foot_options(feet: Iterable[Foot]) -> str:
    """Return the words for a shell that name some feet."""
    return " ".join(f"--foot {foot.name}={shell_quoted(foot.word)}" for foot in feet)


def offer_finding(log: Log, sets: Sequence[FootSet], call: str) -> Finding:
    """Return which topics or fields may be feet, and the command that measures with them.

    Args:
        log: the log.
        sets: at least one, the most likely first; all of topics, or all of fields.
        call: a call of `stats` without the feet.
    """
    feet, reasons = sets[0].feet, sets[0].reasons
    told = "; or ".join(one.told for one in sets[:_MOST_OFFERED])
    if any(foot.leg_position is None for foot in feet):
        told += "; which leg each is, they do not say: put front_left, back_right ... for "
        told += f"{feet[0].name} and the others, and gaits have names"
    say, command = "plain", f"{call} {foot_options(feet)}"
    # What fields are, and of which foot, can only be said in a robot's file.
    if reasons and any((foot.field and foot.field.kind) or foot.sensor_of for foot in feet):
        file = f"{PurePath(log.words[0]).stem}.toml"
        words = ["dogbot-logtool", "robots", "new", *log.words, "-o", file]
        say, command = "draft", shell_joined(words)
    cases = ("possible",) if reasons else ()
    finding = found("FEET_UNSURE", *cases, say=say, told=told, call=command)
    return replace(finding, command=command)


def call_of(log: Log, options: RobotOptions) -> str:
    """Return a call of `stats` with the user's options."""
    mass = None if options.mass is None else f"{options.mass:g}"
    words = ["dogbot-logtool", "stats", *log.words]
    for option, value in (
        ("--robot", options.robot),
        ("--odom-topic", options.odom_topic),
        ("--mass", mass),
        *(("--foot", f"{name}={text}") for name, text in (options.foot or {}).items()),
        *(("--set", f"{name}={text}") for name, text in (options.set or {}).items()),
    ):
        words += [option, value] if value is not None else []
    return shell_joined(words)


# --- what cannot be read or is not told ---


def unreadable_findings(
    log: Log, feet: Collection[Channel], poses: Collection[Channel], transforms: Iterable[Channel]
) -> Iterator[Finding]:
    """Say which topics cannot be decoded, and for which our definition stands in for the log's.

    It is an error where no odometry, or no foot, is left.

    Args:
        log: the log.
        feet: channels of feet that are used.
        poses: those of the base.
        transforms: those of frames.
    """
    used = {channel.id for channel in (*feet, *poses, *transforms)}
    topics_of_text: dict[tuple[str, str], set[str]] = {}
    for channel in log.channels.values():
        cases: dict[str, str] = {}
        sources = source_of(channel, "feet"), source_of(channel, "base")
        for source, has_other in zip(sources, (feet, poses), strict=True):
            if source is None:
                continue
            # Messages that can be about anything need not be about feet or the base.
            is_asked = not (source.row.anything or source.row.choose)
            if source.fault and (source is sources[0] or not (sources[0] or source.row.anything)):
                is_needed = is_asked and not has_other
                cases[source.fault + _NOT_USED] = "" if is_needed else "one_topic"
            elif source.own_definition and channel.id in used:
                text = f"{source.own_definition}; the one that comes with dogbot-logtool is used"
                cases[text] = "own_definition"
        encoding = channel.message_encoding
        is_known = encoding in SERIALISATIONS or channel.type_name.startswith("foxglove.")
        if not (any(sources) or is_known or feet):
            text = f"messages encoded as {encoding!r} are not read, only ROS 1's and CDR"
            cases[text] = "not_needed"
        for text, case in cases.items():
            topics_of_text.setdefault((case, text), set()).add(channel.topic)
    for (case, text), topics in sorted(topics_of_text.items()):
        where = min(topics) if len(topics) == 1 else ""
        told = f"{listed(sorted(topics))}: {text}"
        yield Finding("UNREADABLE", told, where, cases=(case,) if case else ())


def contact_findings(feet_of: Mapping[Channel, tuple[int, ...]], robot: Robot) -> Iterator[Finding]:
    """Say what contact messages do not tell."""
    unscaled = [foot for foot in robot.feet if foot.newtons_per_count is None]
    for channel in sorted(feet_of, key=lambda channel: channel.type_name):
        name, source = channel.type_name, foot_source(channel, robot.feet_of(channel.topic))
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
    yield from (found("PLANNED", topic=channel.topic) for channel in feet_of if is_planned(channel))


def not_calibrated(
    robot: Robot, feet: Sequence[Foot], name: str, say: str = "unseen", told: str = ""
) -> Finding:
    """Return a warning of what is missing while the counts of raw sensors have no scale.

    Args:
        robot: with the threshold of contact.
        feet: those without a scale.
        name: of the type of their messages.
        say: where the thresholds of contact are from, if there is none in the robot's file.
        told: these thresholds, or why they cannot be estimated.
    """
    names, counts = tuple(foot.name for foot in feet), robot.contact_on_counts
    if counts is not None:
        say, told = "given", f"{counts:.6g}"
    finding = found("NO_FORCE", "counts", say=say, type=name, names=", ".join(names), told=told)
    return replace(finding, feet=names)


def nothing_to_do(log: Log, findings: Sequence[Finding]) -> str:
    """Return a sentence for a log that has nothing of use: why, or else what it does have.

    Args:
        log: the log.
        findings: of the choice of its topics.
    """
    path = name_of(log.source.path)
    for offer in sorted(findings, key=lambda each: each.code):
        has_poses = offer.code == "NO_BASE" and "--odom-topic" in offer.text
        if offer.code == "FEET_UNSURE" or has_poses:
            command = offer.command and f"\n  {offer.command}"
            return f"{path}: nothing is surely the base or a foot; {offer.sentence}{command}"
    reasons = [
        each.text.removesuffix(_NOT_USED)
        for each in findings
        if each.code == "UNREADABLE" and "own_definition" not in each.cases
    ]
    if reasons:
        because = "; ".join(reasons[:_MOST_REASONS])
        return f"{path}: has no odometry and no contact messages that can be read: {because}"
    known = sorted({(c.topic, c.type_name) for c in log.channels.values()})
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
