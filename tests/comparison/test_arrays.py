"""Arrays, bytes and texts of decoded messages, compared as a whole."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dogbot_logtool.comparison.fields import Tree, compare_fields, text_of
from dogbot_logtool.comparison.outcome import Differences, Tally
from dogbot_logtool.comparison.tolerances import FieldRules, Rules, Tolerance


class Found(Differences):
    tally: Tally


def compared(expected: Tree, actual: Tree, atol: float = 0.0, limit: int = 100) -> Found:
    """Compare; integers get the tolerance where it is not 0."""
    rules = Rules(Tolerance(atol), (Tolerance(atol, fields=("*",)),) if atol else ())
    found = Found(limit)
    found.tally = Tally()
    for leaf in compare_fields({"a": expected}, {"a": actual}, FieldRules(rules)):
        found.tally.add(leaf)
        found.add(leaf)
    return found


def lines(found: Found) -> list[str]:
    return [f"{one.path}: {one.expected} | {one.actual}" for one in found.kept]


@pytest.mark.parametrize("kind", [np.uint8, np.int64, np.uint64])
def test_integers_are_exact_unless_a_tolerance_names_them(kind: type) -> None:
    expected: NDArray[Any] = np.array([1, 2, 200], kind)
    actual: NDArray[Any] = np.array([2, 1, 205], kind)
    assert compared(expected, actual).tally.different == 3
    found = compared(expected, actual, 1.0)
    tally = found.tally
    assert (tally.within_tolerance, tally.different, tally.deviation) == (2, 1, 5.0)
    assert lines(found) == ["a[2]: 200 | 205"]
    assert compared(np.array([True]), np.array([False]), 9.0).count == 1


@pytest.mark.parametrize("kind", [list, np.array])
def test_arrays_of_other_lengths(kind: Any) -> None:
    found = compared(kind([1.0, 2.0, 3.0]), kind([1.0, 2.5]))
    assert sorted(lines(found)) == ["a: 3 elements | 2 elements", "a[1]: 2.0 | 2.5"]
    tally = found.tally
    assert (tally.equal, tally.different, tally.missing, tally.extra) == (1, 1, 1, 0)


@pytest.mark.parametrize("kind", [np.float32, np.uint8])
def test_an_array_is_counted_whole_and_listed_up_to_the_limit(kind: type) -> None:
    found = compared(np.zeros(1000, kind), np.ones(1000, kind), limit=3)
    assert [one.path for one in found.kept] == ["a[0]", "a[1]", "a[2]"]
    assert (found.count, found.tally.different) == (1000, 1000)


def test_texts_are_short_and_harmless() -> None:
    assert text_of("\x1b[31m\n") == '"\\u001b[31m\\n"'
    for long in ("x" * 10_000, b"x" * 10_000, list(range(10_000))):
        assert len(text_of(long)) == 100
