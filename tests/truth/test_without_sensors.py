"""Gait, base and forces of robots without foot sensors and odometry, against a physics engine."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import dogbot_logtool as dl
from tests.truth.free_walker import HEAVY_KG, biped, quadruped
from tests.truth.geometry import Floats, product, turned
from tests.truth.parts import urdf
from tests.truth.physics import BARE, Imu, Physics, resized, write_log

Change = Callable[[Floats, Floats, Floats], tuple[Floats, ...]]
ROBOTS: Final[Mapping[str, Callable[[], Physics]]] = {
    "trot": quadruped,
    "turn": lambda: quadruped(command=(0.3, 0.0, 0.5)),
    "walk": lambda: quadruped(gait="walk", command=(0.2, 0.0, 0.0)),
    "slope": lambda: quadruped(slope_rad=np.radians(10.0)),
    "heavy legs": lambda: quadruped(legs_kg=HEAVY_KG),
    "pushes": lambda: quadruped(push_n=60.0),
    "biped": biped,
}
PERIOD_S: Final = {"biped": 0.8}
CLASS: Final = {"walk": "walk", "biped": "walk"}


def no_efforts(position: Floats, velocity: Floats, effort: Floats) -> tuple[Floats, ...]:
    return position, velocity, np.full_like(effort, np.nan)


SOURCES: Final[Mapping[str, Change]] = {
    "joint_torques": lambda *states: states,
    "kinematics": no_efforts,
}


@cache
def robot(name: str) -> Physics:
    return ROBOTS[name]()


def measured(path: Path, walk: Physics, **options: Any) -> dl.Walk:
    return dl.measure(write_log(path / "log.mcap", walk, **{**BARE, **options}))


def codes(walk: dl.Walk) -> dict[str, str]:
    return {each["code"]: each["text"] for each in walk.stats["findings"]}


def force_error_bw(walk: dl.Walk, truth: Physics) -> float:
    """The rms of the vertical forces of all feet against the engine's, in body weights."""
    errors = []
    for number, name in enumerate(walk.stats["feet"]):
        told = walk.samples(name)
        real = np.interp(told["time_s"], truth.time, truth.force[:, number, 2])
        errors.append((told["force_z_n"] - real) / (truth.mass_kg * 9.81))
    return float(np.sqrt(np.mean(np.square(errors))))


@pytest.mark.slow
@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("name", ROBOTS)
def test_gait_and_base_are_those_of_the_engine(name: str, source: str, tmp_path: Path) -> None:
    truth = robot(name)
    walk = measured(tmp_path, truth.telling(SOURCES[source]))
    stats = walk.stats
    assert stats["settings"]["contact_from"] == source
    assert stats["settings"]["base_from"] == "legs"
    assert stats["gait"]["name"] == CLASS.get(name, "trot")
    assert stats["gait"]["stride_frequency_hz"] == pytest.approx(
        1.0 / PERIOD_S.get(name, 0.5), rel=0.02
    )
    down = [foot["contact_fraction"] for foot in stats["feet"].values()]
    assert down == pytest.approx(truth.touching.tolist(), abs=0.1)
    assert stats["base"]["forward_speed_mps"] == pytest.approx(truth.speed_mps, rel=0.05)
    turned = truth.base_velocity[:, 2].mean()
    assert stats["base"]["yaw_rate_radps"] == pytest.approx(turned, abs=0.01)
    if source == "joint_torques":
        assert stats["forces"]["vertical_impulse_over_weight"] == pytest.approx(1.0, abs=0.1)
        assert force_error_bw(walk, truth) < 0.15
    assert "warning" not in {each["severity"] for each in stats["findings"]}


def test_a_stand_is_a_stand(tmp_path: Path) -> None:
    walk = measured(tmp_path, quadruped(gait="stand", command=(0.0, 0.0, 0.0)))
    assert walk.gait.name == "stand"
    assert walk.stats["base"]["path_length_m"] == 0.0


def test_trot_by_torques(tmp_path: Path) -> None:
    walk = measured(tmp_path, robot("trot"))
    assert walk.gait.name == "trot"
    assert walk.stats["feet"]["front_left"]["peak_force_n"] is None
    assert walk.stats["base"]["climb_m"] is None
    assert {"CONTACT_ESTIMATED", "BASE_FROM_LEGS"} <= codes(walk).keys()


