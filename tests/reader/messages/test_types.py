"""One walk in every type of contact message: the same columns, judged by the walk itself."""

from contextlib import closing
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from numpy.typing import NDArray

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.reader.messages.feet import flagged
from dogbot_logtool.reader.messages.gazebo import foot_sides, newest_step, step_times
from dogbot_logtool.reader.messages.table import rows_of
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.measuring.foot_samples import decide_contacts
from dogbot_logtool.robot.selection import Selection, select_topics
from tests.oracles import state_walks, walks
from tests.reader.decode.oracle import texts_of

JOINT_FOOT: Final = "sensor_msgs/msg/JointState"
KINDS: Final = (*walks.KINDS, *state_walks.KINDS, JOINT_FOOT)
FLAGS_ONLY: Final = (
    "spot_msgs/msg/FootStateArray",
    "champ_msgs/msg/ContactsStamped",
    *state_walks.FLAGS_ONLY,
)
RAW: Final = (
    *(kind for kind in walks.KINDS if kind.startswith("unitree")),
    *state_walks.RAW,
    JOINT_FOOT,
)
UNSTAMPED: Final = (
    *state_walks.PLANNED,
    *(kind for kind in RAW if kind != JOINT_FOOT),
    "spot_msgs/msg/FootStateArray",
    "quadropted_msgs/msg/RobotFootContact",
)
IN_BASE: Final = (*state_walks.RAW, "dwl_msgs/msg/WholeBodyState", "old_dwl/msg/WholeBodyState")
"""Kinds whose points are seen from the base."""


def write(folder: Path, kind: str, ros: int) -> Path:
    walk = walks.Walk(ros) if kind in walks.KINDS else state_walks.StateWalk(ros)
    entries = [
        walks.Entry("/joint_foot" if e.kind == JOINT_FOOT else e.topic, e.kind, e.log_time, e.data)
        for e in walk.messages(kind)
    ]
    return walks.write_log(folder, walk, entries)


def read(folder: Path, kind: str, ros: int, robot: str = "generic") -> tuple[Selection, list[Any]]:
    with closing(open_log(write(folder, kind, ros))) as log:
        selection = select_topics(log, MeasureOptions(robot=robot))
        found = read_recording(log, selection.wanted(), jobs=1)
    assert not found.losses
    feet, selection = decide_contacts(found.recording.feet, selection)
    return selection, list(feet)


def leg_of(name: str) -> str:
    """The leg that a foot walks like: a biped's feet walk like those in front."""
    return f"front_{name}" if name in {"left", "right"} else name


