"""What a quick look into a log shows, against the truth of the sample logs."""

import json
from itertools import pairwise
from typing import Any

import pytest

from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.options import TopicOptions
from dogbot_logtool.robot.probe import Probe
from dogbot_logtool.robot.topics.selection import select_topics
from tests.paths import SAMPLE_LOGS
from tests.probes import probe_log

LOGS = ("dogbot_trot.bag", "dogbot_walk.mcap", "dogbot_troubled.bag")


def look(name: str, options: TopicOptions | None = None) -> Probe:
    log = open_log(SAMPLE_LOGS / name)
    try:
        return probe_log(log, select_topics(log, options or TopicOptions()))
    finally:
        log.close()


def truth(name: str) -> dict[str, Any]:
    path = (SAMPLE_LOGS / name).with_suffix(".truth.json")
    told: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return told


@pytest.mark.parametrize("name", LOGS)
def test_the_wrench_frame_is_recognised(name: str) -> None:
    seen = look(name).wrench_frame
    assert seen.frame == WrenchFrame(truth(name)["forces"]["wrench_frame"])
    assert seen.samples >= 20
    assert seen.world is not None
    assert 0 <= seen.world.alignment <= 1


@pytest.mark.parametrize("name", LOGS)
def test_frames_are_those_of_the_odometry(name: str) -> None:
    told, seen = truth(name)["log"], look(name)
    assert seen.world_frames == (told["world_frame_id"],)
    assert seen.base_frames == (told["base_frame_id"],)
    slashed = (told["world_frame_id"],) if told["world_frame_id"].startswith("/") else ()
    assert seen.slashed_frames == slashed


@pytest.mark.parametrize("name", LOGS)
def test_zero_stamps_are_seen(name: str) -> None:
    zero = look(name).zero_stamps
    if not truth(name)["damage"] or not truth(name)["damage"].get("zero_stamps"):
        assert zero == frozenset()
    else:
        used = {t for t in truth(name)["log"]["messages"] if "contact" in t or "odom" in t}
        assert zero == used


@pytest.mark.parametrize("name", LOGS)
def test_parents_are_those_of_the_legs(name: str) -> None:
    parents = look(name).parents
    for foot in ("front_left", "front_right", "back_left", "back_right"):
        chain = [
            "base_link",
            *(f"{foot}_{part}" for part in ("hip", "upperleg", "lowerleg", "foot")),
        ]
        for parent, child in pairwise(chain):
            assert parents[child] == {parent}
        assert parents[f"{foot}_sole"] == {f"{foot}_lowerleg"}
    assert len(parents) == 20


def test_without_feet_the_wrench_frame_is_unknown() -> None:
    log = open_log(SAMPLE_LOGS / "dogbot_trot.bag")
    try:
        selection = select_topics(log, TopicOptions())
        bare = probe_log(log, type(selection)(selection.robot, (), (), {}, (), ()))
    finally:
        log.close()
    assert bare.wrench_frame.frame is WrenchFrame.UNKNOWN
    assert bare.wrench_frame.world is None
    assert (bare.world_frames, bare.base_frames, bare.parents) == ((), (), {})
    assert bare.zero_stamps == frozenset()
