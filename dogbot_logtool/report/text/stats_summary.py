"""The figures of a log among several: a row of a few."""

from pathlib import Path
from typing import Final

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Severity
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.figures.figure import Json, TableName
from dogbot_logtool.report.figures.tables import cells_of, headers
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.report.verdict import gait_name

SUMMARY_HEADERS: Final = ("log", "gait", *headers(TableName.SUMMARY), "warnings", "damage")
"""Headings of a `summary_row`."""


def summary_row(stats: Stats, document: Json) -> tuple[str, ...]:
    """Return the row of a log among several.

    Args:
        stats: its figures.
        document: the same as `stats_json`.
    """
    main = stats.main
    notes = [each["severity"] == Severity.NOTE.word for each in document["findings"]]
    return (
        printable(Path(document["log"]["path"]).name),
        NOTHING if main is None or main.gait.name is None else gait_name(main).lower(),
        *cells_of(TableName.SUMMARY, document),
        str(notes.count(False)),
        _damage(document["quality"]),
    )


def _damage(quality: Json) -> str:
    """Say in a word or two what could not be read."""
    lost = quality["lost_messages"]
    if not (quality["losses"] or quality["lost_bytes"] or lost != 0):
        return NOTHING
    return f"{lost} lost" if lost else "damaged"
