"""The synthetic walk in messages that tell of all feet: the same contacts, forces and arrows."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg

from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import InfoOptions, MeasureOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import state_walks, walks
from tests.oracles.state_walks import StateWalk
from tests.reader.messages.test_sources import steps


def written(folder: Path, kind: str, walk: StateWalk | None = None) -> Path:
    """Write the walk into an MCAP file."""
    path = folder / "walk.mcap"
    entries = state_walks.messages(kind) if walk is None else list(walk.messages(kind))
    walks.write_mcap(path, walk or StateWalk(2), entries)
    return path


def options(folder: Path, kind: str) -> MeasureOptions:
    """Return no options but a mass; raw sensors need the robot's file."""
    if kind in state_walks.RAW:
        return MeasureOptions(robot=str(robot_file(folder)))
    return MeasureOptions(mass=walks.MASS_KG)


def robot_file(folder: Path) -> Path:
    return walks.robot_file(folder, "unitree_go/msg/SportModeState")


def figures(path: Path, topics: MeasureOptions) -> dict[str, Any]:
    done = measure(path, topics)
    return stats_json(done)


@pytest.mark.parametrize("kind", state_walks.KINDS)
def test_what_is_planned_is_called_planned(tmp_path: Path, kind: str) -> None:
    told = describe(written(tmp_path, kind), InfoOptions())
    (use,) = [topic.use for topic in told.topics if topic.topic == "/feet"]
    said = "PLANNED" in {finding.code for finding in told.findings}
    assert (use.startswith("planned feet "), said) == ((kind in state_walks.PLANNED),) * 2


def test_measured_forces_are_taken_before_commanded_ones(tmp_path: Path) -> None:
    kind, walk = "quad_msgs/msg/GRFArray", StateWalk(2)
    entries = [
        walks.Entry(topic, entry.kind, entry.log_time, entry.data)
        for entry in walk.messages(kind)
        for topic in (("/control/grfs", "/state/grfs") if entry.kind == kind else (entry.topic,))
    ]
    walks.write_mcap(tmp_path / "walk.mcap", walk, entries)
    uses = {t.topic: t.use for t in describe(tmp_path / "walk.mcap", InfoOptions()).topics}
    assert uses["/state/grfs"].startswith("feet ")
    assert uses["/control/grfs"] == ""


class WithArm(StateWalk):
    """A robot whose messages tell of a gripper, too."""

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        names = ["gripper", *(f"{tip[:2]}_foot" for tip in state_walks.TIPS.values())]
        wrenches = [[force] for force in ((0.0, 0.0, -12.0), *self.forces(sample))]
        yield "/feet", self.make(kind, name=names, wrench=wrenches, **self.stamped(sample, ""))


