"""Messages in JSON and protobuf: what is read, and what is malformed."""

import json
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.columns import Table
from dogbot_logtool.reader.decode.message_layout import compile_layout
from dogbot_logtool.reader.decode.objects import as_ros1, object_definition
from tests.reader.decode.oracle import decode_messages

DEFINITION = object_definition("foxglove.JointStates", "json")
KNEE = {"name": "é", "position": 2}
SOUND = {"timestamp": {"sec": 5, "nsec": 7}, "joints": [KNEE, {"name": "b"}]}


def written(message: Any) -> bytes | None:
    data = message if isinstance(message, bytes) else json.dumps(message).encode()
    return as_ros1("foxglove.JointStates", "json", data, DEFINITION)


def decoded(*messages: Any) -> Table:
    data = [written(each) or b"" for each in messages]
    table, sound = decode_messages(compile_layout(DEFINITION, "ros1", None), data)
    assert sound.all()
    return table


def test_messages_become_columns() -> None:
    table = decoded(SOUND, {}, {"joints": [{}]})
    assert table.nanoseconds("timestamp").tolist() == [5_000_000_007, 0, 0]
    joints = table.nested("joints")
    assert joints.parent.tolist() == [0, 0, 2]
    assert joints.table.texts("name").encode()[1] == ("é", "b", "")
    np.testing.assert_array_equal(joints.table.numbers("position"), [2.0, np.nan, np.nan])


@pytest.mark.parametrize(
    "message",
    [
        b"",
        b"\xff\xff",
        b"[1, 2]",
        b"null",
        b"[" * 100_000,
        b'{"timestamp": ' + b"9" * 5000 + b"}",
        SOUND | {"joints": [KNEE | {"name": 3}]},
        SOUND | {"joints": [KNEE | {"position": True}]},
        SOUND | {"joints": [KNEE | {"position": "2"}]},
        SOUND | {"joints": [KNEE | {"position": 10**400}]},
        SOUND | {"joints": 4},
        SOUND | {"joints": [7]},
        SOUND | {"timestamp": {"sec": None, "nsec": 0}},
        b" " * (1 << 20) + json.dumps(SOUND).encode(),
    ],
)
def test_other_messages_are_malformed(message: Any) -> None:
    assert written(message) is None


@pytest.mark.parametrize("stamp", [{"sec": -1, "nsec": 0}, {"sec": 10**30, "nsec": 0}])
def test_a_stamp_that_times_do_not_hold_is_none(stamp: dict[str, int]) -> None:
    assert decoded(SOUND | {"timestamp": stamp}).nanoseconds("timestamp").tolist() == [0]


@pytest.mark.parametrize("name", ["sensor_msgs/Imu", "foxglove.NoSuchType"])
def test_types_that_are_not_known_are_refused(name: str) -> None:
    with pytest.raises(DefinitionError):
        object_definition(name, "protobuf")
