"""Feet as fields of messages of any type, as a user meets them."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests import forked_cli
from tests.forked_cli import command
from tests.oracles import walks
from tests.oracles.definitions import CELLS
from tests.oracles.field_logs import (
    DUTY,
    PERIOD_S,
    WEIGHT_N,
    four_cells_a_foot,
    is_down,
    load_n,
    six_feet,
    six_feet_in_two,
    write,
)
from tests.paths import ROOT

STATE = "odd_msgs/msg/State"
Samples = Iterator[tuple[str, str, dict[str, Any]]]
"""Topics, types and fields of the messages at a time."""


def figures(*words: object, folder: Path = ROOT) -> dict[str, Any]:
    done = forked_cli.run("stats", *words, "--json", "-v", folder=folder)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def as_offered(log: Path) -> tuple[str, list[str], dict[str, Any]]:
    """Type the command that `info` offers, and then that of the robot's file, if it writes one."""
    shown = forked_cli.run("info", log, folder=log.parent, environment={"COLUMNS": "400"}).stdout
    words = command(shown)
    if words[0] == "robots":
        words = command(forked_cli.run(*words, folder=log.parent).stderr)
    return shown, words, figures(*words[1:], folder=log.parent)


def check_steps(found: dict[str, Any], feet: int = 6) -> None:
    """Compare with what the walk was made of."""
    assert len(found["feet"]) == feet
    for foot in found["feet"].values():
        assert foot["stance_s"]["median"] == pytest.approx(DUTY * PERIOD_S, abs=0.011)
        assert foot["stride_period_s"]["median"] == pytest.approx(PERIOD_S, abs=0.011)
        assert foot["contact_fraction"] == pytest.approx(DUTY, abs=0.01)


@pytest.mark.parametrize("kind", ["Reading", "Touch", "Counts"])
def test_six_feet_on_unusual_topics(kind: str, tmp_path: Path) -> None:
    """Counts may be contacts or forces, which only a robot's file can say."""
    log = six_feet(tmp_path / "crawl.mcap", f"odd_msgs/msg/{kind}")
    shown, words, found = as_offered(log)
    assert ("--robot" in words) == (kind == "Counts")
    assert "put front_left, back_right ... for" in shown
    check_steps(found)
    touchdowns = [foot["touchdown_s"][1] % PERIOD_S for foot in found["feet"].values()]
    assert touchdowns == pytest.approx(touchdowns[:2] * 3, abs=0.011)
    assert abs(touchdowns[0] - touchdowns[1]) == pytest.approx(PERIOD_S / 2.0, abs=0.011)
    if kind != "Touch":
        loads = [foot["mean_force_n"]["median"] for foot in found["feet"].values()]
        down = np.mean([sum(is_down(t, f) for f in range(6)) for t in np.arange(0.0, 1.0, 0.01)])
        assert sum(loads) == pytest.approx(WEIGHT_N * 6 / down, rel=0.1)


