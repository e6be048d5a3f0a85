"""The load on a foot, in newtons and in body weights."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import ContactSensor, follow_feet, initial_memory
from dogbot_logtool.core.load.loads import (
    Loads,
    LoadState,
    body_weight_n,
    foot_loads,
    opening_loads,
)


def loads_of(samples: Samples, weight_n: float | None) -> Loads:
    return foot_loads(samples, (), weight_n)


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
    loads = loads_of(samples_of((3, 4, 12), (0, 0, 0), (0, 0, -50)), 100)

    assert loads.force.tolist() == [13, 0, 50]
    assert loads.body_weights.tolist() == [0.13, 0, 0.5]
    assert loads.in_contact.tolist() == [True, False, True]


def test_body_weights_are_unknown_without_a_weight() -> None:
    loads = loads_of(samples_of((3, 4, 12), (0, 0, 0)), None)

    assert loads.force.tolist() == [13, 0]
    assert np.isnan(loads.body_weights).all()


@pytest.mark.parametrize("force", [(math.nan, 0, 0), (0, math.inf, 0), (1e200, 0, 0)])
def test_what_is_not_finite_stays_so(force: Vector) -> None:
    loads = loads_of(samples_of((0, 0, 5), force), 100)

    assert np.isfinite(loads.force).tolist() == [True, False]
    assert np.isfinite(loads.body_weights).tolist() == [True, False]


def test_feet_and_times_are_those_of_the_samples() -> None:
    loads = loads_of(samples_of((0, 0, 1), (0, 0, 2), (0, 0, 3)), None)

    assert loads.foot.tolist() == [0, 1, 2]
    assert loads.log_time.tolist() == [1000, 1001, 1002]
    assert loads.stamp.tolist() == [1000, 7, 14]  # a stamp of zero is none


def test_no_samples_have_no_loads() -> None:
    loads = loads_of(samples_of(), 100)

    assert len(loads.force) == len(loads.body_weights) == 0


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(*[st.floats(-1e4, 1e4)] * 3), max_size=10))
def test_loads_equal_plain_arithmetic_to_the_bit(forces: list[Vector]) -> None:
    loads = loads_of(samples_of(*forces), 208.5)

    magnitudes = [math.sqrt(x * x + y * y + z * z) for x, y, z in forces]
    assert loads.force.tolist() == magnitudes
    assert loads.body_weights.tolist() == [magnitude / 208.5 for magnitude in magnitudes]


def states_of(samples: Samples, sensor: ContactSensor) -> list[LoadState]:
    memory = (initial_memory(),) * 4
    trackers = follow_feet([samples], memory, (sensor,) * 4, force_in_world=True)
    return [LoadState(state) for state in foot_loads(samples, trackers, None).state.tolist()]


def one_foot(*vertical: float) -> Samples:
    samples = samples_of(*((0.0, 0.0, force) for force in vertical))
    return replace(samples, foot=np.zeros(len(vertical), np.int64))


def test_states_are_those_of_contact_detection() -> None:
    sensor = ContactSensor(ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.0))
    assert states_of(one_foot(5.0, 20.0, 5.0, 2.0, math.nan, 2.0), sensor) == [
        LoadState.SWING,
        LoadState.STANCE,
        LoadState.STANCE,
        LoadState.SWING,
        LoadState.UNKNOWN,
        LoadState.SWING,
    ]


def test_a_foot_that_never_touched_is_unknown() -> None:
    rule = ContactRule(on_n=10.0, off_n=4.0, debounce_s=0.0)
    dead = ContactSensor(rule, works=False)
    assert set(states_of(one_foot(0.0, 0.0), dead)) == {LoadState.UNKNOWN}
    assert states_of(one_foot(0.0, 20.0, 0.0), dead)[1:] == [LoadState.STANCE, LoadState.SWING]
    unusable = ContactSensor(replace(rule, unusable="it is stuck"))
    assert set(states_of(one_foot(0.0, 20.0), unusable)) == {LoadState.UNKNOWN}


def test_the_first_loads_stand_at_the_log_s_first_time() -> None:
    loads = loads_of(samples_of((0, 0, 1), (0, 0, 2), (0, 0, 3), (0, 0, 4), (0, 0, 5)), None)
    opening = opening_loads(loads, 1000, {0, 1, 2, 3})
    # The first foot's message is there already; only the first of each foot counts.
    assert opening.foot.tolist() == [1, 2, 3]
    assert opening.force.tolist() == [2.0, 3.0, 4.0]
    assert set(opening.log_time.tolist()) == set(opening.stamp.tolist()) == {1000}
    assert len(opening_loads(loads, 1000 - 100_000_000, {0, 1, 2, 3}).foot) == 0
