"""Two sides of walks: known differences are found, and what keeps them from being compared."""

import copy
import io
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.comparison.walks import (
    MetricDifference,
    compare_walks,
    doubts,
    metric_differences,
    why_not_comparable,
)
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.metrics import Base, Stability
from dogbot_logtool.core.records import to_json, unknown
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import SOUND
from dogbot_logtool.report.comparison_report import print_gait_comparison
from dogbot_logtool.report.page.comparison import comparison_page
from dogbot_logtool.results import Figures, StrideTable
from tests import forked_cli
from tests.paths import TROT as BAG
from tests.paths import WALK as MCAP
from tests.truth import gaits
from tests.truth.gaits import Gait
from tests.truth.log_file import write_log
from tests.truth.walking import Walk

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


def alike(*feet: str, **columns: float) -> Figures:
    """Make a run of strides that do not vary, sampled every 4 ms."""
    same = {name: np.full(40 * len(feet), each) for name, each in columns.items()}
    return of(feet * 40, same, 0.004)


SHORT, LIGHT = alike("left", stance_s=0.5, swing_s=0.3), alike("left", peak_force_n=150.0)


@pytest.mark.parametrize(
    ("first", "second", "found"),
    [
        *((run(seed), run(seed + 100), set()) for seed in range(3)),
        # Below the sampling interval, and below one per cent.
        (SHORT, alike("left", stance_s=0.502, swing_s=0.298), set()),
        (SHORT, alike("left", stance_s=0.52, swing_s=0.28), {"stance_s", "swing_s"}),
        (LIGHT, alike("left", peak_force_n=150.75), set()),
        (LIGHT, alike("left", peak_force_n=153.0), {"peak_force_n"}),
        # Too few strides, and other feet.
        (run(1, strides=4), run(2, duty=0.9), set()),
        (LIGHT, alike("nose", peak_force_n=200.0), set()),
    ],
)
def test_differences_that_mean_something_are_found(
    first: Figures, second: Figures, found: set[str]
) -> None:
    assert {each.metric for each in differing(first, second)} == found


def test_what_is_not_known_has_no_difference() -> None:
    unknown = alike("left", length_m=np.nan)
    assert metric_differences([unknown], [unknown]) == []


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


@pytest.mark.parametrize(
    ("other", "says"),
    [
        (log(speed=0.55), ""),
        (log("walk"), "the gaits differ: trot against walk"),
        (log(None), "the gaits differ: trot against not known"),
        (log(speed=0.8), "the speeds differ: 0.50 m/s against 0.80 m/s"),
        (log(mass=25.0), "the masses differ: 20 kg, 25 kg"),
        (log(mass=None), "the masses differ: 20 kg"),
        (log(strides=4), "side 2 has 8 strides of 2 feet: too few"),
        (log(feet=("left", "nose")), "the robots have different feet"),
    ],
)
def test_what_keeps_walks_from_being_compared_is_named(other: dict[str, Any], says: str) -> None:
    assert why_not_comparable([log()], [other]) == [says] * bool(says)


def test_checks_that_failed_are_doubts() -> None:
    bad = log()
    bad["quality"]["checks"].append({"name": "all topics have one clock", "outcome": "failed"})
    assert list(doubts([log(), bad])) == ["a.bag: it does not hold that all topics have one clock"]


# --- Their page -----------------------------------------------------------------------------------


TROT, SHORTER, PACE = gaits.TROT, Gait("trot", gaits.TROT.phases, 0.55), gaits.PACE


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Figures]:
    folder = tmp_path_factory.mktemp("logs")
    return {
        name: _measured(folder / f"{name}.mcap", gait)
        for name, gait in (("trot", TROT), ("<shorter>", SHORTER), ("pace", PACE))
    }


def _measured(path: Path, gait: Gait) -> Figures:
    log = write_log(Walk(gait=gait, seconds=9.0).recorded(200.0), path)
    return figures(log, options=MeasureOptions(mass=20.0, jobs=1))


def page(first: Figures, second: Figures) -> str:
    found = compare_walks([first], [second])
    return comparison_page(found, ([first.json], [second.json])).decode()


