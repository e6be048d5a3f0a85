"""Two logs compared: what describes the topics, records, then the messages, window by window."""

from collections.abc import Callable, Iterator, Mapping, Sequence

from dogbot_logtool.comparison.fields import Findings, compare_fields
from dogbot_logtool.comparison.logs.field_names import ALWAYS, message_fields, tree_names
from dogbot_logtool.comparison.logs.messages import MessageSweep
from dogbot_logtool.comparison.logs.records import OWN_VERSION, records_tree
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
    FileLoss,
    Kind,
    Tally,
)
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, nothing_left
from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.containers.log import Log, Loss

_MakeTrack = Callable[[Log, Mapping[int, int]], Track]


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
    if (
        not (rules.topics or rules.fit(rules.ignore, RECORDS))
        and expected.container == actual.container
    ):
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
    for log in (expected, actual) if rules.unmatched else ():
        _note_names(log, rules)
    return Comparison(
        expected.source.path,
        actual.source.path,
        "messages",
        tallies,
        differences.kept,
        differences.count,
        [*_file_losses(expected, losses[0]), *_file_losses(actual, losses[1])],
        rules.warnings(),
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


def _note_names(log: Log, rules: Rules) -> None:
    """Note which globs fit what a log has, whether or not it was compared or had to be decoded."""
    records = FieldRules(rules)
    for name in tree_names(records_tree(log)):
        records.note(name)
    for channel in log.channels.values():
        fields, names = FieldRules(rules, channel.topic), message_fields(channel)
        for name in (*ALWAYS, *(names or ())):
            fields.note(name)
        if names is None:
            fields.note_unknown()


def _topic_numbers(topics: Sequence[Topic], *, is_expected: bool) -> Mapping[int, int]:
    return {
        channel.id: number
        for number, topic in enumerate(topics)
        for channel in (topic.expected if is_expected else topic.actual)
    }


def _file_losses(log: Log, losses: Sequence[Loss]) -> Iterator[FileLoss]:
    # A damaged chunk is met again in each window that it reaches into.
    for loss in dict.fromkeys(losses):
        yield FileLoss(log.source.path, loss)


def _compare_records(expected: Log, actual: Log, rules: Rules, differences: Differences) -> Tally:
    """Compare what is no message; an entry of a metadata record counts as one."""
    tally = Tally(RECORDS)
    findings = Findings(differences.limit)
    ignoring = FieldRules(rules.ignoring(OWN_VERSION))
    compare_fields(records_tree(expected), records_tree(actual), ignoring, findings)
    differences.take(findings, RECORDS, Kind.DESCRIPTION)
    tally.count_leaves(findings)
    return tally
