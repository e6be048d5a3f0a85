"""A comparison for programs: one JSON document."""

from typing import Any, Final

from dogbot_logtool import __version__
from dogbot_logtool.comparison.outcome import Comparison, Difference, Tally
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.io.storage import shown
from dogbot_logtool.report.documents.damage import damage_json

SCHEMA: Final = "dogbot-logtool/compare/2"
"""Changes when a field goes or changes its meaning; new fields may come."""


def comparison_json(comparison: Comparison) -> str:
    """Return the document, indented, with a line break at its end."""
    return to_json(comparison_document(comparison), indent=2) + "\n"


def comparison_document(comparison: Comparison) -> dict[str, Any]:
    """Return the comparison as JSON's own types."""
    return {
        "schema": SCHEMA,
        "tool": {"name": "dogbot-logtool", "version": __version__},
        "expected": shown(comparison.expected),
        "actual": shown(comparison.actual),
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
        "described_differently": tally.faults,
        "largest_deviation": tally.deviation,
        "largest_deviation_at": tally.deviation_path or None,
        "note": tally.note or None,
    }


def _difference(difference: Difference) -> dict[str, Any]:
    return {
        "kind": difference.kind.value,
        "topic": difference.topic,
        "index": difference.index,
        "time_s": difference.time_s,
        "path": difference.path,
        "expected": difference.expected,
        "actual": difference.actual,
        "deviation": difference.deviation,
        "line": difference.line,
    }
