"""The sample logs are made anew byte for byte, and measured as their truth says and as agreed.

After an intended change of what the program makes of them: `make golden`, look at what it says, and
tell the change in CHANGELOG.md.
"""

import io
import json
from pathlib import Path
from typing import Any

import generate
import numpy as np
import pytest
from golden import GOLDEN, Case, cases
from rich.console import Console
from scenario import Scenario

from dogbot_logtool.commands.compare import compare
from dogbot_logtool.options.compare import CompareOptions
from dogbot_logtool.report.comparison_report import show_comparison
from dogbot_logtool.report.documents import stats_json
from tests.measured import measured, walk_of
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


near = pytest.approx


def truth_of(log: Path) -> Any:
    return json.loads(log.with_suffix(".truth.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("log", [TROT, WALK], ids=lambda log: log.stem)
def test_contacts_are_true_within_one_sample(log: Path) -> None:
    """Also where the message after a lift-off still holds the last steps of the stance."""
    truth, feet = truth_of(log), stats_json(measured(log))["feet"]
    start = truth["log"]["start_stamp_s"] - measured(log).walk.origin / 1e9
    latest = truth["log"]["contact_interval_s"] + 1e-6
    for foot, true in truth["feet"].items():
        assert feet[foot]["contact_fraction"] == near(true["contact_fraction"], abs=0.0015)
        for times, expected in (("lift_off_s", "liftoff_s"), ("touchdown_s", "touchdown_s")):
            late = np.array(feet[foot][times]) - np.array(true[expected]) - start
            assert -1e-6 < late.min() <= late.max() <= latest


@pytest.mark.parametrize("log", [TROT, WALK], ids=lambda log: log.stem)
def test_metrics_are_as_the_truth_says(log: Path) -> None:
    """In the trot the wrenches are in the links' frames, and the log's /tf turns them."""
    truth, stats, strides = truth_of(log), stats_json(measured(log)), walk_of(log).strides
    gait, base, forces = stats["gait"], stats["base"], stats["forces"]
    true, moved = truth["gait"], truth["base"]
    rows: list[tuple[object, Any]] = [
        (gait["name"], true["class"]),
        (gait["duty_factor"], near(true["duty_factor"], abs=0.005)),
        (gait["stride_frequency_hz"], near(true["stride_frequency_hz"], rel=0.002)),
        (gait["support"], near({**gait["support"], **true["support_fraction"]}, abs=0.02)),
        (base["forward_speed_mps"], near(moved["forward_speed_mps"], rel=0.002)),
        (base["path_length_m"], near(moved["path_length_m"], rel=0.002)),
        (base["height_m"]["mean"], near(moved["mean_height_m"], abs=1e-4)),
        (forces["vertical_impulse_over_weight"], near(1.0, abs=0.005)),
    ]
    for foot, true in truth["feet"].items():
        found, phase = stats["feet"][foot], gait["phase"][foot]
        off = phase["mean"] - truth["gait"]["phase"][foot]
        rows += [
            ((off + 0.5) % 1.0, near(0.5, abs=0.005)),
            (phase["consistency"] > 0.99, True),
            (forces["load_share"]["feet"][foot], near(true["load_share"], abs=0.005)),
            (found["peak_force_n"]["max"], near(true["peak_force_n"], rel=0.01)),
            (found["peak_vertical_force_n"]["max"], near(true["peak_vertical_force_n"], rel=0.01)),
            (found["mean_vertical_force_n"]["mean"], near(true["mean_vertical_force_n"], rel=0.01)),
            (found["friction_use"]["max"] <= true["peak_friction_use"] + 1e-6, True),
        ]
    for foot, true in truth["legs"]["feet"].items():
        rows.append(
            (stats["feet"][foot]["clearance_m"]["median"], near(true["clearance_m"], abs=0.002))
        )
        for key in ("absolute_work_j", "positive_work_j"):
            work = np.median(strides[key][strides["foot"] == foot])
            rows.append((work, near(true[key], rel=0.03)))
        for joint, torque in true["peak_torque_nm"].items():
            peak = stats["legs"]["joints"][f"{foot}_{joint}"]["peak_effort"]
            rows.append((peak, near(torque, rel=0.05)))
    assert [row for row in rows if row[0] != row[1]] == []


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
