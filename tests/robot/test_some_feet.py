"""Feet of which one type of messages tells some only, or of which some were not recorded."""

from pathlib import Path

import pytest

import dogbot_logtool as dl
from tests import forked_cli
from tests.oracles.foot_logs import CONTACTS, WRENCH, write_log

CORNERS = ("front_left", "front_right", "back_left", "back_right")


def feet_of(path: Path) -> dict[str, str]:
    return {
        name: foot["topic"] for name, foot in dl.measure(path).stats["settings"]["feet"].items()
    }


def logged(folder: Path, kinds: dict[str, str]) -> Path:
    topics = {f"/{name}/contact": kind for name, kind in kinds.items()}
    return write_log(folder / "log.mcap", topics, odometry=["/odom"], samples=200)


@pytest.mark.parametrize("fore", [WRENCH, CONTACTS])
def test_two_types_tell_of_two_pairs(fore: str, tmp_path: Path) -> None:
    hind = CONTACTS if fore == WRENCH else WRENCH
    path = logged(tmp_path, dict(zip(CORNERS, (fore, fore, hind, hind), strict=True)))
    assert feet_of(path) == {name: f"/{name}/contact" for name in CORNERS}


def test_a_type_that_tells_of_all_feet_comes_first(tmp_path: Path) -> None:
    topics = {f"/{name}/contact": CONTACTS for name in CORNERS[:2]}
    topics |= {f"/{name}_foot/wrench": WRENCH for name in CORNERS}
    path = write_log(tmp_path / "log.mcap", topics, odometry=["/odom"], samples=200)
    assert feet_of(path) == {name: f"/{name}_foot/wrench" for name in CORNERS}


def test_a_foot_that_was_not_recorded_is_one_of_the_robot(tmp_path: Path) -> None:
    path = logged(tmp_path, dict.fromkeys(CORNERS[:3], CONTACTS))
    found = dl.measure(path).stats
    assert list(found["feet"]) == list(CORNERS)
    assert found["settings"]["feet"]["back_right"]["topic"] is None
    assert found["gait"]["support"] is None
    assert found["forces"]["load_share"]["feet"] is None
    assert {"NO_MESSAGES"} <= {each["code"] for each in found["findings"]}


def test_a_drafted_robot_file_leaves_its_topic_out(tmp_path: Path) -> None:
    path = logged(tmp_path, dict.fromkeys(CORNERS[:3], CONTACTS))
    done = forked_cli.run("robots", "new", path)
    assert done.returncode == 0, done.stderr
    assert "# [feet.back_right]\n# topic =" in done.stdout
    (tmp_path / "robot.toml").write_text(done.stdout)
    assert list(dl.measure(path, robot=str(tmp_path / "robot.toml")).stats["feet"]) == list(
        CORNERS[:3]
    )


@pytest.mark.parametrize("says", ["file", "options"])
def test_feet_that_the_user_leaves_out_are_missing(says: str, tmp_path: Path) -> None:
    """What rests on all feet is not known, and the words that add one are said."""
    path = logged(tmp_path, dict.fromkeys(CORNERS, CONTACTS))
    topics = {name: f"/{name}/contact" for name in CORNERS[:3]}
    if says == "file":
        robot = tmp_path / "three.toml"
        feet = (f'[feet.{name}]\ntopic = "{topic}"\n' for name, topic in topics.items())
        robot.write_text('name = "three"\n' + "".join(feet))
        found = dl.measure(path, robot=str(robot)).stats
    else:
        found = dl.measure(path, foot=topics).stats
    used = {name: foot["topic"] for name, foot in found["settings"]["feet"].items()}
    assert used == topics | {"back_right": None}
    assert found["gait"]["support"] is None
    assert found["forces"]["load_share"]["feet"] is None
    missing = [each["text"] for each in found["findings"] if each["code"] == "NO_MESSAGES"]
    assert any("--foot back_right=/back_right/contact" in text for text in missing)


def test_hands_are_no_feet_that_were_left_out(tmp_path: Path) -> None:
    topics = {
        f"/{side}_{limb}/wrench": WRENCH for side in ("left", "right") for limb in ("foot", "hand")
    }
    path = write_log(tmp_path / "log.mcap", topics, odometry=["/odom"], samples=200)
    feet = {side: f"/{side}_foot/wrench" for side in ("left", "right")}
    found = dl.measure(path, foot=feet).stats
    assert list(found["feet"]) == ["left", "right"]
    assert "NO_MESSAGES" not in {each["code"] for each in found["findings"]}
