"""`export` of a log: one of a walk's tables, behind the log's name, or its events as labels."""

from typing import TYPE_CHECKING, BinaryIO

from dogbot_logtool.api.table import Table, texts
from dogbot_logtool.api.walk import Walk
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.storage import Location, shown
from dogbot_logtool.report.documents.stats_json import stats_json
from dogbot_logtool.report.files.event_files import event_file

if TYPE_CHECKING:
    from dogbot_logtool.pipeline.options import StatsOptions
    from dogbot_logtool.report.files.table_file import TableFile
    from dogbot_logtool.run.in_order import OnProgress


@dataclass(frozen=True, slots=True)
class Export:
    """Writes a table of each log that it is called with."""

    options: "StatsOptions"
    table: str
    """``strides``, ``stances``, ``joints``, ``events``, ``base``, ``commands`` or ``samples``."""
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

    def finish(self) -> None:
        """Write what stands at the end of the file."""
        self.file.finish()

    def _add(self, log: str, table: Table) -> None:
        self.file.add({"log": texts([log] * len(table)), **table.columns})


@dataclass(frozen=True, slots=True)
class ExportLabels:
    """Writes the events of one log in a format that holds those of one log only."""

    options: "StatsOptions"
    suffix: str
    """See `event_file`."""
    file: BinaryIO

    def __call__(self, log: Location, on_progress: "OnProgress | None") -> int:
        """Measure a log and write its events; return the exit code of measuring it.

        Raises:
            LogError: the format cannot hold the events of these feet.
        """
        measured = measure(log, self.options, on_progress)
        document = stats_json(measured.stats, measured.facts)
        self.file.write(event_file(self.suffix, document).encode())
        return measured.exit_code

    def finish(self) -> None:
        """Do nothing: the file has no end of its own."""
