"""What `convert`, `report` and `export --dataset` wrote, for people."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rich.console import Console

from dogbot_logtool.io.printable import listed, printable
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.report.text.console import (
    human_size,
    print_findings,
    print_losses,
    print_sentence,
)
from dogbot_logtool.report.verdict import headline, quality_of

if TYPE_CHECKING:
    from dogbot_logtool.comparison.walks import GaitComparison
    from dogbot_logtool.results import Conversion, Page


def _print_written(console: Console, name: str, words: str) -> None:
    print_sentence(console, (printable(name), "bold"), printable(f": {words}"))


def print_conversion(console: Console, done: "Conversion", *, verbose: bool) -> None:
    """Print what was written of a log, and if verbose how many annotations each topic has."""
    added = sum(done.annotations.values())
    words = f"{done.copied:,} recorded messages and {added:,} annotations"
    _print_written(console, name_of(done.target), words)
    if verbose:
        for topic, count in done.annotations.items():
            print_sentence(console, f"         {count:>9,}  {printable(topic)}")
    print_findings(console, done.findings)
    print_losses(console, done.damage)


def print_page(console: Console, done: "Page", *, verbose: bool) -> None:
    """Print what a page says, and if verbose all findings."""
    measured = done.measured
    words = f"{headline(measured.metrics)}. {quality_of(measured).line} ({human_size(done.size)})"
    _print_written(console, name_of(done.target), words)
    if verbose:
        print_findings(console, measured.findings)
    print_losses(console, done.damage)


def print_comparison_page(console: Console, name: str, size: int, found: "GaitComparison") -> None:
    """Print what a page of so many bytes, which compares two sides, comes to."""
    words = f"{len(found.differing)} of {len(found.differences)} metrics differ"
    if found.reasons:
        words = f"not comparable: {'; '.join(found.reasons)}"
    _print_written(console, name, f"{words} ({human_size(size)})")


def print_dataset(
    console: Console, dataset: str, counts: Mapping[str, int], pruned: Sequence[str]
) -> None:
    """Print what was done to a dataset, and name the logs that were removed.

    Args:
        console: where to.
        dataset: its name.
        counts: of logs that are measured, unchanged, failed or damaged.
        pruned: names of logs that were removed, since they are gone.
    """
    every = {**counts, "pruned": len(pruned)}
    words = [f"{every.get('measured', 0):,} measured"]
    words += [
        f"{every[what]:,} {what}" for what in ("unchanged", "failed", "pruned") if every[what]
    ]
    _print_written(console, dataset, f"{', '.join(words)}; {every['damaged']:,} damaged")
    for name in pruned:
        print_sentence(console, f" pruned  {printable(name)}: is gone", indent=9)


def print_failures(console: Console, failures: Sequence[tuple[str, str]]) -> None:
    """Print names of logs and why they could not be done; those of one cause share a line."""
    names: dict[str, list[str]] = {}
    for name, sentence in failures:
        first = sentence.removeprefix(f"{name}: ").partition("\n  ")[0]
        names.setdefault(first, []).append(name)
    labels = {first: printable(listed(each)) for first, each in names.items()}
    width = min(max(map(len, labels.values())), 60)
    for first, label in labels.items():
        print_sentence(console, f"  {label:<{width}}  {printable(first)}", indent=4)
