"""The sample logs are what their truth says, read with the containers' own libraries."""

from pathlib import Path
from typing import Any

import generate
import numpy as np
import pytest
from scenario import Scenario

import dogbot_logtool as dl
from tests.paths import SAMPLE_LOGS
from tests.sample_logs.decoded_logs import (
    FEET,
    LOGS,
    ODOMETRY,
    TROT,
    TROUBLED,
    WALK,
    by_number,
    contact_topic,
    has_stamp,
    newest_step,
    poses_in_world,
    read_log,
    seconds,
    stamp_ns,
    states_by_step,
    vector,
    world_forces,
)

LOWER_LEG_M = 0.3


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
        same = fresh.read_bytes() == (SAMPLE_LOGS / fresh.name).read_bytes()
        assert same, f"{fresh.name}: other messages, or a codec of another version"


@pytest.mark.parametrize("name", [TROT, WALK])
def test_forces_add_up_to_the_weight_and_stay_within_friction(name: str) -> None:
    log = read_log(name)
    peak_n = dict.fromkeys(FEET, 0.0)
    for _, forces_n in world_forces(log):
        total_n = np.sum(list(forces_n.values()), axis=0)
        np.testing.assert_allclose(total_n, [0, 0, log.truth["robot"]["weight_n"]], atol=1e-3)
        for foot, force_n in forces_n.items():
            truth = log.truth["feet"][foot]
            used = float(np.hypot(*force_n[:2]) / force_n[2])
            assert used <= truth["peak_friction_use"] + 1e-6
            assert used < log.truth["robot"]["friction_coefficient"]
            peak_n[foot] = max(peak_n[foot], float(np.linalg.norm(force_n)))
    for foot in FEET:
        assert peak_n[foot] == pytest.approx(log.truth["feet"][foot]["peak_force_n"], rel=0.01)


@pytest.mark.parametrize("name", [TROT, WALK])
def test_touchdowns_and_liftoffs_are_seen_within_a_message(name: str) -> None:
    log = read_log(name)
    interval_s = log.truth["log"]["contact_interval_s"]
    for foot in FEET:
        down = [bool(message.states) for message in log.contacts(foot)]
        times_s = [seconds(log, stamp_ns(message.header)) for message in log.contacts(foot)]
        changes = list(zip(times_s[1:], down[:-1], down[1:], strict=True))
        truth = log.truth["feet"][foot]
        # The message after a lift-off still holds the stance's last steps, if it has several.
        for key, goes_down, most in (("touchdown_s", True, 1), ("liftoff_s", False, 2)):
            seen_s = [at for at, before, after in changes if before != after == goes_down]
            late_s = np.subtract(seen_s, truth[key])
            assert np.all((late_s > 0) & (late_s <= most * interval_s))
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
            for expected_m in ((poses[f"{foot}_foot"] @ sole)[:3], poses[f"{foot}_sole"][:3, 3]):
                np.testing.assert_allclose(points_m.mean(axis=0), expected_m, atol=1e-6)


@pytest.mark.parametrize("name", LOGS)
def test_the_base_and_the_joints_move_as_stated(name: str) -> None:
    log = read_log(name)
    base, command = log.truth["base"], log.truth["command"]
    positions_m = np.array([vector(each.pose.pose.position) for each in log.messages(ODOMETRY)])
    forward = np.array([-np.sin(base["heading_rad"]), np.cos(base["heading_rad"]), 0])
    moved_m = (positions_m[-1] - positions_m[0]) @ forward
    assert moved_m == pytest.approx(base["path_length_m"], abs=1e-6)
    for message in log.messages(command["topic"]):
        linear = getattr(message, "twist", message).linear
        assert (linear.x, linear.y, linear.z) == (0.0, base["forward_speed_mps"], 0.0)
    joints = log.messages("/dogbot/joint_states"), log.messages("/tf")
    for states, transforms in zip(*joints, strict=True):
        knee_rad = dict(zip(states.name, states.position, strict=True))["back_left_knee"]
        (link,) = (t for t in transforms.transforms if t.child_frame_id == "back_left_lowerleg")
        assert link.transform.rotation.x == pytest.approx(np.sin(knee_rad / 2), abs=1e-6)


def test_the_troubled_log_has_the_damage_that_its_truth_lists_and_no_other() -> None:
    log = read_log(TROUBLED)
    damage: dict[str, Any] = log.truth["damage"]
    for topic, messages in log.topics.items():
        for _, message in messages:
            if has_stamp(message):
                links = message.transforms if topic == "/tf" else [message]
                assert {stamp_ns(each.header) for each in links} == {0}
    frames = {(each.header.frame_id, each.child_frame_id) for each in log.messages(ODOMETRY)}
    assert frames == {("/world", "")}
    assert not any(message.states for message in log.contacts(damage["dead_foot"]))

    silence, interval_s = damage["silence"], log.truth["log"]["contact_interval_s"]
    entries = log.topics[silence["topic"]]
    times_s = np.array([seconds(log, time_ns) for time_ns, _ in entries])
    before = int(np.argmax(np.diff(times_s)))
    assert times_s[before] < silence["start_s"] < times_s[before] + 2 * interval_s
    gap_s = times_s[before + 1] - times_s[before]
    assert gap_s == pytest.approx(silence["duration_s"] + interval_s, abs=1e-3)
    assert entries[before][1].states

    for topic in map(contact_topic, FEET):
        not_finite: dict[str, list[int]] = {"nan_force": [], "infinite_position": []}
        for _, message in by_number(log, topic):
            for state in newest_step(message):
                if np.isnan(state.total_wrench.force.z):
                    not_finite["nan_force"].append(message.header.seq)
                if np.isinf(state.contact_positions[0].x):
                    not_finite["infinite_position"].append(message.header.seq)
        assert not_finite == {key: damage[key].get(topic, []) for key in not_finite}
    turns = [message.pose.pose.orientation for _, message in by_number(log, ODOMETRY)]
    zero = [row for row, q in enumerate(turns) if not any((q.x, q.y, q.z, q.w))]
    assert zero == damage["zero_quaternion"][ODOMETRY]
    for topic in (ODOMETRY, *map(contact_topic, FEET)):
        entries = by_number(log, topic)
        numbers = np.array([message.header.seq for _, message in entries])[1:]
        steps_ns = np.diff([time_ns for time_ns, _ in entries])
        assert numbers[steps_ns == 0].tolist() == damage["duplicate_log_time"].get(topic, [])
        assert numbers[steps_ns < 0].tolist() == damage["backward_log_time"].get(topic, [])


@pytest.mark.parametrize("name", [TROT, WALK])
def test_legs_are_measured_as_their_truth_says(name: str) -> None:
    walk = dl.measure(SAMPLE_LOGS / name)
    strides = walk.strides
    for foot, true in read_log(name).truth["legs"]["feet"].items():
        found = walk.feet[foot]
        assert found.clearance_m is not None
        assert found.clearance_m.median == pytest.approx(true["clearance_m"], abs=0.002)
        for key in ("absolute_work_j", "positive_work_j"):
            done = np.median(strides[key][strides["foot"] == foot])
            assert done == pytest.approx(true[key], rel=0.03), (foot, key)
        for joint, torque in true["peak_torque_nm"].items():
            peak = walk.legs.joints[f"{foot}_{joint}"].peak_effort
            assert peak == pytest.approx(torque, rel=0.05)
