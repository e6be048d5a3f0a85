"""Messages compared by their definitions, in every encoding, and as bytes without."""

import struct
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate

from dogbot_logtool.options.compare import CompareOptions
from tests.comparison.recordings import (
    JSON,
    RAW,
    SCENE,
    WITH_NUMBER,
    Kind,
    Pair,
    Recording,
    counts,
    odometry,
    one_topic,
    ros_kind,
    scene,
    tally,
)

KIND, AT = ros_kind(1), "/a[0] t=0.000 s"
RENAMED = replace(KIND, schema=KIND.schema.replace(b"child_frame_id", b"other_frame_id"))
COMMENTED = replace(KIND, schema=b"# a comment\n" + KIND.schema.replace(b"\n", b"\r\n"))
UNKNOWN = bytes([(100 << 3) & 0x7F | 0x80, (100 << 3) >> 7, 7])
"""A field of protobuf that the definition lacks."""
NO_POSE = '{"position": null, "orientation": null}'
DEFINITION = '/a schema: expected "string child_frame_id", got "string other_frame_id"'


def update(*, with_pose: bool) -> bytes:
    message: Any = SceneUpdate()
    arrow = message.entities.add().arrows.add()
    if with_pose:
        arrow.pose.SetInParent()
    data: bytes = message.SerializeToString()
    return data


ARRAYS = Kind("ros1", "a/Arrays", "ros1msg", b"uint64[] whole\nfloat32[] numbers\n")


def arrays(whole: Sequence[int], numbers: Sequence[float]) -> bytes:
    parts = zip(("<u8", "<f4"), (whole, numbers), strict=True)
    return b"".join(
        struct.pack("<I", len(each)) + np.array(each, kind).tobytes() for kind, each in parts
    )


def padded() -> bytes:
    """The scene with a length in two bytes; the entity has become a byte longer."""
    data = scene(entity="a").replace(b"\x1a\x01a", b"\x1a\x81\x00a", 1)
    return data[:1] + bytes([len(data) - 2]) + data[2:]


PAIRS: dict[str, tuple[Recording, Recording, list[str]]] = {
    "an unknown encoding": (one_topic(RAW, b"abc", b"abc"), one_topic(RAW, b"abx", b"ab"), [
        f"{AT} payload[2]: expected 0x63, got 0x78",
        "/a[1] t=0.001 s payload: expected 3 bytes, got 2 bytes",
    ]),
    "a field that protobuf leaves out": (
        one_topic(SCENE, update(with_pose=True)), one_topic(SCENE, update(with_pose=False)), [
        f"{AT} entities[0].arrows[0].pose: expected {NO_POSE}, got null"
    ]),
    "a field that protobuf's definition lacks": (
        one_topic(SCENE, scene()), one_topic(SCENE, scene() + UNKNOWN), [
        f"{AT} (unknown fields): expected nothing, got {len(UNKNOWN)} bytes {UNKNOWN.hex()}"
    ]),
    "protobuf in another way": (
        one_topic(SCENE, scene(entity="a")), one_topic(SCENE, padded()), []
    ),
    "arrays": (
        one_topic(ARRAYS, arrays([1, 2, 200], [1.0, 2.0, 3.0])),
        one_topic(ARRAYS, arrays([2, 1, 200], [1.0, 2.5])), [
        f"{AT} whole[0]: expected 1, got 2",
        f"{AT} whole[1]: expected 2, got 1",
        f"{AT} numbers[1]: expected 2.0, got 2.5 (|d| 0.5)",
        f"{AT} numbers: expected 3 elements, got 2 elements",
    ]),
    "a definition with comments": (
        one_topic(KIND, odometry(1)), one_topic(COMMENTED, odometry(1)), []
    ),
    # Named once.
    "another definition": (
        one_topic(KIND, *[odometry(1)] * 100), one_topic(RENAMED, *[odometry(1)] * 100), [
        DEFINITION
    ]),
    "each by its own definition": (
        one_topic(KIND, odometry(1)), one_topic(RENAMED, odometry(1, frame="w")), [
        DEFINITION,
        f'{AT} header.frame_id: expected "world", got "w"',
        f'{AT} child_frame_id: expected "base_link", got nothing',
        f'{AT} other_frame_id: expected nothing, got "base_link"',
    ]),
    "another JSON schema": (
        one_topic(JSON, b"1"), one_topic(replace(JSON, schema=b'{"type": "array"}'), b"1"), [
        r'/a schema: expected "\"type\": \"object\"", got "\"type\": \"array\""'
    ]),
    "another type and encoding": (
        one_topic(KIND, *[odometry(1)] * 100), one_topic(SCENE, *[scene()] * 100), [
        "/a type: expected nav_msgs/Odometry, got foxglove.SceneUpdate",
        "/a encoding: expected ros1, got protobuf",
    ]),
}  # fmt: skip


