"""Two logs compared: what describes the topics, records, then the messages, window by window."""

import hashlib
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from io import BytesIO
from typing import Final

from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode

from dogbot_logtool.comparison.fields import Findings, Tree, compare_fields
from dogbot_logtool.comparison.logs.messages import MessageSweep
from dogbot_logtool.comparison.logs.topics import Topic, find_topics
from dogbot_logtool.comparison.logs.windows import (
    Track,
    UntrueTimes,
    indexed_track,
    load,
    measured_track,
    plan_windows,
)
from dogbot_logtool.comparison.outcome import (
    RECORDS,
    Comparison,
    Differences,
    Kind,
    Tally,
)
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits, nothing_left
from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.containers.log import Extra, Log, Loss
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.reader.salvage.losses import damage_of

_MakeTrack = Callable[[Log, Mapping[int, int]], Track]

OWN_VERSION: Final = "metadata:dogbot_logtool.version"
"""The version of this program that wrote a file says nothing of what is in it."""
_HEAD_SIZE: Final = 9
_PIECE: Final = 1 << 20
_LARGEST_METADATA: Final = 64 << 20


def compare_logs(expected: Log, actual: Log, rules: Rules, max_differences: int) -> Comparison:
    """Compare two logs.

    Args:
        expected: the one.
        actual: the other.
        rules: what may differ.
        max_differences: how many differences to keep; all are counted.

    Raises:
        CallError: none of the topics is wanted.
    """
    try:
        return _compare(expected, actual, rules, max_differences, indexed_track)
    except UntrueTimes:
        # The index of one of them does not tell the truth: read both once more for it.
        return _compare(expected, actual, rules, max_differences, measured_track)


def _compare(
    expected: Log, actual: Log, rules: Rules, max_differences: int, make_track: _MakeTrack
) -> Comparison:
    differences = Differences(max_differences)
    topics = find_topics(expected, actual, rules, differences)
    if rules.topics and not topics:
        raise CallError(f"--topics: neither file has a topic like {', '.join(rules.topics)}")
    tallies = [topic.tally for topic in topics]
    if not (rules.topics or fits(rules.ignore, RECORDS)) and expected.container == actual.container:
        tallies.append(_compare_records(expected, actual, rules, differences))

    tracks = (
        make_track(expected, _topic_numbers(topics, is_expected=True)),
        make_track(actual, _topic_numbers(topics, is_expected=False)),
    )
    losses = ([*expected.losses, *tracks[0].losses], [*actual.losses, *tracks[1].losses])
    sweep = MessageSweep(topics, expected.start_time or actual.start_time or 0, differences)
    for window in plan_windows(tracks):
        blocks = load(tracks[0], window), load(tracks[1], window)
        sweep.compare(*blocks)
        for found, block in zip(losses, blocks, strict=True):
            found.extend(block.losses)
    if not any(losses):
        _refuse_ignoring_all(tallies, rules)
    return Comparison(
        expected.source.path,
        actual.source.path,
        "messages",
        tallies,
        differences.kept,
        differences.count,
        [*_damage(expected, losses[0]), *_damage(actual, losses[1])],
    )


def _refuse_ignoring_all(tallies: Sequence[Tally], rules: Rules) -> None:
    """Refuse a comparison of nothing; that both files have a profile says nothing.

    Raises:
        CallError: patterns leave neither a topic nor a record.
    """
    least = 0 if FieldRules(rules).ignored("profile") else 1
    found = any(
        tally.name != RECORDS or max(tally.expected, tally.actual) > least or not tally.same
        for tally in tallies
    )
    if rules.ignore and not found:
        raise nothing_left(rules, "topic")


def _topic_numbers(topics: Sequence[Topic], *, is_expected: bool) -> Mapping[int, int]:
    return {
        channel.id: number
        for number, topic in enumerate(topics)
        for channel in (topic.expected if is_expected else topic.actual)
    }


def _damage(log: Log, losses: Sequence[Loss]) -> Iterator[Damage]:
    if losses:
        # A damaged chunk is met again in each window that it reaches into.
        yield damage_of(log, dict.fromkeys(losses))


def _compare_records(expected: Log, actual: Log, rules: Rules, differences: Differences) -> Tally:
    """Compare what is no message; an entry of a metadata record counts as one."""
    tally = Tally(RECORDS)
    findings = Findings(differences.limit)
    ignoring = FieldRules(rules.ignoring(OWN_VERSION))
    compare_fields(records_tree(expected), records_tree(actual), ignoring, findings)
    differences.take(findings, RECORDS, Kind.DESCRIPTION)
    tally.count_leaves(findings)
    return tally


def records_tree(log: Log) -> Mapping[str, Tree]:
    """Return a log's records beside its messages, by the names that patterns know them by.

    Attachments are compared by type, size and the hash of their content, which bounds the memory.
    Their times are not compared: they say when a file was attached, not what it holds.
    """
    metadata: dict[str, Tree] = {}
    attachments: dict[str, Tree] = {}
    for extra in log.extras:
        if extra.opcode == Opcode.METADATA:
            name, value = _metadata(extra)
            _add(metadata, f"metadata:{name}", value)
        else:
            name, value = _attachment(extra)
            _add(attachments, f"attachment:{name}", value)
    return {"profile": log.profile, **metadata, **attachments}


def _add(named: dict[str, Tree], name: str, value: Tree) -> None:
    """Add a value; a second of the same name gets a number."""
    number = 1
    unique = name
    while unique in named:
        number += 1
        unique = f"{name} ({number})"
    named[unique] = value


def _metadata(extra: Extra) -> tuple[str, Tree]:
    size = min(extra.size - _HEAD_SIZE, _LARGEST_METADATA)
    body = extra.source.read(extra.offset + _HEAD_SIZE, size)
    try:
        record = records.Metadata.read(ReadDataStream(BytesIO(body)))
    except (McapError, struct.error, ValueError, OverflowError):
        return "(damaged)", body[:_PIECE]
    return record.name, dict(record.metadata)


def _attachment(extra: Extra) -> tuple[str, Tree]:
    """Describe an attachment: log and create time, name, media type, then size and content."""
    offset = extra.offset + _HEAD_SIZE
    end = extra.offset + extra.size
    head = extra.source.read(offset, min(_PIECE, end - offset))
    try:
        at, texts = 16, []
        for _ in range(2):
            (length,) = struct.unpack_from("<I", head, at)
            texts.append(str(head[at + 4 : at + 4 + length], "utf-8", "replace"))
            at += 4 + length
        (size,) = struct.unpack_from("<Q", head, at)
    except struct.error:
        return "(damaged)", head
    start = offset + at + 8
    content = hashlib.sha256()
    for piece in range(start, min(start + size, end), _PIECE):
        content.update(extra.source.read(piece, min(_PIECE, start + size - piece)))
    return texts[0], {"media_type": texts[1], "size": size, "sha256": content.hexdigest()}
