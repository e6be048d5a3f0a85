"""`stats` from the file to the metrics, against what is known of samples, and of plans."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.documents import schema, stats_json
from tests.measured import measured
from tests.oracles import walks
from tests.oracles.state_walks import StateWalk
from tests.paths import ROOT, SAMPLE_LOGS

WALKS = ("dogbot_trot.bag", "dogbot_walk.mcap")


def figures(log: Path, options: MeasureOptions | None = None) -> dict[str, Any]:
    return stats_json(measured(log, options or MeasureOptions()))


def truth(log: str) -> dict[str, Any]:
    text = (SAMPLE_LOGS / f"{Path(log).stem}.truth.json").read_text(encoding="utf-8")
    known: dict[str, Any] = json.loads(text)
    return known


@pytest.fixture(scope="module", params=WALKS)
def walk(request: pytest.FixtureRequest) -> tuple[dict[str, Any], dict[str, Any]]:
    true = truth(request.param)
    origin = measured(SAMPLE_LOGS / request.param, MeasureOptions()).walk.origin
    true["log"]["start_s"] = true["log"]["start_stamp_s"] - origin / 1e9
    return figures(SAMPLE_LOGS / request.param), true


Walk = tuple[dict[str, Any], dict[str, Any]]


def test_contacts_are_true_within_one_sample(walk: Walk) -> None:
    """Also where the message after a lift-off still holds the last steps of the stance."""
    got, true = walk
    start, latest = true["log"]["start_s"], true["log"]["contact_interval_s"] + 1e-6
    for foot, known in true["feet"].items():
        found = got["feet"][foot]
        assert found["contact_fraction"] == pytest.approx(known["contact_fraction"], abs=0.0015)
        for name, expected in (("lift_off_s", "liftoff_s"), ("touchdown_s", "touchdown_s")):
            late = np.array(found[name]) - np.array(known[expected]) - start
            assert -1e-6 < late.min() <= late.max() <= latest


def test_the_gait_is_true(walk: Walk) -> None:
    got, true = walk
    gait, known = got["gait"], true["gait"]
    assert gait["name"] == known["class"]
    assert gait["stride_frequency_hz"] == pytest.approx(known["stride_frequency_hz"], rel=0.002)
    assert gait["duty_factor"] == pytest.approx(known["duty_factor"], abs=0.005)
    for foot, phase in known["phase"].items():
        off = gait["phase"][foot]["mean"] - phase
        assert abs((off + 0.5) % 1.0 - 0.5) < 0.005
        assert gait["phase"][foot]["consistency"] > 0.99
    for feet, fraction in known["support_fraction"].items():
        assert gait["support"][feet] == pytest.approx(fraction, abs=0.02)


def test_the_feet_carry_the_weight(walk: Walk) -> None:
    """In the trot the wrenches are in the links' frames, and the log's /tf turns them."""
    got, true = walk
    assert got["forces"]["vertical_impulse_over_weight"] == pytest.approx(1.0, abs=0.005)
    for foot, known in true["feet"].items():
        feet = got["feet"][foot]
        peak, vertical = feet["peak_force_n"], feet["peak_vertical_force_n"]
        assert peak["max"] == pytest.approx(known["peak_force_n"], rel=0.01)
        assert vertical["max"] == pytest.approx(known["peak_vertical_force_n"], rel=0.01)
        assert got["forces"]["load_share"]["feet"][foot] == pytest.approx(
            known["load_share"], abs=0.005
        )


def test_the_base_moves_as_it_should(walk: Walk) -> None:
    got, true = walk
    base, known = got["base"], true["base"]
    assert base["forward_speed_mps"] == pytest.approx(known["forward_speed_mps"], rel=0.002)
    assert base["path_length_m"] == pytest.approx(known["path_length_m"], rel=0.002)
    assert base["height_m"]["mean"] == pytest.approx(known["mean_height_m"], abs=1e-4)


def test_without_its_transforms_a_link_frame_log_has_no_vertical_figures(tmp_path: Path) -> None:
    # A robot whose frames the log's transforms do not name: nothing can be turned.
    robot = tmp_path / "stranger.toml"
    text = (ROOT / "dogbot_logtool/robot/known/dogbot.toml").read_text(encoding="utf-8")
    robot.write_text(text.replace('base = "base_link"', 'base = "trunk"'), encoding="utf-8")
    options = MeasureOptions(robot=str(robot))
    got = figures(SAMPLE_LOGS / "dogbot_trot.bag", options)

    assert got["forces"]["vertical_impulse_over_weight"] is None
    for foot in got["feet"].values():
        assert foot["peak_vertical_force_n"] is None
        assert foot["peak_force_n"]["n"] > 0
    assert (
        got["null_because"]["feet.front_left.peak_vertical_force_n"]
        == "frame of the forces not known"
    )


def test_the_json_is_what_the_schema_says() -> None:
    Draft202012Validator.check_schema(schema(WalkMetrics))
    validator = Draft202012Validator(schema(WalkMetrics))
    for log in (*WALKS, "dogbot_troubled.bag"):
        validator.validate(json.loads(json.dumps(figures(SAMPLE_LOGS / log), allow_nan=False)))


# --- Feet against their plan: delays, misses and agreement ----------------------------------------


AHEAD: Final = 4
"""Samples of 10 ms by which everything is planned earlier."""
PLANNED_FORCE: Final = 1.25
GRF, HRP, XPP = (
    "quad_msgs/msg/GRFArray",
    "hrpsys_ros_bridge/msg/ContactStatesStamped",
    "xpp_msgs/msg/RobotStateCartesian",
)
TOPICS: Final = {
    GRF: ("/state/grfs", "/control/grfs"),
    HRP: ("/act_contact_states", "/ref_contact_states"),
    XPP: ("/xpp/state_curr", "/xpp/state_des"),
}
SWINGING: Final = 12
"""Samples after its lift-off at which a foot is planned to touch down once more."""


class Plan(StateWalk):
    """The walk as it is planned: earlier, and stronger."""

    def header(self, sample: int, frame: str) -> Any:
        return super().header(max(sample - AHEAD, 0), frame)

    def forces(self, sample: int, legs: Any = walks.LEGS) -> list[Any]:
        return [PLANNED_FORCE * force for force in super().forces(sample, legs)]


class HastyPlan(Plan):
    """A plan in which the left front foot touches down once more in its first swing."""

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        flags = super().flags(sample, legs)
        (lifted, *_) = np.flatnonzero(np.diff(walks.TOUCHES["front_left"].astype(int)) < 0)
        extra = SWINGING <= sample - lifted < SWINGING + 5
        return flags | (np.array([leg == "front_left" for leg in legs]) & extra)


def both(kind: str, plan: StateWalk) -> Iterator[walks.Entry]:
    topics = TOPICS[kind]
    for entry in StateWalk(2).messages(kind):
        topic = topics[0] if entry.kind == kind else entry.topic
        yield walks.Entry(topic, entry.kind, entry.log_time, entry.data)
    for entry in plan.messages(kind):
        time = entry.log_time - AHEAD * walks.STEP
        if entry.kind == kind and time >= walks.START:
            yield walks.Entry(topics[1], kind, time, entry.data)


def write(folder: Path, kind: str, plan: StateWalk) -> Path:
    path = folder / "walk.mcap"
    entries = sorted(both(kind, plan), key=lambda entry: entry.log_time)
    walks.write_mcap(path, StateWalk(2), entries)
    return path


@pytest.mark.parametrize("kind", TOPICS)
def test_a_walk_that_is_late_against_its_plan(tmp_path: Path, kind: str) -> None:
    found = figures(write(tmp_path, kind, Plan(2)))
    assert {foot["topic"] for foot in found["settings"]["feet"].values()} == {TOPICS[kind][0]}
    for foot in found["feet"].values():
        planned, steps = foot["planned"], len(foot["touchdown_s"])
        assert (planned["missed"], planned["unplanned"]) == (0, 0)
        delay = planned["delay_s"]
        assert delay["n"] == steps
        assert (delay["min"], delay["max"]) == pytest.approx((0.04, 0.04), abs=1e-6)
        # 40 ms of disagreement at each touchdown and each lift-off.
        known = (walks.SAMPLES - 1 - AHEAD) * walks.STEP / 1e9
        changes = steps + len(foot["lift_off_s"])
        assert planned["agreement"] == pytest.approx(1 - 0.04 * changes / known, abs=1e-6)
    assert "PLANNED" in {finding["code"] for finding in found["findings"]}


def test_a_planned_touchdown_that_does_not_come_is_missed(tmp_path: Path) -> None:
    found = figures(write(tmp_path, GRF, HastyPlan(2)))
    missed = {name: foot["planned"]["missed"] for name, foot in found["feet"].items()}
    assert missed == {"front_left": 1, "front_right": 0, "back_left": 0, "back_right": 0}
    foot = found["feet"]["front_left"]
    assert foot["planned"]["delay_s"]["n"] == len(foot["touchdown_s"])


class Velocities(StateWalk):
    """The driver of the A1: planned contacts stand beside the counts, as velocities."""

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        for topic, message in super().contacts(kind, sample):
            message.velocity[12:] = self.flags(min(sample + AHEAD, walks.SAMPLES - 1))
            yield topic, message


def test_planned_contacts_beside_the_counts(tmp_path: Path) -> None:
    kind, walk = "sensor_msgs/msg/JointState", Velocities(2)
    entries = [
        walks.Entry("/joint_foot" if e.kind == kind else e.topic, e.kind, e.log_time, e.data)
        for e in walk.messages(kind)
    ]
    walks.write_mcap(tmp_path / "walk.mcap", walk, entries)
    for foot in figures(tmp_path / "walk.mcap")["feet"].values():
        assert foot["planned"]["delay_s"]["median"] == pytest.approx(0.04, abs=1e-6)
