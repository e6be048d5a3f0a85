"""Arrows as a person would draw them: `pressure`, and what all styles have in common."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.scene.arrows import (
    ArrowCounts,
    ArrowScale,
    arrow_scale,
    classic_arrows,
    force_arrows,
    pressure_arrows,
)
from tests.core.scene.arrow_samples import (
    INF,
    LIFTED,
    NAN,
    DrawnSample,
    Vector,
    components,
    contacts_of,
    drawn,
    generated,
    points,
    pressed,
    samples_of,
    turned_x,
)


def test_pressure_stands_on_the_contact_point_and_is_as_long_as_the_load() -> None:
    felt = [
        DrawnSample((3, 4, 12)),
        DrawnSample((0, 0, -70), position=(5, 6, 7)),
        DrawnSample((120, 0, 0)),
    ]

    arrows, counts = pressure_arrows(samples_of(*felt))

    assert counts == ArrowCounts()
    assert arrows.shown.all()
    assert arrows.length.tolist() == [0.13, 0.7, 1.2]
    assert arrows.position.tolist() == [[1, 2, 0], [5, 6, 7], [1, 2, 0]]


def test_pressure_points_straight_up_whatever_the_force() -> None:
    arrows, _ = pressure_arrows(
        samples_of(DrawnSample((0, 0, 50)), DrawnSample((50, -20, 0)), DrawnSample((0, 0, -9)))
    )

    for quaternion in arrows.orientation:
        assert turned_x(quaternion) == pytest.approx([0, 0, 1], abs=1e-15)


def test_newtons_per_metre_scale_the_length_but_not_the_colour() -> None:
    samples = samples_of(DrawnSample((0, 0, 50)))

    usual, _ = pressure_arrows(samples)
    longer, _ = pressure_arrows(samples, ArrowScale(25.0))

    assert usual.length.tolist() == [0.5]
    assert longer.length.tolist() == [2.0]
    assert longer.colour.tolist() == usual.colour.tolist()


def test_pressure_has_the_colours_of_classic_up_to_full_scale() -> None:
    loads = [DrawnSample((0, 0, load)) for load in np.linspace(1, 200, 300).tolist()]

    arrows, _ = pressure_arrows(samples_of(*loads))
    classic, _ = classic_arrows(contacts_of([pressed(felt.force) for felt in loads]))

    assert arrows.colour == pytest.approx(classic.colour, abs=1e-6)


@pytest.mark.parametrize("load", [200.00000000000003, 201.0, 5000.0, 1e150])
def test_pressure_stays_red_past_full_scale(load: float) -> None:
    full, _ = pressure_arrows(samples_of(DrawnSample((0, 0, 200))))
    past, _ = pressure_arrows(samples_of(DrawnSample((0, 0, load))))

    assert past.colour.tolist() == full.colour.tolist()
    assert past.colour[0].tolist() == pytest.approx([0.3**0.8, 0, 0, 1])
    assert past.shown.all()


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_lift_off_removes_the_arrow_and_is_no_fault(style: str) -> None:
    arrows, counts = drawn(style, DrawnSample(), LIFTED, DrawnSample(), LIFTED)

    assert arrows.shown.tolist() == [True, False, True, False]
    assert arrows.foot.tolist() == [0, 1, 2, 3]
    assert arrows.log_time.tolist() == [1000, 1010, 1020, 1030]
    assert counts == ArrowCounts()


@pytest.mark.parametrize("style", ["pressure", "force"])
@pytest.mark.parametrize("zero", [(0, 0, 0), (-0.0, 0, -0.0), (1e-200, 0, 0)])
def test_contact_without_load_removes_the_arrow_and_is_no_fault(style: str, zero: Vector) -> None:
    arrows, counts = drawn(style, DrawnSample(zero))

    assert arrows.shown.tolist() == [False]
    assert counts == ArrowCounts()


@pytest.mark.parametrize("style", ["pressure", "force"])
@pytest.mark.parametrize("force", [(NAN, 0, 1), (0, INF, 0), (0, 0, -INF), (1e200, 1, 1)])
def test_a_load_that_is_not_finite_removes_the_arrow_and_is_counted(
    style: str, force: Vector
) -> None:
    arrows, counts = drawn(style, DrawnSample(), DrawnSample(force))

    assert arrows.shown.tolist() == [True, False]
    assert counts == ArrowCounts(not_finite=1)


@pytest.mark.parametrize("style", ["pressure", "force"])
@pytest.mark.parametrize("position", [(NAN, 0, 0), (0, INF, 0), (0, 0, -INF)])
def test_a_position_that_is_not_finite_removes_the_arrow_and_is_counted(
    style: str, position: Vector
) -> None:
    arrows, counts = drawn(style, DrawnSample(position=position))

    assert arrows.shown.tolist() == [False]
    assert counts == ArrowCounts(not_finite=1)


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_contact_without_a_point_removes_the_arrow_and_is_counted(style: str) -> None:
    nowhere = DrawnSample(points=0, position=(NAN, NAN, NAN))

    arrows, counts = drawn(style, nowhere, DrawnSample())

    assert arrows.shown.tolist() == [False, True]
    assert counts == ArrowCounts(no_position=1)


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_numbers_that_are_not_finite_are_no_fault_without_contact(style: str) -> None:
    arrows, counts = drawn(style, replace(LIFTED, force=(NAN, INF, 0)))

    assert arrows.shown.tolist() == [False]
    assert counts == ArrowCounts()


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_the_stamp_is_the_messages_or_its_log_time_where_that_is_zero(style: str) -> None:
    arrows, _ = drawn(style, DrawnSample(stamp=77), DrawnSample(stamp=0))

    assert arrows.stamp.tolist() == [77, 1010]


@pytest.mark.parametrize("style", ["pressure", "force"])
def test_no_samples_give_no_arrows(style: str) -> None:
    arrows, counts = drawn(style)

    assert len(arrows.shown) == 0
    assert arrows.orientation.shape == (0, 4)
    assert counts == ArrowCounts()


felt_strategy: Final = st.builds(
    DrawnSample,
    force=st.tuples(components, components, components),
    in_contact=st.booleans(),
    in_world=st.booleans(),
    points=st.integers(0, 3),
    position=points,
    normal=st.sampled_from([(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (-1.0, 0.0, 0.0), (NAN, NAN, NAN)]),
)


@generated
@given(st.lists(felt_strategy, max_size=8), st.booleans())
def test_what_is_shown_can_be_drawn_and_what_is_not_is_explained(
    felt: list[DrawnSample],
    force_in_world: bool,  # noqa: FBT001
) -> None:
    samples = samples_of(*felt)
    for arrows, counts in (
        pressure_arrows(samples),
        force_arrows(samples, force_in_world=force_in_world, body_weight_n=None),
    ):
        shown = arrows.shown
        assert np.isfinite(arrows.position[shown]).all()
        assert np.isfinite(arrows.length[shown]).all()
        assert (arrows.length[shown] > 0).all()
        assert np.isfinite(arrows.orientation[shown]).all()
        assert np.linalg.norm(arrows.orientation[shown], axis=1) == pytest.approx(1, abs=1e-12)
        assert ((arrows.colour[shown] >= 0) & (arrows.colour[shown] <= 1)).all()
        unloaded = sum(
            one.in_contact and math.hypot(*one.force) < 1e-150 and one.points > 0 for one in felt
        )
        explained = counts.not_finite + counts.no_position + counts.no_direction
        in_contact = sum(one.in_contact for one in felt)
        assert in_contact - unloaded <= shown.sum() + explained <= in_contact


def test_a_weight_is_as_long_as_the_base_is_high_unless_the_robot_s_file_says_else() -> None:
    assert arrow_scale(100.0, 785.0, 0.9) == ArrowScale(100.0, 200.0)
    assert arrow_scale(None, 785.0, 0.5) == ArrowScale(1570.0, 1177.5)
    assert arrow_scale(None, None, 0.5) == ArrowScale(100.0, 200.0)
    load = samples_of(DrawnSample((0.0, 0.0, 785.0)))
    arrows, _ = pressure_arrows(load, arrow_scale(None, 785.0, 0.9))
    assert arrows.length.tolist() == pytest.approx([0.9])


def test_counts_add_up() -> None:
    assert ArrowCounts(1, 2, 3, 4) + ArrowCounts(10, 20, 30, 40) == ArrowCounts(11, 22, 33, 44)
