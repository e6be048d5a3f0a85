"""Runs with known differences: which are found, and what keeps runs from being compared."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.comparison.walks import (
    MetricDifference,
    compare_walks,
    doubts,
    metric_differences,
    why_not_comparable,
)
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import SOUND
from dogbot_logtool.results import Figures, StrideTable
from tests.truth import sensor_faults
from tests.truth.log_file import write_log
from tests.truth.recording import disturbed
from tests.truth.walking import Walk as TrueWalk

STEP_S = 0.002


def of(feet: tuple[str, ...], columns: dict[str, Floats], interval_s: float = STEP_S) -> Figures:
    return Figures((), {}, StrideTable(feet, columns), interval_s, SOUND)


def run(seed: int, *, strides: int = 40, duty: float = 0.6, peak_n: float = 150.0) -> Figures:
    """Make a run of two feet whose strides vary by 2 %, at sampled times."""
    random = np.random.default_rng(seed)
    period = random.normal(0.8, 0.016, 2 * strides)
    stance = np.round(duty * period / STEP_S) * STEP_S
    swing = np.round((period - stance) / STEP_S) * STEP_S
    columns = {
        "start_s": np.arange(2.0 * strides),
        "stance_s": stance,
        "swing_s": swing,
        "duty_factor": stance / (stance + swing),
        "peak_force_n": random.normal(peak_n, 0.05 * peak_n, 2 * strides),
        "length_m": np.full(2 * strides, np.nan),
    }
    return of(("left",) * strides + ("right",) * strides, columns)


def differing(first: Figures, second: Figures) -> list[MetricDifference]:
    return [each for each in metric_differences([first], [second]) if each.differs]


@pytest.mark.parametrize("seed", range(3))
def test_runs_of_one_kind_do_not_differ(seed: int) -> None:
    assert differing(run(seed), run(seed + 100)) == []


def test_a_duty_factor_changed_by_five_per_cent_is_found() -> None:
    found = differing(run(1), run(2, duty=0.63))

    assert {each.metric for each in found} == {"duty_factor", "stance_s", "swing_s"}
    duty = next(each for each in found if each.metric == "duty_factor")
    assert duty.difference == pytest.approx(0.03, abs=0.003)
    assert duty.interval[0] < 0.03 < duty.interval[1]


def test_the_largest_effect_comes_first() -> None:
    found = metric_differences([run(1)], [run(2, duty=0.75, peak_n=165.0)])
    effects = [abs(each.effect) for each in found if each.differs]
    assert effects == sorted(effects, reverse=True)
    assert [each.differs for each in found] == sorted((e.differs for e in found), reverse=True)


@pytest.mark.parametrize(("later_s", "found"), [(0.002, set()), (0.02, {"stance_s", "swing_s"})])
def test_a_difference_below_the_sampling_interval_is_none(later_s: float, found: set[str]) -> None:
    sides = [
        of(
            ("left",) * 40,
            {"stance_s": np.full(40, 0.5 + late), "swing_s": np.full(40, 0.3 - late)},
            0.004,
        )
        for late in (0.0, later_s)
    ]
    assert {each.metric for each in differing(*sides)} == found


@pytest.mark.parametrize(("force_n", "found"), [(150.75, set()), (153.0, {"peak_force_n"})])
def test_a_certain_difference_below_one_per_cent_is_none(force_n: float, found: set[str]) -> None:
    sides = [of(("left",) * 40, {"peak_force_n": np.full(40, each)}) for each in (150.0, force_n)]
    assert {each.metric for each in differing(*sides)} == found


def test_too_few_strides_and_unknown_figures_are_not_compared() -> None:
    assert metric_differences([run(1, strides=4)], [run(2)]) == []
    unknown = of(("left",) * 40, {"length_m": np.full(40, np.nan)})
    assert metric_differences([unknown], [unknown]) == []


def test_feet_of_one_side_only_are_not_compared() -> None:
    other = of(("nose",) * 80, dict(run(2).strides.columns))
    assert metric_differences([run(1)], [other]) == []


def log(
    gait: str | None = "trot",
    speed: float | None = 0.5,
    mass: float | None = 20.0,
    strides: int = 30,
    feet: tuple[str, ...] = ("left", "right"),
) -> dict[str, Any]:
    return {
        "log": {"path": "a.bag"},
        "settings": {"mass_kg": mass},
        "base": {"forward_speed_mps": speed},
        "feet": {foot: {"strides": strides} for foot in feet},
        "gait": {"name": gait},
        "quality": {"checks": [{"name": "one world", "outcome": "passed"}]},
    }


def test_runs_of_one_kind_are_comparable() -> None:
    assert why_not_comparable([log()], [log(speed=0.55), log(speed=0.45)]) == []


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (log("walk"), "the gaits differ: trot against walk"),
        (log(None), "the gaits differ: trot against not known"),
        (log(speed=0.8), "the speeds differ: 0.50 m/s against 0.80 m/s"),
        (log(mass=25.0), "the masses differ: 20 kg, 25 kg"),
        (log(mass=None), "the masses differ: 20 kg"),
        (log(strides=4), "side 2 has 8 strides of 2 feet: too few"),
        (log(feet=("left", "nose")), "the robots have different feet"),
    ],
)
def test_a_difference_is_named(other: dict[str, Any], says: str) -> None:
    assert why_not_comparable([log()], [other]) == [says]


def test_checks_that_failed_are_doubts() -> None:
    bad = log()
    bad["quality"]["checks"].append({"name": "one clock", "outcome": "failed"})
    assert list(doubts([log(), bad])) == ["a.bag: one clock does not hold"]


def test_two_halves_of_a_run_walk_alike(tmp_path: Path) -> None:
    faults = (sensor_faults.as_force_sensors, sensor_faults.noise(1.0))
    log = write_log(
        disturbed(TrueWalk(seconds=20.0).recorded(200.0, 100.0), *faults), tmp_path / "log.mcap"
    )
    halves = [
        figures(log, options=MeasureOptions(mass=20.0, start=start, end=end))
        for start, end in ((0.0, 10.0), (10.0, 20.0))
    ]
    found = compare_walks(*([half] for half in halves))

    assert found.reasons == ()
    assert found.differing == ()
    assert len(found.differences) > 20
