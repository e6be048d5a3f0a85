import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import (
    all_finite,
    dots,
    nearest_rows,
    rows_by_group,
    stable_order,
)


@pytest.mark.parametrize("highest", [0, 5, (1 << 16) - 1, 1 << 16, 1 << 40])
def test_equal_numbers_stay_in_order(highest: int) -> None:
    values = np.array([highest, 3, 0, highest, 3, 0], np.int64)

    np.testing.assert_array_equal(stable_order(values), np.argsort(values, kind="stable"))


def test_nothing_has_an_order() -> None:
    assert not len(stable_order(np.empty(0, np.int64)))


@given(st.lists(st.sampled_from([0, 1, 3, 70_000])))
def test_rows_of_a_group_stand_in_their_order(numbers: list[int]) -> None:
    group = np.array(numbers, np.int64)

    rows = {number: rows.tolist() for number, rows in rows_by_group(group)}

    assert list(rows) == sorted(set(numbers))
    assert rows == {
        number: [row for row, each in enumerate(numbers) if each == number] for number in rows
    }


def test_a_row_is_finite_when_all_its_numbers_are() -> None:
    vectors = np.array([[0.0, 1.0, -2.0], [np.nan, 0.0, 0.0], [0.0, 0.0, -np.inf]])

    np.testing.assert_array_equal(all_finite(vectors), [True, False, False])
    assert not len(all_finite(np.empty((0, 3))))


def test_scalar_products_are_added_up_row_by_row() -> None:
    first, second = np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 1e200]]), np.array([[4.0, -5.0, 6.0]] * 2)
    assert dots(first, second).tolist() == [12.0, 6e200]


def test_the_nearest_row_is_found_between_and_beyond_all_rows() -> None:
    time = np.array([0, 10, 30], np.int64)
    at = np.array([-11, 4, 5, 6, 19, 21, 29, 41], np.int64)
    assert nearest_rows(time, at).tolist() == [0, 0, 0, 1, 1, 2, 2, 2]
    assert set(nearest_rows(time[:1], at).tolist()) == {0}
