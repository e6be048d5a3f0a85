"""What is offered, and what is said of topics: those that may be feet, or cannot be read."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePath
from typing import Final

from dogbot_logtool.finding import Finding, found
from dogbot_logtool.io.printable import MOST, listed, printable, shell_joined, shell_quoted
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.reader.containers.log import Channel, Log, damage_of
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.bases import ODOMETRY_TYPE
from dogbot_logtool.reader.messages.contacts import foot_source
from dogbot_logtool.reader.messages.messages import SERIALISATIONS
from dogbot_logtool.reader.messages.others import FOXGLOVE_TYPES, TRANSFORM_TYPES
from dogbot_logtool.reader.messages.source import source_of
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.robot import Robot
from dogbot_logtool.robot.topics import is_planned, readable_source

_ALTERNATIVES: Final = 3
"""Sets of topics that are offered beside the most likely one."""
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
    first, *others = sets
    call = f"{call} {foot_options(first.feet)}"
    if not first.type_name:
        options = " or ".join(foot_options(one.feet) for one in others[:_ALTERNATIVES])
        which = first.fields + (f"; or {options}" if others else "")
        return replace(found("FEET_UNSURE", say="topics", which=which, call=call), command=call)
    told = "; or ".join(f"{o.fields} ({o.points} points: {o.reasons})" for o in sets[:3])
    if any(foot.leg_position is None for foot in first.feet):
        told += "; which leg each is, they do not say: put front_left, back_right ... for "
        told += f"{first.feet[0].name} and the others, and gaits have names"
    file = f"{PurePath(log.words[0]).stem}.toml"
    draft = shell_joined(["dogbot-logtool", "robots", "new", *log.words, "-o", file])
    # What fields are, and of which foot, can only be said in a robot's file.
    needs_file = any((foot.field and foot.field.kind) or foot.sensor_of for foot in first.feet)
    say, command = ("draft", draft) if needs_file else ("fields", call)
    values = {"type": first.type_name, "told": told, "draft": draft, "call": command}
    return replace(found("FEET_UNSURE", "possible", say=say, **values), command=command)


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
    unknown: dict[str, set[str]] = {}
    for channel in log.channels.values():
        is_base = channel.type_name in {ODOMETRY_TYPE, *TRANSFORM_TYPES}
        source = source_of(channel, "base" if is_base else "feet")
        if source is not None and source.fault:
            # Messages that can be about anything need not be about feet.
            is_error = not source.row.anything and not contacts
            if is_base:
                is_error = channel.type_name == ODOMETRY_TYPE and not odometry
            lost.setdefault((is_error, source.fault), set()).add(channel.topic)
        is_known = channel.message_encoding in SERIALISATIONS or channel.type_name in FOXGLOVE_TYPES
        if not is_known and not readable_source(channel, "base"):
            unknown.setdefault(channel.message_encoding, set()).add(channel.topic)
    for (is_error, reason), topics in sorted(lost.items()):
        yield _about(topics, reason + _NOT_USED, () if is_error else ("one_topic",))
    for encoding, topics in unknown.items() if not (contacts or lost) else ():
        text = f"messages encoded as {encoding!r} are not read, only ROS 1's and CDR"
        yield _about(topics, text, ("not_needed",))


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


def own_definition_findings(used: Iterable[Channel]) -> Iterator[Finding]:
    """Say for which of the used channels this program's definition stands in for the log's."""
    topics: dict[str, set[str]] = {}
    for channel in used:
        for source in (source_of(channel, "feet"), source_of(channel, "base")):
            if source and source.own_definition:
                topics.setdefault(source.own_definition, set()).add(channel.topic)
    for because, own in sorted(topics.items()):
        text = f"{because}; the one that comes with dogbot-logtool is used"
        yield _about(own, text, ("own_definition",))


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
