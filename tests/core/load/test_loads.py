"""The load on a foot, in newtons and in body weights."""

import math
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.load.loads import body_weight_n, foot_loads

Vector = tuple[float, float, float]

DOGBOT_KG: Final = 21.261


def samples_of(*forces: Vector) -> Samples:
    count = len(forces)
    return Samples(
        foot=np.arange(count) % 4,
        log_time=np.arange(count) + 1000,
        stamp=np.arange(count) * 7,
        in_contact=np.array([force != (0, 0, 0) for force in forces], np.bool_),
        force=np.array(forces, np.float64).reshape(count, 3),
        in_world=np.zeros(count, np.bool_),
        points=np.ones(count, np.int64),
        position=np.zeros((count, 3)),
        normal=np.zeros((count, 3)),
    )


def test_the_weight_of_dogbot() -> None:
    assert body_weight_n(DOGBOT_KG) == pytest.approx(208.57, abs=0.01)


def test_a_robot_of_unknown_mass_has_no_weight() -> None:
    assert body_weight_n(None) is None


def test_the_load_is_the_magnitude_of_the_force() -> None:
    loads = foot_loads(samples_of((3, 4, 12), (0, 0, 0), (0, 0, -50)), 100)

    assert loads.force.tolist() == [13, 0, 50]
    assert loads.body_weights.tolist() == [0.13, 0, 0.5]
    assert loads.in_contact.tolist() == [True, False, True]


def test_body_weights_are_unknown_without_a_weight() -> None:
    loads = foot_loads(samples_of((3, 4, 12), (0, 0, 0)), None)

    assert loads.force.tolist() == [13, 0]
    assert np.isnan(loads.body_weights).all()


@pytest.mark.parametrize("force", [(math.nan, 0, 0), (0, math.inf, 0), (1e200, 0, 0)])
def test_what_is_not_finite_stays_so(force: Vector) -> None:
    loads = foot_loads(samples_of((0, 0, 5), force), 100)

    assert np.isfinite(loads.force).tolist() == [True, False]
    assert np.isfinite(loads.body_weights).tolist() == [True, False]


def test_feet_and_times_are_those_of_the_samples() -> None:
    loads = foot_loads(samples_of((0, 0, 1), (0, 0, 2), (0, 0, 3)), None)

    assert loads.foot.tolist() == [0, 1, 2]
    assert loads.log_time.tolist() == [1000, 1001, 1002]
    assert loads.stamp.tolist() == [1000, 7, 14]  # a stamp of zero is none


def test_no_samples_have_no_loads() -> None:
    loads = foot_loads(samples_of(), 100)

    assert len(loads.force) == len(loads.body_weights) == 0


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-1e4, 1e4)] * 3), max_size=10))
def test_loads_equal_plain_arithmetic_to_the_bit(forces: list[Vector]) -> None:
    loads = foot_loads(samples_of(*forces), 208.5)

    magnitudes = [math.sqrt(x * x + y * y + z * z) for x, y, z in forces]
    assert loads.force.tolist() == magnitudes
    assert loads.body_weights.tolist() == [magnitude / 208.5 for magnitude in magnitudes]
