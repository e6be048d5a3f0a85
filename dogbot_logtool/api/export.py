"""`export` of a log: one of a walk's tables, behind the log's name."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dogbot_logtool.api.table import Table, texts
from dogbot_logtool.api.walk import Walk
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.io.storage import Location, shown

if TYPE_CHECKING:
    from dogbot_logtool.options import MeasureOptions
    from dogbot_logtool.report.table_file import TableFile
    from dogbot_logtool.results import Measurement
    from dogbot_logtool.run.runner import OnProgress


@dataclass(frozen=True, slots=True)
class Export:
    """Writes a table of each log that it is called with."""

    options: "MeasureOptions"
    table: str
    """``strides``, ``stances``, ``joints``, ``events``, ``base``, ``commands`` or ``samples``."""
    file: "TableFile"

    def __call__(self, log: Location, progress: "OnProgress | None" = None) -> "Measurement":
        """Measure a log and write its rows."""
        measured = measure(log, self.options, progress)
        walk, name = Walk(log, measured, self.options), shown(log)
        if self.table == "samples":
            for table in walk.all_samples():
                self._add(name, table)
        else:
            self._add(name, getattr(walk, self.table))
        return measured

    def finish(self) -> None:
        """Write what stands at the end of the file."""
        self.file.finish()

    def _add(self, log: str, table: Table) -> None:
        self.file.add({"log": texts([log] * len(table)), **table.columns})
