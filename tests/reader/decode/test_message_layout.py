"""Layouts are short, and CDR's alignment is what a person works out by hand."""

from dataclasses import replace
from typing import Final

import numpy as np
from rosbags.typesys import Stores, get_typestore

from dogbot_logtool.reader.decode.definition import parse_definition
from dogbot_logtool.reader.decode.message_layout import (
    ArrayStep,
    Layout,
    Leaf,
    LeafGroup,
    Run,
    Serialisation,
    Step,
    TextStep,
    compile_layout,
)

SEPARATOR: Final = "=" * 80


def layout_of(
    fields: str,
    serialisation: Serialisation,
    wanted: tuple[str, ...] | None = None,
    **messages: str,
) -> Layout:
    sections = [fields, *(f"MSG: demo/{name}\n{text}" for name, text in messages.items())]
    encoding = "ros1msg" if serialisation == "ros1" else "ros2msg"
    struct = parse_definition("demo/Root", f"\n{SEPARATOR}\n".join(sections), encoding)
    return compile_layout(struct, serialisation, wanted)


def odometry(serialisation: Serialisation, wanted: tuple[str, ...] | None = None) -> Layout:
    store, version, encoding = (
        (Stores.ROS1_NOETIC, 1, "ros1msg")
        if serialisation == "ros1"
        else (Stores.ROS2_HUMBLE, 2, "ros2msg")
    )
    name = "nav_msgs/msg/Odometry"
    text, _ = get_typestore(store).generate_msgdef(name, ros_version=version)
    return compile_layout(parse_definition(name, text, encoding), serialisation, wanted)


def offsets(step: Step) -> dict[str, int]:
    assert isinstance(step, Run)
    return {leaf.path: leaf.offset for group in step.groups for leaf in group.leaves}


def run(alignment: int, size: int, *leaves: Leaf) -> Run:
    """A run whose leaves are near each other."""
    first, last = leaves[0], leaves[-1]
    return Run(alignment, size, (LeafGroup(first.offset, last.end - first.offset, leaves),))


def array(step: Step) -> ArrayStep:
    assert isinstance(step, ArrayStep)
    return step


# --- ROS 1 ------------------------------------------------------------------------------------


def test_ros1_fields_of_fixed_width_make_one_run_without_gaps() -> None:
    layout = layout_of(
        "uint8 a\nfloat64 b\nInner c\nuint16[3] d\ntime e", "ros1", Inner="bool x\nint64 y"
    )

    assert layout.steps == (
        run(
            1,
            1 + 8 + 9 + 6 + 8,
            Leaf("a", 0, "u1", None),
            Leaf("b", 1, "f8", None),
            Leaf("c.x", 9, "u1", None),
            Leaf("c.y", 10, "i8", None),
            Leaf("d", 18, "u2", 3),
            Leaf("e.sec", 24, "u4", None),
            Leaf("e.nanosec", 28, "u4", None),
        ),
    )


def test_numbers_far_from_each_other_are_fetched_apart() -> None:
    near, far = Leaf("a", 0, "u4", None), Leaf("b", 4 + 64, "u4", None)
    (step,) = layout_of("uint32 a\nuint8[64] x\nuint32 b", "ros1", ("a", "b")).steps
    assert step == run(1, 72, near, far)

    far = replace(far, offset=4 + 65)
    (step,) = layout_of("uint32 a\nuint8[65] x\nuint32 b", "ros1", ("a", "b")).steps
    assert step == Run(1, 73, (LeafGroup(0, 4, (near,)), LeafGroup(69, 4, (far,))))
    assert isinstance(step, Run)
    assert step.groups[1].dtype(">") == np.dtype([("b", ">u4")])


def test_a_ros1_odometry_is_four_steps() -> None:
    head, frame, child, body = odometry("ros1").steps

    assert offsets(head) == {"header.seq": 0, "header.stamp.sec": 4, "header.stamp.nanosec": 8}
    assert frame == TextStep("header.frame_id", wanted=True, alignment=1)
    assert child == TextStep("child_frame_id", wanted=True, alignment=1)
    assert isinstance(body, Run)
    assert body.size == 8 * (7 + 36 + 6 + 36)
    assert offsets(body)["pose.pose.orientation.w"] == 48
    assert offsets(body)["pose.covariance"] == 56
    assert offsets(body)["twist.twist.angular.z"] == 8 * (7 + 36 + 5)


def test_a_cdr_odometry_is_four_steps_with_an_aligned_body() -> None:
    head, frame, child, body = odometry("cdr").steps

    assert offsets(head) == {"header.stamp.sec": 0, "header.stamp.nanosec": 4}
    assert frame == TextStep("header.frame_id", wanted=True, alignment=1)  # 8 is a multiple of 4
    assert child == TextStep("child_frame_id", wanted=True, alignment=4)
    assert isinstance(body, Run)
    assert (body.alignment, body.size) == (8, 8 * (7 + 36 + 6 + 36))


def test_only_wanted_fields_are_leaves_but_all_are_stepped_over() -> None:
    wanted = ("header.stamp", "pose.pose.position.z", "child_frame_id")

    head, frame, child, body = odometry("ros1", wanted).steps

    assert offsets(head) == {"header.stamp.sec": 4, "header.stamp.nanosec": 8}
    assert frame == TextStep("header.frame_id", wanted=False, alignment=1)
    assert child == TextStep("child_frame_id", wanted=True, alignment=1)
    assert offsets(body) == {"pose.pose.position.z": 16}
    assert isinstance(body, Run)
    assert body.size == 8 * (7 + 36 + 6 + 36)