@pytest.mark.parametrize("heading_rad", [0.0, 2.0])
def test_poses_place_the_feet_that_joints_tell(heading_rad: float, tmp_path: Path) -> None:
    truth = robot("trot")
    half = [0.0, 0.0, np.sin(heading_rad / 2.0), np.cos(heading_rad / 2.0)]
    north = replace(
        truth,
        base=turned(np.array([half]), truth.base),
        attitude=product(np.array([half]), truth.attitude),
    )
    log = write_log(tmp_path / "log.mcap", north, every=5, with_feet=False)
    stats = dl.measure(log).stats
    assert stats["settings"]["contact_from"] == "joint_torques"
    assert stats["settings"]["base_from"] == "pose"
    assert stats["gait"]["name"] == "trot"
    assert stats["base"]["forward_speed_mps"] == pytest.approx(truth.speed_mps, rel=0.01)
    assert stats["forces"]["vertical_impulse_over_weight"] == pytest.approx(1.0, abs=0.1)
    braking = -truth.force[:, :, 0].clip(max=0.0).mean(axis=0) * 0.5
    for foot, true in zip(stats["feet"].values(), braking, strict=True):
        assert foot["stride_length_m"]["median"] == pytest.approx(truth.speed_mps / 2.0, rel=0.02)
        assert foot["braking_impulse_ns"]["mean"] == pytest.approx(true, abs=0.8)


