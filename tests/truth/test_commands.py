"""Tracking of commands, against a base that follows them in closed form."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dogbot_logtool as dl
from tests.truth.commanded import Commanded, commanded_walk
from tests.truth.log_file import write_log
from tests.truth.recording import VectorRecording

AXES = {"forward": "mps", "lateral": "mps", "yaw": "radps"}


def tracked(
    folder: Path,
    robot: Commanded,
    change: Callable[[VectorRecording], VectorRecording] = lambda given: given,
    **options: Any,
) -> Any:
    """What the JSON says of a base that follows commands."""
    log = write_log(commanded_walk(robot, change(robot.commands())), folder / "log.mcap")
    return dl.measure(log, mass=20.0, **options).stats


def said(stats: Any, code: str) -> list[str]:
    return [each["text"] for each in stats["findings"] if each["code"] == code]


@pytest.mark.parametrize("delay_s", [0.0, 0.17])
def test_errors_are_those_of_means_over_a_stride(delay_s: float, tmp_path: Path) -> None:
    """The gait swings about the mean, which is no error."""
    robot = Commanded(delay_s=delay_s, drift=(0.0, 0.03, -0.02))
    time = np.arange(0.0, robot.seconds, 0.001)
    off = np.cumsum(robot.velocity(time) - robot.commanded(time), axis=0)
    stride = round(1000.0 * robot.period_s)
    error = (off[stride:] - off[:-stride]) / stride
    found = tracked(tmp_path, robot)["commands"]
    for column, (axis, unit) in enumerate(AXES.items()):
        mean, rms = error[:, column].mean(), np.sqrt(np.square(error[:, column]).mean())
        assert found[axis][f"mean_error_{unit}"] == pytest.approx(mean, abs=0.003)
        # Commands come every 20 ms, so that a step is up to so much late.
        assert found[axis][f"rms_error_{unit}"] == pytest.approx(rms, abs=0.005)


def test_the_opposite_of_a_command_is_told_part_by_part(tmp_path: Path) -> None:
    (text,) = said(tracked(tmp_path, Commanded(gain=(-0.9, 1.0, 1.0))), "COMMAND_AXES")
    assert "forward" in text


def test_a_late_answer_is_no_opposition(tmp_path: Path) -> None:
    """Every 0.5 s up and down, half a turn late: at no other delay is it the opposite."""
    steps = tuple((0.5 * row, (0.8 * (row % 2), 0.0, 0.0)) for row in range(50))
    gain, sway = (1.0, 1.0, 1.0), (0.3, 0.0, 0.0)
    robot = Commanded(steps, delay_s=0.5, gain=gain, period_s=0.1, sway=sway)
    assert not said(tracked(tmp_path, robot), "COMMAND_AXES")


def test_commands_in_the_axes_of_the_base_are_turned(tmp_path: Path) -> None:
    def turned(given: VectorRecording) -> VectorRecording:
        return replace(given, vector=given.vector[:, [1, 0, 2]] * [-1.0, 1.0, 1.0])

    robot = Commanded(body_yaw_rad=-np.pi / 2.0)
    stats = tracked(tmp_path, robot, turned, set={"forward_axis": "+y"})
    forward = stats["commands"]["forward"]
    # Gain 0.9, and some 0.17 s of delay.
    assert forward["measured_mps"] == pytest.approx(0.9 * forward["commanded_mps"], rel=0.1)


def test_commands_in_the_world_have_no_figures_of_directions(tmp_path: Path) -> None:
    stats = tracked(tmp_path, Commanded(), lambda given: replace(given, frame="odom"))
    (text,) = said(stats, "COMMAND_AXES")
    assert "which axes" in text
    found = stats["commands"]
    assert found["forward"]["commanded_mps"] is found["lateral"]["commanded_mps"] is None
    assert found["yaw"]["commanded_radps"] is not None


def test_a_silence_is_no_command(tmp_path: Path) -> None:
    stats = tracked(tmp_path, Commanded(silences=((6.0, 9.0),)))
    # The command before it holds for 0.5 s.
    assert "there is no command for 2.5 s of 22.0 s" in said(stats, "NO_COMMAND")[0]
    assert stats["commands"]["commanded_s"] == pytest.approx(22.0 - 2.5, abs=0.06)
    assert not said(stats, "GAPS")


def test_poses_years_apart_take_no_memory(tmp_path: Path) -> None:
    robot = Commanded(seconds=3.0)
    recording = commanded_walk(robot, robot.commands())
    far = recording.base.stamp + np.arange(len(recording.base.stamp)) * 10**16
    log = write_log(
        replace(recording, base=replace(recording.base, stamp=far)), tmp_path / "x.mcap"
    )
    assert dl.measure(log, mass=20.0).stats["commands"]["forward"]["commanded_mps"] is None
