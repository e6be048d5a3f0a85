"""Results of `compare` as text, plain data and JUnit XML."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any, Final

from rich.console import Console

from dogbot_logtool.comparison.outcome import Comparison, Difference, Tally, counted
from dogbot_logtool.comparison.walks import CONFIDENCE, GaitComparison, MetricDifference
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.storage import name_of
from dogbot_logtool.report.documents import ERROR, FAILURE, TOOL, Case, damage_json, junit_xml
from dogbot_logtool.report.text.console import NameTable, Row, print_losses, print_sentence

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
    rows = comparison.tallies
    if len(rows) > _MOST_ROWS:
        rows = [tally for tally in rows if not tally.same][:_MOST_ROWS]
    if rows:
        console.print(_table(comparison, rows), crop=False)
    if more := len(comparison.tallies) - len(rows):
        different = sum(not tally.same for tally in comparison.tallies)
        different -= sum(not tally.same for tally in rows)
        print_sentence(console, f"... and {more} more, {different} of them different")
    for tally in rows:
        if tally.note:
            print_sentence(console, printable(f"{tally.name}: {tally.note}"))
    for difference in comparison.differences:
        print_sentence(console, printable(difference.line))
    if more := comparison.difference_count - len(comparison.differences):
        print_sentence(console, f"... and {more} more")


def _table(comparison: Comparison, rows: Sequence[Tally]) -> NameTable:
    # Plain ASCII columns: what is redirected into a file is read in a browser or mailed.
    unit = comparison.unit
    counts = "equal", "within tolerance", "different", "missing", "extra", "largest |d|"
    headings = ("topic" if unit == "messages" else "part", unit, *counts)
    return NameTable(headings, [_tally_row(tally) for tally in rows])


def _tally_row(tally: Tally) -> Row:
    count = f"{tally.expected}"
    if tally.actual != tally.expected:
        count += f" / {tally.actual}"
    numbers = tally.equal, tally.within_tolerance, tally.different, tally.missing, tally.extra
    deviation = f"{tally.deviation:.3g}" if tally.deviation else "0"
    style = "" if tally.same else _STYLES["different"]
    return Row([printable(tally.name)], [count, *map(str, numbers), deviation], style)


SCHEMA: Final = "dogbot-logtool/compare/2"
"""Changes when a field goes or changes its meaning; new fields may come."""


def comparison_json(comparison: Comparison) -> str:
    """Return the document, indented, with a line break at its end."""
    return to_json(comparison_document(comparison), indent=2) + "\n"


def comparison_document(comparison: Comparison) -> dict[str, Any]:
    """Return the comparison as JSON's own types."""
    return {
        "schema": SCHEMA,
        "tool": TOOL,
        "expected": name_of(comparison.expected),
        "actual": name_of(comparison.actual),
        "same": comparison.same,
        "exit_code": comparison.exit_code,
        "verdict": comparison.verdict,
        "unit": comparison.unit,
        "topics": [_tally(tally) for tally in comparison.tallies],
        "differences": [_difference(difference) for difference in comparison.differences],
        "difference_count": comparison.difference_count,
        "damage": [{"log": each.log, **damage_json(each)} for each in comparison.damage],
        "warnings": list(comparison.warnings),
    }


def _tally(tally: Tally) -> dict[str, Any]:
    return {
        "name": tally.name,
        "type": tally.type_name,
        "same": tally.same,
        "only_in": tally.only_in or None,
        "expected": tally.expected,
        "actual": tally.actual,
        "equal": tally.equal,
        "within_tolerance": tally.within_tolerance,
        "different": tally.different,
        "missing": tally.missing,
        "extra": tally.extra,
        "described_differently": tally.described_differently,
        "largest_deviation": tally.deviation,
        "largest_deviation_at": tally.deviation_path or None,
        "note": tally.note or None,
    }


def _difference(difference: Difference) -> dict[str, Any]:
    return {**asdict(difference), "kind": difference.kind.value, "line": difference.line}


def comparison_junit(comparison: Comparison) -> bytes:
    """Return JUnit XML: a topic that differs is a failure, damage of a file an error."""
    cases = [Case("files can be read")]
    if comparison.damage:
        message = "; ".join(printable(damage.line) for damage in comparison.damage)
        losses = (loss for damage in comparison.damage for loss in damage.losses)
        text = "\n".join(printable(loss.what) for loss in losses)
        cases = [Case("files can be read", ERROR, f"damage: {message}", text)]
    for tally in comparison.tallies:
        if tally.same:
            cases.append(Case(tally.name))
            continue
        summary = f"{counted([tally])}, of {tally.expected} {comparison.unit}"
        lines = [each.line for each in comparison.differences if each.topic == tally.name]
        cases.append(Case(tally.name, FAILURE, summary, "\n".join(lines or [summary])))
    name = f"compare {comparison.expected} {comparison.actual}"
    return junit_xml(name, {name: (comparison.expected.name, cases)})


_HEADINGS: Final = ("metric", "first", "second", "difference", "from", "to", "effect", "strides")


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
    verdict = f"{len(differing)} of {len(all_of_them)} metrics differ"
    print_sentence(console, (verdict, style), f" (at {CONFIDENCE:.0%} over all of them)")
    rows = all_of_them if verbose else differing
    if rows:
        console.print(NameTable(_HEADINGS, [_metric_row(each) for each in rows]), crop=False)


def _metric_row(each: MetricDifference) -> Row:
    low, high = each.interval
    cells = (*each.medians, each.difference, low, high)
    numbers = [f"{cell:.4g}" for cell in cells]
    counts = f"{each.strides[0]} / {each.strides[1]}"
    name = printable(f"{each.foot} {each.metric}")
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
        "differences": [each._asdict() for each in found.differences],
    }
