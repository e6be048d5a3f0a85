"""A comparison for people: verdict, a table of the topics, the first differences."""

from collections.abc import Sequence
from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from dogbot_logtool.comparison.outcome import Comparison, Tally
from dogbot_logtool.printable import printable

_STYLES = {"same": "green", "different": "bold red"}
_MOST_ROWS: Final = 200
"""A row of a table takes a millisecond, so thousands would take seconds."""


def show_comparison(comparison: Comparison, console: Console) -> None:
    """Print a comparison."""
    style = _STYLES["same" if comparison.same else "different"]
    console.print(Text(comparison.verdict, style), soft_wrap=True)
    for found in comparison.losses:
        line = Text(printable(f"{found.path}: {found.loss.what}"), "yellow")
        console.print(line, soft_wrap=True)
    shown = _shown(comparison.tallies)
    if shown:
        console.print(_table(comparison, shown))
    if more := len(comparison.tallies) - len(shown):
        different = sum(not tally.same for tally in comparison.tallies)
        different -= sum(not tally.same for tally in shown)
        console.print(Text(f"... and {more} more, {different} of them different"))
    for tally in shown:
        if tally.note:
            note = f"{printable(tally.name)}: {printable(tally.note)}"
            console.print(Text(note), soft_wrap=True)
    for difference in comparison.differences:
        console.print(Text(difference.line), soft_wrap=True)
    if more := comparison.difference_count - len(comparison.differences):
        console.print(Text(f"... and {more} more"))


def _shown(tallies: Sequence[Tally]) -> Sequence[Tally]:
    """Return the rows of the table: all, or of very many the first that differ."""
    if len(tallies) <= _MOST_ROWS:
        return tallies
    return [tally for tally in tallies if not tally.same][:_MOST_ROWS]


def _table(comparison: Comparison, shown: Sequence[Tally]) -> Table:
    # Plain ASCII columns: what is redirected into a file is read in a browser or mailed.
    table = Table(box=None, pad_edge=False)
    table.add_column("topic" if comparison.unit == "messages" else "part", overflow="fold")
    for heading in (comparison.unit, "equal", "within tolerance", "different", "missing", "extra"):
        table.add_column(heading, justify="right")
    table.add_column("largest |d|", justify="right")
    for tally in shown:
        table.add_row(*_cells(tally), style=None if tally.same else _STYLES["different"])
    return table


def _cells(tally: Tally) -> list[Text]:
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
    return [
        Text(printable(tally.name)),
        Text(count),
        *(Text(str(number)) for number in numbers),
        Text(deviation),
    ]
