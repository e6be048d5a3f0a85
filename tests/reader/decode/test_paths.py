"""Paths to fields of a message: which bytes they read, of whole and of odd arrays."""

import re
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.columns import Nested, Table
from dogbot_logtool.reader.decode.definition import parse_definition
from dogbot_logtool.reader.decode.message_layout import ELEMENT
from dogbot_logtool.reader.decode.paths import (
    MOST_ELEMENTS,
    Want,
    parse_field_path,
    path_of,
)

STATE: Final = parse_definition(
    "odd/State",
    """\
Leg[] legs
float64[4] loads
float32[] cells
int8 mode
bool down
string name
================================================================================
MSG: odd/Leg
string label
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
""",
    "ros2msg",
)


@pytest.mark.parametrize(
    ("text", "want", "words"),
    [
        ("name", "number", "field 'name' of odd/State must be readable as number, but"),
        ("mode", "text", "must be readable as text, but the log's definition has int8"),
        ("mode", "time", "must be readable as time"),
        ("legs[].weight", "number", "has no field 'legs.weight', which is needed"),
        ("name[]", "text", "must be readable as name[]"),
        ("loads[].x", "number", "has no field 'loads.x', which is needed"),
        ("legs[]", "number", "must be readable as number, but the log's definition has odd/Leg"),
        ("loads[4]", "number", "must be readable as loads[4], but"),
    ],
)
def test_what_a_definition_does_not_have_is_refused(text: str, want: Want, words: str) -> None:
    with pytest.raises(DefinitionError, match=re.escape(words)):
        path_of(text, want, STATE)


def table(lists: list[list[float]]) -> Table:
    """An array of numbers in each message."""
    pairs = [(row, value) for row, values in enumerate(lists) for value in values]
    parent = np.array([row for row, _ in pairs], np.int64)
    run = np.array([(value,) for _, value in pairs], [(ELEMENT, "<f8")])
    return Table(len(lists), (), {"cells": Nested(parent, Table(len(pairs), (run,), {}))})


@given(
    st.lists(st.lists(st.floats(-9, 9), max_size=MOST_ELEMENTS + 3), min_size=1, max_size=6),
    st.integers(0, 20),
)
def test_elements_are_those_of_each_message(lists: list[list[float]], index: int) -> None:
    given_lists = table(lists)
    (one,) = path_of(f"cells[{index}]", "number", STATE).values(given_lists).T[0]
    expected = [values[index] if index < len(values) else np.nan for values in lists]
    np.testing.assert_array_equal(one, expected)

    last = path_of("cells[-1]", "number", STATE).values(given_lists)[:, 0, 0]
    np.testing.assert_array_equal(last, [values[-1] if values else np.nan for values in lists])

    every = path_of("cells[]", "number", STATE).values(given_lists)[:, :, 0]
    most = min(max(map(len, lists)), MOST_ELEMENTS)
    padded = [(values + [np.nan] * most)[:most] for values in lists]
    np.testing.assert_array_equal(every, np.array(padded).reshape(len(lists), most))


@pytest.mark.parametrize(
    ("condition", "fits"), [("of 6", [6]), ("of 6+", [6, 7]), ("", [4, 5, 6, 7])]
)
def test_vectors_of_arrays_of_another_length_are_not_known(condition: str, fits: list[int]) -> None:
    lists = [[float(number) for number in range(length)] for length in (3, 4, 5, 6, 7)]
    path = path_of(f"cells[1:4 by 3 {condition}]".replace(" ]", "]"), "xyz", STATE)
    found = path.values(table(lists))
    assert found.shape == (5, 1, 3)
    for values, row in zip(lists, found[:, 0], strict=True):
        assert np.isnan(row).all() if len(values) not in fits else row.tolist() == [1.0, 2.0, 3.0]


# Paths that users name


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("zz", "it has"),
        ("dawn", "nearest are down (bool)"),
        ("legs[0].turn", "nearest are legs[].turn.x"),
        ("legs.force", "nearest are legs[].force"),
        ("", "is no path"),
        ("loads[-1]", "is no path"),
        ("loads[0]&1", "only integers have bits"),
        ("down&0", "only integers have bits"),
        ("legs[0].force&1", "only integers have bits"),
    ],
)
def test_paths_that_do_not_fit_say_what_there_is(path: str, expected: str) -> None:
    with pytest.raises(DefinitionError, match=re.escape(expected)):
        parse_field_path(STATE, path)
