"""Two logs compared: how topics are described, records, then the messages, window by window.

Messages belong together when topic and log time are the same, and, where several of a topic have
the same log time, when they have the same index among those in the order of the file.
"""

from collections.abc import Iterator, Sequence
from itertools import repeat
from pathlib import Path

import numpy as np

from dogbot_logtool.comparison.decoders import Decoder, Undecodable, decoder_of
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
from dogbot_logtool.reader.containers.log import Channel, Log
from dogbot_logtool.reader.losses import damage_of


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
        return _compare(expected, actual, rules, Findings(max_differences), measured=False)
    except UntrueTimes:
        # The index of one of them does not tell the truth: read both once more for it.
        return _compare(expected, actual, rules, Findings(max_differences), measured=True)


def _compare(
    expected: Log, actual: Log, rules: Rules, findings: Findings, *, measured: bool
) -> Comparison:
    logs = expected, actual
    names = sorted({name for log in logs for name in log.channels_by_topic if rules.takes(name)})
    if rules.topics and not names:
        raise CallError(f"--topics: neither file has a topic like {', '.join(rules.topics)}")
    tallies = [_described(name, logs, findings) for name in names]
    numbers = {name: number for number, name in enumerate(names)}
    kinds: dict[str, int] = {}
    sides = [Side(log, numbers, kinds, measured=measured) for log in logs]
    comparer = _MessageComparer(tuple(tallies), rules, findings, logs)
    if not (rules.topics or fits(rules.ignore, RECORDS)) and expected.container == actual.container:
        tallies.append(compare_records(expected, actual, rules, findings))
    for window in plan_windows(sides):
        comparer.compare(*(side.load(window) for side in sides))
    # A damaged chunk is met again in each window that it reaches into.
    damage = [damage_of(each.log, dict.fromkeys(each.losses)) for each in sides if each.losses]
    if rules.ignore and not damage and not _anything(tallies, rules):
        raise nothing_left(rules, "topic")
    return Comparison(
        Path(str(expected.source.path)),
        Path(str(actual.source.path)),
        "messages",
        tallies,
        findings.differences,
        findings.count,
        damage,
    )


def _anything(tallies: Sequence[Tally], rules: Rules) -> bool:
    """Tell whether something was compared; that both files have a profile says nothing."""
    least = 0 if FieldRules(rules).ignored("profile") else 1
    return any(
        tally.name != RECORDS or max(tally.expected, tally.actual) > least or not tally.same
        for tally in tallies
    )


