"""The sample logs are made anew byte for byte, and measured as their truth says and as agreed.

After an intended change of what the program makes of them: `make golden`, look at what it says, and
tell the change in CHANGELOG.md.
"""

import io
from pathlib import Path

import generate
import pytest
from golden import GOLDEN, Case, cases
from rich.console import Console
from scenario import Scenario

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.report.comparison_report import show_comparison
from tests.paths import SAMPLE_LOGS


@pytest.mark.parametrize(
    "scenario",
    [
        generate.TROUBLED,
        pytest.param(generate.TROT, marks=pytest.mark.slow),
        pytest.param(generate.WALK, marks=pytest.mark.slow),
    ],
    ids=lambda scenario: scenario.name,
)
def test_regenerating_gives_the_committed_bytes(tmp_path: Path, scenario: Scenario) -> None:
    generate.write_sample(scenario, tmp_path)
    written = sorted(tmp_path.iterdir())
    assert [path.stem for path in written] == [scenario.name, f"{scenario.name}.truth"]
    for fresh in written:
        same = fresh.read_bytes() == (SAMPLE_LOGS / fresh.name).read_bytes()
        assert same, f"{fresh.name}: other messages, or a codec of another version"


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