@pytest.mark.parametrize("name", PAIRS)
def test_what_differs(pair: Pair, name: str) -> None:
    expected, actual, lines = PAIRS[name]
    assert pair.lines(expected, actual) == lines


def test_descriptions_are_counted_apart_from_messages(pair: Pair) -> None:
    pair.write(*PAIRS["another definition"][:2])
    one = tally(pair.compare(), "/a")
    assert (counts(one), one.described_differently) == ((100, 100, 100, 0, 0, 0, 0), 1)
    pair.write(*PAIRS["another type and encoding"][:2])
    assert counts(tally(pair.compare(), "/a")) == (100, 100, 0, 0, 100, 0, 0)
    pair.write(*PAIRS["an unknown encoding"][:2])
    note = "compared as bytes: the encoding 'cbor' is not known"
    assert tally(pair.compare(), "/a").note == note


def test_of_very_many_integers_some_are_named_and_all_are_counted(pair: Pair) -> None:
    pair.write(*(one_topic(ARRAYS, arrays([each] * 107, [])) for each in (0, 1)))
    result = pair.compare(CompareOptions(max_differences=1000))
    assert result.differences[-1].line == f"{AT} whole: expected 7 more elements, got others"
    assert (len(result.differences), result.difference_count) == (101, 107)


@pytest.mark.parametrize("encoding", WITH_NUMBER)
def test_messages_that_cannot_be_decoded_are_compared_as_bytes(pair: Pair, encoding: str) -> None:
    kind, make, _ = WITH_NUMBER[encoding]
    sound = make(1.0)
    assert pair.lines(one_topic(kind, sound), one_topic(kind, sound[:-1])) == [
        f"/a[0] t=0.000 s payload: expected {len(sound)} bytes, got {len(sound) - 1} bytes"
    ]
    assert tally(pair.compare(), "/a").note.startswith("compared as bytes: not ")


@pytest.mark.parametrize("encoding", ["ros1", "cdr", "protobuf"])
def test_broken_definitions_mean_comparing_bytes(pair: Pair, encoding: str) -> None:
    kind, make, _ = WITH_NUMBER[encoding]
    broken = replace(kind, schema=b"\xff( no definition")
    expected, actual = one_topic(broken, make(1.0)), one_topic(broken, make(2.0))
    assert not pair.lines(expected, expected)
    assert len(pair.lines(expected, actual)) == 1
    assert tally(pair.compare(), "/a").note.startswith("compared as bytes: the definition of ")


def test_json_that_is_nested_too_deeply_is_compared_as_bytes(pair: Pair) -> None:
    expected, actual = (b"[" * 990 + number + b"]" * 990 for number in (b"1", b"2"))
    assert pair.lines(one_topic(JSON, expected), one_topic(JSON, actual)) == [
        "/a[0] t=0.000 s payload[990]: expected 0x31, got 0x32"
    ]
    assert tally(pair.compare(), "/a").note.startswith("compared as bytes: ")
