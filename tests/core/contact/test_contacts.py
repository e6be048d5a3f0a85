"""Contact messages become one sample each."""

import math
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import (
    Samples,
    contact_samples,
)
from tests.core.contact.states import State, contacts_of

NAN: Final = math.nan
NOWHERE: Final = [NAN, NAN, NAN]


def sample_of(*states: State) -> Samples:
    return contact_samples(contacts_of([states]))


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
