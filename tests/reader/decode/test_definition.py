"""Recorded definitions become trees."""

from typing import Final

import pytest
from rosbags.typesys import Stores, get_typestore

from dogbot_logtool.reader.decode.definition import (
    FieldType,
    FixedArray,
    Primitive,
    Struct,
    Text,
    VariableArray,
    fixed_size,
    parse_definition,
    short_type_name,
    smallest_size,
)
from tests.reader.decode.definitions import CONTACTS_TEXT, SEPARATOR, STAMPED_IDL, ros1

F8, U4, I4, U1 = Primitive("f8"), Primitive("u4"), Primitive("i4"), Primitive("u1")

ODOMETRY: Final = "nav_msgs/msg/Odometry"


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


@pytest.mark.parametrize(
    ("store", "version", "encoding"),
    [
        (Stores.ROS1_NOETIC, 1, "ros1msg"),
        (Stores.ROS2_HUMBLE, 2, "ros2msg"),
        (Stores.ROS2_JAZZY, 2, "ros2msg"),
    ],
)
@pytest.mark.parametrize("name", [ODOMETRY, "nav_msgs/Odometry"])
def test_odometry_parses_under_either_spelling_of_its_name(
    store: Stores, version: int, encoding: str, name: str
) -> None:
    text, _ = get_typestore(store).generate_msgdef(ODOMETRY, ros_version=version)

    odometry = parse_definition(name, text, encoding)

    assert odometry.name == ODOMETRY
    assert [name for name, _ in odometry.fields] == ["header", "child_frame_id", "pose", "twist"]
    assert field(odometry, "header.frame_id") == Text()
    assert field(odometry, "pose.pose.orientation.w") == F8
    assert field(odometry, "pose.covariance") == FixedArray(F8, 36)
    assert field(odometry, "twist.twist.linear") == vector()
    header = field(odometry, "header")
    assert isinstance(header, Struct)
    assert ("seq" in dict(header.fields)) == (version == 1)


def test_contacts_state_parses() -> None:
    contacts = parse_definition("gazebo_msgs/ContactsState", CONTACTS_TEXT, "ros1msg")

    wrench = Struct("geometry_msgs/msg/Wrench", (("force", vector()), ("torque", vector())))
    assert field(contacts, "states.info") == Text()
    assert field(contacts, "states.wrenches") == VariableArray(wrench)
    assert field(contacts, "states.total_wrench") == wrench
    assert field(contacts, "states.contact_normals") == VariableArray(vector())
    assert field(contacts, "states.depths") == VariableArray(F8)


def test_tf_message_parses() -> None:
    stamped, _ = get_typestore(Stores.ROS1_NOETIC).generate_msgdef(
        "geometry_msgs/msg/TransformStamped", ros_version=1
    )
    text = (
        f"geometry_msgs/TransformStamped[] transforms\n{SEPARATOR}\n"
        f"MSG: geometry_msgs/TransformStamped\n{stamped}"
    )

    tf = parse_definition("tf2_msgs/TFMessage", text, "ros1msg")

    assert isinstance(field(tf, "transforms"), VariableArray)
    assert field(tf, "transforms.child_frame_id") == Text()
    assert field(tf, "transforms.transform.translation") == vector()


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


@pytest.mark.parametrize(
    ("kind", "dtype"),
    [
        ("bool", "u1"),
        ("char", "u1"),
        ("int8", "i1"),
        ("uint8", "u1"),
        ("int16", "i2"),
        ("uint16", "u2"),
        ("int32", "i4"),
        ("uint32", "u4"),
        ("int64", "i8"),
        ("uint64", "u8"),
        ("float32", "f4"),
        ("float64", "f8"),
    ],
)
def test_primitives_have_their_widths(kind: str, dtype: str) -> None:
    assert ros1(f"{kind} x").fields == (("x", Primitive(dtype)),)


def test_a_recorded_time_wins_over_the_built_in_one() -> None:
    text = f"builtin_interfaces/Time t\n{SEPARATOR}\nMSG: builtin_interfaces/Time\nint64 ticks"

    assert field(parse_definition("demo/Root", text, "ros2msg"), "t.ticks") == Primitive("i8")


def test_an_empty_ros1_message_has_no_fields() -> None:
    assert ros1("# nothing\n").fields == ()


# --- questions about trees --------------------------------------------------------------------


@pytest.mark.parametrize("name", ["nav_msgs/Odometry", "nav_msgs/msg/Odometry"])
def test_short_type_names_have_no_msg_part(name: str) -> None:
    assert short_type_name(name) == "nav_msgs/Odometry"


def test_sizes_of_a_struct_of_everything() -> None:
    text = (
        f"float64[3] a\nuint16 b\nstring[2] c\nInner[] d\nInner[2] e\n{SEPARATOR}\n"
        "MSG: demo/Inner\nuint32 x\nstring y"
    )
    tree = ros1(text)

    assert fixed_size(field(tree, "a")) == 24
    assert fixed_size(tree) is None
    assert smallest_size(field(tree, "c")) == 2 * 4
    assert smallest_size(field(tree, "d")) == 4
    assert smallest_size(field(tree, "e")) == 2 * (4 + 4)
    assert smallest_size(tree) == 24 + 2 + 8 + 4 + 16


def test_the_size_of_a_struct_of_numbers_is_their_sum() -> None:
    tree = ros1("float64[3] a\nuint16 b\nduration c")

    assert fixed_size(tree) == smallest_size(tree) == 24 + 2 + 8
