"""Recorded definitions: the trees that they become, as rosbags parses them; or a refusal."""

from typing import Any, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.errors import DefinitionError
from dogbot_logtool.reader.decode.definition import (
    FixedArray,
    Primitive,
    Struct,
    Text,
    VariableArray,
    parse_definition,
)
from tests.reader.decode.definitions import CONTACTS_TEXT, SEPARATOR, STAMPED_IDL

F8, U4, I4, U1 = Primitive("f8"), Primitive("u4"), Primitive("i4"), Primitive("u1")
RULE: Final = "=" * 80
SEVERAL_IDL: Final = (
    f"{RULE}\nIDL: demo/msg/Root\n"
    '#include "geometry_msgs/msg/Vector3.idl"\n'
    "module demo { module msg { struct Root { geometry_msgs::msg::Vector3 v; }; }; };\n"
    f"{RULE}\nIDL: geometry_msgs/msg/Vector3\n"
    "module geometry_msgs { module msg {\n"
    '  @verbatim (language="comment", text="A \\"vector\\" (or a point)" "(in space)")\n'
    "  struct Vector3 { double x; double y; double z; };\n};};\n"
)
MSG: Final = """\
    # a comment
    uint8 LEVEL=3
    string NAME = some text # not a comment
    int32 plain 5   # a default
    string<=7 bounded
    float64[<=4] few
"""
OWN_TIME: Final = (
    f"builtin_interfaces/Time t\n{SEPARATOR}\nMSG: builtin_interfaces/Time\nint64 ticks"
)


@pytest.mark.parametrize(
    ("name", "text", "encoding", "fields"),
    [
        (
            "demo/msg/Stamped",
            STAMPED_IDL,
            "ros2idl",
            {
                "stamp": Struct("builtin_interfaces/msg/Time", (("sec", I4), ("nanosec", U4))),
                "position": FixedArray(F8, 3),
                "distances": VariableArray(F8),
                "names": VariableArray(Text()),
                "label": Text(),
                "valid": U1,
            },
        ),
        (
            "demo/msg/Root",
            SEVERAL_IDL,
            "ros2idl",
            {"v": Struct("geometry_msgs/msg/Vector3", (("x", F8), ("y", F8), ("z", F8)))},
        ),
        (
            "demo/Root",
            MSG,
            "ros2msg",
            {"plain": I4, "bounded": Text(), "few": VariableArray(F8)},
        ),
        (
            "demo/Root",
            OWN_TIME,
            "ros2msg",
            {"t": Struct("builtin_interfaces/msg/Time", (("ticks", Primitive("i8")),))},
        ),
    ],
    ids=["IDL", "IDL of several files", "constants, defaults, bounds", "a time of its own"],
)
def test_definitions_become_trees(name: str, text: str, encoding: str, fields: Any) -> None:
    assert dict(parse_definition(name, text, encoding).fields) == fields


def test_windows_line_ends_are_read_like_others() -> None:
    name, text = "gazebo_msgs/ContactsState", CONTACTS_TEXT.replace("\n", "\r\n")
    other = parse_definition(name, CONTACTS_TEXT, "ros1msg")
    assert parse_definition(name, text, "ros1msg") == other


def idl(field: str) -> str:
    return f"module demo {{ module msg {{ struct Root {{ {field}; }}; }}; }};"


def levels(count: int, *fields: str) -> str:
    """Return a definition of messages within messages."""
    inner = [
        f"MSG: demo/Level{level}\n" + "".join(f"Level{level + 1} {field}\n" for field in fields)
        for level in range(count)
    ]
    last = f"MSG: demo/Level{count}\nint32 x"
    return f"\n{SEPARATOR}\n".join(["Level0 root", *inner, last])


def with_inner(field: str, inner: str = "int32 x") -> str:
    return f"{field}\n{SEPARATOR}\nMSG: demo/Inner\n{inner}"


UNPARSABLE: Final = ("3 is no field", "int32", "int32 x y z\n}", "int32[ x", "int32[][] x", "\0")
NAMES: Final = ("", "Root", "demo/Root\nint32 y", "demo/Ro ot", "demo/Root\0")
IDL_NAMES: Final = ("", "Root", "demo/Root\nint32 y", "demo/Other", "demo/", "/")
LENGTHS: Final = ("-3", "1 << 99999999999999999999", "1 / 0", "2.5", "MISSING")
IN_A_RING: Final = f"demo/A a\n{SEPARATOR}\nMSG: demo/A\ndemo/B%s b\n{SEPARATOR}\nMSG: demo/B\nA a"


@pytest.mark.parametrize(
    ("name", "text", "encoding", "why"),
    [
        *(
            ("demo/Root", text, encoding, "demo/Root")
            for text in (*UNPARSABLE, "int32 x\nint32[3 y")
            for encoding in ("ros1msg", "ros2msg", "ros2idl")
        ),
        *(
            ("demo/Root", "int32 x", encoding, "not read")
            for encoding in ("", "protobuf", "jsonschema", "ROS1MSG")
        ),
        *((name, idl("long x"), "ros2idl", ".") for name in IDL_NAMES),
        *((name, "int32 x", "ros1msg", ".") for name in NAMES),
        *(("demo/Root", idl(f"{each} x"), "ros2idl", "not read") for each in ("wstring", "wchar")),
        ("demo/Root", idl("long double x"), "ros2idl", "not read"),
        *(("demo/Root", idl(f"long x[{length}]"), "ros2idl", ".") for length in LENGTHS),
        *(
            ("demo/Root", text % array, "ros1msg", "contains itself")
            for array in ("", "[]", "[2]")
            for text in ("demo/Root%s x", IN_A_RING)
        ),
        ("demo/Root", "geometry_msgs/Vector3 x", "ros1msg", "geometry_msgs/msg/Vector3"),
        *(
            ("demo/Root", f"{kind} x", "ros1msg", kind)
            for kind in ("wstring", "float128", "int128", "wchar")
        ),
        *(
            ("demo/Root", f"float64[{length}] x", "ros1msg", "absurd")
            for length in (2**28, 2**31, 2**63, 2**64, 10**30)
        ),
        *(
            ("demo/Root", with_inner(f"{kind}[-1] x"), "ros1msg", ".")
            for kind in ("float64", "string", "Inner")
        ),
        *(
            ("demo/Root", with_inner(f"{kind}[{length}] x", "string text"), "ros1msg", "absurd")
            for kind in ("string", "Inner")
            for length in (2**31, 10**30)
        ),
        ("demo/Root", with_inner("Inner[2147483648] x", ""), "ros1msg", "absurd"),
        ("demo/Root", "#" * 2_000_001, "ros1msg", "2000001 characters"),
        ("demo/Root", levels(20, "a", "b"), "ros1msg", "fields"),
        ("demo/Root", levels(40, "a"), "ros1msg", "too deep"),
    ],
    ids=lambda each: each[:30] if isinstance(each, str) else None,
)
def test_what_no_message_can_be_is_refused(name: str, text: str, encoding: str, why: str) -> None:
    with pytest.raises(DefinitionError, match=why):
        parse_definition(name, text, encoding)


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
