"""Legs named by where their feet are."""

import numpy as np
import pytest

from dogbot_logtool.core.leg_position import leg_names


def test_four_feet_are_corners_in_any_order() -> None:
    points = np.array([[-0.3, 0.2, 0], [0.3, 0.2, 0], [-0.3, -0.2, 0], [0.3, -0.2, 0]])
    assert leg_names(points) == ("back_left", "front_left", "back_right", "front_right")


def test_two_feet_are_sides_even_where_both_lie_on_one_side_of_the_base() -> None:
    assert leg_names(np.array([[0.1, -0.4, 0], [-0.1, -0.1, 0]])) == ("right", "left")


def test_six_feet_have_a_middle_pair() -> None:
    points = [[x, y, 0] for x in (0.3, 0.0, -0.3) for y in (0.2, -0.2)]
    ends = ("front", "middle", "back")
    expected = tuple(f"{end}_{side}" for end in ends for side in ("left", "right"))
    assert leg_names(np.array(points)) == expected


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.zeros((4, 3)), np.ones((3, 3))])
def test_other_feet_are_counted(points: np.ndarray) -> None:
    assert leg_names(points) == tuple(f"foot_{n + 1}" for n in range(len(points)))