def test_it_says_what_differs_the_largest_effect_first(measured: dict[str, Figures]) -> None:
    html = page(measured["trot"], measured["<shorter>"])
    found = compare_walks([measured["trot"]], [measured["<shorter>"]])
    assert f"{len(found.differing)} of {len(found.differences)} metrics differ" in html
    order = re.findall(r'<th scope="row">(\w+ \w+) <span role="img" aria-label="(\w+)"', html)
    assert [name for name, _ in order] == [f"{e.foot} {e.metric}" for e in found.differing]
    assert ("front_left duty_factor", "less") in order
    console = Console(file=io.StringIO(), width=120, record=True)
    print_gait_comparison(console, found, verbose=False)
    rows = [" ".join(line.split()[:2]) for line in console.export_text().splitlines()[2:]]
    assert rows == [name for name, _ in order]
    assert "&lt;shorter&gt;.mcap" in html
    assert "<shorter>" not in html
    assert "<script" not in html


def test_runs_that_cannot_be_compared_say_why_first(measured: dict[str, Figures]) -> None:
    html = page(measured["trot"], measured["pace"])
    assert html.index("They cannot be compared") < html.index("the gaits differ: trot against pace")
    assert "Metrics of strides" not in html
    assert "Side by side" in html


def points(html: str, side: str) -> list[Any]:
    """The lines of one side: (n, 2) pixels each, vertical forces of all feet first."""
    found = re.findall(rf'<polyline class="{side}" points="(.*?)"', html)
    return [np.array([each.split(",") for each in line.split()], np.float64) for line in found]


def test_curves_of_both_sides_are_laid_over_each_other(measured: dict[str, Figures]) -> None:
    html = page(measured["trot"], measured["<shorter>"])
    assert re.findall(r'text-anchor="end">(\d+)</text>', html)[:3] == ["0", "50", "100"]
    for name, side in (("trot", "first"), ("<shorter>", "second")):
        (line, *others), feet = points(html, side), measured[name].json["feet"]
        assert len(others) + 1 == 2 * len(feet)
        force = np.array(feet["front_left"]["vertical_over_stride_n"]["median"])
        # The drawing's y is a falling linear function of the force.
        slope, at_zero = np.polyfit(force, line[:, 1], 1)
        assert slope < 0.0
        assert slope * force + at_zero == pytest.approx(line[:, 1], abs=0.1)
        assert (np.diff(line[:, 0]) > 0.0).all()


def test_what_is_not_known_is_left_out(measured: dict[str, Figures]) -> None:
    blind: dict[str, Any] = copy.deepcopy(measured["trot"].json)
    for foot in blind["feet"].values():
        foot["vertical_over_stride_n"] = foot["forward_over_stride_n"] = foot["duty_factor"] = None
    blind["base"] = to_json(unknown(Base))
    blind["stability"] = to_json(unknown(Stability))
    found = compare_walks([measured["trot"]], [measured["pace"]])
    html = comparison_page(found, ([measured["trot"].json], [blind])).decode()
    assert len(points(html, "first")) == 8
    assert points(html, "second") == []
    html = comparison_page(found, ([blind], [blind])).decode()
    assert "<rect" not in html
    assert "no curves" in html


# --- Their page on the command line ---------------------------------------------------------------


def against(folder: Path, *words: object) -> forked_cli.Ended:
    return forked_cli.run("report", words[0], "--against", *words[1:], "--jobs", 1, folder=folder)


def test_a_page_of_two_groups(tmp_path: Path) -> None:
    for log in ("yesterday/1.bag", "today/1.bag", "today/2.bag"):
        (tmp_path / log).parent.mkdir(exist_ok=True)
        shutil.copy(BAG, tmp_path / log)
    ended = against(tmp_path, "yesterday", "today", "-o", "both.html", "--json")
    assert ended.returncode == 0
    found = json.loads(ended.stdout)
    assert found["comparable"]
    assert [len(found[side]) for side in ("first", "second")] == [1, 2]
    assert not any(each["differs"] for each in found["differences"])
    assert "both.html: 0 of 56 metrics differ" in ended.stderr
    assert (tmp_path / "both.html").stat().st_size == found["bytes"]


def test_what_cannot_be_compared_or_written(tmp_path: Path) -> None:
    ended = against(tmp_path, BAG, MCAP)
    assert ended.returncode == 0
    assert "not comparable: the gaits differ: trot against walk" in ended.stderr
    page = tmp_path / "dogbot_trot.against.html"
    page.write_text("mine")
    assert against(tmp_path, BAG, MCAP).returncode == 2
    assert page.read_text() == "mine"
    (tmp_path / "bad.bag").write_bytes(b"#ROSBAG V2.0\n")
    ended = against(tmp_path, BAG, "bad.bag", "-o", "none.html")
    assert ended.returncode == 1
    assert "1 of 2 logs could not be done" in ended.stderr
    assert not (tmp_path / "none.html").exists()