def test_a_gripper_among_feet_is_no_foot(tmp_path: Path) -> None:
    path = written(tmp_path, "syropod_highlevel_controller/msg/TipState", WithArm(2))
    got = figures(path, MeasureOptions(mass=walks.MASS_KG))
    assert set(got["feet"]) == set(walks.LEGS)
    for leg in walks.LEGS:
        assert got["feet"][leg]["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)


class Unflagged(StateWalk):
    """A publisher that never sets its flags."""

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        return np.zeros_like(super().flags(sample, legs))


def test_flags_that_are_never_set_do_not_decide(tmp_path: Path) -> None:
    path = written(tmp_path, state_walks.KINDS[0], Unflagged(2))
    got = figures(path, MeasureOptions(mass=walks.MASS_KG))
    assert "FLAGS_CONTRADICTED" in {finding["code"] for finding in got["findings"]}
    for leg in walks.LEGS:
        assert got["feet"][leg]["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)


class Shifted(StateWalk):
    """A plan whose flags end contact before the force does."""

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        return super().flags(min(sample + 4, walks.SAMPLES - 1), legs)


def test_flags_decide_contact_where_forces_say_otherwise(tmp_path: Path) -> None:
    path = written(tmp_path, state_walks.KINDS[0], Shifted(2))
    got = figures(path, MeasureOptions(mass=walks.MASS_KG))
    assert "FLAGS_CONTRADICTED" in {finding["code"] for finding in got["findings"]}
    for leg in walks.LEGS:
        expected = [time - 0.04 for time in steps(leg)[0]]
        assert got["feet"][leg]["touchdown_s"] == pytest.approx(expected, abs=1e-6)


class Ballbot(StateWalk):
    """A robot without legs that uses the same controller."""

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        state = {"state": [np.zeros(10)], "input": [np.zeros(3)]}
        yield "/feet", self.make(kind, time=0.01 * sample, **state)


def test_an_observation_of_a_robot_without_legs_is_not_of_feet(tmp_path: Path) -> None:
    path = written(tmp_path, "ocs2_msgs/msg/mpc_observation", Ballbot(2))
    told = describe(path, InfoOptions())
    assert not any("feet" in topic.use for topic in told.topics)


def test_a_type_without_its_fields_is_not_of_feet(tmp_path: Path) -> None:
    """Unitree's humanoids have a LowState without forces on feet."""
    walk = StateWalk(2)
    walk.store.register(
        get_types_from_msg("uint32 tick\nfloat32[3] position", "unitree_hg/msg/LowState")
    )
    kind = "unitree_hg/msg/LowState"
    message = walk.make(kind, tick=1, position=np.zeros(3, np.float32))
    entry = walks.Entry("/lowstate", kind, walks.START, walk.bytes_of(kind, message))
    walks.write_mcap(tmp_path / "log.mcap", walk, [entry])
    told = describe(tmp_path / "log.mcap", InfoOptions())
    assert [topic.use for topic in told.topics] == [""]
    assert "NO_FEET" in {finding.code for finding in told.findings}


def write_joint_foot(folder: Path, topic: str) -> Path:
    kind, walk = "sensor_msgs/msg/JointState", StateWalk(2)
    entries = [
        walks.Entry(topic if e.kind == kind else e.topic, e.kind, e.log_time, e.data)
        for e in walk.messages(kind)
    ]
    path = folder / "joints.mcap"
    walks.write_mcap(path, walk, entries)
    return path


def test_efforts_of_joint_foot_are_feet(tmp_path: Path) -> None:
    got = figures(write_joint_foot(tmp_path, "/hardware_a1/joint_foot"), MeasureOptions())
    for leg in walks.LEGS:
        assert got["feet"][leg]["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)
        assert got["feet"][leg]["peak_force_n"] is None


def test_other_joint_states_are_not_of_feet(tmp_path: Path) -> None:
    told = describe(write_joint_foot(tmp_path, "/joint_states"), InfoOptions())
    assert {t.topic: t.use for t in told.topics}["/joint_states"] == "joints"


@pytest.mark.parametrize("kind", ["old_xpp/msg/RobotStateCartesian", "anymal_msgs/msg/AnymalState"])
def test_the_base_is_part_of_a_state_in_any_package(tmp_path: Path, kind: str) -> None:
    walk = StateWalk(2)
    entries = [entry for entry in walk.messages(kind) if entry.kind == kind]
    walks.write_mcap(tmp_path / "walk.mcap", walk, entries)
    walked = 0.003 * (walks.SAMPLES - 1)
    got = figures(tmp_path / "walk.mcap", MeasureOptions())
    assert got["base"]["net_displacement_m"] == pytest.approx(walked, rel=1e-6)


class Rounded(StateWalk):
    """Counts that are as good as constant on the ground, and jitter by one in the air."""

    def counts(self, forces: Any) -> Any:
        down = {leg: force[2] > 0.0 for leg, force in forces.items()}
        order = ("front_right", "front_left", "back_right", "back_left")
        jitter = int(next(self.ticks) % 2)
        return np.array([140 if down[leg] else 20 + jitter for leg in order], np.int16)

    def __init__(self, ros: int) -> None:
        super().__init__(ros)
        self.ticks = iter(range(10**6))


def test_counts_of_two_levels_tell_contact(tmp_path: Path) -> None:
    """The narrower level is that of stance here, but a load never lowers a count."""
    got = figures(written(tmp_path, "go2_interfaces/msg/Go2State", Rounded(2)), MeasureOptions())
    for leg in walks.LEGS:
        assert got["feet"][leg]["touchdown_s"] == pytest.approx(steps(leg)[0], abs=1e-6)
