"""The page that shows two sides side by side."""

import copy
import json
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.comparison.walks import compare_walks
from dogbot_logtool.core.metrics import Base, Stability
from dogbot_logtool.core.records import to_json, unknown
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.page.comparison import comparison_page
from dogbot_logtool.results import Figures
from tests.forked_cli import Ended, run
from tests.paths import TROT as BAG
from tests.paths import WALK as MCAP
from tests.truth import gaits
from tests.truth.gaits import Gait
from tests.truth.log_file import write_log
from tests.truth.walking import Walk

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


# --- The command ----------------------------------------------------------------------------------


def against(folder: Path, *words: object) -> Ended:
    return run("report", words[0], "--against", *words[1:], "--jobs", 1, folder=folder)


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
