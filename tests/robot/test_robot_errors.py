"""An error in a robot's file names the file, the key and the line."""

import re
import tomllib
from pathlib import Path

import pytest

from dogbot_logtool.errors import CallError
from dogbot_logtool.robot.robot import load_robot, parse_robot, robot_toml
from tests.robot.test_robot import FOOT


def refused(text: str) -> str:
    """The error of a robot's file called mine.toml."""
    with pytest.raises(CallError) as caught:
        parse_robot(text, "mine.toml")
    return str(caught.value)


@pytest.mark.parametrize("name", ["dogcat", "", "DogBot", "dogbot.tom"])
def test_an_unknown_robot_is_named_and_the_known_ones_are_listed(name: str) -> None:
    for ask in (load_robot, robot_toml):
        with pytest.raises(CallError) as caught:
            ask(name)
        assert repr(name) in str(caught.value)
        assert "dogbot, generic" in str(caught.value)


@pytest.mark.parametrize("content", [b"\xff\xfe", b"name = '\x80'"])
def test_a_file_that_is_not_text_is_named(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "binary.toml"
    file.write_bytes(content)

    with pytest.raises(CallError) as caught:
        load_robot(str(file))

    assert str(file) in str(caught.value)


def test_a_directory_is_no_file(tmp_path: Path) -> None:
    folder = tmp_path / "folder.toml"
    folder.mkdir()

    with pytest.raises(CallError) as caught:
        load_robot(str(folder))

    assert str(folder) in str(caught.value)


def test_broken_toml_is_named_with_its_line() -> None:
    message = refused('name = "x"\nmass_kg = = 3\n')

    assert message.startswith("mine.toml: ")
    assert "line 2" in message


@pytest.mark.parametrize(
    ("text", "key"),
    [
        # unknown keys, at every level
        ("colour = 1", "colour"),
        ("topics.camera = '/image'", "topics.camera"),
        ("contact.on = 3", "contact.on"),
        (f"{FOOT}color = 1", "feet.left.color"),
        # wrong types
        ("name = 3", "name"),
        ("description = ['a']", "description"),
        ("topics = '/odom'", "topics"),
        ("contact = 10", "contact"),
        ("feet.left = '/left'", "feet.left"),
        ("feet.left.topic = 3", "feet.left.topic"),
        (f"{FOOT}collision = true", "feet.left.collision"),
        ("mass_kg = '21 kg'", "mass_kg"),
        ("mass_kg = true", "mass_kg"),
        # wrong values
        ("mass_kg = 0", "mass_kg"),
        ("mass_kg = nan", "mass_kg"),
        ("foot_rolling_m = -0.1", "foot_rolling_m"),
        ("forward_axis = '+z'", "forward_axis"),
        ("frames.world = ''", "frames.world"),
        ("frames.base = '/base_link'", "frames.base"),
        ("arrows.newtons_per_metre = 0", "arrows.newtons_per_metre"),
        ("contact.on_n = 0", "contact.on_n"),
        ("contact.debounce_s = nan", "contact.debounce_s"),
        ("contact.on_n = 5\ncontact.off_n = 6", "contact.off_n"),
        # feet
        ("feet.left = {}", "feet.left.topic"),
        ("feet.left.topic = ''", "feet.left.topic"),
        (f"{FOOT}place = 'front'", "feet.left.place"),
        (f"{FOOT}place = ['left', 'front']", "feet.left.place"),
        (f"{FOOT}place = ['front', 'left', 'up']", "feet.left.place"),
        (f"{FOOT}place = ['front', 3]", "feet.left.place"),
        (f"{FOOT}place = ['front', {{side = 'left'}}]", "feet.left.place"),
        (f"{FOOT}[feet.right]\ntopic = '/left'", "/left"),
    ],
)
def test_an_error_names_the_file_and_the_key(text: str, key: str) -> None:
    tomllib.loads(text)  # the fault is not one of TOML

    message = refused(text)

    assert message.startswith("mine.toml, line ")
    assert re.search(rf"(?<![\w.]){re.escape(key)}(?![\w.])", message)


PROFILE = """\
# A robot of our own.
name = "walker"
description = '''
mass_kg = "this is no key"
'''
mass_kg = 12.0

[frames]
base = "trunk"

[contact]
on_n = 20.0
off_n = 10.0

[feet.left]
topic = "/left"
place = [
    "front",
    "left",
]

[feet."right"]
topic = "/both"
element = 0

# The last one.
[feet.third]
topic = "/both"
element = 1
"""


@pytest.mark.parametrize(
    ("spoilt", "by", "key", "line"),
    [
        ("mass_kg = 12.0", "mass_kg = -12.0", "mass_kg", 6),
        ('base = "trunk"', 'base = "/trunk"', "frames.base", 9),
        ("[frames]", "[frame]", "frame", 8),
        ("off_n = 10.0", "off_n = 30.0", "contact.off_n", 13),
        ('    "front",', '    "up",', "feet.left.place", 17),
        ('topic = "/left"', "topics = 1", "feet.left.topic", 15),
        ('topic = "/left"', "topic = 1", "feet.left.topic", 16),
        ("element = 1", "element = 0", "/both", 29),
        ("element = 1", "", "/both", 28),
        ("element = 1", "elements = 1\nelement = 1", "feet.third.elements", 29),
        ("element = 1", 'element = 1\nframe = ""', "feet.third.frame", 30),
        ("element = 1", "element = 1\ncontact_point_m = [0, 0]", "feet.third.contact_point_m", 30),
        ("[frames]", "[[frames]]", "frames", 8),
        ("mass_kg = 12.0", "frames.world = 3\nmass_kg = 12.0", "frames", 9),
    ],
)
def test_a_fault_is_told_by_key_and_line(spoilt: str, by: str, key: str, line: int) -> None:
    message = refused(PROFILE.replace(spoilt, by, 1))

    assert key in message
    assert f"line {line}" in message.split(": ", 1)[1 if "TOML" in message else 0]


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ('field = "data"\nkind = "weight"', "kind"),
        ('field = "data"\nunit = "pound"', "unit"),
        ('field = "data"\nsign = "down"', "sign"),
        ('field = "data"\naxis = "w"', "axis"),
        ('field = "data"\nscale = 0', "scale"),
        ('field = "data"\nthreshold = "x"', "threshold"),
        ('kind = "force"', "kind"),
    ],
)
def test_bad_words_of_a_field_are_named_with_their_line(text: str, key: str) -> None:
    message = refused(f"{FOOT}{text}")
    assert f"feet.left.{key}" in message
    assert f"line {2 + len(text.splitlines())}" in message


# --- several feet ---------------------------------------------------------------------------------


def test_two_feet_cannot_be_one_field() -> None:
    other = FOOT.replace("feet.left", "feet.right")
    assert "a field of its own" in refused(f'{FOOT}field = "a"\n{other}field = "a"')
    assert len(parse_robot(f'{FOOT}field = "a"\n{other}field = "b"', "mine.toml").feet) == 2


ELEMENTS = '[feet.a]\ntopic = "/all"\nelement = 0\n[feet.b]\ntopic = "/all"\n'


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("element", "-1"),
        ("element", "1.5"),
        ("element", "true"),
        ("offset", "nan"),
        ("offset", '"3"'),
        ("newtons_per_count", "0"),
    ],
)
def test_bad_numbers_of_a_raw_sensor_are_told(key: str, value: str) -> None:
    assert f"feet.left.{key}" in refused(f"{FOOT}{key} = {value}")
