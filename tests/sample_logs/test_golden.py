"""What the program makes of the sample logs is what was agreed on.

After an intended change: `make golden`, look at what it says, and tell the change in CHANGELOG.md.
"""

import io
from pathlib import Path

import pytest
from golden import GOLDEN, Case, cases
from rich.console import Console

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.report.comparison_report import show_comparison

# Sines and powers differ in their last bits from one processor to the next.
OPTIONS = CompareOptions(atol=1e-9, rtol=1e-9)


@pytest.mark.parametrize("case", list(cases()), ids=lambda case: case.name)
def test_output_is_as_agreed(case: Case, tmp_path: Path) -> None:
    comparison = compare(GOLDEN / case.name, case.make(tmp_path), OPTIONS)

    console = Console(file=io.StringIO(), width=120, record=True)
    show_comparison(comparison, console)
    assert comparison.same, f"`make golden` if this is intended\n{console.export_text()}"


def test_every_golden_file_is_compared() -> None:
    assert {file.name for file in GOLDEN.iterdir()} == {case.name for case in cases()}
