"""Feet of unknown messages that strings beside an array name; and stats that offers them."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg

from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.robot.topics.annotated import open_recorded
from dogbot_logtool.robot.topics.selection import Selection, select_topics
from tests.oracles import walks
from tests.oracles.field_logs import RATE_HZ, load_n, odd_walk

DEFINITIONS = {
    "odd_msgs/msg/Limb": "string name\ngeometry_msgs/Vector3 grf\nfloat64[3] q\n",
    "odd_msgs/msg/Limbs": "geometry_msgs/Pose base_pose\nodd_msgs/Limb[] legs\n",
    "odd_msgs/msg/Tips": "string[] name\ngeometry_msgs/Wrench[] wrench\n",
}
PLACES = {
    "front_left": ("front", "left"),
    "front_right": ("front", "right"),
    "back_left": ("back", "left"),
    "back_right": ("back", "right"),
}


def select(
    folder: Path,
    kind: str,
    labels: Sequence[str],
    *,
    shuffled: bool = False,
    topic: str = "/state",
) -> Selection:
    """Write limbs that walk in turns and select what is used of the log."""
    walk = odd_walk()
    for name, text in DEFINITIONS.items():
        walk.store.register(get_types_from_msg(text, name))
    entries = []
    for sample in range(1200):
        loads = [load_n(sample / RATE_HZ, foot) for foot in range(len(labels))]
        time = walks.START + round(sample * 1e9 / RATE_HZ)
        called = list(labels)[:: -1 if shuffled and sample % 2 else 1]
        fields = {"odd_msgs/msg/Limbs": limbs, "odd_msgs/msg/Tips": tips}[kind](walk, called, loads)
        message = walk.make(kind, **fields)
        entries.append(walks.Entry(topic, kind, time, walk.bytes_of(kind, message)))
    walks.write_mcap(folder / "log.mcap", walk, entries)
    log = open_recorded(folder / "log.mcap")
    try:
        return select_topics(log, MeasureOptions())
    finally:
        log.close()


def limbs(walk: walks.Walk, labels: Sequence[str], loads: Sequence[float]) -> dict[str, Any]:
    origin = walk.vector((0.0, 0.0, 0.5), "geometry_msgs/Point")
    turn = walk.make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
    legs = [
        walk.make("odd_msgs/Limb", name=label, grf=walk.vector((0, 0, load)), q=np.zeros(3))
        for label, load in zip(labels, loads, strict=True)
    ]
    pose = walk.make("geometry_msgs/Pose", position=origin, orientation=turn)
    return {"base_pose": pose, "legs": legs}


def tips(walk: walks.Walk, labels: Sequence[str], loads: Sequence[float]) -> dict[str, Any]:
    return {"name": list(labels), "wrench": [walk.wrench((0, 0, load)) for load in loads]}


def test_strings_in_the_elements_name_the_feet(tmp_path: Path) -> None:
    found = select(tmp_path, "odd_msgs/msg/Limbs", ("FL", "FR", "RL", "RR"))
    feet = {foot.name: foot.leg_position for foot in found.possible_feet[0].feet}
    assert feet == PLACES
    assert [foot.field.path for foot in found.possible_feet[0].feet if foot.field] == [
        f"legs[{leg}].grf" for leg in range(4)
    ]


def test_strings_beside_the_array_name_the_feet(tmp_path: Path) -> None:
    """Rows of a hexapod are lettered: B is in the middle, not the back."""
    labels = ("AR_tip", "BR_tip", "CR_tip", "CL_tip", "BL_tip", "AL_tip")
    found = select(tmp_path, "odd_msgs/msg/Tips", labels)
    names = [foot.name for foot in found.possible_feet[0].feet]
    assert names == ["right_a", "right_b", "right_c", "left_c", "left_b", "left_a"]


def test_names_in_changing_order_name_nothing(tmp_path: Path) -> None:
    found = select(tmp_path, "odd_msgs/msg/Limbs", ("FL", "FR", "RL", "RR"), shuffled=True)
    assert [foot.name for foot in found.possible_feet[0].feet] == [f"foot_{n}" for n in range(4)]


@pytest.mark.parametrize("labels", [("left_hand", "right_hand"), ("left_wrist", "right_wrist")])
def test_hands_that_alternate_are_no_feet(tmp_path: Path, labels: tuple[str, str]) -> None:
    assert select(tmp_path, "odd_msgs/msg/Tips", ("left_foot", "right_foot")).possible_feet
    assert not select(tmp_path, "odd_msgs/msg/Tips", labels).possible_feet


@pytest.mark.parametrize("topic", ["/wheel_loads", "/gripper/finger_force", "/drill/contacts"])
def test_tools_that_alternate_are_no_feet(tmp_path: Path, topic: str) -> None:
    found = select(tmp_path, "odd_msgs/msg/Tips", ("a", "b", "c", "d"), topic=topic)
    assert not found.possible_feet
    assert "FEET_UNSURE" not in {finding.code for finding in found.findings}


def test_the_offered_command_names_a_likely_base(tmp_path: Path) -> None:
    found = select(tmp_path, "odd_msgs/msg/Limbs", ("FL", "FR", "RL", "RR"))
    (offer,) = [each for each in found.findings if each.code == "FEET_UNSURE"]
    words = shlex.split(offer.command)
    assert words[:2] == ["dogbot-logtool", "stats"]
    assert words[3:5] == ["--odom-topic", "/state:base_pose"]
    assert words[5:7] == ["--foot", "front_left=/state:legs[0].grf"]