def test_a_wanted_name_does_not_cover_a_longer_name() -> None:
    layout = layout_of("uint8 pose\nuint8 pose_count", "ros1", ("pose",))

    assert offsets(layout.steps[0]) == {"pose": 0}


def test_a_wanted_field_inside_an_array_makes_the_array_wanted_but_not_its_neighbours() -> None:
    layout = layout_of(
        "Inner[] few\nInner[] none\nInner[] all",
        "ros1",
        ("few.y", "all"),
        Inner="uint8 x\nuint8 y",
    )

    few, none, every = (array(step) for step in layout.steps)

    assert (few.wanted, offsets(few.element[0])) == (True, {"y": 1})
    assert (none.wanted, offsets(none.element[0])) == (False, {})
    assert (every.wanted, offsets(every.element[0])) == (True, {"x": 0, "y": 1})


def test_arrays_know_the_fewest_bytes_of_an_element() -> None:
    layout = layout_of(
        "string[] a\nfloat32[] b\nInner[2] c", "ros1", Inner="uint16 x\nstring[] y\nstring z"
    )

    steps = [array(step) for step in layout.steps]

    assert [step.smallest_element for step in steps] == [4, 4, 2 + 4 + 4]
    assert [step.length for step in steps] == [None, None, 2]
    assert steps[0].element == (TextStep("value", wanted=True, alignment=1),)
    assert steps[1].element == (run(1, 4, Leaf("value", 0, "f4", None)),)


# --- CDR --------------------------------------------------------------------------------------


def test_cdr_numbers_are_aligned_to_their_own_width_from_the_start() -> None:
    layout = layout_of("uint8 a\nuint16 b\nuint8 c\nuint32 d\nuint8 e\nfloat64 f\nbool g", "cdr")

    # a, a gap, b b, c, three gaps, d d d d, e, seven... from 13 to 16, f, g
    assert [offsets(step) for step in layout.steps] == [
        {"a": 0, "b": 2, "c": 4, "d": 8, "e": 12, "f": 16, "g": 24}
    ]
    (run,) = layout.steps
    assert isinstance(run, Run)
    assert run.size == 25


def test_cdr_nested_messages_have_no_alignment_of_their_own() -> None:
    # Inner's first number is one byte wide, so it follows at once; C++ would pad it to 8.
    layout = layout_of("uint8 a\nInner b\nuint8 c", "cdr", Inner="uint8 x\nfloat64 y\nuint8 z")

    assert offsets(layout.steps[0]) == {"a": 0, "b.x": 1, "b.y": 8, "b.z": 16, "c": 17}


def test_cdr_fixed_arrays_are_aligned_once() -> None:
    layout = layout_of("uint8 a\nuint16[3] b\nuint8[3] c\nfloat64[2] d", "cdr")

    assert offsets(layout.steps[0]) == {"a": 0, "b": 2, "c": 8, "d": 16}


def test_cdr_string_lengths_are_aligned_statically_where_the_place_is_known() -> None:
    first, text, second = layout_of("uint8 a\nstring b\nuint8 c", "cdr").steps

    assert isinstance(first, Run)
    assert first.size == 4  # a and three bytes of padding
    assert text == TextStep("b", wanted=True, alignment=1)
    assert second == run(1, 1, Leaf("c", 0, "u1", None))


def test_cdr_after_a_string_everything_is_aligned_when_it_is_read() -> None:
    _, *steps = layout_of("string a\nuint8 b\nuint16 c\nfloat32 d\nuint16 e\nstring f", "cdr").steps

    # Where b stands is not known, so c needs its own alignment, and so does d; e is known by d.
    assert steps == [
        run(1, 1, Leaf("b", 0, "u1", None)),
        run(2, 2, Leaf("c", 0, "u2", None)),
        run(4, 8, Leaf("d", 0, "f4", None), Leaf("e", 4, "u2", None)),
        TextStep("f", wanted=True, alignment=1),
    ]


def test_cdr_elements_are_aligned_each() -> None:
    layout = layout_of("uint32 a\nPair[] pairs\nfloat64[] b", "cdr", Pair="float64 x\nuint8 y")

    _, pairs, numbers = layout.steps

    assert array(pairs).alignment == 1  # its count stands at 4
    assert array(pairs).element == (run(8, 9, Leaf("x", 0, "f8", None), Leaf("y", 8, "u1", None)),)
    assert array(numbers).alignment == 4
    assert array(numbers).element == (run(8, 8, Leaf("value", 0, "f8", None)),)


def test_cdr_elements_that_begin_with_a_narrow_number_are_of_uneven_size() -> None:
    layout = layout_of("Pair[] pairs", "cdr", Pair="uint8 x\nfloat64 y")

    # x follows the last element at once: how far y lies from it depends on the place.
    assert array(layout.steps[0]).element == (
        run(1, 1, Leaf("x", 0, "u1", None)),
        run(8, 8, Leaf("y", 0, "f8", None)),
    )


def test_nothing_gives_no_steps() -> None:
    assert layout_of("", "ros1").steps == ()
