"""The sample logs are what their truth says."""

import re
from collections import Counter, defaultdict
from pathlib import Path

import generate
import numpy as np
import pytest
from mcap.reader import make_reader
from scenario import Scenario

from tests.paths import SAMPLE_LOGS
from tests.sample_logs.decoded_logs import (
    FEET,
    LOGS,
    ODOMETRY,
    TROT,
    TROUBLED,
    WALK,
    force_on_foot,
    has_stamp,
    newest_step,
    poses_in_world,
    read_log,
    read_raw,
    seconds,
    stamp_ns,
    stances,
    states_by_step,
    step_time_ns,
    vector,
    world_forces,
)

PAD_FOOT = "back_right"

MAX_FILE_BYTES = 1_500_000
LOWER_LEG_M = 0.3
FORCE_ON_N = 10.42  # 5 % of body weight
FORCE_TOLERANCE_N = 1e-3
LENGTH_TOLERANCE_M = 1e-6

ROS1_INFO = re.compile(
    r"Debug:  i:\(\d+/\d+\)     my geom:\S+   other geom:\S+ {9}time:\d+\.\d{9}\n"
)
ROS2_INFO = re.compile(
    r"Debug:  i: \(1/1\)     my_geom: \[\S+\]  other_geom: \[\S+\] {8}time: \[\d+\.\d+\]\n"
)


@pytest.mark.parametrize(
    "scenario",
    [
        generate.TROUBLED,
        pytest.param(generate.TROT, marks=pytest.mark.slow),
        pytest.param(generate.WALK, marks=pytest.mark.slow),
    ],
    ids=lambda scenario: scenario.name,
)
def test_regenerating_gives_the_committed_bytes(tmp_path: Path, scenario: Scenario) -> None:
    generate.write_sample(scenario, tmp_path)
    written = sorted(tmp_path.iterdir())
    assert [path.stem for path in written] == [scenario.name, f"{scenario.name}.truth"]
    for fresh in written:
        path = SAMPLE_LOGS / fresh.name
        if path.name in LOGS:
            assert read_raw(fresh) == read_raw(path), f"{path.name}: other messages"
        assert fresh.read_bytes() == path.read_bytes(), (
            f"{path.name}: the same messages in other bytes, so a codec's version differs"
        )


@pytest.mark.parametrize("name", LOGS)
def test_files_are_small(name: str) -> None:
    assert (SAMPLE_LOGS / name).stat().st_size < MAX_FILE_BYTES


@pytest.mark.parametrize("name", LOGS)
def test_counts_and_log_times_are_those_of_the_truth(name: str) -> None:
    log = read_log(name)
    assert {topic: len(messages) for topic, messages in log.topics.items()} == (
        log.truth["log"]["messages"]
    )
    log_times_ns = [time_ns for topic in log.topics for time_ns in log.log_times_ns(topic)]
    assert min(log_times_ns) == log.truth["log"]["first_log_time_ns"]
    assert max(log_times_ns) == log.truth["log"]["last_log_time_ns"]


@pytest.mark.parametrize("name", [TROT, WALK])
def test_log_times_follow_stamps_by_the_stated_delay(name: str) -> None:
    log = read_log(name)
    truth = log.truth["log"]
    for topic, delay_s in truth["log_delay_s"].items():
        for log_time_ns, message in log.topics[topic]:
            if not has_stamp(message):
                continue
            header = message.transforms[0].header if "tf" in topic else message.header
            lag_s = (log_time_ns - stamp_ns(header)) / 1e9
            assert delay_s - 1e-12 <= lag_s <= delay_s + truth["log_jitter_max_s"]


def test_messages_stand_in_the_mcap_in_the_order_of_their_log_times() -> None:
    with (SAMPLE_LOGS / WALK).open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        in_file = [m.log_time for _, _, m in reader.iter_messages(log_time_order=False)]
        summary = reader.get_summary()
    assert in_file == sorted(in_file)
    assert summary is not None
    assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}


