"""Definitions that name a known type with other fields: columns, or a sentence; never a crash."""

import struct
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
    Text,
    VariableArray,
    parse_definition,
)
from tests.reader import adapters
from tests.reader.adapters import DECODED

SEPARATOR = "=" * 80 + "\n"
KINDS = (
    "string",
    "wstring",
    "bool",
    "byte",
    "int8",
    "uint64",
    "float32",
    "float64",
    "time",
    "duration",
    "builtin_interfaces/Time",
    "std_msgs/Header",
    "missing_msgs/Missing",
)
SHAPES = ("", "[]", "[0]", "[2]", "[9]", "[<=3]")
ODOMETRY = "nav_msgs/Odometry"
CONTACTS = "gazebo_msgs/ContactsState"


def sections(type_name: str) -> list[list[str]]:
    """Return the lines of a definition's parts: the type's own, then its dependencies."""
    parts = adapters.definition(type_name).split(SEPARATOR)
    return [[line for line in part.splitlines() if line.strip()] for part in parts]


def joined(parts: list[list[str]]) -> str:
    return SEPARATOR.join("\n".join(part) + "\n" for part in parts)


@st.composite
def other_definitions(draw: st.DrawFn, type_name: str) -> str:
    """Draw a definition of the type with a few changes."""
    parts = sections(type_name)
    for _ in range(draw(st.integers(1, 3))):
        part = draw(st.sampled_from(parts))
        rows = [row for row, line in enumerate(part) if not line.startswith("MSG:")]
        if not rows:
            continue
        row = draw(st.sampled_from(rows))
        kind, _, name = part[row].partition(" ")
        other = draw(st.sampled_from(KINDS)) + draw(st.sampled_from(SHAPES))
        match draw(st.sampled_from(("kind", "shape", "twice", "gone", "last", "name", "constant"))):
            case "kind":
                part[row] = f"{other} {name}"
            case "shape":
                part[row] = f"{kind.partition('[')[0]}{draw(st.sampled_from(SHAPES))} {name}"
            case "twice":
                part.append(draw(st.sampled_from((part[row], f"{other} {name}"))))
            case "gone":
                del part[row]
            case "last":
                part.append(part.pop(row))
            case "name":
                part[row] = f"{kind} other_{name}"
            case "constant":
                part[row] = f"int32 {name}=1"
    return joined(parts)


@pytest.mark.parametrize("type_name", DECODED)
@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)
@given(st.data())
def test_other_definitions_give_columns_or_a_sentence(type_name: str, data: st.DataObject) -> None:
    text = data.draw(other_definitions(type_name))
    channel = adapters.channel(type_name, text)
    source = adapters.source(channel)
    if source is None:
        # Known by its fields alone, it is another type now.
        assert type_name in adapters.VARIANTS
        return
    if source.fault or source.own_definition:
        assert_is_sentence(source.fault or source.own_definition)
    if source.fault:
        return
    recorded = adapters.batch(adapters.payloads(type_name, 5))
    assert sum(adapters.read(channel, recorded).malformed.values()) <= 5
    if not source.own_definition:
        definition = parse_definition(type_name, text, "ros2msg")
        message = b"\0\1\0\0" + b"".join(serialised(definition, 0))
        outcome = adapters.read(channel, adapters.batch([message] * 5))
        assert outcome.malformed == {}


def assert_is_sentence(text: str) -> None:
    assert 20 < len(text) < 300
    assert "\n" not in text
    assert "Error" not in text


def serialised(definition: FieldType, position: int) -> Iterator[bytes]:
    """Yield a message in CDR: arrays of two elements, texts of two letters, all numbers one."""
    match definition:
        case Primitive(dtype):
            yield aligned(np.array(1, f"<{dtype}").tobytes(), position, definition.size)
        case Text():
            yield aligned(struct.pack("<I", 3) + b"ab\0", position, 4)
        case VariableArray(element):
            count = aligned(struct.pack("<I", 2), position, 4)
            yield count
            yield from in_order([element] * 2, position + len(count))
        case FixedArray(element, length):
            yield from in_order([element] * length, position)
        case Struct(_, fields):
            yield from in_order([inner for _, inner in fields], position)


