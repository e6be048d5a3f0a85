"""`export` of a log: one of a walk's tables, behind the log's name."""

from typing import TYPE_CHECKING

from dogbot_logtool.api.table import Table, texts
from dogbot_logtool.api.walk import Walk
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.storage import Location, shown

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import StatsOptions
    from dogbot_logtool.report.table_file import TableFile
    from dogbot_logtool.run.in_order import OnProgress


@dataclass(frozen=True, slots=True)
class Export:
    """Writes a table of each log that it is called with."""

    options: "StatsOptions"
    table: str
    """``strides``, ``stances``, ``events``, ``base`` or ``samples``."""
    file: "TableFile"

    def __call__(self, log: Location, on_progress: "OnProgress | None") -> int:
        """Measure a log and write its rows; return the exit code of measuring it."""
        measured = measure(log, self.options, on_progress)
        walk, name = Walk(log, measured, self.options), shown(log)
        if self.table == "samples":
            walk.each_block_of_samples(lambda block: self._add(name, block))
        else:
            self._add(name, getattr(walk, self.table))
        return measured.exit_code

    def _add(self, log: str, table: Table) -> None:
        self.file.add({"log": texts([log] * len(table)), **table.columns})
