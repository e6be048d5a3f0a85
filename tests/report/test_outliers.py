"""Which strides are marked as odd."""

import numpy as np
import pytest

from dogbot_logtool.report.page.tables import outliers

EVEN = [0.50, 0.51, 0.49, 0.50, 0.52, 0.48, 0.51, 0.49]


@pytest.mark.parametrize(
    ("usual", "others", "signs", "least"),
    [
        (EVEN, [0.8, 0.2], [1, -1], 0.0),
        # Half of the values may be odd without hiding it.
        ([1.0, 1.01, 0.99, 1.0, 1.02], [9.0, 9.5, 8.0], [1, 1, 1], 0.0),
        # One sample more is no event in an even walk, whose durations have no spread.
        ([0.300] * 20, [0.304], [0], 0.0),
        ([0.0] * 20, [0.03], [1], 0.0),
        # Differences that are too small to print are none.
        ([0.0] * 20, [2e-4], [1], 0.0),
        ([0.0] * 20, [2e-4], [0], 0.1),
        ([1.0, 1.0, 1.0], [50.0], [0], 0.0),
        ([], [], [], 0.0),
    ],
)
def test_what_is_far_from_the_others_is_marked(
    usual: list[float], others: list[float], signs: list[int], least: float
) -> None:
    found, _ = outliers(np.array([*usual, *others]), least)
    assert found.tolist() == [0] * len(usual) + signs
