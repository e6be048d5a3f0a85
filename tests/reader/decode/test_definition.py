"""Recorded definitions become trees."""

from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
    Text,
    VariableArray,
    parse_definition,
)
from tests.reader.decode.definitions import CONTACTS_TEXT, SEPARATOR, STAMPED_IDL

F8, U4, I4, U1 = Primitive("f8"), Primitive("u4"), Primitive("i4"), Primitive("u1")


def vector(name: str = "geometry_msgs/msg/Vector3") -> Struct:
    return Struct(name, (("x", F8), ("y", F8), ("z", F8)))


def field(struct: FieldType, path: str) -> FieldType:
    """Follow a dotted path, through arrays as well."""
    for name in path.split("."):
        if isinstance(struct, FixedArray | VariableArray):
            struct = struct.element
        assert isinstance(struct, Struct)
        struct = dict(struct.fields)[name]
    return struct


# --- real definitions -------------------------------------------------------------------------


def test_idl_of_several_files_parses_as_recorders_join_them() -> None:
    rule = "=" * 80
    text = (
        f"{rule}\nIDL: demo/msg/Root\n"
        '#include "geometry_msgs/msg/Vector3.idl"\n'
        "module demo { module msg { struct Root { geometry_msgs::msg::Vector3 v; }; }; };\n"
        f"{rule}\nIDL: geometry_msgs/msg/Vector3\n"
        "module geometry_msgs { module msg {\n"
        '  @verbatim (language="comment", text="A \\"vector\\" (or a point)" "(in space)")\n'
        "  struct Vector3 { double x; double y; double z; };\n};};\n"
    )

    root = parse_definition("demo/msg/Root", text, "ros2idl")

    assert root == Struct("demo/msg/Root", (("v", vector()),))


def test_idl_parses() -> None:
    time = Struct("builtin_interfaces/msg/Time", (("sec", I4), ("nanosec", U4)))

    stamped = parse_definition("demo/msg/Stamped", STAMPED_IDL, "ros2idl")

    assert stamped == Struct(
        "demo/msg/Stamped",
        (
            ("stamp", time),
            ("position", FixedArray(F8, 3)),
            ("distances", VariableArray(F8)),
            ("names", VariableArray(Text())),
            ("label", Text()),
            ("valid", U1),
        ),
    )


def test_windows_line_ends_are_read_like_others() -> None:
    text = CONTACTS_TEXT.replace("\n", "\r\n")

    assert parse_definition("gazebo_msgs/ContactsState", text, "ros1msg") == parse_definition(
        "gazebo_msgs/ContactsState", CONTACTS_TEXT, "ros1msg"
    )


def test_constants_defaults_bounds_and_comments_are_no_fields() -> None:
    text = """\
        # a comment
        uint8 LEVEL=3
        string NAME = some text # not a comment
        int32 plain 5   # a default
        string<=7 bounded
        float64[<=4] few
    """

    assert parse_definition("demo/Root", text, "ros2msg").fields == (
        ("plain", I4),
        ("bounded", Text()),
        ("few", VariableArray(F8)),
    )


def test_a_recorded_time_wins_over_the_built_in_one() -> None:
    text = f"builtin_interfaces/Time t\n{SEPARATOR}\nMSG: builtin_interfaces/Time\nint64 ticks"

    assert field(parse_definition("demo/Root", text, "ros2msg"), "t.ticks") == Primitive("i8")


# --- questions about trees --------------------------------------------------------------------