def _described(name: str, logs: tuple[Log, Log], findings: Findings) -> Tally:
    """Compare how a topic is described in either log; return its tally."""
    one, other = (log.channels_by_topic.get(name, ()) for log in logs)
    tally = Tally(name, ", ".join(dict.fromkeys(c.type_name for c in (*one, *other))))
    if one and other:
        found = Findings(findings.room)
        compare_descriptions(one, other, found)
        findings.take(found, Difference(kind=Kind.DESCRIPTION, topic=name))
        tally.faults = found.count
        return tally
    tally.only_in = "expected" if one else "actual"
    log, what = (logs[0], "missing") if one else (logs[1], "extra")
    count = sum(log.counts.get(channel.id, 0) for channel in (*one, *other))
    text = f"the topic is {what} ({count} messages)"
    findings.add(Difference(text, kind=Kind.TOPIC, topic=name))
    tally.faults = 1
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
        self._decoders: dict[tuple[int, int], Decoder | str] = {}
        """By side and channel; a text says why there is none."""
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
        self._add("expected", counts[0])
        self._add("actual", counts[1])
        self._add("equal", self._counted(one.topic[rows[same]]))
        self._add("missing", self._counted(one.topic[missing]))
        self._add("extra", self._counted(other.topic[extra]))
        events = [
            *_events(_PAIR, one, rows[~same], others[~same]),
            *_events(_MISSING, one, missing, missing),
            *_events(_EXTRA, other, extra, extra),
        ]
        for time, topic, what, row, second in sorted(events):
            tally = self._tallies[topic]
            index = row + int(before[int(what == _EXTRA), topic])
            kind = {_PAIR: Kind.FIELD, _MISSING: Kind.MISSING, _EXTRA: Kind.EXTRA}[what]
            time_s = (time - self._origin) / 1e9
            where = Difference(kind=kind, topic=tally.name, index=index, time_s=time_s)
            if what == _PAIR:
                found = self._compare_pair(topic, one, row, other, second)
                tally.deviate(f"[{index}] {found.deviation_path}", found.deviation)
                self._findings.take(found, where)
            elif not tally.only_in:  # such topics were named once and for all
                self._findings.add(where)

    def _counted(self, topic: Ints) -> Ints:
        """Return the number of messages of each topic."""
        return np.bincount(topic, minlength=len(self._tallies))

    def _add(self, name: str, numbers: Ints) -> None:
        """Add to a count of the tallies."""
        for topic in np.flatnonzero(numbers).tolist():
            tally = self._tallies[topic]
            setattr(tally, name, getattr(tally, name) + int(numbers[topic]))

    def _compare_pair(
        self, topic: int, one: Block, row: int, other: Block, second: int
    ) -> Findings:
        """Compare two messages, and count them as one that is equal or not."""
        tally, rules = self._tallies[topic], self._rules[topic]
        found = Findings(self._findings.room)
        first = self._channels[0][int(one.messages.channel[row])]
        then = self._channels[1][int(other.messages.channel[second])]
        if kind_of(first) == kind_of(then):
            payloads = one.payload(row), other.payload(second)
            found = self._compare_payloads(topic, (first, then), payloads)
            times = [int(b.messages.publish_time[r]) for b, r in ((one, row), (other, second))]
            compare_fields(times[0], times[1], rules, found, "publish_time")
        elif not tally.faults:
            compare_fields(kind_of(first), kind_of(then), rules, found, "type")
        else:  # they were named once, with the topic
            tally.different += 1
            return found
        tally.different += bool(found.count)
        tally.within_tolerance += bool(not found.count and found.loose)
        tally.equal += not (found.count or found.loose)
        return found

    def _compare_payloads(
        self, topic: int, channels: Sequence[Channel], payloads: tuple[bytes, bytes]
    ) -> Findings:
        rules, found = self._rules[topic], Findings(self._findings.room)
        one, other = payloads
        if one == other:
            return found
        try:
            trees = [
                self._decoder(side, channel)(data)
                for side, (channel, data) in enumerate(zip(channels, payloads, strict=True))
            ]
            return compare_fields(trees[0], trees[1], rules, found)
        except Undecodable as undecodable:
            reason = str(undecodable)
        except RecursionError:
            reason = "a message is nested too deeply"
        self._tallies[topic].note = f"compared as bytes: {reason}"
        return compare_fields(one, other, rules, Findings(self._findings.room), "payload")

    def _decoder(self, side: int, channel: Channel) -> Decoder:
        """Return a channel's decoder, made once; so is the error where there is none."""
        if (side, channel.id) not in self._decoders:
            try:
                self._decoders[side, channel.id] = decoder_of(channel)
            except Undecodable as error:
                self._decoders[side, channel.id] = str(error)
        found = self._decoders[side, channel.id]
        if isinstance(found, str):
            raise Undecodable(found)
        return found


_PAIR, _MISSING, _EXTRA = range(3)


def _events(what: int, block: Block, rows: Ints, others: Ints) -> Iterator[tuple[int, ...]]:
    """Yield what is looked at one by one: log time, topic, kind of event, and the two rows."""
    time, topic = block.messages.log_time[rows].tolist(), block.topic[rows].tolist()
    return zip(time, topic, repeat(what), rows.tolist(), others.tolist())
