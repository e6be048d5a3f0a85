"""Definitions that name a known type with other fields: columns, or a sentence; never a crash."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.messages.source import Source
from tests.reader import adapters
from tests.reader.adapters import DECODED

SEPARATOR = "=" * 80 + "\n"
KINDS = (
    *("string", "wstring", "bool", "byte", "int8", "uint64", "float32", "float64", "time"),
    *("builtin_interfaces/Time", "std_msgs/Header", "missing_msgs/Missing"),
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


def source_of(type_name: str, text: str | None = None) -> Source:
    """Return how messages of a definition are read."""
    source = adapters.source(adapters.channel(type_name, text))
    assert source
    return source


def fault(type_name: str, text: str | None = None) -> str:
    return source_of(type_name, text).fault


def assert_is_sentence(text: str) -> None:
    assert 20 < len(text) < 300
    assert "\n" not in text
    assert "Error" not in text


def test_a_field_of_another_kind_is_named() -> None:
    text = adapters.definition(ODOMETRY).replace("float64 x", "string x")
    assert fault(ODOMETRY, text) == (
        "field 'pose.pose.position.x' of nav_msgs/Odometry must be a single number, but the log's "
        "definition has string"
    )


def test_a_missing_field_is_named() -> None:
    text = adapters.definition(ODOMETRY).replace("string frame_id", "string frame")
    assert "has no field 'header.frame_id', which" in fault(ODOMETRY, text)


def test_a_definition_with_a_field_twice_is_none() -> None:
    line = "string child_frame_id\n"
    text = adapters.definition(ODOMETRY).replace(line, line * 2)
    assert source_of(ODOMETRY, text).own_definition == (
        "the definition of nav_msgs/msg/Odometry has the field 'child_frame_id' twice"
    )


@pytest.mark.parametrize("type_name", [ODOMETRY, CONTACTS, "tf2_msgs/TFMessage", "tf/tfMessage"])
@pytest.mark.parametrize("text", ["", "%%%"])
def test_our_own_definition_reads_the_same(type_name: str, text: str) -> None:
    given = adapters.batch(adapters.payloads(type_name, 5))
    channel = adapters.channel(type_name, text)
    assert source_of(type_name, text).own_definition
    outcome, usual = (adapters.read(each, given) for each in (channel, adapters.channel(type_name)))
    assert outcome.malformed == {}
    np.testing.assert_array_equal(outcome.log_time, usual.log_time)


def test_types_that_differ_from_version_to_version_need_the_log_s_definition() -> None:
    assert "the log has no definition of spot_msgs/" in fault("spot_msgs/FootStateArray", "")
