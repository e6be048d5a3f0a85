"""What no message can be is refused, whatever its text."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.definition import (
    Struct,
    parse_definition,
)
from tests.reader.decode.definitions import CONTACTS_TEXT, SEPARATOR, STAMPED_IDL, ros1


@pytest.mark.parametrize(
    "text",
    [
        "3 is no field",
        "int32",
        "int32 x y z\n}",
        "int32[ x",
        "int32[][] x",
        "int32 x\nint32[3 y",
        "\0",
    ],
)
@pytest.mark.parametrize("encoding", ["ros1msg", "ros2msg", "ros2idl"])
def test_what_cannot_be_parsed_is_refused(text: str, encoding: str) -> None:
    with pytest.raises(DefinitionError, match="demo/Root"):
        parse_definition("demo/Root", text, encoding)


@pytest.mark.parametrize("encoding", ["", "protobuf", "jsonschema", "ROS1MSG"])
def test_other_schema_encodings_are_refused(encoding: str) -> None:
    with pytest.raises(DefinitionError, match="not read"):
        parse_definition("demo/Root", "int32 x", encoding)


@pytest.mark.parametrize("name", ["", "Root", "demo/Root\nint32 y", "demo/Other", "demo/", "/"])
def test_a_type_that_its_text_does_not_define_is_refused(name: str) -> None:
    text = "module demo { module msg { struct Root { long x; }; }; };"

    with pytest.raises(DefinitionError):
        parse_definition(name, text, "ros2idl")


@pytest.mark.parametrize("name", ["", "Root", "demo/Root\nint32 y", "demo/Ro ot", "demo/Root\0"])
def test_a_name_that_no_type_has_is_refused(name: str) -> None:
    with pytest.raises(DefinitionError):
        parse_definition(name, "int32 x", "ros1msg")


@pytest.mark.parametrize("array", ["", "[]", "[2]"])
def test_a_message_that_contains_itself_is_refused(array: str) -> None:
    with pytest.raises(DefinitionError, match="contains itself"):
        ros1(f"demo/Root{array} x")
    with pytest.raises(DefinitionError, match="contains itself"):
        ros1(f"demo/A a\n{SEPARATOR}\nMSG: demo/A\ndemo/B{array} b\n{SEPARATOR}\nMSG: demo/B\nA a")


def test_a_missing_dependency_is_named() -> None:
    with pytest.raises(DefinitionError, match="geometry_msgs/msg/Vector3"):
        ros1("geometry_msgs/Vector3 x")


@pytest.mark.parametrize("kind", ["wstring", "float128", "int128", "wchar"])
def test_field_types_that_are_not_ros_types_are_refused(kind: str) -> None:
    with pytest.raises(DefinitionError, match=kind):
        ros1(f"{kind} x")


@pytest.mark.parametrize("kind", ["wstring", "wchar", "long double"])
def test_idl_field_types_that_are_not_ros_types_are_refused(kind: str) -> None:
    text = f"module demo {{ module msg {{ struct Root {{ {kind} x; }}; }}; }};"

    with pytest.raises(DefinitionError, match="not read"):
        parse_definition("demo/Root", text, "ros2idl")


@pytest.mark.parametrize("length", [2**28, 2**31, 2**63, 2**64, 10**30])
def test_an_absurdly_long_array_is_refused(length: int) -> None:
    with pytest.raises(DefinitionError, match="absurd"):
        ros1(f"float64[{length}] x")


@pytest.mark.parametrize("element", ["float64", "string", "Inner"])
def test_an_array_of_negative_length_is_refused(element: str) -> None:
    with pytest.raises(DefinitionError):
        ros1(f"{element}[-1] x\n{SEPARATOR}\nMSG: demo/Inner\nint32 x")


@pytest.mark.parametrize("length", [2**31, 10**30])
@pytest.mark.parametrize("element", ["string", "Inner"])
def test_an_absurdly_long_array_of_uneven_elements_is_refused(element: str, length: int) -> None:
    with pytest.raises(DefinitionError, match="absurd"):
        ros1(f"{element}[{length}] x\n{SEPARATOR}\nMSG: demo/Inner\nstring text")


@pytest.mark.parametrize("length", ["-3", "1 << 99999999999999999999", "1 / 0", "2.5", "MISSING"])
def test_idl_array_lengths_that_are_no_lengths_are_refused(length: str) -> None:
    text = f"module demo {{ module msg {{ struct Root {{ long x[{length}]; }}; }}; }};"

    with pytest.raises(DefinitionError):
        parse_definition("demo/Root", text, "ros2idl")


def test_a_huge_text_is_refused_unparsed() -> None:
    with pytest.raises(DefinitionError, match="2000001 characters"):
        ros1("#" * 2_000_001)


def test_a_definition_that_unfolds_to_too_many_fields_is_refused() -> None:
    levels = [
        f"MSG: demo/Level{level}\n" + f"Level{level + 1} a\nLevel{level + 1} b\n"
        for level in range(20)
    ]
    text = f"\n{SEPARATOR}\n".join(["Level0 root", *levels, "MSG: demo/Level20\nint32 x"])

    with pytest.raises(DefinitionError, match="fields"):
        ros1(text)


def test_a_definition_that_is_too_deep_is_refused() -> None:
    levels = [f"MSG: demo/Level{level}\nLevel{level + 1} a" for level in range(40)]
    text = f"\n{SEPARATOR}\n".join(["Level0 root", *levels, "MSG: demo/Level40\nint32 x"])

    with pytest.raises(DefinitionError, match="too deep"):
        ros1(text)


@given(
    place=st.integers(0, 1500),
    removed=st.integers(0, 30),
    # No parentheses: rosbags' IDL parser takes 50 times longer for every level of them.
    added=st.text("\n =[]<>{};:,#/@\"'-+*_aZ09é\0", max_size=8),
)
@settings(max_examples=75, deadline=None)
def test_a_damaged_definition_is_parsed_or_refused_with_one_error(
    place: int, removed: int, added: str
) -> None:
    for name, text, encoding in (
        ("gazebo_msgs/ContactsState", CONTACTS_TEXT, "ros1msg"),
        ("demo/msg/Stamped", STAMPED_IDL, "ros2idl"),
    ):
        start = place % len(text)
        damaged = text[:start] + added + text[start + removed :]
        try:
            tree = parse_definition(name, damaged, encoding)
        except DefinitionError:
            continue
        assert isinstance(tree, Struct)
