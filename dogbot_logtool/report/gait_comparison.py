"""How two sides walk, for people and for programs."""

from typing import Any, Final

from rich.console import Console

from dogbot_logtool.comparison.walks.two_runs import CONFIDENCE, FigureDifference, GaitComparison
from dogbot_logtool.io.printable import printable
from dogbot_logtool.report.documents.damage import damage_json
from dogbot_logtool.report.text.console import human_size, print_sentence
from dogbot_logtool.report.text.text_layout import NameTable, Row

_HEADINGS: Final = ("figure", "first", "second", "difference", "from", "to", "effect", "strides")


def print_gait_comparison(console: Console, found: GaitComparison, *, verbose: bool) -> None:
    """Print what differs, the largest effect first.

    Args:
        console: where to.
        found: the comparison.
        verbose: print also what does not differ.
    """
    for damage in found.damage:
        print_sentence(console, (" damage   ", "red"), printable(damage.line))
    for doubt in found.doubts:
        print_sentence(console, ("doubtful  ", "yellow"), printable(doubt), indent=10)
    if found.reasons:
        print_sentence(console, ("not comparable", "bold red"))
        for reason in found.reasons:
            print_sentence(console, f"  {printable(reason)}", indent=4)
        return
    differing, all_of_them = found.differing, found.differences
    style = "bold red" if differing else "green"
    verdict = f"{len(differing)} of {len(all_of_them)} figures differ"
    print_sentence(console, (verdict, style), f" (at {CONFIDENCE:.0%} over all of them)")
    shown = all_of_them if verbose else differing
    if shown:
        console.print(NameTable(_HEADINGS, [_row(each) for each in shown]), crop=False)


def print_comparison_page(console: Console, name: str, size: int, found: GaitComparison) -> None:
    """Print what a page that compares two sides comes to.

    Args:
        console: where to.
        name: of the page.
        size: bytes.
        found: the comparison.
    """
    words = f"{len(found.differing)} of {len(found.differences)} figures differ"
    if found.reasons:
        words = f"not comparable: {'; '.join(found.reasons)}"
    name_in_bold = printable(name), "bold"
    print_sentence(console, name_in_bold, printable(f": {words} ({human_size(size)})"))


def _row(each: FigureDifference) -> Row:
    low, high = each.interval
    cells = (*each.medians, each.difference, low, high)
    numbers = [f"{cell:.4g}" for cell in cells]
    counts = f"{each.counts[0]} / {each.counts[1]}"
    name = printable(f"{each.foot} {each.figure}")
    return Row([name], [*numbers, f"{each.effect:.1f}", counts], "" if each.differs else "dim")


def gait_comparison_json(found: GaitComparison) -> dict[str, Any]:
    """Return the comparison as plain data."""
    return {
        "first": list(found.sides[0]),
        "second": list(found.sides[1]),
        "damage": [{"log": each.log, **damage_json(each)} for each in found.damage],
        "comparable": not found.reasons,
        "reasons": list(found.reasons),
        "doubts": list(found.doubts),
        "confidence": CONFIDENCE,
        "differences": [_difference(each) for each in found.differences],
    }


def _difference(each: FigureDifference) -> dict[str, Any]:
    return {
        "foot": each.foot,
        "figure": each.figure,
        "strides": list(each.counts),
        "medians": list(each.medians),
        "difference": each.difference,
        "interval": list(each.interval),
        "effect": each.effect,
        "differs": each.differs,
    }
