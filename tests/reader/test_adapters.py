"""Every adapter copes with messages that cannot be decoded: none, some, or all of a batch."""

import numpy as np
import pytest

from dogbot_logtool.reader.messages.table import types_of
from tests.reader import adapters
from tests.reader.adapters import ALL, DAMAGES, FOXGLOVE, POSES

COUNT = 12


MALFORMED = [
    (type_name, damage)
    for type_name in ALL
    for damage in DAMAGES
    # Protobuf has no fixed form: an empty message is a sound one.
    if not (type_name in (*FOXGLOVE, *POSES) and damage == "empty")
]


@pytest.mark.parametrize(("type_name", "damage"), MALFORMED)
def test_malformed_messages_leave_their_neighbours_alone(type_name: str, damage: str) -> None:
    channel, sound = adapters.channel(type_name), adapters.payloads(type_name, COUNT)
    harmed = [DAMAGES[damage](message) for message in sound]
    whole = adapters.read(channel, adapters.batch(sound))
    assert sorted(set(whole.log_time.tolist())) == adapters.batch(sound).messages.log_time.tolist()
    some = adapters.read(channel, adapters.batch([*sound[:4], *harmed[4:7], *sound[7:]]))
    assert (whole.malformed, some.malformed) == ({}, {1: 3})
    lost = adapters.batch(sound).messages.log_time[4:7]
    np.testing.assert_array_equal(some.log_time, whole.log_time[~np.isin(whole.log_time, lost)])
    for messages in ([], harmed):
        nothing = adapters.read(channel, adapters.batch(messages))
        assert len(nothing.log_time) == 0
        assert nothing.malformed == ({1: COUNT} if messages else {})


@pytest.mark.parametrize(
    "type_name", [*adapters.FOOT_TYPES, *adapters.VARIANTS, "tf2_msgs/TFMessage"]
)
def test_messages_of_nothing_are_sound(type_name: str) -> None:
    message = adapters.empty_payload(type_name)
    outcome = adapters.read(adapters.channel(type_name), adapters.batch([message] * COUNT))
    assert outcome.malformed == {}


def test_every_contact_source_is_tested() -> None:
    assert set(types_of("feet")) <= set(ALL)
