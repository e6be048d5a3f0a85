"""The story of `report --against`: a page that shows two runs, or groups of runs, side by side."""

from collections.abc import Sequence
from typing import NamedTuple

from dogbot_logtool.comparison.walks import GaitComparison, compare_walks
from dogbot_logtool.io.output import Output, refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location, file_stem
from dogbot_logtool.report.page.comparison import comparison_page
from dogbot_logtool.results import Figures

ENDING = ".against.html"
"""Ending of the page's name in a directory, after the name of the first log."""


class ComparisonPage(NamedTuple):
    """A page that was written."""

    target: Location
    size: int
    """bytes."""
    found: GaitComparison


def comparison_target(
    output: Output, logs: Sequence[Location], others: Sequence[Location], *, overwrite: bool
) -> Location:
    """Choose where the page goes, before any work is done.

    Raises:
        CallError: it may not be written there.
    """
    target = output.path / f"{file_stem(logs[0])}{ENDING}" if output.is_folder else output.path
    refuse_bad_target(target, (*logs, *others), overwrite=overwrite)
    return target


def report_against(
    first: Sequence[Figures],
    second: Sequence[Figures],
    target: Location,
    *,
    overwrite: bool,
) -> ComparisonPage:
    """Compare two sides, and write their page.

    Args:
        first: what `stats` of each log of one side comes to.
        second: of the other.
        target: the page.
        overwrite: replace a page that is there.

    Raises:
        LogError: nothing of a side could be measured.
        LogtoolError: the page cannot be written.
    """
    found = compare_walks(first, second)
    html = comparison_page(found, ([each.json for each in first], [each.json for each in second]))
    with whole_file(target, overwrite=overwrite) as file:
        file.write(html)
    return ComparisonPage(target, len(html), found)
