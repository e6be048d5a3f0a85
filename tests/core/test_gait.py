"""Classes of gaits by their phases, and names and order of legs."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from dogbot_logtool.core.gait import classes
from dogbot_logtool.core.metrics import Gait
from dogbot_logtool.core.records import unknown
from dogbot_logtool.core.settings import leg_names, legs_in_order

SURE = (1.0,) * 6


def classify(
    phases: Sequence[float],
    consistency: Sequence[float],
    duty_factor: float = 0.6,
    flight_fraction: float | None = None,
) -> Gait:
    gait = replace(unknown(Gait), duty_factor=duty_factor, flight_fraction=flight_fraction)
    return classes.classify(gait, phases, consistency)


@pytest.mark.parametrize(
    ("phases", "name", "sequence"),
    [
        ((0.0, 0.55, 0.48, 0.95), "trot", None),
        ((0.0, 0.0, 0.4, 0.4), "bound", None),
        ((0.0, 0.5, 0.83, 0.33), "walk", "lateral"),
        ((0.0, 0.5, 0.63, 0.13), "walk", "lateral"),
        ((0.0, 0.5, 0.59, 0.09), "trot", None),
        ((0.0, 0.09, 0.48, 0.57), "bound", None),
        ((0.0, 0.12, 0.48, 0.6), "gallop", "transverse"),
        ((0.0, 0.18, 0.6, 0.78), "gallop", "transverse"),
        ((0.0, 0.18, 0.78, 0.6), "gallop", "rotary"),
        ((0.0, 0.5, 0.35, 0.0), "irregular", None),
        ((0.0, 0.3, 0.0, 0.3), "irregular", None),
        # Both fore feet before both hind feet: no pair is evenly spaced, so it is no walk.
        ((0.0, 0.25, 0.5, 0.75), "gallop", "transverse"),
    ],
)
def test_bounds_of_classes(phases: tuple[float, ...], name: str, sequence: str | None) -> None:
    gait = classify(phases, SURE)
    assert (gait.name, gait.sequence) == (name, sequence)


def test_an_amble_has_no_flight() -> None:
    single_foot = (0.0, 0.5, 0.75, 0.25)
    assert classify(single_foot, SURE, 0.4, 0.0).name == "amble"
    gait = classify(single_foot, SURE, 0.2, 0.2)
    assert (gait.name, gait.nearest_name) == ("irregular", "amble")


def test_loose_phases_are_irregular_but_the_nearest_class_is_named() -> None:
    gait = classify((0.0, 0.5, 0.5, 0.0), (1.0, 0.9, 0.79, 1.0))
    assert (gait.name, gait.nearest_name, gait.class_distance) == ("irregular", "trot", 0.0)


def test_two_and_six_feet_have_an_order_too() -> None:
    sides = [(end, side) for end in ("back", "middle", "front") for side in ("left", "right")]
    assert legs_in_order(sides) == (4, 5, 2, 3, 0, 1)
    assert legs_in_order([None, None]) == (0, 1)
    assert legs_in_order([("centre", "right"), ("centre", "left")]) == (1, 0)
    assert legs_in_order([("front", "left"), ("front", "right")]) is None
    assert legs_in_order([None] * 6) is None


def test_four_feet_are_corners_in_any_order() -> None:
    points = np.array([[-0.3, 0.2, 0], [0.3, 0.2, 0], [-0.3, -0.2, 0], [0.3, -0.2, 0]])
    assert leg_names(points) == ("back_left", "front_left", "back_right", "front_right")


def test_two_feet_are_sides_even_where_both_lie_on_one_side_of_the_base() -> None:
    assert leg_names(np.array([[0.1, -0.4, 0], [-0.1, -0.1, 0]])) == ("right", "left")


@pytest.mark.parametrize("points", [np.zeros((0, 3)), np.zeros((4, 3)), np.ones((3, 3))])
def test_other_feet_are_counted(points: np.ndarray) -> None:
    assert leg_names(points) == tuple(f"foot_{n + 1}" for n in range(len(points)))
