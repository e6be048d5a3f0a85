"""Tracking of commands, against a base that follows them in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints
from dogbot_logtool.core.base.poses import Odometry, base_history
from dogbot_logtool.core.commands.tracking import (
    AxisTracking,
    CommandTrack,
    Tracking,
    follow_commands,
    tracking,
)
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.recorded.vectors import VectorSamples, vector_history
from tests.truth.commanded import Commanded
from tests.truth.recording import START_NS, BaseRecording, VectorRecording

NONE = timespans.no_spans()
AXES = ("forward", "lateral", "yaw")


def followed(
    robot: Commanded, *, forward_axis: str = "+x", stepping: Ints | None = None
) -> CommandTrack:
    return follow(robot.base(), robot.commands(), robot.period_s, forward_axis, stepping)


def follow(
    base: BaseRecording,
    given: VectorRecording,
    period_s: float | None,
    forward_axis: str = "+x",
    stepping: Ints | None = None,
) -> CommandTrack:
    clock = TimeSource.HEADER
    vectors = VectorSamples(given.log_time, given.stamp, given.vector)
    commands = vector_history("/cmd_vel", vectors, [given.frame], clock, None, averages=False)
    unknown = np.full_like(base.velocity, np.nan)
    odometry = Odometry(
        base.log_time, base.stamp, base.position, base.orientation, unknown, unknown
    )
    steps = NONE if stepping is None else stepping
    poses = base_history(odometry, clock)
    track = follow_commands(commands, poses, NONE, forward_axis, steps, period_s)
    assert track is not None
    return track


def axis_of(found: Tracking, name: str) -> AxisTracking:
    axis = getattr(found, name)
    assert isinstance(axis, AxisTracking)
    return axis


def test_a_gait_that_swings_is_no_error() -> None:
    robot = Commanded(gain=(1.0, 1.0, 1.0), delay_s=0.0)
    found = tracking(followed(robot))
    for name in AXES:
        axis = axis_of(found, name)
        assert abs(axis.mean_error) < 0.002
        # Commands come every 20 ms, so that a step is up to so much late.
        assert axis.rms_error < 0.01


def test_errors_are_those_of_a_constant_offset() -> None:
    steps = ((0.0, (0.4, 0.0, 0.0)),)
    robot = Commanded(steps, gain=(1.0, 1.0, 1.0), delay_s=0.0, drift=(-0.05, 0.02, 0.03))
    found = tracking(followed(robot))
    for name, drift in zip(AXES, robot.drift, strict=True):
        axis = axis_of(found, name)
        assert axis.mean_error == pytest.approx(drift, abs=1e-4)
        assert axis.rms_error == pytest.approx(abs(drift), abs=1e-3)
    assert axis_of(found, "forward").commanded_mean == pytest.approx(0.4)
    assert axis_of(found, "forward").measured_mean == pytest.approx(0.35, abs=1e-3)


def test_the_opposite_of_a_command_is_told_part_by_part() -> None:
    found = tracking(followed(Commanded(gain=(-0.9, 1.0, 1.0))))
    assert [axis_of(found, name).is_opposed for name in AXES] == [True, False, False]


def test_a_late_answer_is_no_opposition() -> None:
    """Every 0.5 s up and down, half a turn late: at no other delay is it the opposite."""
    steps = tuple((0.5 * row, (0.8 * (row % 2), 0.0, 0.0)) for row in range(50))
    robot = Commanded(steps, gain=(1.0, 1.0, 1.0), delay_s=0.5, period_s=0.1, sway=(0.3, 0.0, 0.0))
    assert not axis_of(tracking(followed(robot)), "forward").is_opposed


def test_a_constant_command_and_a_robot_that_stands_oppose_nothing() -> None:
    constant = Commanded(((-1.0, (0.4, 0.0, 0.0)),))
    standing = Commanded(gain=(0.0, 0.0, 0.0), sway=(0.0, 0.0, 0.0))
    for robot in (constant, standing):
        assert not axis_of(tracking(followed(robot)), "forward").is_opposed


@pytest.mark.parametrize("axis", ["+y", "-x", "-y"])
def test_axes_are_those_that_fit(axis: str) -> None:
    """A command's x is forward, whichever way the base's own axes point."""
    turns = {"+y": -np.pi / 2.0, "-x": np.pi, "-y": np.pi / 2.0}
    robot = Commanded(body_yaw_rad=turns[axis])
    track = followed(robot, forward_axis=axis)
    assert track.axes == "forward"
    found = axis_of(tracking(track), "forward")
    # Gain 0.9, and some 0.17 s of delay.
    assert found.measured_mean == pytest.approx(0.9 * found.commanded_mean, rel=0.1)


def test_commands_in_the_axes_of_the_base_are_turned() -> None:
    robot = Commanded(body_yaw_rad=-np.pi / 2.0)
    given = robot.commands()
    turned = replace(given, vector=given.vector[:, [1, 0, 2]] * [-1.0, 1.0, 1.0])
    track = follow(robot.base(), turned, robot.period_s, "+y")
    assert track.axes == "body"
    found = axis_of(tracking(track), "forward")
    # Gain 0.9, and some 0.17 s of delay.
    assert found.measured_mean == pytest.approx(0.9 * found.commanded_mean, rel=0.1)


def test_commands_in_the_world_have_no_figures_of_directions() -> None:
    robot = Commanded()
    track = follow(robot.base(), replace(robot.commands(), frame="odom"), robot.period_s)
    found = tracking(track)
    assert track.axes is None
    assert found.forward is None
    assert found.lateral is None
    assert found.yaw is not None


def test_a_silence_is_no_command() -> None:
    robot = Commanded(silences=((6.0, 9.0),))
    found = tracking(followed(robot))
    # The command before it holds for 0.5 s.
    assert found.no_command_s == pytest.approx(3.0 - 0.5 + 0.02, abs=0.03)
    assert found.commanded_s == pytest.approx(22.0 - 0.01 - found.no_command_s, abs=0.03)


def test_drift_while_straight_is_commanded() -> None:
    robot = Commanded(((0.0, (0.4, 0.0, 0.0)), (12.0, (0.4, 0.0, 0.5))), drift=(0.0, 0.03, -0.02))
    straight = tracking(followed(robot)).straight
    assert straight is not None
    assert straight.duration_s == pytest.approx(12.0 - 1.0 - 0.8, abs=0.2)
    assert straight.lateral == pytest.approx(0.03, abs=0.001)
    assert straight.yaw_rate == pytest.approx(-0.02, abs=0.001)


def test_drift_of_steps_in_place() -> None:
    robot = Commanded(((0.0, (0.0, 0.0, 0.0)),), drift=(0.05, -0.02, 0.01))
    stepping = START_NS + np.array([[2, 12]], np.int64) * 1_000_000_000
    in_place = tracking(followed(robot, stepping=stepping)).in_place
    assert in_place is not None
    assert in_place.forward == pytest.approx(0.05, abs=0.001)
    assert in_place.lateral == pytest.approx(-0.02, abs=0.001)
    assert in_place.duration_s == pytest.approx(10.0 - 0.8, abs=0.1)
    assert tracking(followed(robot)).in_place is None


def test_a_part_of_the_log_has_its_own_figures() -> None:
    robot = Commanded(
        ((0.0, (0.2, 0.0, 0.0)), (10.0, (0.6, 0.0, 0.0))),
        gain=(1.0, 1.0, 1.0),
        delay_s=0.0,
        sway=(0.0, 0.0, 0.0),
    )
    track = followed(robot)
    later = START_NS + np.array([[11, 21]], np.int64) * 1_000_000_000
    found = tracking(track, later)
    assert axis_of(found, "forward").commanded_mean == pytest.approx(0.6)
    assert found.commanded_s == pytest.approx(10.0)


def test_poses_years_apart_take_no_memory() -> None:
    robot = Commanded(seconds=3.0)
    base = robot.base()
    far = replace(base, stamp=base.stamp + np.arange(len(base.stamp)) * 10**16)
    track = follow(far, robot.commands(), robot.period_s)
    assert len(track.time) == 0
    found = tracking(track)
    assert found.forward is None
    assert found.straight is None
