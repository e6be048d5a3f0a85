"""Options about topics and fields: what they choose, and what is said of those that do not fit."""

import json
from contextlib import closing
from pathlib import Path

import pytest

import dogbot_logtool as dl
from dogbot_logtool.options import RobotOptions
from dogbot_logtool.robot.recorded import open_recorded
from dogbot_logtool.robot.selection import Selection, select_topics
from tests import forked_cli
from tests.forked_cli import Ended, command
from tests.oracles.small_logs import CONTACTS, WRENCH, write_log

LEGS = ("front_left", "front_right", "back_left", "back_right")
DOGBOT = {f"/dogbot/{leg}_contactsensor_state": CONTACTS for leg in LEGS}
SPARE = {f"/spare/{number}": CONTACTS for number in range(4)}
SENSORS = {
    f"/{side} {at}/wrench": WRENCH for side in ("left", "right") for at in ("toe y", "toe x")
}


def selected(path: Path, options: RobotOptions, **topics: str) -> Selection:
    feet, models = topics or DOGBOT | SPARE, {"a": 0.0, "b": 0.1}
    write_log(path, feet, odometry=["/dogbot/odom", "/x"], models=models)
    with closing(open_recorded(path)) as log:
        return select_topics(log, options)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "log.mcap"


def test_a_robot_of_which_the_log_has_nothing(path: Path) -> None:
    found = selected(path, RobotOptions(robot="anymal"), **SPARE)
    assert any("none of the topics of the robot 'anymal'" in each.text for each in found.findings)
    named = selected(path, RobotOptions(robot="anymal", odom_topic="/x"), **SPARE)
    assert "ROBOT_GUESSED" not in {each.code for each in named.findings}


# What is offered in a terminal


def run(*words: object) -> Ended:
    return forked_cli.run(*words, environment={"COLUMNS": "80"})


@pytest.mark.parametrize("name", ["stats", "convert", "layout", "report", "stats --figure x.svg"])
def test_the_errors_offer_feet_by_a_command_that_can_be_typed(tmp_path: Path, name: str) -> None:
    log = write_log(tmp_path / "it's a walk.mcap", SENSORS, samples=400)
    first, *words = name.split()
    done = run(first, log, *(tmp_path / word if "." in word else word for word in words))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("error: ")
    assert sorted(tmp_path.iterdir()) == [log]
    offered = command(done.stderr)
    assert offered[:2] == ["stats", str(log)]
    figures = json.loads(run(*offered, "--json", "-v").stdout)
    feet = {name: foot["topic"] for name, foot in figures["settings"]["feet"].items()}
    assert feet == {side: f"/{side} toe x/wrench" for side in ("left", "right")}
    assert all(foot["touchdown_s"] for foot in figures["feet"].values())


def test_a_gait_without_feet_is_not_measured(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.mcap", {}, odometry=["/odom"])
    assert "Gait: not measured (no topic of feet)" in run("stats", log).stdout


# Some of the feet only


def logged(folder: Path, kinds: dict[str, str]) -> Path:
    topics = {f"/{name}/contact": kind for name, kind in kinds.items()}
    return write_log(folder / "log.mcap", topics, odometry=["/odom"], samples=200)


@pytest.mark.parametrize("says", ["log", "file", "options"])
def test_a_foot_that_is_missing_is_one_of_the_robot(says: str, tmp_path: Path) -> None:
    """What rests on all feet is not known, and the words that add one are said."""
    path = logged(tmp_path, dict.fromkeys(LEGS[: 3 if says == "log" else 4], CONTACTS))
    topics = {name: f"/{name}/contact" for name in LEGS[:3]}
    file = tmp_path / "three.toml"
    feet = (f'[feet.{name}]\ntopic = "{topic}"\n' for name, topic in topics.items())
    file.write_text('name = "three"\n' + "".join(feet))
    robot, foot = (str(file) if says == "file" else None), (topics if says == "options" else None)
    found = dl.measure(path, robot=robot, foot=foot).stats
    used = {name: foot["topic"] for name, foot in found["settings"]["feet"].items()}
    assert used == topics | {"back_right": None}
    assert found["gait"]["support"] is None
    assert found["forces"]["load_share"]["feet"] is None
    missing = [each["text"] for each in found["findings"] if each["code"] == "NO_MESSAGES"]
    said = "foot back_right" if says == "log" else "--foot back_right=/back_right/contact"
    assert any(said in text for text in missing)
    if says == "log":
        done = run("robots", "new", path)
        assert "# [feet.back_right]\n# topic =" in done.stdout
        file.write_text(done.stdout)
        assert list(dl.measure(path, robot=str(file)).stats["feet"]) == list(LEGS[:3])
