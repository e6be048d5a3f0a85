"""Two logs compared: how topics are described, records, then the messages.

Messages belong together when topic and log time are the same, and, where several of a topic have
the same log time, when they have the same index among those in the order of the file.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.comparison.decoders import Undecodable, decoded
from dogbot_logtool.comparison.descriptions import compare_descriptions, compare_records, kind_of
from dogbot_logtool.comparison.fields import compare_fields
from dogbot_logtool.comparison.message_index import Message, MessageIndex, Rows, pair_messages
from dogbot_logtool.comparison.outcome import (
    RECORDS,
    Comparison,
    Difference,
    Findings,
    Kind,
    Tally,
)
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits, nothing_left
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.containers.log import Log, damage_of

_KINDS: Final = (Kind.FIELD, Kind.MISSING, Kind.EXTRA)
"""Kinds of differences between messages, by number."""


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
    logs = expected, actual
    findings = Findings(max_differences)
    names = sorted({name for log in logs for name in log.channels_by_topic if rules.takes(name)})
    if rules.topics and not names:
        raise CallError(f"--topics: neither file has a topic like {', '.join(rules.topics)}")
    topics = [_described(name, logs, findings) for name in names]
    is_whole = not (rules.topics or fits(rules.ignore, RECORDS))
    has_records = is_whole and expected.container == actual.container
    others = [compare_records(expected, actual, rules, findings)] if has_records else []
    indexes = [MessageIndex(log, frozenset(names)) for log in logs]
    start = expected.start_time or actual.start_time or 0
    _compare_messages(indexes, topics, rules, findings, start)
    losses = zip(logs, (each.losses for each in indexes), strict=True)
    damage = [damage_of(log, lost) for log, lost in losses if lost]
    # That both files have a profile says nothing.
    most = 0 if FieldRules(rules).ignored("profile") else 1
    is_nothing = all(each.same and each.both <= most for each in others)
    if rules.ignore and is_nothing and not (names or damage):
        raise nothing_left(rules, "topic")
    one, other = (Path(str(log.source.path)) for log in logs)
    tallies, count = [*topics, *others], findings.count
    return Comparison(one, other, "messages", tallies, findings.differences, count, damage)


def _described(name: str, logs: tuple[Log, Log], findings: Findings) -> Tally:
    """Compare how a topic is described in either log; return its tally."""
    one, other = (log.channels_by_topic.get(name, ()) for log in logs)
    tally = Tally(name, ", ".join(dict.fromkeys(c.type_name for c in (*one, *other))))
    if one and other:
        found = findings.within(Difference(kind=Kind.DESCRIPTION, topic=name))
        compare_descriptions(one, other, found)
    else:
        tally.only_in = "expected" if one else "actual"
        log, what = (logs[0], "missing") if one else (logs[1], "extra")
        count = sum(log.counts.get(channel.id, 0) for channel in (*one, *other))
        found = findings.within(Difference(kind=Kind.TOPIC, topic=name))
        found.add(f"the topic is {what} ({count} messages)")
    findings.take(found)
    tally.faults = found.count
    return tally


def _compare_messages(
    indexes: Sequence[MessageIndex],
    tallies: Sequence[Tally],
    rules: Rules,
    findings: Findings,
    start: int,
) -> None:
    """Pair the messages of each topic, then compare what is not the same in the order of time.

    Args:
        indexes: of both logs.
        tallies: one a topic, to be filled.
        rules: what may differ.
        findings: where to note what is found.
        start: ns, from which times count.
    """
    of_topics = [FieldRules(rules, tally.name) for tally in tallies]
    events = [np.empty((0, 6), np.int64)]
    for topic, tally in enumerate(tallies):
        events += _unequal(topic, tally, *(index.take(tally.name) for index in indexes))
    found = np.concatenate(events)
    for time, topic, kind, row, *positions in found[np.lexsort(found.T[::-1])].tolist():
        tally, time_s = tallies[topic], (time - start) / 1e9
        of = Difference(kind=_KINDS[kind], topic=tally.name, index=row, time_s=time_s)
        noted = findings.within(of)
        if of.kind is Kind.FIELD:
            one, other = map(MessageIndex.message, indexes, positions)
            noted = _compare_pair(one, other, tally, of_topics[topic], noted)
        else:
            noted.add()
        findings.take(noted)


def _unequal(topic: int, tally: Tally, one: Rows, other: Rows) -> Iterator[Ints]:
    """Count the messages of a topic; yield those that are not the same byte for byte.

    Yields:
        (n, 6) log time, topic, kind of difference, row in the topic, positions in either log.
    """
    rows, others, missing, extra = pair_messages(one, other)
    differ = np.flatnonzero(one.digest[rows] != other.digest[others])
    tally.equal += len(rows) - len(differ)
    tally.missing += len(missing)
    tally.extra += len(extra)
    rows, others = rows[differ], others[differ]
    found = [(one, rows, other.position[others])]
    if not tally.only_in:  # such topics were named once and for all
        found += [(one, missing, missing), (other, extra, extra)]
    for kind, (side, row, position) in enumerate(found):
        numbers = np.full(len(row), topic), np.full(len(row), kind)
        yield np.stack([side.log_time[row], *numbers, row, side.position[row], position], axis=1)


def _compare_pair(
    one: Message, other: Message, tally: Tally, rules: FieldRules, found: Findings
) -> Findings:
    """Compare two messages, and count them as one that is equal or not."""
    kinds = kind_of(one.channel), kind_of(other.channel)
    if kinds[0] == kinds[1]:
        if one.payload != other.payload:
            found = _compare_payloads(one, other, tally, rules, found)
        compare_fields(one.publish_time, other.publish_time, rules, found, "publish_time")
    elif tally.faults:  # they were named once, with the topic
        tally.different += 1
        return found
    else:
        compare_fields(*kinds, rules, found, "type")
    tally.deviate(f"[{found.of.index}] {found.tally.deviation_path}", found.tally.deviation)
    is_loose = bool(found.tally.within_tolerance)
    tally.different += bool(found.count)
    tally.within_tolerance += is_loose and not found.count
    tally.equal += not (is_loose or found.count)
    return found


def _compare_payloads(
    one: Message, other: Message, tally: Tally, rules: FieldRules, none: Findings
) -> Findings:
    """Compare payloads field by field; as bytes where they cannot be decoded."""
    try:
        first, second = (decoded(each.channel, each.payload) for each in (one, other))
        return compare_fields(first, second, rules, none.within(none.of))
    except (Undecodable, RecursionError) as error:
        tally.note = f"compared as bytes: {error}"
        return compare_fields(one.payload, other.payload, rules, none, "payload")
