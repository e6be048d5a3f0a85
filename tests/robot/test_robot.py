"""Robots' files: those that come along are sound, every key is read, errors name their place."""

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.toml_table import declared_fields, toml_values
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.robot.robot import Robot, known_robots, load_robot, parse_robot, robot_toml

FOOT = '[feet.left]\ntopic = "/left"\n'
WORDS = ("-x", "link", "log", "none", "kN", "force", "-", "word")
VALUES = (2.5, 3, *WORDS, [0.5, 0.0, -1.0], ["front", "left"])
"""No default of a field, and every field takes one of them."""


def filled(record: type, prefix: str = "") -> dict[str, Any]:
    """Return a value for every key that a file may have for a record."""
    kinds = {prefix + key: kind for _, kind, key in declared_fields(record)}
    return {key: next(filter(kind.is_right, VALUES)) for key, kind in kinds.items()}


def test_every_key_is_written_and_read() -> None:
    given = filled(Robot) | filled(Foot, "feet.one.") | filled(FootField, "feet.one.")
    text = "\n".join(f"{key} = {json.dumps(value)}" for key, value in given.items())
    robot = parse_robot(text, "mine.toml")
    (foot,) = robot.feet
    assert foot.field is not None
    written: dict[str, str] = {}
    for record, prefix in ((robot, ""), (foot, "feet.one."), (foot.field, "feet.one.")):
        written |= {prefix + key: text for key, text in toml_values(record).items()}
    assert {key: tomllib.loads(f"x = {text}")["x"] for key, text in written.items()} == given


@pytest.mark.parametrize("name", known_robots())
def test_known_robots_load_under_their_own_name_and_can_be_copied(
    name: str, tmp_path: Path
) -> None:
    robot, copy = load_robot(name), tmp_path / "copy.toml"
    copy.write_text(robot_toml(name), encoding="utf-8")
    assert load_robot(str(copy)) == robot
    assert robot.name == name
    assert robot.description
    # Which of them may fit a log is seen before any is parsed.
    assert all(topic in robot_toml(name) for topic in robot.topics)
    if name.startswith("unitree") and "state" not in name:
        elements = {foot.name: foot.element for foot in robot.feet}
        assert elements == {"front_right": 0, "front_left": 1, "back_right": 2, "back_left": 3}


@pytest.mark.parametrize("content", [None, b"\xff\xfe", b"name = '\x80'"])
def test_a_file_that_is_none_or_no_text_is_named(tmp_path: Path, content: bytes | None) -> None:
    file = tmp_path / "binary.toml"
    file.write_bytes(content) if content else file.mkdir()
    with pytest.raises(CallError, match=re.escape(str(file))):
        load_robot(str(file))


def refused(text: str) -> str:
    """The error of a robot's file called mine.toml."""
    with pytest.raises(CallError, match=r"^mine\.toml") as caught:
        parse_robot(text, "mine.toml")
    return str(caught.value)


WRONG = """
colour = 1 | colour
contact.on = 3 | contact.on
FOOT color = 1 | feet.left.color
name = 3 | name
contact = 10 | contact
feet.left.topic = 3 | feet.left.topic
mass_kg = '21 kg' | mass_kg
mass_kg = 0 | mass_kg
mass_kg = nan | mass_kg
foot_rolling_m = -0.1 | foot_rolling_m
forward_axis = '+z' | forward_axis
frames.base = '/base_link' | frames.base
contact.debounce_s = nan | contact.debounce_s
contact = {on_n = 5, off_n = 6} | contact.off_n
feet.left = {} | feet.left.topic
feet.left.topic = '' | feet.left.topic
FOOT place = 'front' | feet.left.place
FOOT place = ['front', 'left', 'up'] | feet.left.place
FOOT place = ['front', {side = 'left'}] | feet.left.place
FOOT element = -1 | feet.left.element
FOOT offset = nan | feet.left.offset
FOOT newtons_per_count = 0 | feet.left.newtons_per_count
FOOT kind = "force" | feet.left.kind
FIELD kind = "weight" | feet.left.kind
FIELD unit = "pound" | feet.left.unit
FIELD sign = "down" | feet.left.sign
FIELD axis = "w" | feet.left.axis
FIELD scale = 0 | feet.left.scale
FIELD threshold = "x" | feet.left.threshold
"""


@pytest.mark.parametrize("row", WRONG.strip().splitlines())
def test_an_error_names_the_file_and_the_key(row: str) -> None:
    text, _, key = row.rpartition(" | ")
    text = text.replace("FIELD ", f'{FOOT}field = "data"\n').replace("FOOT ", FOOT)
    tomllib.loads(text)  # the fault is not one of TOML
    message = refused(text)
    assert re.search(rf"(?<![\w.]){re.escape(key)}(?![\w.])", message)
    assert message.startswith("mine.toml: ")