def sample_numbers(samples: Samples) -> NDArray[np.int64]:
    return np.asarray((samples.log_time - walks.START) // walks.STEP)


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_columns_are_those_of_the_walk(tmp_path: Path, kind: str, ros: int) -> None:
    selection, feet = read(tmp_path, kind, ros)
    names = [foot.name for foot in selection.robot.feet]
    assert names == (["left", "right"] if kind.startswith("hrpsys") else list(walks.LEGS))
    for name, samples in zip(names, feet, strict=True):
        leg, number = leg_of(name), sample_numbers(samples)
        # A sensor's offset in swing is 0.6 N.
        touching = samples.in_contact & ~(np.linalg.norm(samples.force, axis=1) < 1.0)
        assert number[touching].tolist() == np.flatnonzero(walks.TOUCHES[leg]).tolist()
        if "ros_gz" not in kind:
            assert number.tolist() == list(range(walks.SAMPLES))
        stamp = np.zeros_like(number) if kind in UNSTAMPED else samples.log_time
        assert samples.stamp.tolist() == stamp.tolist()
        if kind in (*FLAGS_ONLY, *RAW):
            # What the counts are in newtons is not known.
            assert np.isnan(samples.force[samples.in_contact, 2]).all()
        else:
            expected = walks.FORCES[leg][number]
            np.testing.assert_allclose(samples.force[:, 2], expected[:, 2], atol=1e-4)
        if kind in state_walks.WITH_POINTS:
            points = np.array([state_walks.foot_position(leg, sample) for sample in number])
            if kind in IN_BASE:
                points -= [state_walks.base_position(sample) for sample in number]
            told = touching if kind not in state_walks.RAW else np.ones_like(touching)
            np.testing.assert_allclose(samples.position[told], points[told], atol=1e-6)
            assert np.isnan(samples.position[~told]).all()


@pytest.mark.parametrize("kind", RAW[:-1])
def test_counts_with_a_scale_are_newtons(tmp_path: Path, kind: str) -> None:
    robot = walks.robot_file(tmp_path, "unitree_go/msg/SportModeState")
    selection, feet = read(tmp_path, kind, 2, str(robot))
    for foot, samples in zip(selection.robot.feet, feet, strict=True):
        assert samples.force[:, 2].tolist() == walks.FORCES[foot.name][:, 2].tolist()


@pytest.mark.parametrize(
    ("type_name", "row", "values"),
    [
        # Open, closed, slipping; below 0 and above 2 there is nothing.
        ("anymal_msgs/AnymalState", 0, {0: 0, 1: 1, 2: 1, 3: None}),
        # Unknown is the default, and not "open": then inactive, active, slipping.
        ("whole_body_state_msgs/WholeBodyState", 0, {0: None, 1: 0, 2: 1, 3: 1}),
        # Closed, open, slipping in earlier versions.
        ("whole_body_state_msgs/WholeBodyState", 1, {-1: None, 0: 1, 1: 0, 2: 1}),
        # Lost is 2, which is not false.
        ("spot_msgs/FootStateArray", 0, {0: None, 1: 1, 2: 0}),
        # A number of each foot's own, for plots.
        ("pronto_msgs/QuadrupedStance", 0, {0.0: 0, 0.1: 1, 0.4: 1, np.nan: None}),
        ("champ_msgs/ContactsStamped", 0, {0: 0, 1: 1}),
        ("hrpsys_ros_bridge/ContactStatesStamped", 0, {0: 0, 1: 1}),
    ],
)
def test_what_flags_mean(type_name: str, row: int, values: dict[float, int | None]) -> None:
    known, touches = flagged(
        rows_of(type_name, "feet")[row], Foot("x", "/x"), np.array([*values], float)
    )
    found = [
        int(touch) if is_known else None for is_known, touch in zip(known, touches, strict=True)
    ]
    assert found == [*values.values()]


# Gazebo's physics steps, and links by the names of their bodies


def told_at(seconds: int) -> str:
    pair = "my geom:dogbot::leg::foot   other geom:ground_plane::link::collision"
    return f"Debug:  i:(0/1)     {pair}         time:{seconds}.000000000\n"


@pytest.mark.parametrize("info", ["", "no time here", "time12.5", "x" * 100, "time"])
def test_a_message_that_tells_no_time_is_one_step_and_is_counted(info: str) -> None:
    infos = [told_at(1), info, told_at(2), info, told_at(3)]
    owner = np.array([0, 0, 0, 1, 2], np.int64)

    newest, _, untimed = newest_step(step_times(texts_of(infos)), owner, np.zeros(3, np.int64))

    assert newest.tolist() == [True] * 5
    assert untimed == 1


@pytest.mark.parametrize(
    ("collision", "link"),
    [
        ("dogbot::front_left_lowerleg::lump__foot_collision_5", "front_left_lowerleg"),
        ("world::dogbot::leg::foot", "leg"),
        ("foot_collision", None),
    ],
)
def test_the_link_stands_in_the_collisions_name(collision: str, link: str | None) -> None:
    pair = texts_of([collision, "ground_plane::link::collision"])
    foot = Foot("front_left", "/x", collision=collision)
    _, links = foot_sides(pair.pick(np.array([0])), pair.pick(np.array([1])), np.array([0]), [foot])
    assert links == ({0: {link}} if link else {})
