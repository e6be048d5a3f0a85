"""Tracking of commands, against a base that follows them in closed form."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.poses import Odometry, base_history
from dogbot_logtool.core.commands import follow_commands
from dogbot_logtool.core.compared import AXES, CommandTrack
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.recording import VectorSamples
from dogbot_logtool.core.vectors import vector_history
from dogbot_logtool.core.walk import Walk
from tests.truth.commanded import Commanded
from tests.truth.recording import START_NS, BaseRecording, VectorRecording

NONE = timespans.no_spans()


def followed(
    robot: Commanded, *, forward_rad: float = 0.0, stepping: Ints | None = None
) -> CommandTrack:
    return follow(robot.base(), robot.commands(), robot.period_s, forward_rad, stepping)


def follow(
    base: BaseRecording,
    given: VectorRecording,
    period_s: float | None,
    forward_rad: float = 0.0,
    stepping: Ints | None = None,
) -> CommandTrack:
    clock = TimeSource.HEADER
    vectors = VectorSamples(given.log_time, given.stamp, given.vector, given.vector)
    commands = vector_history("/cmd_vel", vectors, [given.frame], clock, None)
    unknown = np.full_like(base.velocity, np.nan)
    odometry = Odometry(
        base.log_time, base.stamp, base.position, base.orientation, unknown, unknown
    )
    steps = NONE if stepping is None else stepping
    poses = base_history(odometry, clock)
    walk = SimpleNamespace(
        corrected=SimpleNamespace(commands=commands),
        track=SimpleNamespace(history=poses),
        settings=SimpleNamespace(forward_rad=forward_rad),
        jumps=SimpleNamespace(spans=NONE),
        segments=(SimpleNamespace(strides=1, spans=steps),),
        period_s=period_s,
    )
    track = follow_commands(cast("Walk", walk))
    assert track is not None
    return track


def test_a_gait_that_swings_is_no_error() -> None:
    robot = Commanded(gain=(1.0, 1.0, 1.0), delay_s=0.0)
    track = followed(robot)
    for axis in range(3):
        *_, mean, rms = track.errors(axis)
        assert mean == pytest.approx(0.0, abs=0.002)
        # Commands come every 20 ms, so that a step is up to so much late.
        assert rms == pytest.approx(0.0, abs=0.01)


def test_the_opposite_of_a_command_is_told_part_by_part() -> None:
    assert followed(Commanded(gain=(-0.9, 1.0, 1.0))).opposed == AXES[:1]


def test_a_late_answer_is_no_opposition() -> None:
    """Every 0.5 s up and down, half a turn late: at no other delay is it the opposite."""
    steps = tuple((0.5 * row, (0.8 * (row % 2), 0.0, 0.0)) for row in range(50))
    robot = Commanded(steps, gain=(1.0, 1.0, 1.0), delay_s=0.5, period_s=0.1, sway=(0.3, 0.0, 0.0))
    assert not followed(robot).opposed


def test_commands_in_the_axes_of_the_base_are_turned() -> None:
    robot = Commanded(body_yaw_rad=-np.pi / 2.0)
    given = robot.commands()
    turned = replace(given, vector=given.vector[:, [1, 0, 2]] * [-1.0, 1.0, 1.0])
    track = follow(robot.base(), turned, robot.period_s, np.pi / 2.0)
    assert track.axes == "body"
    commanded, measured, *_ = track.errors(0)
    # Gain 0.9, and some 0.17 s of delay.
    assert commanded is not None
    assert measured == pytest.approx(0.9 * commanded, rel=0.1)


def test_commands_in_the_world_have_no_figures_of_directions() -> None:
    robot = Commanded()
    track = follow(robot.base(), replace(robot.commands(), frame="odom"), robot.period_s)
    assert track.axes is None
    assert [track.errors(axis)[0] is None for axis in range(3)] == [True, True, False]


def test_a_silence_is_no_command() -> None:
    robot = Commanded(silences=((6.0, 9.0),))
    found = followed(robot)
    # The command before it holds for 0.5 s.
    assert found.no_command_s == pytest.approx(3.0 - 0.5 + 0.02, abs=0.03)
    assert found.commanded_s == pytest.approx(22.0 - 0.01 - found.no_command_s, abs=0.03)


def test_drift_while_straight_is_commanded_and_of_steps_in_place() -> None:
    robot = Commanded(((0.0, (0.4, 0.0, 0.0)), (12.0, (0.4, 0.0, 0.5))), drift=(0.0, 0.03, -0.02))
    assert followed(robot).drifts["straight"][1:] == pytest.approx([0.03, -0.02], abs=0.001)
    robot = Commanded(((0.0, (0.0, 0.0, 0.0)),), drift=(0.05, -0.02, 0.01))
    stepping = START_NS + np.array([[2, 12]], np.int64) * 1_000_000_000
    in_place = followed(robot, stepping=stepping).drifts["in place"]
    assert in_place == pytest.approx([0.05, -0.02, 0.01], abs=0.001)
    assert not followed(robot).drifts


def test_poses_years_apart_take_no_memory() -> None:
    robot = Commanded(seconds=3.0)
    base = robot.base()
    far = replace(base, stamp=base.stamp + np.arange(len(base.stamp)) * 10**16)
    track = follow(far, robot.commands(), robot.period_s)
    assert len(track.time) == 0
    assert track.errors(0) == (None,) * 4
    assert not track.drifts
