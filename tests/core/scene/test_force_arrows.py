"""`force` arrows: along the force, coloured by body weights."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.scene.arrows import (
    ArrowCounts,
    ArrowScale,
    force_arrows,
    pressure_arrows,
    turn_x_to,
)
from tests.core.scene.arrow_samples import (
    BODY_WEIGHT_N,
    NAN,
    DrawnSample,
    Vector,
    drawn,
    generated,
    samples_of,
    turned_x,
    vectors,
)
from tests.oracles.conversion import light


def unit(vector: Vector) -> Vector:
    length = math.hypot(*vector)
    return (vector[0] / length, vector[1] / length, vector[2] / length)


nearly_zero: Final = st.floats(1e-100, 1e-6) | st.floats(-1e-6, -1e-100)
unit_vectors: Final = st.one_of(
    st.tuples(*[st.floats(-1, 1).map(lambda x: round(x, 12))] * 3)
    .filter(lambda v: math.hypot(*v) > 0.01)
    .map(unit),
    # The two ends of the x axis, and beside them; a test below goes nearer still.
    st.tuples(
        st.sampled_from([1.0, -1.0]),
        *[st.just(0.0) | nearly_zero | st.sampled_from([1e-9, -1e-20, 1e-100])] * 2,
    ).map(unit),
    st.sampled_from([(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]),
)


@settings(generated, max_examples=150)
@given(unit_vectors)
def test_the_rotation_turns_x_to_the_direction(direction: Vector) -> None:
    (quaternion,) = turn_x_to(vectors([direction]))

    assert math.hypot(*quaternion.tolist()) == pytest.approx(1, abs=1e-15)
    assert turned_x(quaternion) == pytest.approx(list(direction), abs=2e-15)


@settings(generated, max_examples=100)
@given(unit_vectors)
def test_the_rotation_is_the_shortest(direction: Vector) -> None:
    (quaternion,) = turn_x_to(vectors([direction]))

    # Its axis is at right angles to both, so it does not roll; its angle is the angle between.
    assert quaternion[0] == 0
    assert 2 * math.acos(min(1, abs(quaternion[3]))) == pytest.approx(
        math.atan2(math.hypot(direction[1], direction[2]), direction[0]), abs=1e-7
    )


@pytest.mark.parametrize("beside", [1e-20, 1e-100, 1e-160, 1e-170, 1e-300, 5e-324])
@pytest.mark.parametrize("end", [1.0, -1.0])
def test_the_rotation_is_right_however_near_the_axis(end: float, beside: float) -> None:
    quaternions = turn_x_to(vectors([(end, beside, 0), (end, 0, -beside), (end, beside, beside)]))

    for quaternion in quaternions:
        assert turned_x(quaternion) == pytest.approx([end, 0, 0], abs=1e-15)


@generated
@given(unit_vectors, st.floats(1, 200))
def test_a_world_frame_force_is_drawn_along_itself(direction: Vector, load: float) -> None:
    x, y, z = direction
    felt = DrawnSample((x * load, y * load, z * load), normal=(0, 0, 1))

    arrows, counts = force_arrows(samples_of(felt), force_in_world=True, body_weight_n=None)

    assert counts == ArrowCounts()
    assert arrows.length.tolist() == pytest.approx([load / 100])
    assert turned_x(arrows.orientation[0]) == pytest.approx(list(direction), abs=1e-14)


def test_where_only_the_magnitude_is_known_it_is_drawn_along_the_normal() -> None:
    felt = DrawnSample((30, 40, 0), normal=(0.6, 0, 0.8))

    arrows, counts = force_arrows(samples_of(felt), force_in_world=False, body_weight_n=None)

    assert counts == ArrowCounts()
    assert arrows.length.tolist() == [0.5]
    assert turned_x(arrows.orientation[0]) == pytest.approx([0.6, 0, 0.8], abs=1e-15)


def test_a_force_read_off_the_ground_is_drawn_along_itself_even_beside_link_frame_ones() -> None:
    link, world = DrawnSample((30, 40, 0)), DrawnSample((30, 40, 0), in_world=True)

    arrows, _ = force_arrows(samples_of(link, world), force_in_world=False, body_weight_n=None)

    assert turned_x(arrows.orientation[0]) == pytest.approx([0, 0, 1], abs=1e-15)
    assert turned_x(arrows.orientation[1]) == pytest.approx([0.6, 0.8, 0], abs=1e-15)


def test_without_a_normal_a_link_frame_force_has_no_direction_and_is_counted() -> None:
    blind = DrawnSample(normal=(NAN, NAN, NAN))

    arrows, counts = force_arrows(
        samples_of(blind, DrawnSample(), replace(blind, in_world=True)),
        force_in_world=False,
        body_weight_n=None,
    )

    assert arrows.shown.tolist() == [False, True, True]
    assert counts == ArrowCounts(no_direction=1)


def test_force_is_coloured_by_body_weights() -> None:
    shares = np.linspace(0.01, 1.5, 40).tolist()
    loads = [DrawnSample((0, 0, share * BODY_WEIGHT_N)) for share in shares]

    arrows, _ = drawn("force", *loads)

    for share, colour in zip(shares, arrows.colour.tolist(), strict=True):
        wavelength = 380 + share / 1.5 * (750 - 380)
        assert colour == pytest.approx([*light(min(wavelength, 750)), 1], abs=1e-6)


def test_force_stays_red_past_one_and_a_half_body_weights() -> None:
    arrows, _ = drawn("force", DrawnSample((0, 0, 1.6 * BODY_WEIGHT_N)), DrawnSample((0, 0, 1e9)))

    assert arrows.colour.tolist() == [pytest.approx([0.3**0.8, 0, 0, 1])] * 2


def test_force_has_the_colours_of_pressure_where_the_weight_is_not_known() -> None:
    loads = samples_of(*[DrawnSample((0, 0, load)) for load in np.linspace(1, 300, 50).tolist()])

    force, _ = force_arrows(loads, force_in_world=True, body_weight_n=None)
    pressure, _ = pressure_arrows(loads)

    assert force.colour == pytest.approx(pressure.colour, abs=1e-6)


def test_force_lengths_follow_newtons_per_metre() -> None:
    arrows, _ = force_arrows(
        samples_of(DrawnSample((0, 0, 50))),
        force_in_world=True,
        body_weight_n=BODY_WEIGHT_N,
        scale=ArrowScale(500.0),
    )

    assert arrows.length.tolist() == [0.1]