@pytest.mark.parametrize("name", [TROT, WALK])
def test_forces_add_up_to_the_weight(name: str) -> None:
    log = read_log(name)
    weight_n = log.truth["robot"]["weight_n"]
    for _, forces_n in world_forces(log):
        total_n = np.sum(list(forces_n.values()), axis=0)
        np.testing.assert_allclose(total_n, [0, 0, weight_n], atol=FORCE_TOLERANCE_N)


@pytest.mark.parametrize("name", [TROT, WALK])
def test_forces_stay_within_friction_and_the_stated_extremes(name: str) -> None:
    log = read_log(name)
    friction = log.truth["robot"]["friction_coefficient"]
    peak_n: dict[str, float] = defaultdict(float)
    for _, forces_n in world_forces(log):
        for foot, force_n in forces_n.items():
            truth = log.truth["feet"][foot]
            used = float(np.hypot(*force_n[:2]) / force_n[2])
            assert used <= truth["peak_friction_use"] + 1e-6 < friction
            magnitude_n = float(np.linalg.norm(force_n))
            assert magnitude_n >= truth["least_force_n"] - FORCE_TOLERANCE_N > FORCE_ON_N
            peak_n[foot] = max(peak_n[foot], magnitude_n)
    for foot in FEET:
        assert peak_n[foot] == pytest.approx(log.truth["feet"][foot]["peak_force_n"], rel=0.01)


def test_adding_all_physics_steps_multiplies_the_weight() -> None:
    log = read_log(TROT)
    steps_per_message = log.truth["log"]["physics_steps_per_contact_message"]
    all_n = newest_n = 0.0
    for foot in FEET:
        for message in log.contacts(foot):
            assert len(newest_step(message)) <= 1
            all_n += sum(float(np.linalg.norm(force_on_foot(s))) for s in message.states)
            newest_n += sum(float(np.linalg.norm(force_on_foot(s))) for s in newest_step(message))
    assert all_n / newest_n == pytest.approx(steps_per_message, rel=0.01)


@pytest.mark.parametrize(("name", "lies_along"), [(TROT, False), (WALK, True)])
def test_only_world_forces_lie_along_the_contact_normals(name: str, *, lies_along: bool) -> None:
    log = read_log(name)
    alignment = [
        abs(vector(state.total_wrench.force) @ vector(state.contact_normals[0]))
        / np.linalg.norm(vector(state.total_wrench.force))
        for foot in FEET
        for message in log.contacts(foot)
        for state in newest_step(message)
    ]
    median = float(np.median(alignment))
    assert median > 0.99 if lies_along else median < 0.85


@pytest.mark.parametrize("name", [TROT, WALK])
def test_states_are_empty_in_swing_and_only_there(name: str) -> None:
    log = read_log(name)
    interval_s = log.truth["log"]["contact_interval_s"]
    step_s = log.truth["log"]["physics_step_s"]
    for foot in FEET:
        known = stances(log, foot)
        for message in log.contacts(foot):
            stamp_s = seconds(log, stamp_ns(message.header))
            steps_s = stamp_s + np.arange(step_s - interval_s, step_s / 2, step_s)
            down = [
                time_s
                for time_s in steps_s[steps_s > -step_s / 2]
                if any(touchdown_s <= time_s < liftoff_s for touchdown_s, liftoff_s in known)
            ]
            recorded_s = [seconds(log, step_time_ns(state)) for state in message.states]
            assert recorded_s == pytest.approx(down, abs=1e-9)


