"""Contact messages become one sample each."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from dogbot_logtool.core.arrays import norms
from dogbot_logtool.core.contact.contacts import (
    FOOT_IS_COLLISION1,
    FOOT_IS_COLLISION2,
    NOT_THIS_FOOT,
    Samples,
    contact_samples,
)
from tests.core.contact.states import Message, State, Vector, contacts_of

NAN: Final = math.nan
NOWHERE: Final = [NAN, NAN, NAN]


def sample_of(*states: State) -> Samples:
    return contact_samples(contacts_of([states]))


# --- what a sample is -------------------------------------------------------------------------


def test_a_message_without_states_is_no_contact() -> None:
    samples = contact_samples(contacts_of([(), (State(),), ()]))

    assert samples.in_contact.tolist() == [False, True, False]
    assert samples.force.tolist() == [[0, 0, 0], [0, 0, 10], [0, 0, 0]]
    assert samples.points.tolist() == [0, 1, 0]
    assert np.isnan(samples.position[[0, 2]]).all()
    assert np.isnan(samples.normal[[0, 2]]).all()
    assert not samples.in_world.any()


def test_no_messages_are_no_samples() -> None:
    samples = contact_samples(contacts_of([]))

    assert samples.force.shape == samples.position.shape == samples.normal.shape == (0, 3)
    assert len(samples.in_contact) == len(samples.points) == len(samples.in_world) == 0


def test_foot_and_times_are_those_of_the_message() -> None:
    contacts = contacts_of([(), (State(),), (State(), State())])

    samples = contact_samples(contacts)

    assert samples.foot.tolist() == [0, 1, 2]
    assert samples.log_time.tolist() == [1000, 1010, 1020]
    assert samples.stamp.tolist() == [0, 10, 20]
    assert samples.time.tolist() == [1000, 10, 20]  # a stamp of zero is none


def test_states_of_the_newest_step_add_up() -> None:
    samples = sample_of(State((1, 2, 30)), State((4, -2, 50)))

    assert samples.force.tolist() == [[5, 0, 80]]


def test_older_steps_do_not_count_in_anything() -> None:
    old = State(
        (7, 7, 700), ((9, 9, 9),), ((7, 7, 700),), ((1, 0, 0),), FOOT_IS_COLLISION2, newest=False
    )
    new = State((0, 3, 40), ((1, 2, 3),), ((0, 3, 40),), ((0, 0, 1),))

    samples = sample_of(old, old, new)

    assert samples.force.tolist() == [[0, 3, 40]]
    assert samples.points.tolist() == [1]
    assert samples.position.tolist() == [[1, 2, 3]]
    assert samples.normal.tolist() == [[0, 0, 1]]
    assert samples.in_world.tolist() == [False]


def test_a_message_of_older_steps_only_is_no_contact() -> None:
    samples = sample_of(State(newest=False))

    assert samples.in_contact.tolist() == [False]
    assert samples.force.tolist() == [[0, 0, 0]]


def test_states_of_other_pairs_do_not_count_in_anything() -> None:
    other = State((7, 7, 7), ((9, 9, 9),), ((7, 7, 7),), ((1, 0, 0),), NOT_THIS_FOOT)

    both, alone = sample_of(other, State()), sample_of(other)

    assert both.force.tolist() == [[0, 0, 10]]
    assert both.position.tolist() == [[0, 0, 0]]
    assert both.normal.tolist() == [[0, 0, 1]]
    assert both.points.tolist() == [1]
    assert alone.in_contact.tolist() == [False]
    assert alone.points.tolist() == [0]


def test_a_foot_that_is_the_second_body_feels_the_opposite_force_along_the_opposite_normal() -> (
    None
):
    samples = sample_of(State((1, -2, -30), normals=((0, 0, -1),), side=FOOT_IS_COLLISION2))

    assert samples.force.tolist() == [[-1, 2, 30]]
    assert samples.normal.tolist() == [[0, 0, 1]]
    assert samples.position.tolist() == [[0, 0, 0]]  # points are in the world anyway


@pytest.mark.parametrize(
    ("sides", "in_world"),
    [
        ((FOOT_IS_COLLISION2,), True),
        ((FOOT_IS_COLLISION2, FOOT_IS_COLLISION2), True),
        ((FOOT_IS_COLLISION1,), False),
        ((FOOT_IS_COLLISION1, FOOT_IS_COLLISION2), False),
        ((FOOT_IS_COLLISION2, NOT_THIS_FOOT), True),
        ((NOT_THIS_FOOT,), False),
        ((), False),
    ],
)
def test_a_force_is_in_the_world_frame_if_all_of_it_was_read_off_the_other_body(
    sides: tuple[int, ...],
    in_world: bool,  # noqa: FBT001
) -> None:
    samples = sample_of(*[State(side=side) for side in sides])

    assert samples.in_world.tolist() == [in_world]


# --- position ---------------------------------------------------------------------------------


def test_the_position_is_the_mean_of_the_points_weighted_by_their_forces() -> None:
    state = State(points=((0, 0, 0), (4, 8, 0)), wrenches=((0, 0, 3), (0, 1, 0)))

    samples = sample_of(state)

    assert samples.points.tolist() == [2]
    assert samples.position.tolist() == [[1, 2, 0]]


def test_points_of_all_states_count_by_their_forces() -> None:
    one = State(points=((0, 0, 0),), wrenches=((0, 0, 30),))
    other = State(points=((4, 4, 4), (4, 4, 4)), wrenches=((0, 5, 0), (5, 0, 0)))

    assert sample_of(one, other).position.tolist() == [[1, 1, 1]]


@pytest.mark.parametrize("wrenches", [(), ((0, 0, 99),), ((0, 0, 1), (0, 0, 9), (0, 0, 5))])
def test_where_points_and_wrenches_differ_in_number_points_share_the_total_force(
    wrenches: tuple[Vector, ...],
) -> None:
    shared = State((0, 0, 6), points=((0, 0, 0), (2, 0, 0)), wrenches=wrenches)
    paired = State((0, 0, 6), points=((7, 0, 0),), wrenches=((0, 6, 0),))

    assert sample_of(shared).position.tolist() == [[1, 0, 0]]
    assert sample_of(shared, paired).position.tolist() == [[4, 0, 0]]  # (3*0 + 3*2 + 6*7) / 12


@pytest.mark.parametrize("force", [(0, 0, 0), (0, 0, 10)])
def test_where_no_wrench_has_a_force_every_point_counts_alike(force: Vector) -> None:
    zero = State(force, points=((0, 0, 0), (2, 4, 0)), wrenches=((0, 0, 0), (0, 0, 0)))
    third = State(force, points=((4, 8, 0),), wrenches=((0, 0, 0),))

    assert sample_of(zero, third).position.tolist() == [[2, 4, 0]]


def test_a_state_without_points_adds_its_force_but_no_position() -> None:
    samples = sample_of(State((0, 0, 5), points=(), wrenches=()), State((0, 0, 1)))

    assert samples.force.tolist() == [[0, 0, 6]]
    assert samples.points.tolist() == [1]
    assert samples.position.tolist() == [[0, 0, 0]]


def test_contact_without_any_point_has_no_position() -> None:
    samples = sample_of(State(points=()))

    assert samples.in_contact.tolist() == [True]
    assert samples.points.tolist() == [0]
    assert np.isnan(samples.position).all()


def test_points_may_be_mixed_otherwise_than_wrenches() -> None:
    # The order of rows is promised for the points of one state only.
    heavy = State(points=((0, 0, 0), (1, 0, 0)), wrenches=((0, 0, 3), (0, 0, 1)))
    light = State(points=((5, 0, 0), (9, 0, 0)), wrenches=((0, 0, 1), (0, 0, 3)))
    straight = contacts_of([(heavy,), (light,)])
    rows = np.array([2, 0, 3, 1])
    mixed = replace(
        straight, wrench_state=straight.wrench_state[rows], wrench_force=straight.wrench_force[rows]
    )

    assert contact_samples(straight).position.tolist() == [[0.25, 0, 0], [8, 0, 0]]
    assert contact_samples(mixed).position.tolist() == [[0.25, 0, 0], [8, 0, 0]]


# --- normals ----------------------------------------------------------------------------------


def test_the_normal_is_the_unit_mean_of_the_normals() -> None:
    samples = sample_of(State(normals=((3, 0, 0), (0, 0, 4))), State(normals=()))

    assert samples.normal.tolist() == [[0.6, 0, 0.8]]


def test_normals_that_cancel_are_none() -> None:
    samples = sample_of(State(normals=((0, 0, 1), (0, 0, -1))))

    assert np.isnan(samples.normal).all()


def test_contact_without_normals_has_none() -> None:
    assert np.isnan(sample_of(State(normals=())).normal).all()


# --- what is not finite -----------------------------------------------------------------------


@pytest.mark.parametrize("force", [(NAN, 0, 0), (0, math.inf, 0), (0, 0, -math.inf), (1e200, 0, 0)])
def test_a_force_without_a_finite_magnitude_is_kept_and_told(force: Vector) -> None:
    samples = contact_samples(contacts_of([(State(),), (State(force),), (State(),)]))

    assert np.isfinite(norms(samples.force)).tolist() == [True, False, True]
    assert samples.in_contact.all()
    assert np.array_equal(samples.force[1], force, equal_nan=True)
    assert samples.force[[0, 2]].tolist() == [[0, 0, 10], [0, 0, 10]]


@pytest.mark.parametrize(
    "state",
    [
        State(points=((NAN, 0, 0),)),
        State(wrenches=((NAN, 0, 0),)),
        State(wrenches=((math.inf, 0, 0),)),
        State(points=((math.inf, 0, 0), (-math.inf, 0, 0)), wrenches=((0, 0, 1), (0, 0, 1))),
        State((NAN, 0, 0), wrenches=()),
    ],
)
def test_a_position_of_what_is_not_finite_is_not_finite_and_spoils_no_other(state: State) -> None:
    samples = contact_samples(contacts_of([(State(),), (state,), (State(),)]))

    assert not np.isfinite(samples.position[1]).all()
    assert samples.position[[0, 2]].tolist() == [[0, 0, 0], [0, 0, 0]]
    assert samples.normal.tolist() == [[0, 0, 1]] * 3


def test_normals_that_are_not_finite_spoil_no_other_message() -> None:
    messages: list[Message] = [(State(),), (State(normals=((NAN, 0, 1),)),), (State(),)]

    samples = contact_samples(contacts_of(messages))

    assert not np.isfinite(samples.normal[1]).all()
    assert samples.normal[[0, 2]].tolist() == [[0, 0, 1], [0, 0, 1]]


def test_picked_rows_keep_every_column() -> None:
    samples = contact_samples(contacts_of([(), (State((1, 2, 3)),), (State(),)]))

    picked = samples.pick(np.array([1]))

    assert picked.force.tolist() == [[1, 2, 3]]
    assert (picked.foot.tolist(), picked.log_time.tolist(), picked.stamp.tolist()) == (
        [1],
        [1010],
        [10],
    )
    assert (picked.in_contact.tolist(), picked.points.tolist()) == ([True], [1])
    assert samples.pick(samples.in_contact).force.tolist() == [[1, 2, 3], [0, 0, 10]]
