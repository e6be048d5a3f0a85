"""Feet against their plan: delays, misses and agreement."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from dogbot_logtool.report.documents import stats_json
from tests.measured import measured
from tests.oracles import walks
from tests.oracles.state_walks import StateWalk

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
HASTY: Final = range(12, 17)
"""Samples after its lift-off in which a foot is planned to touch down once more."""


class Plan(StateWalk):
    """The walk as it is planned: earlier, stronger, with one touchdown that does not come."""

    def header(self, sample: int, frame: str) -> Any:
        return super().header(max(sample - AHEAD, 0), frame)

    def forces(self, sample: int, legs: Any = walks.LEGS) -> list[Any]:
        return [PLANNED_FORCE * force for force in super().forces(sample, legs)]

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        flags = super().flags(sample, legs)
        (lifted, *_) = np.flatnonzero(np.diff(walks.TOUCHES["front_left"].astype(int)) < 0)
        extra = sample - lifted in HASTY
        return flags | (np.array([leg == "front_left" for leg in legs]) & extra)


def both(kind: str) -> Iterator[walks.Entry]:
    topics = TOPICS[kind]
    for entry in StateWalk(2).messages(kind):
        topic = topics[0] if entry.kind == kind else entry.topic
        yield walks.Entry(topic, entry.kind, entry.log_time, entry.data)
    for entry in Plan(2).messages(kind):
        time = entry.log_time - AHEAD * walks.STEP
        if entry.kind == kind and time >= walks.START:
            yield walks.Entry(topics[1], kind, time, entry.data)


@pytest.mark.parametrize("kind", TOPICS)
def test_a_walk_that_is_late_against_its_plan(tmp_path: Path, kind: str) -> None:
    entries = sorted(both(kind), key=lambda entry: entry.log_time)
    walks.write_mcap(tmp_path / "walk.mcap", StateWalk(2), entries)
    found = stats_json(measured(tmp_path / "walk.mcap"))
    assert {foot["topic"] for foot in found["settings"]["feet"].values()} == {TOPICS[kind][0]}
    for name, foot in found["feet"].items():
        hasty = name == "front_left"
        planned, steps = foot["planned"], len(foot["touchdown_s"])
        assert (planned["missed"], planned["unplanned"]) == (hasty, 0)
        delay = planned["delay_s"]
        assert delay["n"] == steps
        assert (delay["min"], delay["max"]) == pytest.approx((0.04, 0.04), abs=1e-6)
        # 40 ms of disagreement at each touchdown and each lift-off.
        known = (walks.SAMPLES - 1 - AHEAD) * walks.STEP / 1e9
        changes = steps + len(foot["lift_off_s"])
        apart = 0.04 * changes + 0.01 * len(HASTY) * hasty
        assert planned["agreement"] == pytest.approx(1 - apart / known, abs=1e-6)
    assert "PLANNED" in {finding["code"] for finding in found["findings"]}


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
    for foot in stats_json(measured(tmp_path / "walk.mcap"))["feet"].values():
        assert foot["planned"]["delay_s"]["median"] == pytest.approx(0.04, abs=1e-6)
