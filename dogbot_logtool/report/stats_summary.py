"""The figures of a log among several: a row of a few."""

from pathlib import Path
from typing import Final

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.figures.document import DOCUMENT, log_source
from dogbot_logtool.report.figures.figure import TableName
from dogbot_logtool.report.figures.tables import cells_of, headers
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.report.verdict import gait_name
from dogbot_logtool.results import LogFacts

SUMMARY_HEADERS: Final = ("log", "gait", *headers(TableName.SUMMARY), "warnings", "damage")
"""Headings of a `summary_row`."""


def summary_row(stats: Stats, log: LogFacts) -> tuple[str, ...]:
    """Return the row of a log among several."""
    main, source = stats.main, log_source(stats, log)
    return (
        printable(Path(log.path).name),
        NOTHING if main is None or main.gait.name is None else gait_name(main).lower(),
        *cells_of(TableName.SUMMARY, DOCUMENT.plain(source)),
        str(source.doubts),
        _damage(log),
    )


def _damage(log: LogFacts) -> str:
    """Say in a word or two what could not be read."""
    if not (log.losses or log.lost_bytes or log.lost_messages != 0):
        return NOTHING
    return f"{log.lost_messages} lost" if log.lost_messages else "damaged"
