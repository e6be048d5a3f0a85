"""Every adapter copes with what it cannot decode: messages, or definitions with other fields."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dogbot_logtool.reader.messages.source import Source
from dogbot_logtool.reader.messages.table import types_of
from tests.reader import adapters
from tests.reader.adapters import ALL, DAMAGES, DECODED, FOXGLOVE, POSES

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


def source_of(type_name: str, text: str) -> Source:
    source = adapters.source(adapters.channel(type_name, text))
    assert source
    return source


def assert_is_sentence(text: str) -> None:
    assert 20 < len(text) < 300
    assert "\n" not in text
    assert "Error" not in text


@pytest.mark.parametrize(
    ("line", "other", "says"),
    [
        ("float64 x", "string x", "position.x' of nav_msgs/Odometry must be a single number, but"),
        ("string frame_id", "string frame", "has no field 'header.frame_id', which"),
        (
            "string child_frame_id\n",
            "bool i\nbool i\n",
            "nav_msgs/msg/Odometry has the field 'i' twice",
        ),
    ],
)
def test_what_is_wrong_with_a_field_is_said(line: str, other: str, says: str) -> None:
    source = source_of(ODOMETRY, adapters.definition(ODOMETRY).replace(line, other))
    assert says in (source.fault or source.own_definition)


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
    source = source_of("spot_msgs/FootStateArray", "")
    assert "the log has no definition of spot_msgs/" in source.fault
