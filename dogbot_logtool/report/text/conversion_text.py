"""Results of `convert` and of `export --dataset` for people."""

from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console
from rich.text import Text

from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.text.console import print_findings, print_losses, print_sentence
from dogbot_logtool.results import Conversion


def print_conversion(console: Console, done: Conversion, *, verbose: bool) -> None:
    """Print what was done."""
    added = sum(done.annotations.values())
    name = printable(shown(done.target))
    line = f": {done.copied:,} recorded messages and {added:,} annotations"
    print_sentence(console, (name, "bold"), line)
    if verbose:
        for topic, count in done.annotations.items():
            print_sentence(console, f"         {count:>9,}  {printable(topic)}")
    print_findings(console, done.findings)
    print_losses(console, done.damage)


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
    damaged: int = 0
    """Logs that were measured and are damaged; what was lost of each is said elsewhere."""


def print_dataset(console: Console, dataset: str, run: DatasetRun) -> None:
    """Print what was done, and name the logs that were removed.

    Args:
        console: where to print.
        dataset: name of the dataset, as it may be shown.
        run: what was done.
    """
    damaged = run.damaged + sum(bool(code) for _, code in run.unchanged)
    counts = (
        (run.measured, "measured"),
        (len(run.unchanged), "unchanged"),
        (run.failed, "failed"),
        (len(run.pruned), "pruned"),
    )
    words = [f"{count:,} {what}" for count, what in counts if count or what == "measured"]
    text = f": {', '.join(words)}; {damaged:,} damaged"
    console.print(Text.assemble(Text(printable(dataset), style="bold"), text), soft_wrap=True)
    for name in run.pruned:
        console.print(Text(f" pruned  {printable(name)}: is gone"), soft_wrap=True)
