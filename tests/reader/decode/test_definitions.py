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

F8, U4, I4, U1 = Primitive("f8"), Primitive("u4"), Primitive("i4"), Primitive("u1")
SEPARATOR: Final = "=" * 80
CONTACTS_TEXT: Final = f"""\
Header header                                   # stamp
gazebo_msgs/ContactState[] states            # array of geom pairs in contact

{SEPARATOR}
MSG: std_msgs/Header
# Standard metadata for higher-level stamped data types.
uint32 seq
time stamp
string frame_id

{SEPARATOR}
MSG: gazebo_msgs/ContactState
string info                                   # text info on this contact
float64[] depths                              # list of penetration depths
"""
STAMPED_IDL: Final = """\
module builtin_interfaces {
  module msg {
    @verbatim (language="comment", text=
      "Time indicates a specific point in time.")
    struct Time {
      @verbatim (language="comment", text="The seconds component.")
      int32 sec;
      uint32 nanosec;
    };
  };
};
module demo {
  module msg {
    typedef double double__3[3];
    struct Stamped {
      builtin_interfaces::msg::Time stamp;
      @unit (value="m")
      double__3 position;
      sequence<double> distances;
      sequence<string, 4> names;
      string<10> label;
      boolean valid;
    };
  };
};
"""
SEVERAL_IDL: Final = (
    f"{SEPARATOR}\nIDL: demo/msg/Root\n"
    '#include "geometry_msgs/msg/Vector3.idl"\n'
    "module demo { module msg { struct Root { geometry_msgs::msg::Vector3 v; }; }; };\n"
    f"{SEPARATOR}\nIDL: geometry_msgs/msg/Vector3\n"
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


UNPARSABLE: Final = ("3 is no field", "int32 x y z\n}", "int32[][] x", "\0", "int32 x\nint32[3 y")
LENGTHS: Final = ("-3", "1 << 99999999999999999999", "1 / 0", "MISSING", "((3))")
IN_A_RING: Final = f"demo/A a\n{SEPARATOR}\nMSG: demo/A\ndemo/B[] b\n{SEPARATOR}\nMSG: demo/B\nA a"
ROOT: Final = "demo/Root"


@pytest.mark.parametrize(
    ("name", "text", "encoding", "why"),
    [
        *(
            (ROOT, text, encoding, ROOT)
            for text in UNPARSABLE
            for encoding in ("ros1msg", "ros2msg", "ros2idl")
        ),
        (ROOT, "int32 x", "", "not read"),
        (ROOT, "int32 x", "protobuf", "not read"),
        *((name, idl("long x"), "ros2idl", ".") for name in ("", "demo/Other", "/")),
        *((name, "int32 x", "ros1msg", ".") for name in ("", "Root", "demo/Ro ot", "demo/Root\0")),
        (ROOT, idl("wstring x"), "ros2idl", "not read"),
        (ROOT, idl("long double x"), "ros2idl", "not read"),
        *((ROOT, idl(f"long x[{length}]"), "ros2idl", ".") for length in LENGTHS),
        (ROOT, "demo/Root x", "ros1msg", "contains itself"),
        (ROOT, IN_A_RING, "ros1msg", "contains itself"),
        (ROOT, "geometry_msgs/Vector3 x", "ros1msg", "geometry_msgs/msg/Vector3"),
        (ROOT, "float128 x", "ros1msg", "float128"),
        *((ROOT, f"float64[{length}] x", "ros1msg", "absurd") for length in (2**28, 10**30)),
        (ROOT, "string[-1] x", "ros1msg", "."),
        (ROOT, f"string[{2**31}] x", "ros1msg", "absurd"),
        (ROOT, f"Inner[{2**31}] x\n{SEPARATOR}\nMSG: demo/Inner\n", "ros1msg", "absurd"),
        (ROOT, f"Inner[] x\n{SEPARATOR}\nMSG: demo/Inner\n", "ros1msg", "absurd"),
        (ROOT, "float64[0] x", "ros1msg", "absurd"),
        (ROOT, "\n".join(f"uint8[{2**30}] x{n}" for n in range(3)), "ros1msg", "absurd"),
        (ROOT, "#" * 2_000_001, "ros1msg", "2000001 characters"),
        (ROOT, levels(20, "a", "b"), "ros1msg", "fields"),
        (ROOT, levels(40, "a"), "ros1msg", "too deep"),
    ],
    ids=lambda each: each[:30] if isinstance(each, str) else None,
)
def test_what_no_message_can_be_is_refused(name: str, text: str, encoding: str, why: str) -> None:
    with pytest.raises(DefinitionError, match=why):
        parse_definition(name, text, encoding)


@given(
    place=st.integers(0, 1000),
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
