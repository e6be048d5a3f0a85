"""What `info` tells of logs, and that a robot's file made from a log finds the same in it."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.new_robot import new_robot
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import base_walks, state_walks, walks
from tests.oracles.state_walks import StateWalk
from tests.paths import TROT, WALK
from tests.reader.mcap_bytes import McapBytes, Message
from tests.shell import Shell


def truth(log: Path) -> dict[str, Any]:
    told: dict[str, Any] = json.loads(log.with_suffix(".truth.json").read_text(encoding="utf-8"))
    return told


@pytest.mark.parametrize("log", [TROT, WALK], ids=lambda log: log.stem)
def test_counts_times_and_types(log: Path) -> None:
    info, told = describe(log, InfoOptions()), truth(log)["log"]
    assert {topic.topic: topic.messages for topic in info.topics} == told["messages"]
    assert info.messages == sum(told["messages"].values())
    assert info.start_time == told["first_log_time_ns"]
    duration_s = (told["last_log_time_ns"] - told["first_log_time_ns"]) / 1e9
    assert info.duration_s == pytest.approx(duration_s, abs=1e-9)
    for topic in info.topics:
        rate = None if topic.messages < 10 else pytest.approx(topic.messages / duration_s)
        assert topic.rate_hz == rate
        assert topic.senders == 1
        assert topic.encoding == ("ros1" if log == TROT else "cdr")
    assert info.size == log.stat().st_size
    assert info.damage.losses == ()
    assert info.robot == "dogbot"


def test_logs_of_no_message_and_of_one(shell: Shell) -> None:
    start = Message(1, 1_700_000_000_000_000_000, b"")
    for name, log in (("empty", McapBytes([], topics={})), ("one", McapBytes([[start]]))):
        (shell.folder / name).write_bytes(log.build())
    empty, one = shell("info", "empty", "one", "--json", "--jobs", 1).json
    assert (empty["messages"], empty["start_time_ns"], empty["duration_s"]) == (0, None, None)
    assert (empty["topics"], empty["frames"]["added"], empty["damage"]["text"]) == ([], None, None)
    assert (one["messages"], one["duration_s"], one["topics"][0]["rate_hz"]) == (1, 0.0, None)
    assert "messages     0\n" in shell("info", "empty").out
    assert "2023-11-14 22:13:20 UTC" in shell("info", "one").out


# --- A robot's file -------------------------------------------------------------------------------


def found_alike(path: Path, part: str) -> Any:
    """A part of the figures of a log, which are the same with a robot's file made from it."""
    file = path.with_name("robot.toml")
    file.write_text(new_robot(path, "walker", MeasureOptions()).text, encoding="utf-8")
    measured = (measure(path, MeasureOptions(robot=robot)) for robot in (None, str(file)))
    without, with_file = (stats_json(each)[part] for each in measured)
    assert with_file == without
    return with_file


def every_third_is_quick(kinds: Iterable[str]) -> list[Any]:
    """They go one way; that each is read, the reader's tests tell of all."""
    slow = pytest.mark.slow
    return [pytest.param(kind, marks=[slow] * bool(n % 3)) for n, kind in enumerate(kinds)]


@pytest.mark.parametrize("kind", every_third_is_quick(state_walks.KINDS))
def test_the_file_has_the_feet_of_messages_of_all_feet(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "walk.mcap"
    entries = [*StateWalk(2).messages(kind)]
    walks.write_mcap(path, StateWalk(2), entries[: len(entries) // 2])
    assert len(found_alike(path, "feet")) > 1


@pytest.mark.parametrize(
    "kind", every_third_is_quick(sorted({*base_walks.TOPICS} - {*base_walks.ON_REQUEST}))
)
def test_the_file_has_the_base_s_poses(tmp_path: Path, kind: str) -> None:
    path = base_walks.write(tmp_path / "walk.mcap", kind, base_walks.TOPICS[kind])
    assert found_alike(path, "base")["path_length_m"] > 1.0
