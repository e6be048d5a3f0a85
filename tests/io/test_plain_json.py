"""JSON that is written in lines, against the standard library's."""

import json

from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.io.plain_json import to_json

TEXT = st.text(max_size=8)
PLAIN = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | TEXT
VALUES = st.recursive(
    PLAIN.filter(lambda each: each not in (float("inf"), float("-inf"))),
    lambda inside: (
        st.lists(inside)
        | st.lists(inside).map(tuple)
        | st.dictionaries(TEXT | st.integers(), inside)
    ),
)


@settings(max_examples=100, deadline=None)
@given(VALUES)
def test_lines_are_those_of_the_standard_library(value: object) -> None:
    assert to_json(value, indent=2) == json.dumps(value, indent=2)


def test_numbers_that_are_not_finite_become_null_in_lines_too() -> None:
    nan, inf = float("nan"), float("inf")
    value = {"a": [1.5, nan], "b": {"c": inf, "d": [[], {}]}}
    assert json.loads(to_json(value, indent=2)) == {
        "a": [1.5, None],
        "b": {"c": None, "d": [[], {}]},
    }