def in_order(parts: list[FieldType], position: int) -> Iterator[bytes]:
    for part in parts:
        for data in serialised(part, position):
            position += len(data)
            yield data


def aligned(data: bytes, position: int, size: int) -> bytes:
    return bytes(-position % size) + data


@pytest.mark.parametrize(
    ("type_name", "old", "new", "path", "expected"),
    [
        (
            ODOMETRY,
            "builtin_interfaces/Time stamp",
            "builtin_interfaces/Time[3] stamp",
            "header.stamp",
            "a single time",
        ),
        (ODOMETRY, "float64 x", "string x", "pose.pose.position.x", "a single number"),
        (ODOMETRY, "string frame_id", "uint8[] frame_id", "header.frame_id", "a single string"),
        (
            ODOMETRY,
            "geometry_msgs/PoseWithCovariance pose",
            "geometry_msgs/PoseWithCovariance[] pose",
            "pose",
            "a single message",
        ),
        (
            CONTACTS,
            "geometry_msgs/Vector3[] contact_positions",
            "geometry_msgs/Vector3 contact_positions",
            "states.contact_positions",
            "an array of messages",
        ),
        (
            "champ_msgs/ContactsStamped",
            "bool[] contacts",
            "string contacts",
            "contacts",
            "a sequence of numbers",
        ),
        (
            "unitree_go/LowState",
            "int16[4] foot_force\n",
            "int16[2] foot_force\n",
            "foot_force",
            "a fixed array of at least 4 numbers",
        ),
    ],
)
def test_a_field_of_another_kind_is_named(
    type_name: str, old: str, new: str, path: str, expected: str
) -> None:
    text = adapters.definition(type_name)
    assert old in text
    source = adapters.source(adapters.channel(type_name, text.replace(old, new)))
    found = new.split(" ", maxsplit=1)[0]
    assert source
    assert source.fault == (
        f"field '{path}' of {type_name} must be {expected}, but the log's definition has {found}"
    )


def test_a_missing_field_is_named() -> None:
    text = adapters.definition(ODOMETRY).replace("string frame_id", "string frame")
    source = adapters.source(adapters.channel(ODOMETRY, text))
    assert source
    assert "has no field 'header.frame_id', which" in source.fault


def test_a_definition_with_a_field_twice_is_none() -> None:
    line = "string child_frame_id\n"
    text = adapters.definition(ODOMETRY).replace(line, line * 2)
    source = adapters.source(adapters.channel(ODOMETRY, text))
    assert source
    assert source.own_definition == (
        "the definition of nav_msgs/msg/Odometry has the field 'child_frame_id' twice"
    )


@pytest.mark.parametrize("type_name", DECODED)
def test_the_usual_definition_fits(type_name: str) -> None:
    source = adapters.source(adapters.channel(type_name))
    assert source
    assert (source.fault, source.own_definition) == ("", "")


@pytest.mark.parametrize(
    "type_name",
    [
        ODOMETRY,
        CONTACTS,
        "tf2_msgs/TFMessage",
        "tf/tfMessage",
        "ros_gz_interfaces/Contacts",
        "geometry_msgs/WrenchStamped",
        "champ_msgs/ContactsStamped",
    ],
)
@pytest.mark.parametrize("text", ["", "%%%"])
def test_our_own_definition_reads_the_same(type_name: str, text: str) -> None:
    given = adapters.batch(adapters.payloads(type_name, 5))
    channel = adapters.channel(type_name, text)
    source = adapters.source(channel)
    assert source
    assert source.own_definition
    outcome, usual = (adapters.read(each, given) for each in (channel, adapters.channel(type_name)))
    assert outcome.malformed == {}
    np.testing.assert_array_equal(outcome.log_time, usual.log_time)


def test_types_that_differ_from_version_to_version_need_the_log_s_definition() -> None:
    source = adapters.source(adapters.channel("spot_msgs/FootStateArray", ""))
    assert source
    assert "the log has no definition of spot_msgs/" in source.fault
