"""The figure for a paper: read back from SVG and PDF, against the truth and `stats --json`."""

import io
import re
from functools import cache
from pathlib import Path
from typing import Any
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
MM_PER_POINT = 25.4 / 72.0
Window = tuple[float, float]


def draw(path: Path, form: str, window: Window | None = None) -> bytes:
    file = io.BytesIO()
    write_figure(figure_of(path, window), file, form)
    return file.getvalue()


def figure_of(path: Path, window: Window | None) -> Figure:
    stats = measured(path, MeasureOptions()).walk
    window = window or default_window(stats)
    return gait_figure(stats, window)


drawn = cache(draw)


def svg_of(path: Path, window: Window | None = None) -> ET.Element:
    return ET.fromstring(drawn(path, "svg", window))  # noqa: S314 - of our own making


def texts(svg: ET.Element) -> list[str]:
    return ["".join(text.itertext()).strip() for text in svg.iter(f"{SVG}text")]


def time_scale(svg: ET.Element) -> np.poly1d:
    """Return the time at a place, from the places of the numbers below the time axis."""
    at = [
        (float(text.get("x", "nan")), float("".join(text.itertext())))
        for axis in svg.iter(f"{SVG}g")
        if axis.get("id", "").startswith("xtick")
        for text in axis.iter(f"{SVG}text")
    ]
    assert len(at) >= 3
    return np.poly1d(np.polyfit([place for place, _ in at], [time for _, time in at], 1))


def bars(svg: ET.Element, foot: str) -> list[Window]:
    """Return start and end of each bar, s, as drawn."""
    (group,) = [g for g in svg.iter(f"{SVG}g") if g.get("id") == f"stance-{foot}"]
    time = time_scale(svg)
    edges = []
    for path in group.iter(f"{SVG}path"):
        places = [float(x) for x in re.findall(r"[ML] (\S+) ", path.get("d", ""))]
        edges.append((float(time(min(places))), float(time(max(places)))))
    return sorted(edges)


@pytest.mark.parametrize("path", [TROT, WALK], ids=["trot", "walk"])
def test_bars_go_from_touchdown_to_liftoff(path: Path) -> None:
    told: dict[str, Any] = stats_json(measured(path, MeasureOptions()))
    window = 0.0, 4.0
    svg = svg_of(path, window)
    assert float(svg.get("width", "").rstrip("pt")) * MM_PER_POINT == pytest.approx(85.0)
    edges = [edge for foot in FEET for bar in bars(svg, foot) for edge in bar]
    assert max(edges) == pytest.approx(4.0, abs=2e-4)
    for foot in FEET:
        figures = told["feet"][foot]
        found = bars(svg, foot)
        starts = within([start for start, _ in found], window)
        ends = within([end for _, end in found], window)
        assert starts == pytest.approx(within(figures["touchdown_s"], window), abs=2e-4)
        assert ends == pytest.approx(within(figures["lift_off_s"], window), abs=2e-4)
        assert len(starts) >= 3


def within(times: list[float], window: Window) -> list[float]:
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
    assert bars(svg_of(TROUBLED, (0.0, 5.0)), "back_left") == []


def test_text_is_text() -> None:
    for form in ("svg", "pdf"):
        if form == "svg":
            found = texts(svg_of(WALK))
        else:
            page = PdfReader(io.BytesIO(drawn(WALK, form))).pages[0]
            found = page.extract_text().replace("\n", " ").split(" ")
        assert set(FEET.values()) <= set(found)
        assert [word for word in " ".join(found).split() if word == "(s)"]
        assert "body" in " ".join(found)


@pytest.mark.parametrize("form", ["svg", "pdf"])
def test_the_same_bytes_whatever_the_user_has_set_up(form: str) -> None:
    first = drawn(WALK, form)
    with mpl.rc_context({"lines.linewidth": 9.0, "font.size": 20.0, "svg.fonttype": "path"}):
        assert draw(WALK, form) == first
    assert not re.search(rb"Matplotlib v|CreationDate|dc:date", first)


def test_sensors_without_a_force_give_the_gait_diagram_alone(tmp_path: Path) -> None:
    kind = "spot_msgs/msg/FootStateArray"
    path = walks.write_walk(tmp_path, kind, "mcap")
    options = MeasureOptions(robot=str(walks.robot_file(tmp_path, kind)))
    done = measure(path, options)
    target = tmp_path / "walk.svg"
    draw_figure(done, target, overwrite=False)
    svg = ET.fromstring(target.read_bytes())  # noqa: S314 - ours
    assert not [g for g in svg.iter(f"{SVG}g") if g.get("id", "").startswith("load-")]
    assert not [text for text in texts(svg) if text.startswith("Load")]
    assert "Time (s)" in texts(svg)
    for leg in walks.LEGS:
        assert bars(svg, leg)
