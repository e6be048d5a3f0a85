import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.report.outliers import outliers

EVEN = [0.50, 0.51, 0.49, 0.50, 0.52, 0.48, 0.51, 0.49]


def test_a_long_stride_is_high_and_a_short_one_low() -> None:
    found = outliers(np.array([*EVEN, 0.8, 0.2]))
    assert found.high.tolist() == [False] * 8 + [True, False]
    assert found.low.tolist() == [False] * 9 + [True]
    assert found.median == 0.5


def test_half_of_the_values_may_be_odd_without_hiding_it() -> None:
    found = outliers(np.array([1.0, 1.01, 0.99, 1.0, 1.02, 9.0, 9.5, 8.0]))
    assert found.high.tolist() == [False] * 5 + [True] * 3


def test_one_sample_more_is_no_event_in_an_even_walk() -> None:
    # Durations in whole samples: nearly all are equal, so that their spread is 0.
    found = outliers(np.array([0.300] * 20 + [0.304]))
    assert not found.high.any()


def test_among_equal_values_a_far_one_is_odd() -> None:
    found = outliers(np.array([0.0] * 20 + [0.03]))
    assert found.high.tolist() == [False] * 20 + [True]


def test_differences_that_are_too_small_to_print_are_no_event() -> None:
    slips = np.array([0.0] * 20 + [2e-4])
    assert outliers(slips).high.any()
    assert not outliers(slips, 0.1).high.any()


@pytest.mark.parametrize("few", [[], [1.0], [1.0, 1.0, 1.0, 50.0]])
def test_few_values_have_no_outliers(few: list[float]) -> None:
    assert not outliers(np.array(few)).high.any()


@given(st.lists(st.floats(0.1, 10.0) | st.just(float("nan")), max_size=30))
def test_the_median_is_no_outlier_and_a_sign_turns_high_into_low(values: list[float]) -> None:
    given_values = np.array(values, np.float64)
    found, turned = outliers(given_values), outliers(-given_values)
    assert (found.high == turned.low).all()
    assert not (found.high & found.low).any()
    assert not found.high[np.isnan(given_values)].any()
    assert found.high.sum() <= len(values) / 2
