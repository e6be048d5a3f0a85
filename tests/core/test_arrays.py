import numpy as np
import pytest

from dogbot_logtool.core.arrays import all_finite, stable_order


@pytest.mark.parametrize("highest", [0, 5, (1 << 16) - 1, 1 << 16, 1 << 40])
def test_equal_numbers_stay_in_order(highest: int) -> None:
    values = np.array([highest, 3, 0, highest, 3, 0], np.int64)

    np.testing.assert_array_equal(stable_order(values), np.argsort(values, kind="stable"))


def test_nothing_has_an_order() -> None:
    assert not len(stable_order(np.empty(0, np.int64)))


def test_a_row_is_finite_when_all_its_numbers_are() -> None:
    vectors = np.array([[0.0, 1.0, -2.0], [np.nan, 0.0, 0.0], [0.0, 0.0, -np.inf]])

    np.testing.assert_array_equal(all_finite(vectors), [True, False, False])
    assert not len(all_finite(np.empty((0, 3))))
