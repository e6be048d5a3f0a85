import numpy as np
import pytest

from dogbot_logtool.core import timespans
from dogbot_logtool.core.base.motion import BaseTrack, base_motion, base_track, stride_lengths
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
    return base_track(base, height, (), timespans.no_spans())


def motion(odometry: Odometry, forward_rad: float = 0.0) -> Base:
    result = base_motion(track(odometry), forward_rad)
    assert result is not None
    return result


def with_gap() -> Odometry:
    """No poses from 1.5 to 2.5 s."""
    odometry = circle()
    kept = np.ones(len(odometry.stamp), np.bool_)
    kept[301:500] = False
    return odometry.pick(kept)


def test_a_part_of_the_log_has_its_own_figures() -> None:
    odometry = circle()
    odometry.position[:, 2] += 0.1 * (odometry.stamp - START) / 1e9
    part = base_motion(track(odometry), 0.0, np.array([[START + 10**9, START + 2 * 10**9]]))
    assert part is not None
    assert part.duration_s == pytest.approx(1.0, abs=0.011)
    assert part.path_length_m == pytest.approx(0.5, abs=0.006)
    assert part.climb_m == pytest.approx(0.1, abs=0.0011)


def test_a_gap_counts_neither_as_path_nor_as_time_nor_as_a_stride() -> None:
    assert motion(with_gap()).duration_s == pytest.approx(3.0)
    begin = START + (np.array([0.503, 1.9]) * 1e9).astype(np.int64)
    end = START + (np.array([1.003, 3.0]) * 1e9).astype(np.int64)
    lengths = stride_lengths(record(with_gap()), begin, end)
    assert lengths[0] == pytest.approx(4.0 * np.sin(0.0625), rel=1e-4)
    # Poses are known at 3.0 s, but not between 1.5 s and 2.5 s.
    assert np.isnan(lengths[1])


def test_poses_that_cannot_be_used_are_counted_and_others_thinned() -> None:
    odometry = circle(rate_hz=1000.0)
    odometry.orientation[7] = 0.0
    odometry.position[9, 2] = np.inf
    result = record(odometry)
    assert result.not_usable == 2
    assert len(result.time) == 401
    assert base_motion(track(circle().pick(np.array([0]))), 0.0) is None


def test_time_far_from_any_pose_is_told() -> None:
    spans = START + np.array([[-500_000_000, 0], [1_000_000_000, 2_000_000_000]], np.int64)
    assert record(circle()).unplaced(spans) == 400_000_000
