"""Paths to fields: what they accept, and which bytes they read."""

import re

import pytest

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.definition import Struct, parse_definition
from dogbot_logtool.reader.decode.field_path import (
    parse_field_path,
    readable_fields,
)

DEFINITION = """\
Leg[] legs
float64[4] loads
float32[] cells
bool down
string name
================================================================================
MSG: odd/Leg
geometry_msgs/Vector3 force
geometry_msgs/Quaternion turn
uint8[2] flags
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
"""


@pytest.fixture(scope="module")
def state() -> Struct:
    return parse_definition("odd/State", DEFINITION, "ros2msg")


@pytest.mark.parametrize(
    ("path", "width", "is_integer"),
    [
        ("down", 1, True),
        ("loads[3]", 1, False),
        ("cells[70]", 1, False),
        ("legs[2].force", 3, False),
        ("legs[2].force.z", 1, False),
        ("legs[0].flags[1]", 1, True),
        ("legs[0].turn.w", 1, False),
        ("legs[0].flags[1]&4", 1, True),
        ("down&0x1", 1, True),
    ],
)
def test_paths_that_fit(state: Struct, path: str, width: int, *, is_integer: bool) -> None:
    found = parse_field_path(state, path)
    assert (found.width, found.is_integer) == (width, is_integer)


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("up", "it has"),
        ("dawn", "nearest are down (bool)"),
        ("name", "it has legs[].force"),
        ("legs[0].turn", "nearest are legs[].turn.x"),
        ("legs.force", "nearest are legs[].force"),
        ("loads[4]", "at least 5 numbers"),
        ("legs[0].flags", "nearest are legs[].flags[] (uint8)"),
        ("down[0]", "nearest are down (bool)"),
        ("", "is no path"),
        ("loads[-1]", "is no path"),
        ("loads[9999999]", "is no path"),
        ("loads[0]&1", "only integers have bits"),
        ("down&0", "only integers have bits"),
        ("down&x", "is no path"),
        ("legs[0].force&1", "only integers have bits"),
    ],
)
def test_paths_that_do_not_fit_say_what_there_is(state: Struct, path: str, expected: str) -> None:
    with pytest.raises(DefinitionError, match=re.escape(expected)):
        parse_field_path(state, path)


def test_all_numbers_and_vectors_are_listed(state: Struct) -> None:
    paths = [path for path, _ in readable_fields(state)]
    assert {"legs[].force", "legs[].force.x", "legs[].flags[]", "loads[]", "down"} <= {*paths}
    assert not {"name", "legs[].turn"} & {*paths}
