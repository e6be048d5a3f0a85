"""The sample logs are made anew byte for byte, and measured as their truth says and as agreed.

After an intended change of what the program makes of them: `make golden`, look at what it says, and
tell the change in CHANGELOG.md.
"""

import io
import json
from pathlib import Path

import generate
import numpy as np
import pytest
from golden import GOLDEN, Case, cases
from rich.console import Console
from scenario import Scenario

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.report.comparison_report import show_comparison
from tests.measured import walk_of
from tests.paths import SAMPLE_LOGS, TROT, WALK


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


@pytest.mark.parametrize("log", [TROT, WALK], ids=lambda log: log.stem)
def test_feet_and_legs_are_measured_as_their_truth_says(log: Path) -> None:
    truth = json.loads(log.with_suffix(".truth.json").read_text(encoding="utf-8"))
    walk = walk_of(log)
    for foot, true in truth["feet"].items():
        found = walk.feet[foot]
        friction, mean = found.friction_use, found.mean_vertical_force_n
        assert friction and mean  # noqa: PT018 - none is null
        assert friction.max <= true["peak_friction_use"] + 1e-6
        assert mean.mean == pytest.approx(true["mean_vertical_force_n"], rel=0.01)
    strides = walk.strides
    for foot, true in truth["legs"]["feet"].items():
        found = walk.feet[foot]
        assert found.clearance_m is not None
        assert found.clearance_m.median == pytest.approx(true["clearance_m"], abs=0.002)
        for key in ("absolute_work_j", "positive_work_j"):
            done = np.median(strides[key][strides["foot"] == foot])
            assert done == pytest.approx(true[key], rel=0.03), (foot, key)
        for joint, torque in true["peak_torque_nm"].items():
            peak = walk.legs.joints[f"{foot}_{joint}"].peak_effort
            assert peak == pytest.approx(torque, rel=0.05)


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
