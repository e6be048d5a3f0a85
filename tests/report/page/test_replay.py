"""What the replay draws, held against the walk that the sample log was made of."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.report import replay_of
from dogbot_logtool.commands.stats import measure_log
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.page.render import page
from dogbot_logtool.report.page.replay import MOST_FRAMES, frame_times, replay
from dogbot_logtool.results import Measurement
from dogbot_logtool.robot.recorded import open_recorded
from tests.measured import LogFacts, measurement_of
from tests.paths import TROT
from tests.report.page.page_data import numbers
from tests.truth import physics
from tests.truth.free_walker import trot
from tests.truth.physics import KEPT_S


@cache
def measured() -> Measurement:
    return measured_and_shown(TROT)[0]


@cache
def shown() -> dict[str, Any]:
    return measured_and_shown(TROT)[1]


@cache
def measured_and_shown(path: Path) -> tuple[Measurement, dict[str, Any]]:
    log = open_recorded(path)
    try:
        found = measure_log(log, MeasureOptions())
        drawn = replay_of(found)
    finally:
        log.close()
    assert drawn is not None
    return found.measurement, drawn


def points(column: Any) -> Any:
    return numbers(column).reshape(-1, 3)


def test_the_robot_is_where_the_log_says() -> None:
    history, time = measured().walk.base_history, numbers(shown()["time"])
    assert np.diff(time) == pytest.approx(0.04, abs=1e-4)
    since = (history.time - measured().walk.origin) / 1e9
    assert abs(history.position[0, :2]).max() < 0.5
    for axis, column in enumerate(points(shown()["position"]).T):
        wanted = np.interp(time, since, history.position[:, axis])
        assert column == pytest.approx(wanted, abs=1e-3)


def test_a_foot_stands_still_while_it_is_down_and_frames_lead_to_it() -> None:
    """The joints come from transforms, the standing feet from contact points: both must agree."""
    angles, position = points(shown()["angles"]), points(shown()["position"])
    limbs = shown()["limbs"]
    joints = numbers(limbs["point"]).reshape(len(position), -1, 3)
    tips = [joint for joint in range(joints.shape[1]) if joint not in limbs["parents"]]
    for foot in shown()["feet"]:
        down, place = numbers(foot["state"]) == 1, points(foot["point"])
        moved = np.linalg.norm(np.diff(place, axis=0), axis=1)
        assert moved[down[1:] & down[:-1]].max() < 2e-3
        turned = [_world(joints[:, tip], position, angles) for tip in tips]
        away = [np.median(np.linalg.norm(each - place, axis=1)[down]) for each in turned]
        assert min(away) < 3e-3


def _world(point: Any, position: Any, angles: Any) -> Any:
    """Turn points by yaw, pitch and roll, one elementary rotation after the other."""
    placed = []
    for row, (roll, pitch, yaw) in zip(point, angles, strict=True):
        c, s = np.cos, np.sin
        about_x = np.array([[1, 0, 0], [0, c(roll), -s(roll)], [0, s(roll), c(roll)]])
        about_y = np.array([[c(pitch), 0, s(pitch)], [0, 1, 0], [-s(pitch), 0, c(pitch)]])
        about_z = np.array([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]])
        placed.append(about_z @ about_y @ about_x @ row)
    return position + np.array(placed)


def test_joint_states_bend_the_legs_as_the_engine_does(tmp_path: Path) -> None:
    """A log without transforms, but with a robot description."""
    log = physics.write_log(tmp_path / "log.mcap", trot(), by_transforms=False)
    _, found = measured_and_shown(log)
    limbs, row = found["limbs"], 10
    joints = numbers(limbs["point"]).reshape(-1, len(limbs["parents"]), 3)[row]
    step = round(numbers(found["time"])[row] / KEPT_S)
    for calf in trot().calf[step, :, :3]:
        assert np.linalg.norm(joints - calf, axis=1).min() < 1e-3


def test_without_frames_lines_lead_to_the_feet_and_unknown_feet_are_below_the_base() -> None:
    stats = measured().walk
    time = frame_times(stats, ())
    plain = replay(stats, (), time, None)
    assert plain is not None
    assert plain["limbs"] is None
    assert not plain["schematic"]
    no_points = np.empty(0, np.int64), np.empty((0, 3))
    nowhere = tuple(
        foot._replace(
            record=replace(
                foot.record,
                track=foot.record.track._replace(contact_points=no_points),
            ),
        )
        for foot in stats.feet
    )
    unknown = replay(replace(stats, feet=nowhere), (), time, None)
    assert unknown is not None
    assert unknown["schematic"]
    html = page(measurement_of(stats, LogFacts()), 0, replay=unknown).decode()
    assert "does not tell where the feet are" in html
    assert "<canvas" in html
    assert "<canvas" not in page(measurement_of(stats, LogFacts()), 0).decode()


def test_a_long_log_is_thinned() -> None:
    stats = measured().walk
    until = stats.poses.time.copy()
    until[-1] = stats.origin + 86_400_000_000_000
    day = replace(stats, poses=replace(stats.poses, time=until))
    time = frame_times(day, ())
    assert len(time) <= MOST_FRAMES
    assert (np.diff(time) > 0).all()
    near = (time > stats.origin + 3_000_000_000) & (time < stats.origin + 6_000_000_000)
    assert np.diff(time[near]).max() <= 40_000_000