@pytest.mark.parametrize("name", [TROT, WALK])
def test_touchdowns_and_liftoffs_are_seen_within_a_message(name: str) -> None:
    log = read_log(name)
    interval_s = log.truth["log"]["contact_interval_s"]
    for foot in FEET:
        down = [bool(message.states) for message in log.contacts(foot)]
        times_s = [seconds(log, stamp_ns(message.header)) for message in log.contacts(foot)]
        changes = list(zip(times_s[1:], down[:-1], down[1:], strict=True))
        touchdowns_s = [time_s for time_s, before, after in changes if after and not before]
        liftoffs_s = [time_s for time_s, before, after in changes if before and not after]
        truth = log.truth["feet"][foot]
        late_s = np.subtract(touchdowns_s, truth["touchdown_s"])
        assert np.all((late_s > 0) & (late_s <= interval_s))
        # The message after a lift-off still holds the stance's last steps, if it has several.
        late_s = np.subtract(liftoffs_s, truth["liftoff_s"])
        assert np.all((late_s > 0) & (late_s <= 2 * interval_s))
        share = np.mean([bool(newest_step(message)) for message in log.contacts(foot)])
        assert share == pytest.approx(truth["contact_fraction"], abs=0.005)


@pytest.mark.parametrize("name", [TROT, WALK])
def test_contact_points_lie_on_the_ground_at_the_end_of_the_lower_leg(name: str) -> None:
    log = read_log(name)
    states = {foot: states_by_step(log, foot) for foot in FEET}
    sole = np.array([0.0, 0.0, -LOWER_LEG_M, 1.0])
    for time_ns, poses in poses_in_world(log):
        for foot in FEET:
            if time_ns not in states[foot]:
                continue
            points_m = np.array([vector(p) for p in states[foot][time_ns].contact_positions])
            assert np.all(points_m[:, 2] == 0)
            # The foot's frame is at the knee, a lower leg's length above the ground contact.
            for expected_m in (
                (poses[f"{foot}_foot"] @ sole)[:3],
                poses[f"{foot}_sole"][:3, 3],
            ):
                np.testing.assert_allclose(
                    points_m.mean(axis=0), expected_m, atol=LENGTH_TOLERANCE_M
                )


def test_the_force_weighted_point_of_the_pad_travels() -> None:
    log = read_log(TROT)
    states = states_by_step(log, PAD_FOOT)
    touchdown_s, liftoff_s = stances(log, PAD_FOOT)[1]
    means_m = []
    for fraction in (0.1, 0.9):
        wanted_s = touchdown_s + fraction * (liftoff_s - touchdown_s)
        state = states[min(states, key=lambda ns: abs(seconds(log, ns) - wanted_s))]
        assert len(state.wrenches) == 2
        weights_n = np.array([np.linalg.norm(vector(w.force)) for w in state.wrenches])
        points_m = np.array([vector(point) for point in state.contact_positions])
        means_m.append(weights_n @ points_m / weights_n.sum())
    travel_m = np.linalg.norm(means_m[1] - means_m[0])
    assert travel_m == pytest.approx(log.truth["feet"][PAD_FOOT]["contact_travel_m"], abs=5e-5)


@pytest.mark.parametrize(("name", "info"), [(TROT, ROS1_INFO), (WALK, ROS2_INFO)])
def test_pairs_are_named_as_gazebo_names_them(name: str, info: re.Pattern[str]) -> None:
    log = read_log(name)
    second_body_foot = log.truth["forces"]["foot_as_collision2"]
    for foot in FEET:
        names = [
            f"dogbot::{foot}_lowerleg::{foot}_lowerleg_fixed_joint_lump__{foot}_foot_collision_5",
            "ground_plane::link::collision",
        ]
        normal_z = 1.0
        if foot == second_body_foot:
            names, normal_z = names[::-1], -1.0
        for message in log.contacts(foot):
            assert message.header.frame_id == log.truth["log"]["contact_frame_id"]
            for state in message.states:
                assert [state.collision1_name, state.collision2_name] == names
                assert info.fullmatch(state.info)
                assert {(n.x, n.y, n.z) for n in state.contact_normals} == {(0, 0, normal_z)}


