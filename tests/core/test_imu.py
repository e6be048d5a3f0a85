"""Accelerometer, forces and poses of walks in closed form, and which of them is odd."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.imu import ForceComparison, ImuComparison, Reading
from dogbot_logtool.core.recording import VectorTopic
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.core.vectors import VectorSamples
from tests.analysed import analysed
from tests.truth.core_columns import foot_samples, odometry, stats_settings
from tests.truth.gaits import PACE, TROT, WALK
from tests.truth.recording import Floats, FootRecording, Recording, about_axis, product, turned
from tests.truth.sensed import G, pushed, with_imu
from tests.truth.walking import Walk

QUESTION = "nothing contradicts the accelerometer"


def walk(**changes: object) -> Recording:
    return Walk(gait=WALK, seconds=12.0, **changes).recorded(200.0, 100.0)  # type: ignore[arg-type]


def measured(recording: Recording, **changes: object) -> Stats:
    settings = stats_settings(recording, imu_topic="/imu/data", **changes)
    samples = [foot_samples(recording, foot) for foot in range(len(recording.feet))]
    sensed = None
    for imu in recording.beside:
        sensed = VectorTopic(
            VectorSamples(imu.log_time, imu.stamp, imu.vector, imu.vector), (imu.frame,)
        )
    return analysed(settings, samples, odometry(recording), sensed)


def compared(stats: Stats) -> ImuComparison:
    assert stats.imu is not None
    return stats.imu


def forces_of(stats: Stats) -> ForceComparison:
    forces = compared(stats).forces
    assert forces is not None
    return forces


def codes(stats: Stats) -> set[str]:
    found = findings_of(stats)
    return {each.code for each in found if QUESTION in each.fails or each.code == "IMU_READS"}


def scaled(factor: float) -> Callable[[int, FootRecording], FootRecording]:
    return lambda _, foot: replace(foot, force=foot.force * factor)


def dead(_: int, foot: FootRecording) -> FootRecording:
    nothing = np.zeros_like(foot.force)
    return replace(foot, force=nothing, touching=np.zeros_like(foot.touching))


TILT = np.deg2rad(20.0)
CLEAN: dict[str, Callable[[], Recording]] = {
    "walk": walk,
    "trot": lambda: Walk(gait=TROT, seconds=12.0).recorded(200.0, 100.0),
    "pace": lambda: Walk(gait=PACE, seconds=12.0).recorded(200.0, 100.0),
    "uphill": lambda: walk(slope_rad=0.1),
    "turned": lambda: walk(heading_rad=0.7, body_yaw_rad=0.4),
    "shares": lambda: walk(shares=(0.3, 0.3, 0.2, 0.2)),
    "accelerating": lambda: pushed(walk(), (0.6, 0.3, 0.0), 5.0),
    "up and down": lambda: pushed(walk(), (0.0, 0.0, 0.8), 5.0),
}


@pytest.mark.parametrize("name", CLEAN)
def test_nothing_is_invented_in_sound_recordings(name: str) -> None:
    stats = measured(with_imu(CLEAN[name](), noise_mps2=0.2))
    assert codes(stats) == set()
    found, forces = compared(stats), forces_of(stats)
    assert found.mounting.reading is Reading.SOUND
    assert found.mounting.mean_mps2 == pytest.approx(G, rel=0.01)
    assert forces.ratio == pytest.approx(1.0, abs=0.01)


def test_the_acceleration_of_the_base_is_in_it() -> None:
    """Half of a swing up: 0.8 sin, whose mean over 2.5 s is 0.8 * 2 / pi."""
    recording = pushed(walk(), (0.0, 0.0, 0.8), 40.0)
    found = compared(measured(with_imu(recording)))
    # From 0.45 to 11.55 s, windows of a stride about each instant.
    mean = 0.8 * (np.cos(2 * np.pi * 0.45 / 40.0) - np.cos(2 * np.pi * 11.55 / 40.0))
    mean *= 40.0 / (2 * np.pi) / 11.1
    assert found.mounting.mean_mps2 == pytest.approx(G + mean, abs=0.02)


def test_a_wrong_mass_is_named() -> None:
    recording = with_imu(walk())
    stats = measured(recording, mass_kg=1.2 * recording.robot.mass_kg)
    assert codes(stats) == {"IMPULSE_IS_NOT_WEIGHT"}
    assert forces_of(stats).ratio == pytest.approx(1.0 / 1.2, rel=0.01)
    (text,) = (f.text for f in findings_of(stats) if QUESTION in f.fails)
    assert "24 kg, should be 20" in text


@pytest.mark.parametrize("foot", ["front_left", "back_right"])
def test_a_dead_foot_is_named(foot: str) -> None:
    stats = measured(with_imu(walk()).each_foot(dead, foot))
    assert codes(stats) == {"IMPULSE_IS_NOT_WEIGHT"}
    (text,) = (f.text for f in findings_of(stats) if QUESTION in f.fails)
    assert f"{foot} never touches" in text


@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_a_foot_with_another_scale_is_named(factor: float) -> None:
    stats = measured(with_imu(walk()).each_foot(scaled(factor), "front_right"))
    assert codes(stats) == {"FOOT_SCALE"}
    odd = forces_of(stats).odd_foot
    assert odd is not None
    assert odd == pytest.approx((1, 1.0 / factor), rel=0.02)


def test_in_a_trot_no_foot_of_a_pair_is_accused() -> None:
    """Both feet of a diagonal press at once: which of them is wrong cannot be told."""
    trot = with_imu(Walk(gait=TROT, seconds=12.0).recorded(200.0, 100.0))
    stats = measured(trot.each_foot(scaled(0.5), "front_left"))
    assert codes(stats) == {"IMPULSE_IS_NOT_WEIGHT"}


def test_an_accelerometer_in_g_is_named() -> None:
    stats = measured(with_imu(walk(), unit_mps2=G))
    assert codes(stats) == {"IMU_READS"}
    assert forces_of(stats).ratio == pytest.approx(1.0, abs=0.01)


def test_gravity_that_was_taken_out_is_named() -> None:
    stats = measured(with_imu(walk(), without_mps2=G))
    assert codes(stats) == {"IMU_READS"}
    assert forces_of(stats).ratio == pytest.approx(1.0, abs=0.01)
    assert compared(stats).mounting.tilt_rad is None


@pytest.mark.parametrize("factor", [0.8, 1.1, 2.0])
def test_another_scale_is_named(factor: float) -> None:
    stats = measured(with_imu(walk(), unit_mps2=1.0 / factor))
    assert codes(stats) == {"IMU_READS"}
    assert compared(stats).mounting.scale == pytest.approx(factor, rel=0.01)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("angle", [TILT, -TILT])
def test_a_turned_mounting_is_named_with_its_tilt(axis: int, angle: float) -> None:
    seat = about_axis(axis, np.array([angle]))[0]
    stats = measured(with_imu(walk(), mounting=seat))
    assert codes(stats) == {"IMU_TURNED"}
    mounting = compared(stats).mounting
    assert mounting.tilt_rad == pytest.approx(TILT, abs=0.005)
    expected = [0.0, 0.0]
    expected[axis] = angle
    assert mounting.roll_pitch_rad == pytest.approx(expected, abs=0.005)
    assert forces_of(stats).ratio == pytest.approx(1.0, abs=0.01)


def test_a_mounting_that_was_recorded_is_used() -> None:
    seat = product(about_axis(0, np.array([np.pi])), about_axis(2, np.array([0.8])))[0]
    recording = with_imu(walk(), mounting=seat, frame="imu_link")
    assert codes(measured(recording, imu_mounting=tuple(seat.tolist()))) == set()
    upside_down = measured(recording)
    assert codes(upside_down) == {"IMU_TURNED"}
    assert compared(upside_down).mounting.tilt_rad == pytest.approx(np.pi, abs=0.01)


def test_a_mounting_that_is_turned_about_the_vertical_shows_in_accelerations() -> None:
    moving = CLEAN["accelerating"]()
    seat = about_axis(2, np.array([np.pi / 2.0]))[0]
    stats = measured(with_imu(moving, mounting=seat))
    assert codes(stats) == {"IMU_TURNED"}
    assert compared(stats).turned_rad == pytest.approx(-np.pi / 2.0, abs=0.05)
    # Gravity alone cannot tell.
    assert codes(measured(with_imu(walk(), mounting=seat))) == set()


def in_frame(rotation: Floats) -> Callable[[int, FootRecording], FootRecording]:
    return lambda _, foot: replace(
        foot, force=turned(np.tile(rotation, (len(foot.time), 1)), foot.force)
    )


def test_forces_in_a_frame_that_is_turned_about_the_vertical_are_named() -> None:
    recording = with_imu(CLEAN["accelerating"]())
    yawed = recording.each_foot(in_frame(about_axis(2, np.array([np.pi / 2.0]))[0]))
    assert codes(measured(yawed)) == {"DIRECTION_UNKNOWN"}


def test_forces_in_a_frame_that_leans_are_named() -> None:
    leaning = with_imu(walk()).each_foot(in_frame(about_axis(0, np.array([0.5]))[0]))
    assert codes(measured(leaning)) == {"DIRECTION_UNKNOWN"}


def test_zeros_are_no_accelerations() -> None:
    recording = with_imu(walk())
    imu = replace(recording.beside[0], vector=np.zeros_like(recording.beside[0].vector))
    assert codes(measured(replace(recording, beside=(imu,)))) == {"IMU_READS"}


def test_what_does_not_follow_gravity_decides_nothing() -> None:
    recording = with_imu(walk())
    noise = np.random.default_rng(2).normal(0.0, 9.0, (12, 3))
    time = recording.base.time
    vector = np.stack([np.interp(time, np.arange(12), column) for column in noise.T], axis=1)
    imu = replace(recording.beside[0], vector=vector + np.array([0.0, 0.0, G]))
    stats = measured(replace(recording, beside=(imu,)))
    assert codes(stats) == {"IMU_READS"}
    assert compared(stats).forces is None


def test_without_a_mass_only_poses_are_compared() -> None:
    stats = measured(with_imu(walk()), mass_kg=None)
    assert codes(stats) == set()
    assert compared(stats).forces is None


def test_a_log_without_an_accelerometer_has_none() -> None:
    assert measured(walk()).imu is None
