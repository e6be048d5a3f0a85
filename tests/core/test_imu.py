"""Accelerometer, forces and poses of walks in closed form, and which of them is odd."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.checks.engine import findings_of
from dogbot_logtool.core.compared import ForceComparison, ImuComparison
from dogbot_logtool.core.recording import VectorSamples, VectorTopic
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from tests.analysed import analysed
from tests.truth.core_columns import foot_samples, odometry, stats_settings
from tests.truth.gaits import PACE, TROT, WALK
from tests.truth.recording import Floats, FootRecording, Recording, about_axis, product, turned
from tests.truth.sensed import G, pushed, with_imu
from tests.truth.walking import Walk

QUESTION = "nothing contradicts the accelerometer"


def walk(**changes: object) -> Recording:
    return Walk(gait=WALK, seconds=12.0, **changes).recorded(200.0, 100.0)  # type: ignore[arg-type]


def measured(recording: Recording, **changes: object) -> MeasuredWalk:
    settings = stats_settings(recording, imu_topic="/imu/data", **changes)
    samples = [foot_samples(recording, foot) for foot in range(len(recording.feet))]
    sensed = None
    for imu in recording.beside:
        sensed = VectorTopic(
            VectorSamples(imu.log_time, imu.stamp, imu.vector, imu.vector), (imu.frame,)
        )
    return analysed(settings, samples, odometry(recording), sensed)


def compared(stats: MeasuredWalk) -> ImuComparison:
    assert stats.imu is not None
    return stats.imu


def forces_of(stats: MeasuredWalk) -> ForceComparison:
    forces = compared(stats).forces
    assert forces is not None
    return forces


def codes(stats: MeasuredWalk) -> set[str]:
    found = findings_of(stats)
    return {each.code for each in found if QUESTION in each.fails or each.code == "IMU_READS"}


def scaled(factor: float) -> Callable[[int, FootRecording], FootRecording]:
    return lambda _, foot: replace(foot, force=foot.force * factor)


def dead(_: int, foot: FootRecording) -> FootRecording:
    nothing = np.zeros_like(foot.force)
    return replace(foot, force=nothing, touching=np.zeros_like(foot.touching))


def in_frame(rotation: Floats) -> Callable[[int, FootRecording], FootRecording]:
    return lambda _, foot: replace(
        foot, force=turned(np.tile(rotation, (len(foot.time), 1)), foot.force)
    )


def reading(vectors: Callable[[Floats], Floats]) -> Recording:
    recording = with_imu(walk())
    (imu,) = recording.beside
    return replace(recording, beside=(replace(imu, vector=vectors(imu.vector)),))


def wandering(vector: Floats) -> Floats:
    noise = np.random.default_rng(2).normal(0.0, 9.0, (12, 3))
    time = np.linspace(0.0, 12.0, len(vector))
    wanders = np.stack([np.interp(time, np.arange(12), column) for column in noise.T], axis=1)
    return np.asarray(wanders + np.array([0.0, 0.0, G]))


TILT = np.deg2rad(20.0)
ABOUT_UP = about_axis(2, np.array([np.pi / 2.0]))[0]
UPSIDE_DOWN = product(about_axis(0, np.array([np.pi])), about_axis(2, np.array([0.8])))[0]
CLEAN: dict[str, Callable[[], Recording]] = {
    "walk": walk,
    "trot": lambda: Walk(gait=TROT, seconds=12.0).recorded(200.0, 100.0),
    "pace": lambda: Walk(gait=PACE, seconds=12.0).recorded(200.0, 100.0),
    "uphill": lambda: walk(slope_rad=0.1),
    "turned": lambda: walk(heading_rad=0.7, body_yaw_rad=0.4),
    "accelerating": lambda: pushed(walk(), (0.6, 0.3, 0.0), 5.0),
    "up and down": lambda: pushed(walk(), (0.0, 0.0, 0.8), 5.0),
}
ODD: dict[str, tuple[Callable[[], Recording], str]] = {
    "dead foot": (
        lambda: with_imu(walk()).each_foot(dead, "back_right"),
        "IMPULSE_IS_NOT_WEIGHT",
    ),
    # Both feet of a diagonal press at once: which of them is wrong cannot be told.
    "foot of a trot": (
        lambda: with_imu(CLEAN["trot"]()).each_foot(scaled(0.5), "front_left"),
        "IMPULSE_IS_NOT_WEIGHT",
    ),
    "in g": (lambda: with_imu(walk(), unit_mps2=G), "IMU_READS"),
    "without gravity": (lambda: with_imu(walk(), without_mps2=G), "IMU_READS"),
    "zeros": (lambda: reading(np.zeros_like), "IMU_READS"),
    "unclear": (lambda: reading(wandering), "IMU_READS"),
    "upside down": (lambda: with_imu(walk(), mounting=UPSIDE_DOWN), "IMU_TURNED"),
    "turned about the vertical": (
        lambda: with_imu(CLEAN["accelerating"](), mounting=ABOUT_UP),
        "IMU_TURNED",
    ),
    # Gravity alone cannot tell.
    "the same at constant speed": (lambda: with_imu(walk(), mounting=ABOUT_UP), ""),
    "forces that lean": (
        lambda: with_imu(walk()).each_foot(in_frame(about_axis(0, np.array([0.5]))[0])),
        "DIRECTION_UNKNOWN",
    ),
}


@pytest.mark.parametrize("name", CLEAN)
def test_nothing_is_invented_in_sound_recordings(name: str) -> None:
    stats = measured(with_imu(CLEAN[name](), noise_mps2=0.2))
    assert codes(stats) == set()
    assert compared(stats).reading == "m/s^2"
    assert compared(stats).metrics.accelerometer_mps2 == pytest.approx(G, rel=0.01)
    assert forces_of(stats).ratio == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("name", ODD)
def test_what_is_odd_is_named(name: str) -> None:
    recording, code = ODD[name]
    assert codes(measured(recording())) == ({code} if code else set())


def test_a_wrong_mass_is_named() -> None:
    recording = with_imu(walk())
    stats = measured(recording, mass_kg=1.2 * recording.robot.mass_kg)
    assert codes(stats) == {"IMPULSE_IS_NOT_WEIGHT"}
    assert forces_of(stats).ratio == pytest.approx(1.0 / 1.2, rel=0.01)
    (text,) = (f.text for f in findings_of(stats) if QUESTION in f.fails)
    assert "24 kg, should be 20" in text


@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_a_foot_with_another_scale_is_named(factor: float) -> None:
    stats = measured(with_imu(walk()).each_foot(scaled(factor), "front_right"))
    assert codes(stats) == {"IMPULSE_IS_NOT_WEIGHT"}
    (text,) = (f.text for f in findings_of(stats) if QUESTION in f.fails)
    assert "the load on front_right, whose sensor reads" in text
    assert forces_of(stats).odd_foot == pytest.approx((1, 1.0 / factor), rel=0.02)


@pytest.mark.parametrize("factor", [0.8, 2.0])
def test_another_scale_is_named(factor: float) -> None:
    stats = measured(with_imu(walk(), unit_mps2=1.0 / factor))
    assert codes(stats) == {"IMU_READS"}
    assert compared(stats).scale == pytest.approx(factor, rel=0.01)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_turned_mounting_is_named_with_its_tilt(axis: int) -> None:
    seat = about_axis(axis, np.array([-TILT]))[0]
    stats = measured(with_imu(walk(), mounting=seat))
    assert codes(stats) == {"IMU_TURNED"}
    assert compared(stats).metrics.tilt_rad == pytest.approx(TILT, abs=0.005)
    assert forces_of(stats).ratio == pytest.approx(1.0, abs=0.01)


def test_a_mounting_that_was_recorded_is_used() -> None:
    recording = with_imu(walk(), mounting=UPSIDE_DOWN, frame="imu_link")
    assert codes(measured(recording, imu_mounting=tuple(UPSIDE_DOWN.tolist()))) == set()


def test_without_a_mass_or_an_accelerometer_less_is_compared() -> None:
    assert compared(measured(with_imu(walk()), mass_kg=None)).forces is None
    assert measured(walk()).imu is None
