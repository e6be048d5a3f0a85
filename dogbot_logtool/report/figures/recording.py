"""Figures of the log itself: facts, settings, findings."""

from collections.abc import Sequence
from typing import Final

from dogbot_logtool.finding import Finding, Severity
from dogbot_logtool.report.figures.figure import Column, Figure, Json, Kind, TableName
from dogbot_logtool.results import LogFacts

_LOG_ROWS: Final = TableName.LOG_ROWS

LOG: Final[Sequence[Figure[LogFacts]]] = (
    Figure("path", Kind.TEXT, lambda log: log.path, "the log, as it was named"),
    Figure(
        "container",
        Kind.TEXT,
        lambda log: log.container,
        "kind of file",
        columns=(Column(_LOG_ROWS, "container", rank=10),),
    ),
    Figure("profile", Kind.TEXT, lambda log: log.profile, "profile of the file: ros1, ros2"),
    Figure(
        "start_s",
        Kind.NUMBER,
        lambda log: log.start_s,
        "log time of the first message, since the epoch",
        null="the log holds no message",
        columns=(Column(_LOG_ROWS, "log_start_s", rank=10),),
    ),
    Figure(
        "duration_s",
        Kind.NUMBER,
        lambda log: log.duration_s,
        "log time of the last message minus that of the first",
        null="the log holds no message",
        columns=(
            Column(TableName.INDEX, "duration s", 2, rank=10),
            Column(_LOG_ROWS, "log_duration_s", rank=10),
        ),
    ),
    Figure(
        "messages",
        Kind.COUNT,
        lambda log: log.messages,
        "messages in the log",
        columns=(Column(_LOG_ROWS, "messages", rank=10),),
    ),
)
"""Facts about the log."""

FINDING: Final[Sequence[Figure[Finding]]] = (
    Figure("code", Kind.TEXT, lambda each: each.code, "what it is: see findings.md"),
    Figure(
        "severity",
        Kind.TEXT,
        lambda each: each.severity.word,
        "how much it matters",
        choices=tuple(each.word for each in Severity),
    ),
    Figure("text", Kind.TEXT, lambda each: each.text, "a sentence about this log"),
    Figure(
        "remedy",
        Kind.TEXT,
        lambda each: each.remedy,
        "what to do about it",
    ),
    Figure(
        "where",
        Kind.TEXT,
        lambda each: each.where or None,
        "the figure or topic that it is about",
        null="it is about the whole log",
    ),
    Figure(
        "voids",
        Kind.TEXTS,
        lambda each: list(each.voids),
        "patterns of the figures that it sets to null",
    ),
)
"""A finding about a log."""


def finding_json(finding: Finding) -> Json:
    """Return a finding as plain data."""
    return {figure.key: figure.plain(finding) for figure in FINDING}
