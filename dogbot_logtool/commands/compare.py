"""`dogbot-logtool compare`: do two files mean the same, and if not, where do they differ?"""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from dogbot_logtool.comparison.fields import compare_json, looks_like_json
from dogbot_logtool.comparison.logs import compare_logs
from dogbot_logtool.comparison.outcome import RECORDS, Comparison
from dogbot_logtool.comparison.tolerances import Rules, load_rules
from dogbot_logtool.errors import CallError
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.reader.opening import open_log


def compare(expected: Path, actual: Path, options: CompareOptions) -> Comparison:
    """Compare two logs, or two JSON documents.

    Raises:
        CallError: an option is wrong, or a file is missing or not like the other.
        LogError: a file cannot be read.
    """
    rules = load_rules(
        options.atol, options.rtol, options.tolerances, options.ignore, options.topics
    )
    comparison = _compare(expected, actual, rules, options.max_differences)
    return comparison._replace(warnings=tuple(_warnings(comparison)))


def _warnings(found: Comparison) -> Iterator[str]:
    """Say where files that are the same prove little."""
    if found.expected.samefile(found.actual):
        yield f"{found.expected} and {found.actual} are the same file, so nothing can differ"
    if not any(t.expected or t.actual for t in found.tallies if t.name != RECORDS):
        yield f"neither file has any {found.unit} to compare"


def _compare(expected: Path, actual: Path, rules: Rules, max_differences: int) -> Comparison:
    are_json = looks_like_json(expected), looks_like_json(actual)
    if all(are_json):
        return compare_json(expected, actual, rules, max_differences)
    if any(are_json):
        json_file, log_file = (expected, actual) if are_json[0] else (actual, expected)
        raise CallError(f"{json_file} is JSON, but {log_file} is not: they cannot be compared")
    with closing(open_log(expected)) as one, closing(open_log(actual)) as other:
        return compare_logs(one, other, rules, max_differences)
