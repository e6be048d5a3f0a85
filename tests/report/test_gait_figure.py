"""The figure for a paper: what is drawn against `stats --json`, and SVG and PDF read back."""

import io
import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from pypdf import PdfReader

from dogbot_logtool.commands.plot import draw_figure
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.gait_figure import gait_figure, write_figure
from dogbot_logtool.report.text.gait_diagram import default_window
from tests.measured import measured
from tests.oracles import walks
from tests.paths import TROT, TROUBLED, WALK

FEET = {"front_left": "FL", "front_right": "FR", "back_left": "BL", "back_right": "BR"}
SVG = "{http://www.w3.org/2000/svg}"
MM_PER_INCH = 25.4
Window = tuple[float, float]


def draw(path: Path, form: str) -> bytes:
    file, walk = io.BytesIO(), measured(path).walk
    write_figure(gait_figure(walk, default_window(walk)), file, form)
    return file.getvalue()


drawn = cache(draw)


def bars(figure: Figure, foot: str) -> list[Window]:
    """Return start and end of each bar, s."""
    drawn = [each for axes in figure.axes for each in axes.collections]
    (group,) = [each for each in drawn if each.get_gid() == f"stance-{foot}"]
    corners = (np.asarray(path.vertices)[:, 0] for path in group.get_paths())
    return [(float(each.min()), float(each.max())) for each in corners]


@pytest.mark.parametrize("path", [TROT, WALK], ids=["trot", "walk"])
def test_bars_go_from_touchdown_to_liftoff(path: Path) -> None:
    window = 0.0, 4.0
    figure, feet = gait_figure(measured(path).walk, window), stats_json(measured(path))["feet"]
    assert figure.get_figwidth() * MM_PER_INCH == pytest.approx(85.0)
    edges = [edge for foot in FEET for bar in bars(figure, foot) for edge in bar]
    assert max(edges) == pytest.approx(4.0, abs=2e-4)
    for foot in FEET:
        starts, ends = (within(each, window) for each in zip(*bars(figure, foot), strict=True))
        assert starts == pytest.approx(within(feet[foot]["touchdown_s"], window), abs=2e-4)
        assert ends == pytest.approx(within(feet[foot]["lift_off_s"], window), abs=2e-4)
        assert len(starts) >= 3


def within(times: "list[float] | tuple[float, ...]", window: Window) -> list[float]:
    """Leave out what lies outside a window, or at its very edge, where bars are cut."""
    return [time for time in times if window[0] + 1e-3 < time < window[1] - 1e-3]


def test_lines_reach_the_peaks_gaps_part_them_and_a_dead_foot_has_no_bars() -> None:
    done = measured(TROUBLED)
    figure = gait_figure(done.walk, (0.0, 5.0))
    lines = {
        line.get_gid(): np.asarray(line.get_ydata(), np.float64)
        for axes in figure.axes
        for line in axes.lines
    }
    peak = stats_json(done)["feet"]["front_left"]["peak_force_bw"]["max"]
    assert np.nanmax(lines["load-front_left"]) == pytest.approx(peak, rel=1e-6)
    broken = {name for name, line in lines.items() if np.isnan(line).any()}
    assert broken == {"load-front_right"}
    assert bars(figure, "back_left") == []


@pytest.mark.parametrize("form", ["svg", "pdf"])
def test_text_is_text_and_bytes_are_the_same_whatever_the_user_has_set_up(form: str) -> None:
    first = drawn(WALK, form)
    if form == "svg":
        found = [*ET.fromstring(first).itertext()]  # noqa: S314 - of our own making
    else:
        found = [PdfReader(io.BytesIO(first)).pages[0].extract_text()]
    assert {*FEET.values(), "(s)", "(body"} <= set(" ".join(found).split())
    with mpl.rc_context({"lines.linewidth": 9.0, "font.size": 20.0, "svg.fonttype": "path"}):
        assert draw(WALK, form) == first
    assert not re.search(rb"Matplotlib v|CreationDate|dc:date", first)


def test_sensors_without_a_force_give_the_gait_diagram_alone(tmp_path: Path) -> None:
    kind = "spot_msgs/msg/FootStateArray"
    path = walks.write_walk(tmp_path, kind, "mcap")
    options = MeasureOptions(robot=str(walks.robot_file(tmp_path, kind)))
    target = tmp_path / "walk.svg"
    draw_figure(measure(path, options), target, overwrite=False)
    svg = ET.fromstring(target.read_bytes())  # noqa: S314 - ours
    groups = {group.get("id", "").rpartition("-")[0] for group in svg.iter(f"{SVG}g")}
    assert "stance" in groups
    assert "load" not in groups
    assert "Time" in " ".join(svg.itertext()).split()
