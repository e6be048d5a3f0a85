"""Results of `check` as text: rules that are not good first, then the count of good ones."""

from collections import Counter
from collections.abc import Sequence
from typing import Final

from rich.console import Console

from dogbot_logtool.comparison.rules.judge import DAMAGE, Judgement, Status, Value, worst
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.text.console import print_sentence

_STYLES: Final = {
    Status.FAIL: "bold red",
    Status.UNKNOWN: "magenta",
    Status.WARN: "yellow",
    Status.GOOD: "green",
}
_LABEL: Final = 9


def print_check(
    console: Console, name: str, judgements: Sequence[Judgement], *, verbose: bool
) -> None:
    """Print what a log comes to.

    Args:
        console: where to.
        name: of the log.
        judgements: what its rules come to.
        verbose: print also what is good, rule by rule.
    """
    status = worst(judgements)
    counts = Counter(found.status for found in judgements)
    words = ", ".join(f"{counts[each]} {each}" for each in Status if counts[each])
    print_sentence(console, (f"{status:<7}  ", _STYLES[status]), f"{printable(name)}: {words}")
    order = list(Status)
    # Damage stands at the top.
    for found in sorted(
        judgements, key=lambda each: (each.rule is not DAMAGE, order.index(each.status))
    ):
        if verbose or found.status is not Status.GOOD:
            print_sentence(console, *_line(found), indent=_LABEL + 2)


def _line(found: Judgement) -> list[str | tuple[str, str]]:
    name = f"{found.rule.name}: " if found.rule.name else ""
    figure = f"{name}{found.figure} is {shown_value(found.value)}; wanted: {found.demand}"
    look = f" ({found.look})" if found.look else ""
    label = (f"  {found.status:<7}  ", _STYLES[found.status])
    return [label, printable(figure), printable(look)]


def shown_value(value: Value) -> str:
    """Return a figure as a sentence shows it."""
    if value is None:
        return "not known"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
