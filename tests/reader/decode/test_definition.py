"""Recorded definitions become trees, and what no message can be is refused."""

from typing import Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from dogbot_logtool.errors import DefinitionError
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

SEPARATOR: Final = "=" * 80
F8, U4, I4, U1 = Primitive("f8"), Primitive("u4"), Primitive("i4"), Primitive("u1")

ODOMETRY: Final = "nav_msgs/msg/Odometry"
CONTACTS_TEXT: Final = f"""\
Header header                                   # stamp
gazebo_msgs/ContactState[] states            # array of geom pairs in contact

{SEPARATOR}
MSG: std_msgs/Header
# Standard metadata for higher-level stamped data types.
uint32 seq
#Two-integer timestamp
time stamp
string frame_id

{SEPARATOR}
MSG: gazebo_msgs/ContactState
string info                                   # text info on this contact
string collision1_name                        # name of contact collision1
string collision2_name                        # name of contact collision2
geometry_msgs/Wrench[] wrenches               # list of forces/torques
geometry_msgs/Wrench total_wrench             # sum of forces/torques in every DOF
geometry_msgs/Vector3[] contact_positions     # list of contact position
geometry_msgs/Vector3[] contact_normals       # list of contact normals
float64[] depths                              # list of penetration depths

{SEPARATOR}
MSG: geometry_msgs/Wrench
# This represents force in free space, separated into
# its linear and angular parts.
Vector3  force
Vector3  torque

{SEPARATOR}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
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


def vector(name: str = "geometry_msgs/msg/Vector3") -> Struct:
    return Struct(name, (("x", F8), ("y", F8), ("z", F8)))


def ros1(text: str) -> Struct:
    return parse_definition("demo/Root", text, "ros1msg")


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


# --- refusals ---------------------------------------------------------------------------------


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
