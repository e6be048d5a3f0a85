"""Two logs compared: how topics are described, records, then the messages, window by window.

Messages belong together when topic and log time are the same, and, where several of a topic have
the same log time, when they have the same index among those in the order of the file.
"""

from collections.abc import Iterator, Sequence
from itertools import repeat
from pathlib import Path

import numpy as np

from dogbot_logtool.comparison.decoders import Undecodable, decoded
from dogbot_logtool.comparison.descriptions import compare_descriptions, compare_records, kind_of
from dogbot_logtool.comparison.fields import compare_fields
from dogbot_logtool.comparison.outcome import (
    RECORDS,
    Comparison,
    Difference,
    Findings,
    Kind,
    Tally,
)
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, fits, nothing_left
from dogbot_logtool.comparison.windows import (
    Block,
    Side,
    UntrueTimes,
    pair_messages,
    plan_windows,
    same_payloads,
)
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.containers.log import Channel, Log, damage_of


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
        return _compare((expected, actual), rules, max_differences, measured=False)
    except UntrueTimes:
        # The index of one of them does not tell the truth: read both once more for it.
        return _compare((expected, actual), rules, max_differences, measured=True)


def _compare(
    logs: tuple[Log, Log], rules: Rules, max_differences: int, *, measured: bool
) -> Comparison:
    findings = Findings(max_differences)
    names = sorted({name for log in logs for name in log.channels_by_topic if rules.takes(name)})
    if rules.topics and not names:
        raise CallError(f"--topics: neither file has a topic like {', '.join(rules.topics)}")
    tallies = [_described(name, logs, findings) for name in names]
    numbers = {name: number for number, name in enumerate(names)}
    kinds: dict[str, int] = {}
    sides = [Side(log, numbers, kinds, measured=measured) for log in logs]
    comparer = _MessageComparer(tuple(tallies), rules, findings, logs)
    is_whole = not (rules.topics or fits(rules.ignore, RECORDS))
    if is_whole and logs[0].container == logs[1].container:
        tallies.append(compare_records(*logs, rules, findings))
    for window in plan_windows(sides):
        comparer.compare(*(side.load(window) for side in sides))
    # A damaged chunk is met again in each window that it reaches into.
    damage = [damage_of(each.log, dict.fromkeys(each.losses)) for each in sides if each.losses]
    # That both files have a profile says nothing.
    most = 0 if FieldRules(rules).ignored("profile") else 1
    is_nothing = all(each.same and each.both <= most for each in tallies)
    if rules.ignore and is_nothing and not (names or damage):
        raise nothing_left(rules, "topic")
    one, other = (Path(str(log.source.path)) for log in logs)
    count = findings.count
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


class _MessageComparer:
    """Goes through both logs window by window and fills the topics' tallies."""

    def __init__(
        self, tallies: Sequence[Tally], rules: Rules, findings: Findings, logs: Sequence[Log]
    ) -> None:
        self._tallies = tallies
        self._rules = [FieldRules(rules, tally.name) for tally in tallies]
        self._findings = findings
        self._channels = [log.channels for log in logs]
        self._origin = logs[0].start_time or logs[1].start_time or 0
        self._seen = np.zeros((2, len(tallies)), np.int64)
        """Messages of each topic in the windows before."""

    def compare(self, one: Block, other: Block) -> None:
        """Compare the messages of a window."""
        counts = [self._counted(block.topic) for block in (one, other)]
        # Messages stand by topic, so that a row is an index in it but for what stands before.
        before = self._seen + counts - np.cumsum(counts, axis=1)
        self._seen += counts
        rows, others, missing, extra = pair_messages(one, other)
        same = same_payloads(one, rows, other, others)
        same &= one.messages.publish_time[rows] == other.messages.publish_time[others]
        same &= one.kind[rows] == other.kind[others]
        numbers = zip(
            self._counted(one.topic[rows[same]]).tolist(),
            self._counted(one.topic[missing]).tolist(),
            self._counted(other.topic[extra]).tolist(),
            strict=True,
        )
        for tally, (equal, absent, more) in zip(self._tallies, numbers, strict=True):
            tally.equal += equal
            tally.missing += absent
            tally.extra += more
        events = [
            *_events(Kind.FIELD, one, rows[~same], others[~same]),
            *_events(Kind.MISSING, one, missing, missing),
            *_events(Kind.EXTRA, other, extra, extra),
        ]
        for time, topic, row, second, kind in sorted(events):
            tally = self._tallies[topic]
            index = row + int(before[int(kind is Kind.EXTRA), topic])
            time_s = (time - self._origin) / 1e9
            of = Difference(kind=kind, topic=tally.name, index=index, time_s=time_s)
            if kind is Kind.FIELD:
                self._compare_pair(topic, (one, row), (other, second), of)
            elif not tally.only_in:  # such topics were named once and for all
                found = self._findings.within(of)
                found.add()
                self._findings.take(found)

    def _counted(self, topic: Ints) -> Ints:
        """Return the number of messages of each topic."""
        return np.bincount(topic, minlength=len(self._tallies))

    def _compare_pair(
        self, topic: int, one: tuple[Block, int], other: tuple[Block, int], of: Difference
    ) -> None:
        """Compare two messages, and count them as one that is equal or not."""
        tally, rules = self._tallies[topic], self._rules[topic]
        channels = [
            channels[int(block.messages.channel[row])]
            for channels, (block, row) in zip(self._channels, (one, other), strict=True)
        ]
        kinds = [kind_of(channel) for channel in channels]
        if kinds[0] == kinds[1]:
            payloads = [block.payload(row) for block, row in (one, other)]
            found = self._compare_payloads(topic, channels, payloads, of)
            times = [int(block.messages.publish_time[row]) for block, row in (one, other)]
            compare_fields(times[0], times[1], rules, found, "publish_time")
        elif tally.faults:  # they were named once, with the topic
            tally.different += 1
            return
        else:
            found = compare_fields(kinds[0], kinds[1], rules, self._findings.within(of), "type")
        self._findings.take(found)
        tally.deviate(f"[{of.index}] {found.tally.deviation_path}", found.tally.deviation)
        is_loose = bool(found.tally.within_tolerance)
        tally.different += bool(found.count)
        tally.within_tolerance += is_loose and not found.count
        tally.equal += not (is_loose or found.count)

    def _compare_payloads(
        self, topic: int, channels: Sequence[Channel], payloads: Sequence[bytes], of: Difference
    ) -> Findings:
        """Compare payloads field by field; as bytes where they cannot be decoded."""
        rules, found = self._rules[topic], self._findings.within(of)
        if payloads[0] == payloads[1]:
            return found
        try:
            one, other = map(decoded, channels, payloads)
            return compare_fields(one, other, rules, found)
        except Undecodable as undecodable:
            reason = str(undecodable)
        except RecursionError:
            reason = "a message is nested too deeply"
        self._tallies[topic].note = f"compared as bytes: {reason}"
        return compare_fields(payloads[0], payloads[1], rules, self._findings.within(of), "payload")


def _events(
    kind: Kind, block: Block, rows: Ints, others: Ints
) -> Iterator[tuple[int, int, int, int, Kind]]:
    """Yield what is looked at one by one: log time, topic, the two rows, kind."""
    time, topic = block.messages.log_time[rows].tolist(), block.topic[rows].tolist()
    return zip(time, topic, rows.tolist(), others.tolist(), repeat(kind), strict=False)
