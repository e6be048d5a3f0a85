"""Every adapter copes with messages that cannot be decoded: none, some, or all of a batch."""

import numpy as np
import pytest

from dogbot_logtool.reader.messages.table import types_of
from tests.reader import adapters
from tests.reader.adapters import ALL, DAMAGES, FOXGLOVE, POSES, Outcome

COUNT = 12
BAD = slice(4, 7)


def rows_of(outcome: Outcome) -> int:
    """Rows a message: feet, or transforms."""
    return len(outcome.log_time) // COUNT


MALFORMED = [
    (type_name, damage)
    for type_name in ALL
    for damage in DAMAGES
    # Protobuf has no fixed form: an empty message is a sound one.
    if not (type_name in (*FOXGLOVE, *POSES) and damage == "empty")
]


@pytest.mark.parametrize("type_name", ALL)
def test_no_messages_give_no_rows(type_name: str) -> None:
    outcome = adapters.read(adapters.channel(type_name), adapters.batch([]))
    assert len(outcome.log_time) == 0
    assert outcome.malformed == {}


@pytest.mark.parametrize("type_name", ALL)
def test_sound_messages_are_all_decoded(type_name: str) -> None:
    given = adapters.batch(adapters.payloads(type_name, COUNT))
    outcome = adapters.read(adapters.channel(type_name), given)
    assert outcome.malformed == {}
    assert rows_of(outcome) >= 1
    assert sorted(set(outcome.log_time.tolist())) == given.messages.log_time.tolist()


@pytest.mark.parametrize(("type_name", "damage"), MALFORMED)
def test_a_batch_of_nothing_but_malformed_messages(type_name: str, damage: str) -> None:
    given = adapters.batch([DAMAGES[damage](m) for m in adapters.payloads(type_name, COUNT)])
    outcome = adapters.read(adapters.channel(type_name), given)
    assert len(outcome.log_time) == 0
    assert outcome.malformed == {1: COUNT}


@pytest.mark.parametrize(("type_name", "damage"), MALFORMED)
def test_malformed_messages_leave_their_neighbours_alone(type_name: str, damage: str) -> None:
    sound = adapters.payloads(type_name, COUNT)
    messages = list(sound)
    messages[BAD] = [DAMAGES[damage](message) for message in messages[BAD]]
    whole = adapters.read(adapters.channel(type_name), adapters.batch(sound))
    outcome = adapters.read(adapters.channel(type_name), adapters.batch(messages))
    assert outcome.malformed == {1: 3}
    lost = adapters.batch(sound).messages.log_time[BAD]
    np.testing.assert_array_equal(outcome.log_time, whole.log_time[~np.isin(whole.log_time, lost)])


@pytest.mark.parametrize("type_name", adapters.WITH_ARRAYS)
def test_messages_of_nothing_are_sound(type_name: str) -> None:
    message = adapters.empty_payload(type_name)
    outcome = adapters.read(adapters.channel(type_name), adapters.batch([message] * COUNT))
    assert outcome.malformed == {}


def test_every_contact_source_is_tested() -> None:
    assert set(types_of("feet")) <= set(ALL)
