"""Robots that are no quadrupeds: a hexapod's tripod gait, and a biped's walk."""

from collections.abc import Mapping
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.layout import view_of
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import ConvertOptions, InfoOptions, MeasureOptions
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.layouts import foxglove_layout
from dogbot_logtool.report.text.stats_text import print_report
from tests.oracles import walks

KIND = "gazebo_msgs/msg/ContactsState"
STRIDE, STANCE, SAMPLES = 80, 48, 560
FORCE = (0.0, 0.0, 60.0)
HEXAPOD = {
    "front_left": 0,
    "front_right": 40,
    "middle_left": 40,
    "middle_right": 0,
    "back_left": 0,
    "back_right": 40,
}
BIPED = {"left": 0, "right": 40}


def touches(phase: int, sample: int) -> bool:
    return sample - 10 - phase >= 0 and (sample - 10 - phase) % STRIDE < STANCE


def walked(path: Path, phases: Mapping[str, int]) -> Path:
    """Write a walk of feet that each begin their stance at a phase, in samples."""
    walk = walks.Walk(2)
    entries = []
    for sample in range(SAMPLES):
        time = walks.START + sample * walks.STEP
        odometry = walk.odometry(sample)
        entries.append(walks.Entry("/odom", "nav_msgs/msg/Odometry", time, odometry))
        for leg, phase in phases.items():
            states = [walk.classic_state(leg, FORCE)] if touches(phase, sample) else []
            message = walk.make(KIND, header=walk.header(sample, "world"), states=states)
            data = walk.bytes_of(KIND, message)
            entries.append(walks.Entry(f"/{leg}/contact", KIND, time, data))
    walks.write_mcap(path, walk, entries)
    return path


@pytest.mark.parametrize("phases", [HEXAPOD, BIPED], ids=["hexapod", "biped"])
def test_gait_figures_are_whole_and_those_of_quadrupeds_null(
    tmp_path: Path, phases: Mapping[str, int]
) -> None:
    log = walked(tmp_path / "walk.mcap", phases)
    feet = {leg: f"/{leg}/contact" for leg in phases}
    carried_kg = len(phases) * STANCE / STRIDE * FORCE[2] / 9.81
    options = MeasureOptions(robot="generic", foot=feet, mass=carried_kg)
    done = measure(log, options)
    got: dict[str, Any] = stats_json(done)

    assert list(got["feet"]) == list(phases)
    for leg, phase in phases.items():
        foot = got["feet"][leg]
        assert foot["duty_factor"]["median"] == pytest.approx(STANCE / STRIDE, abs=0.02)
        assert foot["stride_period_s"]["median"] == pytest.approx(0.8)
        assert foot["peak_force_n"]["max"] == pytest.approx(60.0)
        told = got["gait"]["phase"][leg]
        assert np.cos(2 * np.pi * (told["mean"] - phase / STRIDE)) == pytest.approx(1.0, abs=1e-3)
    assert got["gait"]["duty_factor"] == pytest.approx(STANCE / STRIDE, abs=0.02)
    assert got["gait"]["name"] == {2: "walk", 6: "tripod"}[len(phases)]
    for quadruped_only in ("sequence", "diagonality"):
        assert got["gait"][quadruped_only] is None
    support = got["gait"]["support"]
    assert sum(support.values()) == pytest.approx(1.0)
    assert set(support) == {str(number) for number in range(len(phases) + 1)}
    both = len(phases)
    assert support[str(both)] == pytest.approx(0.2, abs=0.02)
    assert support[str(both // 2)] == pytest.approx(0.8, abs=0.05)
    out = StringIO()
    print_report(Console(file=out, width=100), done)
    assert all(leg in out.getvalue() for leg in phases)
    assert "all four feet" not in out.getvalue()
    assert {2: "Gait: walk (high confidence", 6: "Gait: tripod (high confidence"}[
        len(phases)
    ] in out.getvalue()


@pytest.mark.parametrize("phases", [HEXAPOD, BIPED], ids=["hexapod", "biped"])
def test_they_are_found_drawn_and_laid_out(tmp_path: Path, phases: Mapping[str, int]) -> None:
    log = walked(tmp_path / "walk.mcap", phases)
    told = describe(log, InfoOptions())
    used = {topic.use for topic in told.topics}
    count = sum(use.startswith("foot ") for use in used)
    assert count == len(phases)
    done = convert(log, tmp_path / "out.mcap", ConvertOptions(style="force"))
    drawn = [topic for topic in done.annotations if topic.startswith("/marker_basic")]
    assert len(drawn) == len(phases)
    assert all(done.annotations[topic] == SAMPLES for topic in drawn)
    layout = foxglove_layout(view_of(log, MeasureOptions()))
    assert all(topic in str(layout) for topic in drawn)
