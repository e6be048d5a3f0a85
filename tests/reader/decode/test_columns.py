"""Columns of texts, against a plain list of strings."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.decode.columns import Texts


def texts_of(values: list[str]) -> Texts:
    encoded = [value.encode() for value in values]
    length = np.array([len(data) for data in encoded], np.int64)
    buffer = np.frombuffer(b"".join(encoded) + b"\0", np.uint8)
    return Texts(buffer, np.cumsum(length) - length, length)


def assert_encodes(values: list[str]) -> None:
    code, names = texts_of(values).encode()
    assert [names[each] for each in code.tolist()] == values
    assert len(set(names)) == len(names) == len(set(values))
    if len(names) < 50:
        assert list(names) == list(dict.fromkeys(values))


@settings(deadline=None)
@given(st.lists(st.text("ab/", max_size=3), max_size=40))
def test_few_different_texts(values: list[str]) -> None:
    assert_encodes(values)


@settings(deadline=None)
@given(st.lists(st.integers(0, 400), min_size=300, max_size=600))
def test_more_different_texts_than_are_taken_out_one_by_one(numbers: list[int]) -> None:
    assert_encodes(["" if number == 7 else f"frame_{number}" for number in numbers])
