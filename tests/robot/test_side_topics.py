"""Velocity commands and inertial units of whole logs."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dogbot_logtool as dl
from dogbot_logtool.core.metrics import NEEDS
from tests.truth.commanded import Commanded, commanded_walk
from tests.truth.gaits import WALK
from tests.truth.log_file import write_log
from tests.truth.pose_faults import drifting
from tests.truth.recording import Recording, VectorRecording, disturbed
from tests.truth.sensed import with_imu
from tests.truth.walking import Walk

ROBOT = Commanded(seconds=16.0)


def walk(*beside: VectorRecording) -> Recording:
    return commanded_walk(ROBOT, *beside)


def measured(tmp_path: Path, recording: Recording, name: str = "x.mcap", **options: Any) -> Any:
    return dl.measure(write_log(recording, tmp_path / name), mass=20.0, **options).stats


def said(stats: Any, code: str) -> list[str]:
    return [each["text"] for each in stats["findings"] if each["code"] == code]


@pytest.mark.parametrize(("kind", "name"), [("twist", "x.mcap"), ("twist_stamped", "x.bag")])
def test_both_types_and_versions_of_ros_are_read(tmp_path: Path, kind: str, name: str) -> None:
    stats = measured(tmp_path, walk(ROBOT.commands(kind)), name)
    assert stats["commands"]["topic"] == "/cmd_vel"
    assert stats["commands"]["forward"]["commanded_mps"] > 0.1
    assert len(said(stats, "LOG_TIME_USED")) == (kind == "twist")


def test_measured_twists_are_no_commands(tmp_path: Path) -> None:
    topics = ("/odom_twist", "/base_velocity", "/cmd_vel_measured", "/twist")
    stats = measured(tmp_path, walk(*(ROBOT.commands(topic=topic) for topic in topics)))
    assert stats["commands"]["topic"] is None
    assert stats["null_because"]["commands.topic"] == NEEDS["commands"]
    assert not any("commands" in each for each in said(stats, "TOPICS_CHOSEN"))


def test_the_best_of_several_is_taken_and_the_others_are_said(tmp_path: Path) -> None:
    topics = ("/joy/desired", "/robot/cmd_vel", "/nav/command_velocity", "/cmd_vel_nav")
    recording = walk(*(ROBOT.commands(topic=topic) for topic in topics))
    stats = measured(tmp_path, recording)
    assert stats["commands"]["topic"] == "/robot/cmd_vel"
    text = " ".join(said(stats, "TOPICS_CHOSEN"))
    assert "/cmd_vel_nav, /nav/command_velocity, /joy/desired (--set command_topic chooses)" in text
    named = measured(tmp_path, recording, "y.mcap", set={"command_topic": "/joy/desired"})
    assert named["commands"]["topic"] == "/joy/desired"


def test_commands_that_are_no_numbers_are_said(tmp_path: Path) -> None:
    given = ROBOT.commands()
    given.vector[[10, 20]] = np.nan
    stats = measured(tmp_path, walk(given))
    (text,) = said(stats, "NOT_FINITE")
    assert "2 messages of 801" in text


def test_tracking_is_null_where_the_odometry_loses_its_way(tmp_path: Path) -> None:
    robot = Commanded(((0.0, (0.4, 0.0, 0.0)),), seconds=16.0)
    sound = Walk(seconds=16.0, speed_mps=0.4).recorded(200.0, 100.0)
    for recording, known in ((sound, True), (disturbed(sound, drifting(0.1)), False)):
        stats = measured(tmp_path, replace(recording, beside=(robot.commands(),)))
        commands = stats["commands"]
        told = [commands[key]["rms_error_mps"] is not None for key in ("forward", "lateral")]
        assert told == [known] * 2
        assert commands["yaw"]["commanded_radps"] == 0.0
        because = stats["null_because"].get("commands.forward.rms_error_mps")
        assert because == (None if known else "WORLDS_DIFFER")


def test_other_units_are_left_aside(tmp_path: Path) -> None:
    recording = with_imu()(Walk(gait=WALK, seconds=10.0).recorded(200.0, 100.0))
    (imu,) = recording.beside
    others = ("/left_foot/imu", "/camera/imu", "/imu/data_raw")
    beside = (imu, *(replace(imu, topic=topic) for topic in others))
    stats = measured(tmp_path, replace(recording, beside=beside))
    assert stats["imu"]["topic"] == "/imu/data"
    option = {"imu_topic": "/camera/imu"}
    named = measured(tmp_path, replace(recording, beside=beside), "y.mcap", set=option)
    assert named["imu"]["topic"] == "/camera/imu"
