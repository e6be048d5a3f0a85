import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core import timespans
from dogbot_logtool.core.arrays import Ints

LENGTH = 40


@st.composite
def spans(draw: st.DrawFn) -> Ints:
    edges = sorted(draw(st.sets(st.integers(0, LENGTH), max_size=12)))
    pairs = edges[: len(edges) // 2 * 2]
    return np.array(pairs, np.int64).reshape(-1, 2)


def cells(table: Ints) -> set[int]:
    """Unit cells that spans cover: the oracle counts them one by one."""
    return {cell for start, end in table.tolist() for cell in range(start, end)}


@given(spans(), spans())
def test_intersection_and_difference(first: Ints, second: Ints) -> None:
    both = timespans.intersect([first, second])
    rest = timespans.subtract(first, second)
    assert cells(both) == cells(first) & cells(second)
    assert cells(rest) == cells(first) - cells(second)
    assert timespans.total(both) == len(cells(both))


@given(st.lists(st.tuples(st.integers(0, LENGTH), st.integers(0, LENGTH)), max_size=8))
def test_merging_joins_what_overlaps(pairs: list[tuple[int, int]]) -> None:
    table = np.array(pairs, np.int64).reshape(-1, 2)
    merged = timespans.merge(table)
    assert cells(merged) == cells(table)
    assert (merged[1:, 0] > merged[:-1, 1]).all()


@given(spans(), st.integers(0, LENGTH), st.integers(1, 5))
def test_what_touches(table: Ints, start: int, length: int) -> None:
    end = start + length
    found = timespans.touches(table, np.array([start]), np.array([end]))
    assert found.tolist() == [any(b >= start and a < end for a, b in table.tolist())]


@given(spans(), st.integers(0, LENGTH), st.integers(0, 4), st.integers(0, 4))
def test_windows_that_one_span_holds(table: Ints, time: int, before: int, after: int) -> None:
    found = timespans.hold_window(table, np.array([time]), before, after)
    assert found.tolist() == [any(a <= time - before and time + after <= b for a, b in table)]


def test_a_start_is_inside_an_end_is_not() -> None:
    table = np.array([[2, 5], [5, 9]], np.int64)
    assert timespans.covers(table, np.array([1, 2, 5, 8, 9])).tolist() == [0, 1, 1, 1, 0]


def test_nothing_in_common_with_nothing() -> None:
    assert timespans.intersect([]).shape == (0, 2)


def test_ticks_are_whole_multiples_in_spans() -> None:
    spans = np.array([[5, 21], [30, 31], [40, 41]], np.int64)
    assert timespans.ticks(spans, 10).tolist() == [10, 20, 30, 40]
    assert len(timespans.ticks(timespans.no_spans(), 10)) == 0
