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
from dogbot_logtool.comparison.outcome import RECORDS, Comparison, Differences, Kind, Leaf, Tally
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits
from dogbot_logtool.core.arrays import Ints
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
    names = sorted({name for log in logs for name in log.channels_by_topic if rules.takes(name)})
    if not names:
        rules.refuse_nothing("topic")
    found = Differences(max_differences)
    tallies = [_described(name, logs, found) for name in names]
    indexes = [MessageIndex(log, frozenset(names)) for log in logs]
    is_whole = not (rules.topics or fits(rules.ignore, RECORDS))
    if is_whole and expected.container == actual.container:
        tallies.append(Tally(RECORDS))
        for leaf in compare_records(expected, actual, rules):
            tallies[-1].add(leaf)
            found.add(leaf, kind=Kind.DESCRIPTION, topic=RECORDS)
    start = expected.start_time or actual.start_time or 0
    _compare_messages(indexes, tallies[: len(names)], rules, found, start)
    losses = zip(logs, (each.losses for each in indexes), strict=True)
    damage = [damage_of(log, lost) for log, lost in losses if lost]
    one, other = (Path(str(log.source.path)) for log in logs)
    return Comparison(one, other, "messages", tallies, found.kept, found.count, damage)


def _described(name: str, logs: tuple[Log, Log], found: Differences) -> Tally:
    """Compare how a topic is described in either log; return its tally."""
    one, other = (log.channels_by_topic.get(name, ()) for log in logs)
    tally = Tally(name, ", ".join(dict.fromkeys(c.type_name for c in (*one, *other))))
    kind, leaves = Kind.DESCRIPTION, [*compare_descriptions(one, other)]
    if not (one and other):
        tally.only_in = "expected" if one else "actual"
        log, what = (logs[0], "missing") if one else (logs[1], "extra")
        count = sum(log.counts.get(channel.id, 0) for channel in (*one, *other))
        kind, leaves = Kind.TOPIC, [Leaf("different", f"the topic is {what} ({count} messages)")]
    tally.described_differently = len(leaves)
    for leaf in leaves:
        found.add(leaf, kind=kind, topic=name)
    return tally


def _compare_messages(
    indexes: Sequence[MessageIndex],
    tallies: Sequence[Tally],
    rules: Rules,
    found: Differences,
    start: int,
) -> None:
    """Pair the messages of each topic, then compare what is not the same in the order of time.

    Args:
        indexes: of both logs.
        tallies: one a topic, to be filled.
        rules: what may differ.
        found: where to note what differs.
        start: ns, from which times count.
    """
    of_topics = [FieldRules(rules, tally.name) for tally in tallies]
    events = [np.empty((0, 6), np.int64)]
    for topic, tally in enumerate(tallies):
        events += _unequal(topic, tally, *(index.take(tally.name) for index in indexes))
    rows = np.concatenate(events)
    for time, topic, number, row, *positions in rows[np.lexsort(rows.T[::-1])].tolist():
        tally, kind, leaves = tallies[topic], _KINDS[number], [Leaf("missing")]
        if kind is Kind.FIELD:
            one, other = map(MessageIndex.message, indexes, positions)
            leaves = _compare_pair(one, other, tally, of_topics[topic])
            tally.add_message(row, leaves)
        for leaf in leaves:
            found.add(leaf, kind=kind, topic=tally.name, index=row, time_s=(time - start) / 1e9)


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


def _compare_pair(one: Message, other: Message, tally: Tally, rules: FieldRules) -> list[Leaf]:
    """Compare two messages field by field; as bytes where they cannot be decoded."""
    kinds = kind_of(one.channel), kind_of(other.channel)
    if kinds[0] != kinds[1]:
        # Where the channels differ, that was named once, with the topic.
        return [Leaf("different", "type", *kinds, values=int(not tally.described_differently))]
    leaves = [*compare_fields(one.publish_time, other.publish_time, rules, "publish_time")]
    if one.payload == other.payload:
        return leaves
    try:
        first, second = (decoded(each.channel, each.payload) for each in (one, other))
        return [*compare_fields(first, second, rules), *leaves]
    except (Undecodable, RecursionError) as error:
        tally.note = f"compared as bytes: {error}"
        return [*compare_fields(one.payload, other.payload, rules, "payload"), *leaves]
