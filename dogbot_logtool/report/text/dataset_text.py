"""Results of `stats --parquet` as text."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any

from rich.console import Console
from rich.text import Text

from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.printable import printable


@dataclass(slots=True)
class DatasetRun:
    """Changes of a dataset."""

    unchanged: Sequence[tuple[str, int]]
    """Names and exit codes of the logs that were there already."""
    pruned: Sequence[str]
    """Names of logs that were removed, since they are gone."""
    measured: int = 0
    failed: int = 0
    """Logs that could not be measured, and directories that could not be searched."""
    damaged: list[tuple[str, str]] = field(default_factory=list)
    """Names of logs that were measured and are damaged, and how much was lost."""

    def add(self, name: str, row: Mapping[str, Any]) -> None:
        """Take a log that was measured, and its row of `logs`."""
        self.measured += 1
        if row["damaged"]:
            self.damaged.append((name, _lost(row)))


def print_dataset(console: Console, dataset: str, run: DatasetRun) -> None:
    """Print what was done, and name the damaged logs and those that were removed.

    Args:
        console: where to print.
        dataset: name of the dataset, as it may be shown.
        run: what was done.
    """
    damaged = [*run.damaged]
    damaged += [
        (name, "unchanged, damaged when it was measured") for name, code in run.unchanged if code
    ]
    counts = (
        (run.measured, "measured"),
        (len(run.unchanged), "unchanged"),
        (run.failed, "failed"),
        (len(run.pruned), "pruned"),
    )
    words = [f"{count:,} {what}" for count, what in counts if count or what == "measured"]
    text = f": {', '.join(words)}; {len(damaged):,} damaged"
    console.print(Text.assemble(Text(printable(dataset), style="bold"), text), soft_wrap=True)
    for name, lost in damaged:
        _print_log(console, Text(" damage  ", style="red"), f"{name}: {lost}")
    for name in run.pruned:
        _print_log(console, Text(" pruned  "), f"{name}: is gone")


def _print_log(console: Console, what: Text, sentence: str) -> None:
    console.print(Text.assemble(what, printable(sentence)), soft_wrap=True)


def _lost(row: Mapping[str, Any]) -> str:
    """Say how much of a log was lost."""
    messages = row["lost_messages"]
    count = "an unknown number of" if messages is None else f"{messages:,}"
    return f"{count} messages, {row['lost_bytes']:,} bytes lost"
