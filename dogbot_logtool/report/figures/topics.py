"""Figures of the timing of each topic."""

from collections.abc import Mapping, Sequence
from typing import Final

from dogbot_logtool.core.quality.quality import Gap, TopicQuality
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.report.figures.figure import (
    Column,
    Figure,
    Kind,
    Member,
    Scope,
    Shape,
    TableName,
)
from dogbot_logtool.report.figures.settings import CLOCKS

_TOPICS: Final = TableName.TOPICS
_NO_HEADER: Final = "its messages have no header"


@dataclass(frozen=True, slots=True)
class TopicSource:
    """The source of a topic's figures."""

    topic: TopicQuality
    origin: int
    """ns, what its times are counted from."""

    def seconds(self, time: int) -> float:
        """Return a time as seconds since the origin."""
        return (time - self.origin) / 1e9


def topic_sources(stats: Stats) -> dict[str, TopicSource]:
    """Return what the figures of each topic are taken from.

    A topic on another clock than the figures counts from its own first message.
    """
    return {
        topic.topic: TopicSource(
            topic, stats.origin if topic.clock is stats.settings.clock else topic.first
        )
        for topic in stats.topics
    }


def _percentile(key: str, words: str) -> Figure[Mapping[str, float]]:
    return Figure(key, Kind.NUMBER, lambda intervals: intervals[key], words, unit="s")


@dataclass(frozen=True, slots=True)
class _GapSource:
    gap: Gap
    topic: TopicSource


def _longest(source: TopicSource) -> list[_GapSource]:
    return [_GapSource(gap, source) for gap in source.topic.longest_gaps]


_GAP: Final[Sequence[Figure[_GapSource]]] = (
    Figure(
        "start_s",
        Kind.NUMBER,
        lambda source: source.topic.seconds(source.gap.start),
        "the last message before it, since the log's start",
    ),
    Figure(
        "length_s",
        Kind.NUMBER,
        lambda source: source.gap.length_s,
        "how long it lasts",
        columns=(Column(_TOPICS, "longest s", 2, rank=60, first=True),),
    ),
)
_GAPS: Final[Sequence[Member]] = (
    Figure[TopicSource](
        "count",
        Kind.COUNT,
        lambda source: source.topic.gaps,
        "number of gaps",
        columns=(Column(_TOPICS, "gaps", rank=40),),
    ),
    Figure[TopicSource](
        "total_s",
        Kind.NUMBER,
        lambda source: source.topic.gaps_total_s,
        "sum of their lengths",
        columns=(Column(_TOPICS, "gaps s", 2, rank=50),),
    ),
    Scope("longest", _GAP, _longest, "the five longest, the longest first", shape=Shape.LIST),
)
TOPIC: Final[Sequence[Member]] = (
    Figure[TopicSource](
        "messages",
        Kind.COUNT,
        lambda source: source.topic.messages,
        "messages of the topic",
        columns=(Column(_TOPICS, "messages", rank=10, thousands=True),),
    ),
    Figure[TopicSource](
        "clock",
        Kind.TEXT,
        lambda source: str(source.topic.clock),
        "clock of first, last, rates, intervals and gaps",
        choices=CLOCKS,
    ),
    Figure[TopicSource](
        "first_s",
        Kind.NUMBER,
        lambda source: source.seconds(source.topic.first),
        "earliest time on that clock, since the log's start",
    ),
    Figure[TopicSource](
        "last_s",
        Kind.NUMBER,
        lambda source: source.seconds(source.topic.last),
        "latest time on that clock, since the log's start",
    ),
    Figure[TopicSource](
        "rate_hz",
        Kind.NUMBER,
        lambda source: source.topic.rate_hz,
        "(messages - 1) / (last - first)",
        null="fewer than 10 messages; all of them within 50 ms",
        columns=(Column(_TOPICS, "Hz", 1, rank=20),),
    ),
    Figure[TopicSource](
        "median_rate_hz",
        Kind.NUMBER,
        lambda source: source.topic.median_rate_hz,
        "1 / median interval; in bursts, messages / the time without gaps",
        null="no interval is usual",
        columns=(Column(_TOPICS, "usual Hz", 1, rank=30),),
    ),
    Scope(
        "interval_s",
        (
            _percentile("p50", "median of the intervals between messages"),
            _percentile("p95", "their 95th percentile"),
            _percentile("p99", "their 99th percentile"),
            _percentile("max", "the longest"),
        ),
        lambda source: source.topic.interval_s,
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
    Figure[TopicSource](
        "duplicate_stamps",
        Kind.COUNT,
        lambda source: source.topic.duplicate_stamps,
        "header stamps equal to the one before",
        null=_NO_HEADER,
    ),
    Figure[TopicSource](
        "backward_stamps",
        Kind.COUNT,
        lambda source: source.topic.backward_stamps,
        "header stamps earlier than the one before",
        null=_NO_HEADER,
    ),
    Figure[TopicSource](
        "zero_stamps",
        Kind.COUNT,
        lambda source: source.topic.zero_stamps,
        "header stamps of zero",
        null=_NO_HEADER,
    ),
    Figure[TopicSource](
        "stamps_ahead",
        Kind.COUNT,
        lambda source: source.topic.stamps_ahead,
        "header stamps ahead of those that follow",
        null=_NO_HEADER,
    ),
    Figure[TopicSource](
        "clock_steps",
        Kind.COUNT,
        lambda source: len(source.topic.clock_steps),
        "times at which the clock of its stamps is set to another time",
    ),
    Figure[TopicSource](
        "duplicate_log_times",
        Kind.COUNT,
        lambda source: source.topic.duplicate_log_times,
        "log times equal to the one before",
    ),
    Figure[TopicSource](
        "backward_log_times",
        Kind.COUNT,
        lambda source: source.topic.backward_log_times,
        "log times earlier than the one before",
    ),
    Figure[TopicSource](
        "header_to_log_offset_s",
        Kind.NUMBER,
        lambda source: source.topic.offset_median_s,
        "median of log time minus header stamp",
        null=_NO_HEADER,
        columns=(Column(_TOPICS, "log - stamp s", 3, rank=70),),
    ),
    Figure[TopicSource](
        "header_to_log_drift_ppm",
        Kind.NUMBER,
        lambda source: source.topic.offset_drift_ppm,
        "millionths by which log time runs faster than the stamps",
        null=f"{_NO_HEADER}; less than 5 s",
    ),
    Figure[TopicSource](
        "frame_ids",
        Kind.TEXTS,
        lambda source: list(source.topic.frame_ids),
        "frame ids of its headers",
    ),
)
"""Figures of the timing of a topic, from a `TopicSource`."""
