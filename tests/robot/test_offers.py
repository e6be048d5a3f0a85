"""Feet as a user meets them: found, or offered with a command that can be typed as it stands."""

import json
import shlex
from pathlib import Path

import pytest

from tests import forked_cli
from tests.forked_cli import Ended
from tests.oracles.foot_logs import CONTACTS, WRENCH, write_log

SIDES = ("left", "right")
SENSORS = {f"/{side} {part}/wrench": WRENCH for side in SIDES for part in ("toe y", "toe x")}
CORNERS = ("front_left", "front_right", "back_left", "back_right")


def run(*words: object, columns: int = 80) -> Ended:
    return forked_cli.run(*words, environment={"COLUMNS": str(columns)})


def command(printed: str) -> list[str]:
    """The words after the program's name of the one command that was printed in one piece."""
    lines = [line for line in printed.splitlines() if line.lstrip().startswith("dogbot-logtool ")]
    assert len(lines) == 1
    return shlex.split(lines[0])[1:]


@pytest.fixture
def sensors(tmp_path: Path) -> Path:
    """Two sensors on each of two feet, and odometry."""
    (tmp_path / "a folder").mkdir()
    path = tmp_path / "a folder" / "it's.mcap"
    return write_log(path, SENSORS, odometry=["/odom"], samples=400)


def test_the_offered_command_can_be_typed(sensors: Path) -> None:
    told = run("stats", sensors)
    assert "Gait: not measured (no topic of feet)" in told.stdout
    done = run(*command(told.stdout), "--json", "-v")
    figures = json.loads(done.stdout)
    feet = {name: foot["topic"] for name, foot in figures["settings"]["feet"].items()}
    assert feet == {side: f"/{side} toe x/wrench" for side in SIDES}
    assert all(foot["touchdown_s"] for foot in figures["feet"].values())


@pytest.mark.parametrize("name", ["stats", "convert", "layout", "report", "stats --figure x.svg"])
def test_the_errors_offer_feet(tmp_path: Path, name: str) -> None:
    log = write_log(tmp_path / "walk.mcap", SENSORS)
    first, *words = name.split()
    done = run(first, log, *(tmp_path / word if "." in word else word for word in words))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("error: ")
    assert command(done.stderr)[:2] == ["stats", str(log)]
    assert sorted(tmp_path.iterdir()) == [log]


def test_a_trot_under_a_controller_called_rl_is_a_trot(tmp_path: Path) -> None:
    order = ("front_left", "front_right", "back_right", "back_left")
    topics = {f"/rl_controller/{leg}/contact": CONTACTS for leg in order}
    log = write_log(tmp_path / "walk.mcap", topics, odometry=["/odom"], samples=500)
    figures = json.loads(run("stats", log, "--json").stdout)
    assert list(figures["feet"]) == list(CORNERS)
    assert figures["gait"]["name"] == "trot"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ["--foot", "nose=/left toe y/wrench", "--robot", "dogbot"],
            "no such foot; it has front_",
        ),
        (
            ["--foot", "a=/left toe y/wrench", "--foot", "a=/left toe x/wrench"],
            "--foot a: is given",
        ),
        (
            ["--foot", "a=/left toe y/wrench", "--foot", "a=/left toe y/wrench"],
            "--foot a: is given",
        ),
        (["--foot", "a=/left toe y/wrench", "--foot", "b=/left toe y/wrench"], "topic of a, b"),
        (["--foot", "a=/left_toe_y/wrench"], "did you mean /left toe y/wrench"),
        (["--foot", "a=/odom"], "is of type nav_msgs/Odometry"),
        (["--odom-topic", "odom"], "did you mean /odom?"),
    ],
)
@pytest.mark.parametrize("name", ["info", "stats", "layout"])
def test_topics_that_do_not_fit(sensors: Path, name: str, words: list[str], said: str) -> None:
    done = run(name, sensors, *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert said in " ".join(done.stderr.split())


def test_a_layout_without_a_log_has_the_given_feet() -> None:
    assert run("layout", "--robot", "dogbot", "--foot", "nose=/x").returncode == 2
    done = run("layout", "--foot", "left=/x", "--foot", "right=/y")
    panels = json.loads(done.stdout)["configById"]
    curves = [panel["paths"] for name, panel in panels.items() if name.startswith("Plot!load")]
    assert [paths[0]["label"] for paths in curves] == ["left", "right"]


@pytest.mark.parametrize("name", ["info", "stats"])
def test_a_robot_of_which_the_log_has_nothing(sensors: Path, name: str) -> None:
    done = run(name, sensors, "--robot", "dogbot", columns=500)
    assert done.returncode == 0
    assert "the log has none of the topics of the robot 'dogbot'" in done.stdout
