import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.motion import (
    BaseTrack,
    base_motion,
    find_travel,
    froude_number,
    stride_lengths,
)
from dogbot_logtool.core.base.poses import BaseHistory, Odometry, base_history
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.metrics import Base

START = 5_000_000_000


def circle(*, seconds: float = 4.0, rate_hz: float = 200.0) -> Odometry:
    """A base that drives a circle of 2 m at 0.5 m/s, facing along it, body x forward."""
    time = np.arange(round(seconds * rate_hz) + 1) / rate_hz
    turned = 0.25 * time
    zero = np.zeros_like(time)
    position = np.stack([2.0 * np.sin(turned), 2.0 - 2.0 * np.cos(turned), zero + 0.4], axis=1)
    orientation = np.stack([zero, zero, np.sin(turned / 2.0), np.cos(turned / 2.0)], axis=1)
    velocity = 0.5 * np.stack([np.cos(turned), np.sin(turned), zero], axis=1)
    stamp = START + np.round(time * 1e9).astype(np.int64)
    return Odometry(stamp, stamp, position, orientation, velocity, np.zeros_like(position))


def record(odometry: Odometry) -> BaseHistory:
    return base_history(odometry, TimeSource.HEADER)


def track(odometry: Odometry, height_m: float = 0.3) -> BaseTrack:
    base = record(odometry)
    height = np.full(len(base.time), height_m)
    return BaseTrack(base, find_travel(base), height, (), timespans.no_spans())


def motion(odometry: Odometry, forward_axis: str = "+x") -> Base:
    result = base_motion(track(odometry), forward_axis)
    assert result is not None
    return result


def test_a_circle_has_its_length_speed_and_turn() -> None:
    result = motion(circle())
    assert result.duration_s == pytest.approx(4.0)
    assert result.path_length_m == pytest.approx(2.0, rel=1e-5)
    assert result.net_displacement_m == pytest.approx(4.0 * np.sin(0.5))
    assert result.forward_speed_mps == pytest.approx(0.5, rel=1e-5)
    assert result.lateral_speed_mps == pytest.approx(0.0, abs=1e-9)
    assert result.yaw_change_rad == pytest.approx(1.0)
    assert result.height_m is not None
    assert result.height_m.mean == pytest.approx(0.3)
    assert result.froude == pytest.approx(0.25 / (9.81 * 0.3), rel=1e-4)
    assert result.yaw_rate_radps == pytest.approx(0.25)
    assert result.climb_m == pytest.approx(0.0)


def test_a_part_of_the_log_has_its_own_figures() -> None:
    odometry = circle()
    odometry.position[:, 2] += 0.1 * (odometry.stamp - START) / 1e9
    part = base_motion(track(odometry), "+x", np.array([[START + 10**9, START + 2 * 10**9]]))
    assert part is not None
    assert part.duration_s == pytest.approx(1.0, abs=0.011)
    assert part.path_length_m == pytest.approx(0.5, abs=0.006)
    assert part.climb_m == pytest.approx(0.1, abs=0.0011)


def tilted(roll: float, pitch: float, yaw: float) -> Odometry:
    odometry = circle()
    halves = [(np.cos(angle / 2.0), np.sin(angle / 2.0)) for angle in (roll, pitch, yaw)]
    about_x = np.array([halves[0][1], 0.0, 0.0, halves[0][0]])
    about_y = np.array([0.0, halves[1][1], 0.0, halves[1][0]])
    about_z = np.array([0.0, 0.0, halves[2][1], halves[2][0]])
    odometry.orientation[:] = product(about_z, product(about_y, about_x))
    return odometry


def product(one: Floats, other: Floats) -> Floats:
    x, y, z, w = one
    a, b, c, d = other
    return np.array(
        [
            w * a + x * d + y * c - z * b,
            w * b - x * c + y * d + z * a,
            w * c + x * b - y * a + z * d,
            w * d - x * a - y * b - z * c,
        ]
    )


@pytest.mark.parametrize(
    ("axis", "roll", "pitch"),
    [("+x", 0.2, 0.0), ("-x", -0.2, 0.0), ("+y", 0.0, -0.2), ("-y", 0.0, 0.2)],
)
def test_roll_and_pitch_are_about_the_robots_own_axes(axis: str, roll: float, pitch: float) -> None:
    """A body that is turned about its x axis by 0.2 rad: its +y side is higher."""
    result = motion(tilted(0.2, 0.0, 1.0), axis)
    assert result.roll_rad is not None
    assert result.pitch_rad is not None
    assert result.roll_rad.mean == pytest.approx(roll, abs=1e-9)
    assert result.pitch_rad.mean == pytest.approx(pitch, abs=1e-9)


def test_the_froude_number_is_of_the_forward_speed() -> None:
    assert motion(circle(), "+y").froude == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("axis", "forward", "left"),
    [("+x", 0.5, 0.0), ("-x", -0.5, 0.0), ("+y", 0.0, -0.5), ("-y", 0.0, 0.5)],
)
def test_forward_is_where_the_robots_file_says(axis: str, forward: float, left: float) -> None:
    result = motion(circle(), axis)
    assert result.forward_speed_mps == pytest.approx(forward, abs=1e-5)
    assert result.lateral_speed_mps == pytest.approx(left, abs=1e-5)


def test_yaw_is_unwrapped() -> None:
    assert motion(circle(seconds=60.0)).yaw_change_rad == pytest.approx(15.0)


def test_speed_comes_from_poses_whatever_the_twist_says() -> None:
    odometry = circle()
    odometry.linear_velocity[:] = 99.0
    assert motion(odometry).forward_speed_mps == pytest.approx(0.5, rel=1e-5)


def test_a_gap_counts_neither_as_path_nor_as_time() -> None:
    odometry = circle()
    kept = np.ones(len(odometry.stamp), np.bool_)
    kept[301:500] = False
    result = motion(odometry.pick(kept))
    assert result.duration_s == pytest.approx(3.0)


def test_poses_that_cannot_be_used_are_counted() -> None:
    odometry = circle()
    odometry.orientation[7] = 0.0
    odometry.position[9, 2] = np.inf
    result = record(odometry)
    assert result.not_usable == 2


def test_stride_length_is_the_bases_way_and_unknown_in_a_gap() -> None:
    odometry = circle()
    kept = np.ones(len(odometry.stamp), np.bool_)
    kept[301:500] = False
    base = record(odometry.pick(kept))
    begin = START + np.array([0.503, 1.9], np.float64) * 1e9
    end = START + np.array([1.003, 3.0], np.float64) * 1e9
    lengths = stride_lengths(base, begin.astype(np.int64), end.astype(np.int64))
    assert lengths[0] == pytest.approx(4.0 * np.sin(0.0625), rel=1e-4)
    # Poses are known at 3.0 s, but not between 1.5 s and 2.5 s.
    assert np.isnan(lengths[1])


def test_the_froude_number_needs_a_height() -> None:
    assert froude_number(0.5, 0.0) is None
    assert froude_number(None, 1.0) is None
    assert froude_number(1.0, 1.0) == pytest.approx(1.0 / 9.81)


def test_one_pose_is_no_motion() -> None:
    assert base_motion(track(circle().pick(np.array([0]))), "+x") is None


def test_poses_are_kept_at_a_hundred_hertz() -> None:
    assert len(record(circle(rate_hz=1000.0)).time) == 401


def test_time_far_from_any_pose_is_told() -> None:
    base = record(circle())
    spans = START + np.array([[-500_000_000, 0], [1_000_000_000, 2_000_000_000]], np.int64)
    assert base.unplaced(spans) == 400_000_000
