"""Messages in JSON and protobuf: what is read, and what is malformed."""

import json
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.fields import Field, Kind
from dogbot_logtool.reader.decode.objects import (
    check_object_type,
    decode_object,
    table_of_rows,
)

FIELDS = (
    Field("stamp", Kind.TIME),
    Field("name", Kind.TEXT),
    Field("at.x", Kind.NUMBER),
    Field("parts", Kind.TABLE, inside=(Field("size", Kind.NUMBER),)),
)
SOUND = {
    "stamp": {"sec": 5, "nsec": 7},
    "name": "é",
    "at": {"x": 2},
    "parts": [{"size": 1.5}, {"size": 2.5}],
}


def decoded(message: Any) -> Any:
    data = message if isinstance(message, bytes) else json.dumps(message).encode()
    return decode_object("foxglove.Any", "json", data, FIELDS)


def test_rows_become_columns() -> None:
    rows = [decoded(SOUND), decoded(SOUND | {"name": "b", "parts": []})]
    columns = table_of_rows(rows, FIELDS)
    assert columns.nanoseconds("stamp").tolist() == [5_000_000_007] * 2
    assert columns.texts("name").encode()[1] == ("é", "b")
    assert columns.numbers("at.x").tolist() == [2.0, 2.0]
    assert columns.nested("parts").parent.tolist() == [0, 0]
    np.testing.assert_array_equal(columns.nested("parts").table.numbers("size"), [1.5, 2.5])


@pytest.mark.parametrize(
    "message",
    [
        b"",
        b"\xff\xff",
        b"[1, 2]",
        b"null",
        b"[" * 100_000,
        b'{"stamp": ' + b"9" * 5000 + b"}",
        {},
        SOUND | {"name": 3},
        SOUND | {"at": {"x": True}},
        SOUND | {"at": {"x": "2"}},
        SOUND | {"at": {"x": 10**400}},
        SOUND | {"parts": 4},
        SOUND | {"parts": [{}]},
        SOUND | {"stamp": {"sec": None, "nsec": 0}},
        b" " * (1 << 20) + json.dumps(SOUND).encode(),
    ],
)
def test_other_messages_are_malformed(message: Any) -> None:
    assert decoded(message) is None


@pytest.mark.parametrize("stamp", [{"sec": -1, "nsec": 0}, {"sec": 10**30, "nsec": 0}])
def test_a_stamp_that_64_bits_do_not_hold_is_none(stamp: dict[str, int]) -> None:
    row = decoded(SOUND | {"stamp": stamp})
    assert table_of_rows([row], FIELDS).nanoseconds("stamp").tolist() == [0]


@pytest.mark.parametrize("name", ["sensor_msgs/Imu", "foxglove.NoSuchType"])
def test_types_that_are_not_known_are_refused(name: str) -> None:
    with pytest.raises(DefinitionError):
        check_object_type(name, "protobuf")