@pytest.fixture(scope="module")
def states(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One message of all feet: arrays of messages, of numbers, and wrenches."""
    walk = walks.Walk(2)

    def samples(time_s: float) -> Samples:
        loads = [load_n(time_s, foot) for foot in range(6)]
        legs = [
            {
                "name": "x" * foot,
                "counts": int(load * 10) + 7,
                "force": (0.0, 0.0, -load),
                "cells": [0.0] * foot + [load / 9.80665],
            }
            for foot, load in enumerate(loads)
        ]
        fields = {
            "header": walk.header(round(time_s * 100), "world"),
            "legs": legs,
            "loads": loads[:4],
            "flags": [load > 0 for load in loads],
            "left": walk.wrench((0, 0, loads[0])),
            "right": walk.wrench((0, 0, loads[1])),
        }
        yield "/state", STATE, fields

    return write(tmp_path_factory.mktemp("states") / "states.mcap", samples)


def loads_of(path: Path, *keys: str, feet: int = 6) -> dict[str, Any]:
    """Measure with a robot's file whose feet have these keys; ``#`` is the foot's number."""
    text = "".join(
        f'[feet.f{foot}]\ntopic = "/state"\n' + "\n".join(keys).replace("#", str(foot)) + "\n"
        for foot in range(feet)
    )
    file = path.with_name("robot.toml")
    file.write_text(text, encoding="utf-8")
    return figures(path, "--robot", file, "--set", "clock=log")


@pytest.mark.parametrize(
    ("keys", "has_force"),
    [
        (('field = "legs[#].force"',), True),
        (('field = "legs[#].force"', 'axis = "-z"'), True),
        (('field = "legs[#].force.z"', 'sign = "-"'), True),
        (('field = "legs[#].cells[#]"', 'unit = "kg"'), True),
        (('field = "legs[#].counts"', 'kind = "force"', "offset = 7", "scale = 0.1"), True),
        (('field = "legs[#].counts"', "threshold = 8"), False),
        (('field = "flags[#]"',), False),
    ],
)
def test_fields_become_the_loads_they_are(
    states: Path, keys: tuple[str, ...], *, has_force: bool
) -> None:
    found = loads_of(states, *keys)
    check_steps(found)
    for foot in found["feet"].values():
        if has_force:
            # Alone on three feet, or with all six down.
            assert foot["peak_force_n"]["median"] == pytest.approx(WEIGHT_N / 3, rel=0.02)
        else:
            assert foot["peak_force_n"] is None


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("/state:legs[0].forces", "nearest are legs[].force (geometry_msgs/Vector3)"),
        ("/stat:left.force", "did you mean /state?"),
        ("/state", "A field of its messages can be named: left=/state:FIELD"),
        ("/state:left.force", "needs a topic or a field of its own"),
    ],
)
def test_a_wrong_path_lists_what_there_is(states: Path, word: str, expected: str) -> None:
    feet = ("left", "right") if "own" in expected else ("left",)
    words = [text for foot in feet for text in ("--foot", f"{foot}={word}")]
    done = forked_cli.run("stats", states, *words)
    assert done.returncode == 2
    assert expected in " ".join(done.stderr.split())


LEGS = ("LF", "RF", "LH", "RH")
TURNS = dict(zip(LEGS, (0, 1, 1, 0), strict=True))
INSIDE = {
    "odd_msgs/msg/Bits": ("/status", [f"foot_contacts&{1 << n}" for n in range(4)]),
    "odd_msgs/msg/Pads": ("/pads", [f"pads[{n}].load" for n in range(4)]),
    "odd_msgs/msg/Pressures": ("/soles", [f"{leg}_foot" for leg in LEGS]),
    "std_msgs/msg/Float64MultiArray": ("/feet/forces", [f"data[{n}]" for n in range(4)]),
}


def inside(kind: str, time_s: float, loads: list[float]) -> dict[str, Any]:
    """Return the fields of a message that tells of four feet, and of something else."""
    feet = [f"{leg}_foot" for leg in LEGS]
    fields: dict[str, dict[str, Any]] = {
        "Bits": {
            "foot_contacts": sum(1 << n for n, load in enumerate(loads) if load) - 128,
            "battery": 50.0 - time_s,
            "contact_number": round(time_s * 100),
        },
        "Pressures": dict(zip(feet, loads, strict=True)),
        "Pads": {"pads": list(zip(feet, loads, strict=True))},
        "Float64MultiArray": {"data": loads},
    }
    return fields[kind.rpartition("/")[2]]


def walk_in(kind: str, path: Path, unloaded: float = 0.0) -> Path:
    """Write a trot in messages of a kind; what a foot reads without load may not be zero."""

    def samples(time_s: float) -> Samples:
        down = {leg: is_down(time_s, turn) for leg, turn in TURNS.items()}
        loads = [unloaded + WEIGHT_N / sum(down.values()) * down[leg] for leg in LEGS]
        yield INSIDE[kind][0], kind, inside(kind, time_s, loads)

    return write(path, samples)


@pytest.mark.parametrize("kind", INSIDE)
def test_feet_inside_one_message(tmp_path: Path, kind: str) -> None:
    shown, words, found = as_offered(walk_in(kind, tmp_path / "walk.mcap"))
    assert "contact_number" not in shown
    paths = [word.partition(":")[2] for word in words if ":" in word]
    assert "--robot" in words or paths == INSIDE[kind][1]
    check_steps(found, 4)
    assert found["gait"]["name"] == ("trot" if kind.endswith("Pressures") else None)


def test_pressures_of_air_are_no_forces(tmp_path: Path) -> None:
    path = walk_in("odd_msgs/msg/Pressures", tmp_path / "walk.mcap", 101_325.0)
    assert "--foot" not in forked_cli.run("info", path).stdout


def test_a_robot_of_two_files_that_are_one_recording(tmp_path: Path) -> None:
    files = six_feet_in_two(tmp_path)
    alone = forked_cli.run("robots", "new", *files)
    assert alone.returncode == 2
    assert "--join" in alone.stderr
    done = forked_cli.run("robots", "new", *files, "--join", "-o", tmp_path / "crawler.toml")
    words = command(done.stderr)
    assert words[:4] == ["stats", *map(str, files), "--join"]
    check_steps(figures(*words[1:]))


def test_cells_of_a_foot_are_its_sensors(tmp_path: Path) -> None:
    """A file names each of them, and their forces add up."""
    _, _, found = as_offered(four_cells_a_foot(tmp_path / "walk.mcap"))
    check_steps(found, 2)
    assert list(found["feet"]) == ["left", "right"]
    told = [each["text"] for each in found["findings"] if "several sensors" in each["text"]]
    for side in ("left", "right"):
        cells = " + ".join(f"/fsr:{cell}" for cell in sorted(CELLS) if cell[0] == side[0])
        assert f"{side} = {cells}" in told[0]
        foot = found["feet"][side]
        assert foot["peak_force_n"]["median"] == pytest.approx(WEIGHT_N / 3, rel=0.01)
