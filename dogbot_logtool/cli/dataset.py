"""`stats --parquet`: measure logs into a dataset."""

from collections.abc import Callable, Generator
from typing import TYPE_CHECKING, Any

from dogbot_logtool.commands.tasks import Measure, MeasuredEntry, MeasureForDataset
from dogbot_logtool.io.storage import from_root, location, shown
from dogbot_logtool.report.dataset.dataset import DatasetWriter, Pending, dataset_at
from dogbot_logtool.report.dataset.labels import parse_labels
from dogbot_logtool.report.dataset.rows import failed_rows
from dogbot_logtool.report.text.dataset_text import DatasetRun

if TYPE_CHECKING:
    from dogbot_logtool.cli.outcomes import Outcomes
    from dogbot_logtool.pipeline.options import StatsOptions
    from dogbot_logtool.results import Figures
    from dogbot_logtool.run.inputs import LogSet
    from dogbot_logtool.run.runner import Runner


class DatasetCall:
    """One call of `stats --parquet`."""

    def __init__(
        self,
        name: str,
        options: "StatsOptions",
        labels: tuple[str, ...],
        log_set: "LogSet",
        *,
        prune: bool,
    ) -> None:
        """Look which logs are to be measured.

        Raises:
            CallError: no dataset can be there, or a label is none.
            LogtoolError: the dataset cannot be read or written.
        """
        self._dataset = dataset_at(from_root(location(name)), options, parse_labels(labels))
        self.pending: Pending = self._dataset.begin(log_set, prune=prune)
        self._run = DatasetRun(self.pending.unchanged, self.pending.pruned)

    def measure(
        self,
        outcomes: "Outcomes",
        runner: "Runner[Any]",
        measure: Measure,
        *,
        keeps_figures: bool,
    ) -> "Generator[Figures, None, None]":
        """Measure the logs into the dataset; yield their figures if they are wanted."""
        work = MeasureForDataset(measure, keeps_figures)
        pending = self.pending
        with self._dataset.writer() as writer:
            take = self._taker(writer)
            names = pending.log_set.names
            for done in outcomes.of(runner, work, pending.entries, names, take):
                outcomes.add(done.figures.json if done.figures else {}, done.exit_code)
                if done.figures is not None:
                    yield done.figures

    def _taker(self, writer: DatasetWriter) -> "Callable[[int, MeasuredEntry | None, str], None]":
        """Return what takes the outcome of each log."""

        def take(number: int, done: "MeasuredEntry | None", sentence: str) -> None:
            entry = self.pending.entries[number]
            if done is not None:
                writer.add(entry, done.rows)
                self._run.add(done.name, done.rows.log)
            elif entry.state.version:
                # A log that is not there at all leaves no row.
                writer.add(entry, failed_rows(sentence))

        return take

    def print_done(self, failed: int) -> None:
        """Print what was done: on stderr, since the result itself is in the dataset."""
        from dogbot_logtool.report.text.console import diagnostics  # noqa: PLC0415 - rich costs 40 ms
        from dogbot_logtool.report.text.dataset_text import print_dataset  # noqa: PLC0415

        self._run.failed = failed
        print_dataset(diagnostics(), shown(self._dataset.root), self._run)
