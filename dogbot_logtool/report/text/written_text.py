"""What `convert`, `report` and `export --dataset` wrote, for people."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.console import Console

from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.text.console import (
    human_size,
    print_findings,
    print_losses,
    print_sentence,
)
from dogbot_logtool.report.verdict import headline, quality_of
from dogbot_logtool.results import Conversion, Page

if TYPE_CHECKING:
    from dogbot_logtool.comparison.walks import GaitComparison


def _print_written(console: Console, name: str, words: str) -> None:
    print_sentence(console, (printable(name), "bold"), printable(f": {words}"))


def print_conversion(console: Console, done: Conversion, *, verbose: bool) -> None:
    """Print what was written of a log, and if verbose how many annotations each topic has."""
    added = sum(done.annotations.values())
    words = f"{done.copied:,} recorded messages and {added:,} annotations"
    _print_written(console, shown(done.target), words)
    if verbose:
        for topic, count in done.annotations.items():
            print_sentence(console, f"         {count:>9,}  {printable(topic)}")
    print_findings(console, done.findings)
    print_losses(console, done.damage)


def print_page(console: Console, done: Page, *, verbose: bool) -> None:
    """Print what a page says, and if verbose all findings."""
    measured = done.measured
    words = f"{headline(measured.metrics)}. {quality_of(measured).line} ({human_size(done.size)})"
    _print_written(console, shown(done.target), words)
    if verbose:
        print_findings(console, measured.findings)
    print_losses(console, done.damage)


def print_comparison_page(console: Console, name: str, size: int, found: "GaitComparison") -> None:
    """Print what a page of so many bytes, which compares two sides, comes to."""
    words = f"{len(found.differing)} of {len(found.differences)} metrics differ"
    if found.reasons:
        words = f"not comparable: {'; '.join(found.reasons)}"
    _print_written(console, name, f"{words} ({human_size(size)})")


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
    """Print what was done to a dataset, and name the logs that were removed."""
    damaged = run.damaged + sum(bool(code) for _, code in run.unchanged)
    counts = {
        "measured": run.measured,
        "unchanged": len(run.unchanged),
        "failed": run.failed,
        "pruned": len(run.pruned),
    }
    words = [f"{count:,} {what}" for what, count in counts.items() if count or what == "measured"]
    _print_written(console, dataset, f"{', '.join(words)}; {damaged:,} damaged")
    for name in run.pruned:
        print_sentence(console, f" pruned  {printable(name)}: is gone", indent=9)
