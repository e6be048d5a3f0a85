"""A robot's file from a log finds in it what was found without the file."""

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.new_robot import new_robot
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import base_walks, state_walks, walks
from tests.oracles.state_walks import StateWalk


def figures(path: Path, topics: MeasureOptions) -> dict[str, Any]:
    done = measure(path, topics)
    return stats_json(done)


def figures_with_file(path: Path, odometry_topic: str | None = None) -> dict[str, Any]:
    file = path.with_name("robot.toml")
    text = new_robot(path, "walker", MeasureOptions(odom_topic=odometry_topic)).text
    file.write_text(text, encoding="utf-8")
    return figures(path, MeasureOptions(robot=str(file)))


def every_third_is_quick(kinds: Iterable[str]) -> list[Any]:
    """They go one way; that each is read, the reader's tests tell of all."""
    slow = pytest.mark.slow
    return [pytest.param(kind, marks=[slow] * bool(n % 3)) for n, kind in enumerate(kinds)]


@pytest.mark.parametrize("kind", every_third_is_quick(state_walks.KINDS))
def test_the_file_has_the_feet_of_messages_of_all_feet(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "walk.mcap"
    entries = state_walks.messages(kind)
    walks.write_mcap(path, StateWalk(2), entries[: len(entries) // 2])
    without, with_file = figures(path, MeasureOptions()), figures_with_file(path)
    assert with_file["feet"] == without["feet"]
    assert len(with_file["feet"]) > 1


@pytest.mark.parametrize(
    "kind", every_third_is_quick(sorted({*base_walks.TOPICS} - {*base_walks.ON_REQUEST}))
)
def test_the_file_has_the_base_s_poses(tmp_path: Path, kind: str) -> None:
    path = base_walks.write(tmp_path / "walk.mcap", kind, base_walks.TOPICS[kind])
    without, with_file = figures(path, MeasureOptions()), figures_with_file(path)
    assert with_file["base"] == without["base"]
    assert with_file["base"]["path_length_m"] > 1.0


def test_the_file_has_what_messages_call_the_feet(tmp_path: Path) -> None:
    walk = StateWalk(2)
    path = tmp_path / "walk.mcap"
    walks.write_mcap(path, walk, state_walks.messages("anymal_msgs/msg/AnymalState"))
    text = new_robot(path, "walker", MeasureOptions()).text
    labels = {foot["label"] for foot in tomllib.loads(text)["feet"].values()}
    assert labels == {"LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT"}
