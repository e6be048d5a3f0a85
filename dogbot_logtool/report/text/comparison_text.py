"""A comparison for people: verdict, a table of the topics, the first differences."""

from collections.abc import Sequence
from typing import Final

from rich.console import Console

from dogbot_logtool.comparison.outcome import Comparison, Tally
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.text.console import print_losses, print_sentence
from dogbot_logtool.report.text.text_layout import NameTable, Row

_STYLES = {"same": "green", "different": "bold red"}
_MOST_ROWS: Final = 200
"""A row of a table takes a millisecond, so thousands would take seconds."""


def show_comparison(comparison: Comparison, console: Console) -> None:
    """Print a comparison."""
    style = _STYLES["same" if comparison.same else "different"]
    print_sentence(console, (printable(comparison.verdict), style))
    for damage in comparison.damage:
        print_sentence(console, (" damage  ", "red"), printable(damage.line))
        print_losses(console, damage)
    shown = _shown(comparison.tallies)
    if shown:
        console.print(_table(comparison, shown), crop=False)
    if more := len(comparison.tallies) - len(shown):
        different = sum(not tally.same for tally in comparison.tallies)
        different -= sum(not tally.same for tally in shown)
        print_sentence(console, f"... and {more} more, {different} of them different")
    for tally in shown:
        if tally.note:
            print_sentence(console, printable(f"{tally.name}: {tally.note}"))
    for difference in comparison.differences:
        print_sentence(console, printable(difference.line))
    if more := comparison.difference_count - len(comparison.differences):
        print_sentence(console, f"... and {more} more")


def _shown(tallies: Sequence[Tally]) -> Sequence[Tally]:
    """Return the rows of the table: all, or of very many the first that differ."""
    if len(tallies) <= _MOST_ROWS:
        return tallies
    return [tally for tally in tallies if not tally.same][:_MOST_ROWS]


def _table(comparison: Comparison, shown: Sequence[Tally]) -> NameTable:
    # Plain ASCII columns: what is redirected into a file is read in a browser or mailed.
    unit = comparison.unit
    counts = (unit, "equal", "within tolerance", "different", "missing", "extra", "largest |d|")
    rows = [_row(tally) for tally in shown]
    return NameTable(("topic" if unit == "messages" else "part", *counts), rows)


def _row(tally: Tally) -> Row:
    count = f"{tally.expected}"
    if tally.actual != tally.expected:
        count += f" / {tally.actual}"
    numbers = (
        tally.equal,
        tally.within_tolerance,
        tally.different,
        tally.missing,
        tally.extra,
    )
    deviation = f"{tally.deviation:.3g}" if tally.deviation else "0"
    style = "" if tally.same else _STYLES["different"]
    return Row([printable(tally.name)], [count, *map(str, numbers), deviation], style)