@pytest.mark.parametrize("name", [TROT, WALK])
def test_odometry_moves_as_stated_with_its_twist_in_world(name: str) -> None:
    log = read_log(name)
    base = log.truth["base"]
    odometry = log.messages(ODOMETRY)
    assert {(m.header.frame_id, m.child_frame_id) for m in odometry} == {("world", "base_link")}
    positions_m = np.array([vector(message.pose.pose.position) for message in odometry])
    moved_m = positions_m[-1] - positions_m[0]
    forward = np.array([-np.sin(base["heading_rad"]), np.cos(base["heading_rad"]), 0])
    assert moved_m @ forward == pytest.approx(base["path_length_m"], abs=LENGTH_TOLERANCE_M)
    assert positions_m[:, 2].mean() == pytest.approx(base["mean_height_m"], abs=1e-4)
    velocity_mps = np.mean([vector(m.twist.twist.linear) for m in odometry], axis=0)
    assert velocity_mps[:2] == pytest.approx(base["forward_speed_mps"] * forward[:2], abs=2e-3)
    noise = np.std([m.twist.twist.linear.x for m in odometry])
    assert noise == pytest.approx(base["twist_noise_std"], rel=0.1)


@pytest.mark.parametrize("name", LOGS)
def test_what_is_commanded_is_what_the_base_does(name: str) -> None:
    log = read_log(name)
    truth = log.truth["command"]
    assert truth["speed_mps"] == log.truth["base"]["forward_speed_mps"]
    for message in log.messages(truth["topic"]):
        twist = getattr(message, "twist", message)
        linear = (twist.linear.x, twist.linear.y, twist.linear.z)
        assert linear == (0.0, truth["speed_mps"], 0.0)
        assert twist.angular.z == 0.0


@pytest.mark.parametrize("name", LOGS)
def test_transforms_hold_the_legs_and_not_the_base(name: str) -> None:
    log = read_log(name)
    static = log.topics.get("/tf_static", [])
    children = Counter(
        link.child_frame_id
        for message in [*log.messages("/tf"), *(message for _, message in static)]
        for link in message.transforms
    )
    joints = ("hip", "upperleg", "lowerleg", "foot", "sole")
    assert set(children) == {f"{foot}_{joint}" for foot in FEET for joint in joints}
    assert bool(static) == (name == WALK)


@pytest.mark.parametrize("name", LOGS)
def test_joint_states_and_transforms_agree(name: str) -> None:
    log = read_log(name)
    for joints, message in zip(
        log.messages("/dogbot/joint_states"), log.messages("/tf"), strict=True
    ):
        knee_rad = dict(zip(joints.name, joints.position, strict=True))["back_left_knee"]
        link = next(t for t in message.transforms if t.child_frame_id == "back_left_lowerleg")
        assert link.transform.rotation.x == pytest.approx(np.sin(knee_rad / 2), abs=1e-6)


@pytest.mark.parametrize("name", LOGS)
def test_the_truth_agrees_with_itself(name: str) -> None:
    truth = read_log(name).truth
    gait = truth["gait"]
    assert truth["forces"]["vertical_impulse_over_weight"] == pytest.approx(1, abs=1e-9)
    shares = [truth["feet"][foot]["load_share"] for foot in FEET]
    assert sum(shares) == pytest.approx(1, abs=1e-8)
    assert sum(gait["support_fraction"].values()) == pytest.approx(1, abs=1e-8)
    for foot in FEET:
        touchdowns_s = truth["feet"][foot]["touchdown_s"]
        assert np.diff(touchdowns_s) == pytest.approx(gait["period_s"])
        phase = (touchdowns_s[0] - truth["feet"]["front_left"]["touchdown_s"][0]) / gait["period_s"]
        assert phase % 1 == pytest.approx(gait["phase"][foot])
        if name != TROUBLED:
            assert len(touchdowns_s) > 6
