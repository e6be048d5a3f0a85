"""Figures of the timing of each topic."""

from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Member,
    Scope,
    TableName,
)
from dogbot_logtool.report.figures.settings import CLOCKS

_TOPICS: Final = TableName.TOPICS
_NO_HEADER: Final = "its messages have no header"


def _percentile(key: str, words: str) -> Figure[Mapping[str, float]]:
    return Figure(key, Kind.NUMBER, lambda intervals: intervals[key], words, unit="s")


_GAPS: Final[Sequence[Member]] = (
    Figure[TopicQuality](
        "count",
        Kind.COUNT,
        lambda topic: topic.gaps,
        "number of gaps",
        columns=(Column(_TOPICS, "gaps", rank=40),),
    ),
    Figure[TopicQuality](
        "total_s",
        Kind.NUMBER,
        lambda topic: topic.gaps_total_s,
        "sum of their lengths",
        columns=(Column(_TOPICS, "gaps s", 2, rank=50),),
    ),
)
TOPIC: Final[Sequence[Member]] = (
    Figure[TopicQuality](
        "messages",
        Kind.COUNT,
        lambda topic: topic.messages,
        "messages of the topic",
        columns=(Column(_TOPICS, "messages", rank=10, thousands=True),),
    ),
    Figure[TopicQuality](
        "clock",
        Kind.TEXT,
        lambda topic: str(topic.clock),
        "clock of rate, intervals and gaps",
        choices=CLOCKS,
    ),
    Figure[TopicQuality](
        "rate_hz",
        Kind.NUMBER,
        lambda topic: topic.rate_hz,
        "(messages - 1) / (latest - earliest time)",
        null="fewer than 10 messages; all of them within 50 ms",
        columns=(Column(_TOPICS, "Hz", 1, rank=20),),
    ),
    Scope(
        "interval_s",
        (
            _percentile("p50", "median of the intervals between messages"),
            _percentile("p95", "their 95th percentile"),
            _percentile("p99", "their 99th percentile"),
            Figure[Mapping[str, float]](
                "max",
                Kind.NUMBER,
                lambda intervals: intervals["max"],
                "the longest",
                unit="s",
                columns=(Column(_TOPICS, "longest s", 2, rank=60),),
            ),
        ),
        lambda topic: topic.interval_s,
        "intervals between messages; percentiles are right to 0.2 %",
        null="fewer than two messages",
    ),
    Scope(
        "gaps",
        _GAPS,
        lambda source: source,
        "silences longer than max(5 usual intervals, 50 ms); usual is the 95th percentile, or "
        "median + 2 interquartile ranges if that is less; in bursts, that of the silences between "
        "them. None are counted where messages come on events, or are fewer than 11, or where a "
        "sensor is silent in swing",
    ),
    Figure[TopicQuality](
        "duplicate_stamps",
        Kind.COUNT,
        lambda topic: topic.duplicate_stamps,
        "header stamps equal to the one before",
        null=_NO_HEADER,
    ),
    Figure[TopicQuality](
        "backward_stamps",
        Kind.COUNT,
        lambda topic: topic.backward_stamps,
        "header stamps earlier than the one before",
        null=_NO_HEADER,
    ),
    Figure[TopicQuality](
        "zero_stamps",
        Kind.COUNT,
        lambda topic: topic.zero_stamps,
        "header stamps of zero",
        null=_NO_HEADER,
    ),
    Figure[TopicQuality](
        "stamps_ahead",
        Kind.COUNT,
        lambda topic: topic.stamps_ahead,
        "header stamps ahead of those that follow",
        null=_NO_HEADER,
    ),
    Figure[TopicQuality](
        "clock_steps",
        Kind.COUNT,
        lambda topic: len(topic.clock_steps),
        "times at which the clock of its stamps is set to another time",
    ),
    Figure[TopicQuality](
        "duplicate_log_times",
        Kind.COUNT,
        lambda topic: topic.duplicate_log_times,
        "log times equal to the one before",
    ),
    Figure[TopicQuality](
        "backward_log_times",
        Kind.COUNT,
        lambda topic: topic.backward_log_times,
        "log times earlier than the one before",
    ),
    Figure[TopicQuality](
        "header_to_log_offset_s",
        Kind.NUMBER,
        lambda topic: topic.offset_median_s,
        "median of log time minus header stamp",
        null=_NO_HEADER,
        columns=(Column(_TOPICS, "log - stamp s", 3, rank=70),),
    ),
    Figure[TopicQuality](
        "header_to_log_drift_ppm",
        Kind.NUMBER,
        lambda topic: topic.offset_drift_ppm,
        "millionths by which log time runs faster than the stamps",
        null=f"{_NO_HEADER}; less than 5 s",
    ),
)
"""Figures of the timing of a topic."""
