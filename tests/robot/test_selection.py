"""What is used of each kind of log, and what is offered where nothing surely is.

The table is `selected.json`; ``python -m tests.robot.test_selection`` writes it anew, to be read.
"""

import json
import os
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

import dogbot_logtool as dl
from tests.oracles import base_walks, field_logs, state_walks, walks
from tests.oracles.small_logs import CONTACTS, WRENCH, write_log
from tests.oracles.state_walks import StateWalk
from tests.paths import ROOT

TABLE = Path(__file__).with_name("selected.json")
FEET = {f"/a1/{leg}_foot/wrench": WRENCH for leg in ("fl", "fr", "rl", "rr")}
SIX = range(1, 7)
CORNERS = ("front_left", "front_right", "back_left", "back_right")
Maker = Callable[[Path], object]


def mixed(*kinds: str) -> dict[str, str]:
    """Topics of feet, by type."""
    return {f"/{leg}/contact": kind for leg, kind in zip(CORNERS, kinds, strict=False)}


def makers() -> Iterator[tuple[str, Maker]]:
    """Yield names of logs and what writes them."""
    for kind in walks.KINDS:
        yield f"walk in {kind}", partial(_walk, walks.Walk, kind)
    for kind in (*state_walks.KINDS, "sensor_msgs/msg/JointState"):
        yield f"walk in {kind} of all feet", partial(_walk, StateWalk, kind)
    for kind, topic in base_walks.TOPICS.items():
        yield f"base in {kind}", partial(_base, kind, topic)
    for topic in ("/goal_pose", "/initialpose", "/object", "/base_to_footprint"):
        yield f"base on {topic}", partial(_base, "geometry_msgs/PoseStamped", topic)
    yield "poses of two robots", partial(_base, "geometry_msgs/PoseStamped", "/r1/pose", "/r2/pose")
    states = ("/xpp/state_des", "/xpp/state_curr")
    yield "planned and measured", partial(_base, "xpp_msgs/RobotStateCartesian", *states)
    yield "two odometries", partial(_base, "nav_msgs/Odometry", "/odom", "/other")
    for name, topics, more in (
        ("feet of one robot of two", FEET, {"odometry": ["/a2/odom", "/a1/odom"]}),
        ("models of two robots", FEET, {"models": {"a2_gazebo": 0.4, "a1_gazebo": 0.4}}),
        ("what moves", FEET, {"models": {"cupboard": 0.0, "laikago": 0.4, "person_x": 1.0}}),
        ("two types", mixed(WRENCH, WRENCH, CONTACTS, CONTACTS), {}),
        ("three feet", mixed(CONTACTS, CONTACTS, CONTACTS), {}),
        ("one type of all", {**mixed(CONTACTS, CONTACTS), **FEET}, {}),
        ("a drill", {"/rl_tool/drill/force": WRENCH}, {}),
        ("topics of a known robot's switches", {f"/leg_{n}/foot_contact": WRENCH for n in SIX}, {}),
    ):
        yield name, partial(write_log, topics=topics, **more)
    for kind in ("Reading", "Counts", "Touch"):
        yield f"fields in {kind}", partial(field_logs.six_feet, kind=f"odd_msgs/msg/{kind}")
    yield "three feet beside a plan of four", _beside_a_plan
    yield "cells", field_logs.four_cells_a_foot
    for topic in ("/state", "/wheel_loads", "/gripper/finger_force", "/drill/contacts"):
        yield f"wrenches on {topic}", partial(field_logs.wrenches, topic=topic)
    for legs in (4, 6):
        yield f"{legs} switches", partial(field_logs.switches, legs=legs)
    for rows in (1, 20):
        yield f"load cell of {rows}", partial(field_logs.load_cell, rows=rows)


def _walk(maker: type[walks.Walk], kind: str, path: Path) -> None:
    walk = maker(2)
    walks.write_mcap(path, walk, list(walk.messages(kind))[:900])


def _beside_a_plan(path: Path) -> None:
    walk = StateWalk(2)
    plan, feet = "xpp_msgs/msg/RobotStateCartesian", "gazebo_msgs/msg/ContactsState"
    entries = [*walk.messages(plan), *walk.messages(feet)]
    walks.write_mcap(path, walk, [each for each in entries if "back_right" not in each.topic])


def _base(kind: str, *topics_and_path: Any) -> None:
    *topics, path = topics_and_path
    base_walks.write(path, kind, *topics)


def recorded() -> Iterator[tuple[str, Path]]:
    """Yield names of recorded logs that are there."""
    for path in sorted((ROOT / "sample_logs").glob("*.*")):
        if path.suffix in {".bag", ".mcap"}:
            yield path.name, path
    for path in sorted(Path(os.environ.get("LOGTOOL_CORPUS", "none")).glob("legged/*")):
        yield path.name, path


def seen(path: Path) -> dict[str, Any]:
    """Return what is used of a log, and what is offered."""
    info = dl.info(path)
    uses = {topic.topic: topic.use for topic in info.topics if topic.use}
    offers = [each.command or each.text for each in info.findings if each.code == "FEET_UNSURE"]
    offers += [each.command or each.text for each in info.findings if each.code == "NO_BASE"]
    offers = [each.replace(f"{path}", "LOG").replace(path.stem, "LOG") for each in offers]
    codes = sorted({each.code for each in info.findings})
    return {"robot": info.robot, "uses": uses, "offers": offers, "codes": codes}


MAKERS = dict(makers())
RECORDED = dict(recorded())


def seen_of(name: str, folder: Path) -> dict[str, Any]:
    path = RECORDED.get(name, folder / "recording.mcap")
    if name in MAKERS:
        MAKERS[name](path)
    return seen(path)


@pytest.mark.parametrize("name", [*MAKERS, *RECORDED])
def test_what_is_used_and_offered(name: str, tmp_path: Path) -> None:
    assert seen_of(name, tmp_path) == json.loads(TABLE.read_text(encoding="utf-8"))[name]


def main() -> None:
    """Write the table."""
    with TemporaryDirectory() as folder:
        table = {name: seen_of(name, Path(folder)) for name in (*MAKERS, *RECORDED)}
    TABLE.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