def test_sensors_without_poses_keep_their_gait_where_joints_tell_nothing(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.mcap", robot("trot"), every=20, with_poses=False)
    stats = dl.measure(log).stats
    assert (stats["settings"]["contact_from"], stats["gait"]["name"]) == ("sensor", "trot")
    assert stats["base"]["forward_speed_mps"] is None


FAULTS: Final[Mapping[str, tuple[Change, str]]] = {
    "empty": (no_efforts, "efforts are empty or zero"),
    "zero": (lambda p, v, e: (p, v, 0.0 * e), "efforts are empty or zero"),
    "turned": (lambda p, v, e: (p, v, -e), "wrong sign"),
    "amperes": (lambda p, v, e: (p, v, e / 0.4), "no torques in N m"),
    "one leg turned": (
        lambda p, v, e: (p, v, np.where(np.arange(12) < 3, -e, e)),
        "no torques in N m",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_efforts_that_are_no_torques_give_no_forces(name: str, tmp_path: Path) -> None:
    change, why = FAULTS[name]
    walk = measured(tmp_path, robot("trot").telling(change))
    assert walk.stats["settings"]["contact_from"] == "kinematics"
    assert walk.gait.name == "trot"
    assert why in codes(walk)["CONTACT_ESTIMATED"]
    assert walk.stats["forces"]["vertical_impulse_over_weight"] is None
    if name not in {"empty", "zero"}:
        assert walk.stats["legs"]["positive_work_j"] is None


def stuck(position: Floats, velocity: Floats, effort: Floats) -> tuple[Floats, ...]:
    leg = np.arange(12) >= 9
    return np.where(leg, position[:1], position), np.where(leg, 0.0, velocity), effort


def noisy(position: Floats, velocity: Floats, effort: Floats) -> tuple[Floats, ...]:
    noise = np.random.default_rng(1).normal(0.0, 0.02, position.shape)
    return position + noise, velocity, effort


@pytest.mark.parametrize(
    ("change", "every", "why"),
    [
        (SOURCES["joint_torques"], 20, "joint states come 12 times in a stride, too rarely"),
        (SOURCES["joint_torques"], 200, "too few joint states tell the positions of all joints"),
        (stuck, 5, "RR_thigh_joint tells one position while other legs move"),
        (noisy, 1, "positions of joints are not exact enough"),
    ],
    ids=["rare", "too few", "stuck", "noisy"],
)
def test_joints_that_do_not_tell_surely_tell_nothing(
    change: Change, every: int, why: str, tmp_path: Path
) -> None:
    walk = measured(tmp_path, robot("trot").telling(change), every=every)
    assert why in codes(walk)["NO_FEET"]
    assert walk.stats["base"]["forward_speed_mps"] is None


def test_descriptions_that_do_not_fit_the_log_tell_nothing(tmp_path: Path) -> None:
    truth = robot("trot")
    for other, why in (
        (replace(truth, joints=("knee", *truth.joints[1:])), "do not tell of FL_hip_joint"),
        (replace(truth, parts=truth.parts[:5]), "the robot description has no two legs"),
    ):
        assert why in codes(measured(tmp_path, other))["NO_FEET"]


def test_efforts_of_a_robot_of_unknown_mass_tell_no_forces(tmp_path: Path) -> None:
    truth = robot("trot")
    light = replace(truth, parts=tuple(replace(part, kg=0.0) for part in truth.parts))
    walk = measured(tmp_path, light)
    assert "the mass is not known" in codes(walk)["CONTACT_ESTIMATED"]
    assert (walk.stats["settings"]["contact_from"], walk.gait.name) == ("kinematics", "trot")


@pytest.mark.parametrize(
    ("gyro", "command", "why"),
    [
        (57.3, (0.4, 0.0, 0.0), "turns by a gyroscope are not the base's in rad/s"),
        (-1.0, (0.3, 0.0, 0.5), "turns by a gyroscope are not the base's in rad/s"),
        (0.0, (0.0, 0.0, 0.8), "by the standing feet, 0.78 rad/s, contradict each other"),
    ],
)
def test_turns_that_contradict_the_feet_leave_all_unknown(
    gyro: float, command: tuple[float, float, float], why: str, tmp_path: Path
) -> None:
    walk = measured(tmp_path, quadruped(command), imu=Imu(gyro=gyro))
    assert why in codes(walk)["NO_FEET"]
    assert (walk.gait.name, walk.stats["base"]["yaw_rate_radps"]) == (None, None)


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ((0.4, 0.0, 0.0), {"imu": None}),
        ((0.3, 0.0, 0.5), {"imu": None}),
        ((0.0, 0.0, 0.8), {"imu": Imu(late_s=1e6)}),
    ],
)
def test_joints_alone_tell_feet_and_base(
    command: tuple[float, float, float], options: dict[str, Any], tmp_path: Path
) -> None:
    truth = quadruped(command)
    walk = measured(tmp_path, truth, **options)
    base, turned = walk.stats["base"], truth.base_velocity[:, 2].mean()
    assert base["yaw_rate_radps"] == pytest.approx(turned, rel=0.05, abs=0.02)
    assert base["forward_speed_mps"] == pytest.approx(truth.speed_mps, rel=0.14, abs=0.02)
    assert walk.gait.name == "trot"
    assert "turns by the feet alone" in codes(walk)["BASE_FROM_LEGS"]


@pytest.mark.parametrize("size", [0.15, 4.0])
def test_small_and_large_robots_turn(size: float, tmp_path: Path) -> None:
    truth = resized(quadruped((0.3, 0.0, 0.5)), size)
    stats = measured(tmp_path, truth).stats
    turned = truth.base_velocity[:, 2].mean()
    assert stats["base"]["yaw_rate_radps"] == pytest.approx(turned, rel=0.05)
    assert stats["base"]["forward_speed_mps"] == pytest.approx(truth.speed_mps, rel=0.06)
    assert "warning" not in {each["severity"] for each in stats["findings"]}


def test_the_robot_walks_through_the_world_of_the_output(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.mcap", robot("trot"), **BARE)
    dl.convert(log, tmp_path / "out.mcap", encoding="ros2")
    with (tmp_path / "out.mcap").open("rb") as stream:
        messages = make_reader(stream, decoder_factories=[DecoderFactory()])
        told = [each[3] for each in messages.iter_decoded_messages(topics=["/tf"])]
    found = [each for message in told for each in message.transforms]
    base = [each for each in found if each.child_frame_id == "base_link"]
    assert {each.header.frame_id for each in base} == {"odom"}
    way = base[-1].transform.translation.x - base[0].transform.translation.x
    assert way == pytest.approx(6.0 * robot("trot").speed_mps, rel=0.05)
    assert {each.child_frame_id for each in found} >= {"FL_hip", "FL_thigh", "FL_calf", "FL_foot"}


def test_an_inertial_unit_is_turned_as_the_description_says(tmp_path: Path) -> None:
    truth = robot("turn")
    mount = (
        '<link name="imu"/><joint name="imu_joint" type="fixed"><parent link="base_link"/>'
        '<child link="imu"/><origin rpy="1.5707963 0 0"/></joint></robot>'
    )
    file = tmp_path / "robot.urdf"
    file.write_text(urdf(truth.parts).replace("</robot>", mount))
    mounted = {**BARE, "imu": Imu("imu")}
    walk = dl.measure(write_log(tmp_path / "log.mcap", truth, **mounted), urdf=file)
    rate = truth.base_velocity[:, 2].mean()
    assert walk.stats["base"]["yaw_rate_radps"] == pytest.approx(rate, abs=0.01)
    assert abs(walk.stats["base"]["roll_rad"]["median"]) < 0.02


def test_without_a_description_the_line_to_paste_is_printed(tmp_path: Path) -> None:
    walk = measured(tmp_path, replace(robot("trot"), parts=()))
    assert walk.gait.name is None
    assert "--urdf ROBOT.urdf" in codes(walk)["NO_FEET"]
    assert walk.stats["legs"]["joints"]["FL_calf_joint"]["peak_speed"] > 1.0
    file = tmp_path / "robot.urdf"
    file.write_text(urdf(robot("trot").parts))
    assert dl.measure(tmp_path / "log.mcap", urdf=file).gait.name == "trot"
