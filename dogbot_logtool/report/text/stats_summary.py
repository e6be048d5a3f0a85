"""The figures of a log among several: a row of a few."""

from pathlib import Path
from typing import Final

from dogbot_logtool.finding import Severity
from dogbot_logtool.io.printable import printable
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.numbers import NOTHING
from dogbot_logtool.report.tables import SUMMARY, cells_of, headers
from dogbot_logtool.report.verdict import gait_name
from dogbot_logtool.results import Measurement

SUMMARY_HEADERS: Final = ("log", "gait", *headers(SUMMARY), "warnings", "damage")
"""Headings of a `summary_row`."""


def summary_row(measured: Measurement) -> tuple[str, ...]:
    """Return the row of a log among several."""
    main = measured.stats.main
    notes = [each.severity is Severity.NOTE for each in measured.findings]
    return (
        printable(Path(measured.facts.path).name),
        NOTHING if main is None or main.gait.name is None else gait_name(main).lower(),
        *cells_of(SUMMARY, measured.metrics),
        str(notes.count(False)),
        _damage(measured.damage),
    )


def _damage(damage: Damage) -> str:
    """Say in a word or two what could not be read."""
    lost = damage.messages
    if not (damage.losses or damage.bytes or lost != 0):
        return NOTHING
    return f"{lost} lost" if lost else "damaged"
